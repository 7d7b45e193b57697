// Rows of the module's tables, as numpy structured arrays. Bodies and parts have the numbers of
// logs and of the command.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "culling/pair.h"
#include "culling/proximity.h"

namespace throng {

/// A begin or end of a contact of two parts.
struct EventRow {
  int64_t frame;
  uint32_t body_a, body_b;
  uint8_t part_a, part_b;
  uint8_t kind;  ///< 0: begins, 1: ends
  uint8_t level;
};

/// A contact of two parts, from begin to end.
struct ContactRow {
  uint32_t body_a, body_b;
  uint8_t part_a, part_b;
  uint8_t level;  ///< PairLevel at the begin
  uint8_t ended;  ///< 0: still touching at the end of the run
  int64_t begin_frame, end_frame;
  double begin_s, end_s;
};

struct PairRow {
  uint32_t body_a, body_b;
  uint8_t part_a, part_b;
};

/// Distance of a pair of parts; see culling/proximity.h. Point values are NaN if only volumes were
/// tested.
struct ProximityRow {
  int64_t frame;
  uint32_t body_a, body_b;
  uint8_t part_a, part_b;
  uint8_t level;  ///< PairLevel: 2 volumes, 3 triangles
  float distance_lo_m, distance_hi_m;
  double point_a_m[3], point_b_m[3];  ///< nearest points, world frame
  float normal[3];
  float depth_m, closing_speed_mps, time_to_contact_s;
};

/// Contact point of a pair of parts; see ContactPoint in culling/proximity.h.
struct ContactPointRow {
  int64_t frame;
  uint32_t body_a, body_b;
  uint8_t part_a, part_b;
  double point_m[3];
  float normal[3];
  float depth_m;
};

struct PersonRow {
  uint32_t id;
  uint16_t group;
  uint16_t model;
  float scale;
  float height_m;
};

struct PositionRow {
  int64_t frame;
  double time_s;
  uint32_t id;
  double x_m, y_m, z_m;
  float heading_rad;
  float speed_mps;
};

struct FrameRow {
  int64_t frame;
  double time_s;
  int64_t touching, begins, ends, persisting;
  int64_t body_sphere_updates, body_sphere_tests, body_sphere_passed;
  int64_t body_box_updates, body_box_tests, body_box_passed;
  int64_t part_box_updates, part_box_tests, part_box_passed;
  int64_t part_volume_updates, part_volume_tests, part_volume_passed;
  int64_t triangles_updates, triangles_tests, triangles_passed;
  int64_t posed_bodies;
  double frame_ms, cull_ms;
};

/// Appends rows of one frame.
void add_proximity(int64_t frame, const ProximityRows& pairs, std::vector<ProximityRow>& rows);
void add_contact_points(int64_t frame, std::span<const ContactPoint> points,
                        std::vector<ContactPointRow>& rows);

inline std::vector<ProximityRow> proximity_rows(int64_t frame, const ProximityRows& pairs) {
  std::vector<ProximityRow> rows;
  add_proximity(frame, pairs, rows);
  return rows;
}
inline std::vector<ContactPointRow> contact_point_rows(int64_t frame,
                                                       std::span<const ContactPoint> points) {
  std::vector<ContactPointRow> rows;
  add_contact_points(frame, points, rows);
  return rows;
}

inline EventRow event_row(int64_t frame, const PairEvent& event) {
  return {frame,
          event.pair.a(),
          event.pair.b(),
          static_cast<uint8_t>(event.pair.part_a()),
          static_cast<uint8_t>(event.pair.part_b()),
          static_cast<uint8_t>(event.kind),
          static_cast<uint8_t>(event.level)};
}

/// Pairs events to contacts, in order of begin. `frames` is the end of the run: contacts that end
/// there or later have not ended.
std::vector<ContactRow> contacts_of(const std::vector<EventRow>& events, double step_s,
                                    int64_t frames);

void register_rows();

}  // namespace throng
