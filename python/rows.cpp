#include "python/rows.h"

#include <pybind11/numpy.h>

#include <limits>
#include <unordered_map>

namespace throng {
namespace {

uint64_t key_of(const EventRow& event) {
  return PairKey(event.body_a, event.body_b, event.part_a, event.part_b).bits();
}

template <class Row>
void set_pair(Row& row, const PairKey& pair) {
  row.body_a = pair.a();
  row.body_b = pair.b();
  row.part_a = static_cast<uint8_t>(pair.part_a());
  row.part_b = static_cast<uint8_t>(pair.part_b());
}

ContactRow begun(const EventRow& event, double step_s) {
  return {event.body_a,
          event.body_b,
          event.part_a,
          event.part_b,
          event.level,
          0,
          event.frame,
          -1,
          static_cast<double>(event.frame) * step_s,
          std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace

std::vector<ContactRow> contacts_of(const std::vector<EventRow>& events, double step_s,
                                    int64_t frames) {
  std::vector<ContactRow> contacts;
  contacts.reserve(events.size() / 2 + 1);
  std::unordered_map<uint64_t, size_t> open;
  for (const EventRow& event : events) {
    if (event.kind == static_cast<uint8_t>(EventKind::kBegin)) {
      open[key_of(event)] = contacts.size();
      contacts.push_back(begun(event, step_s));
      continue;
    }
    const auto found = open.find(key_of(event));
    if (found == open.end()) continue;  // the begin is missing in the log
    ContactRow& contact = contacts[found->second];
    open.erase(found);
    contact.end_frame = event.frame;
    contact.end_s = static_cast<double>(event.frame) * step_s;
    contact.ended = event.frame < frames;
  }
  return contacts;
}

void add_proximity(int64_t frame, const ProximityRows& pairs, std::vector<ProximityRow>& rows) {
  for (const ProximityPair& pair : pairs) {
    ProximityRow& row = rows.emplace_back();
    row.frame = frame;
    set_pair(row, pair.pair);
    row.level = static_cast<uint8_t>(pair.level);
    row.distance_lo_m = pair.lo_m;
    row.distance_hi_m = pair.hi_m;
    std::copy(pair.point_a_m.begin(), pair.point_a_m.end(), row.point_a_m);
    std::copy(pair.point_b_m.begin(), pair.point_b_m.end(), row.point_b_m);
    std::copy(pair.normal.begin(), pair.normal.end(), row.normal);
    row.depth_m = pair.depth_m;
    row.closing_speed_mps = pair.closing_speed_mps;
    row.time_to_contact_s = pair.time_to_contact_s();
  }
}

void add_contact_points(int64_t frame, std::span<const ContactPoint> points,
                        std::vector<ContactPointRow>& rows) {
  for (const ContactPoint& point : points) {
    ContactPointRow& row = rows.emplace_back();
    row.frame = frame;
    set_pair(row, point.pair);
    std::copy(point.point_m.begin(), point.point_m.end(), row.point_m);
    std::copy(point.normal.begin(), point.normal.end(), row.normal);
    row.depth_m = point.depth_m;
  }
}

void register_rows() {
  PYBIND11_NUMPY_DTYPE(EventRow, frame, body_a, body_b, part_a, part_b, kind, level);
  PYBIND11_NUMPY_DTYPE(ContactRow, body_a, body_b, part_a, part_b, level, ended, begin_frame,
                       end_frame, begin_s, end_s);
  PYBIND11_NUMPY_DTYPE(PairRow, body_a, body_b, part_a, part_b);
  PYBIND11_NUMPY_DTYPE(ProximityRow, frame, body_a, body_b, part_a, part_b, level, distance_lo_m,
                       distance_hi_m, point_a_m, point_b_m, normal, depth_m, closing_speed_mps,
                       time_to_contact_s);
  PYBIND11_NUMPY_DTYPE(ContactPointRow, frame, body_a, body_b, part_a, part_b, point_m, normal,
                       depth_m);
  PYBIND11_NUMPY_DTYPE(PersonRow, id, group, model, scale, height_m);
  PYBIND11_NUMPY_DTYPE(PositionRow, frame, time_s, id, x_m, y_m, z_m, heading_rad, speed_mps);
  PYBIND11_NUMPY_DTYPE(FrameRow, frame, time_s, touching, begins, ends, persisting,
                       body_sphere_updates, body_sphere_tests, body_sphere_passed, body_box_updates,
                       body_box_tests, body_box_passed, part_box_updates, part_box_tests,
                       part_box_passed, part_volume_updates, part_volume_tests, part_volume_passed,
                       triangles_updates, triangles_tests, triangles_passed, posed_bodies, frame_ms,
                       cull_ms);
}

}  // namespace throng
