// The rows of the module's tables, as numpy has them: structured arrays.
// One rule: a field is named after what it is, with its unit; bodies and parts go by the numbers
// that logs and the command give them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "culling/pair.h"
#include "culling/proximity.h"

namespace throng {

/// A pair of parts begins or ceases to touch.
struct EventRow {
  int64_t frame;
  uint32_t a, b;
  uint8_t part_a, part_b;
  uint8_t kind;   ///< 0: begins, 1: ends
  uint8_t level;  ///< PairLevel
};

/// A pair of parts from when it began to touch until it ceased to.
struct ContactRow {
  uint32_t a, b;
  uint8_t part_a, part_b;
  uint8_t level;  ///< PairLevel, when it began
  uint8_t ended;  ///< 0: it still touched when the run was over
  int64_t begin_frame, end_frame;
  double begin_s, end_s;
};

/// A pair of parts that touches now.
struct PairRow {
  uint32_t a, b;
  uint8_t part_a, part_b;
};

/// How near a pair of parts is; see culling/proximity.h. NaN where only volumes were asked.
struct ProximityRow {
  uint32_t a, b;
  uint8_t part_a, part_b;
  uint8_t level;  ///< PairLevel: 2 volumes, 3 triangles
  float lo_m, hi_m;
  double a_m[3], b_m[3];  ///< the nearest points, in the world
  float normal[3];
  float depth_m, closing_speed_mps, time_to_contact_s;
};

/// Where a pair of parts touches; see ContactPoint in culling/proximity.h.
struct ContactPointRow {
  uint32_t a, b;
  uint8_t part_a, part_b;
  double point_m[3];
  float direction[3];
  float depth_m;
};

struct PersonRow {
  uint32_t id;
  uint16_t group;  ///< index into the names of groups
  uint16_t model;  ///< index into the names of models
  float scale;     ///< height / height of the model
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

/// What a frame cost, and found.
struct FrameRow {
  int64_t frame;
  double time_s;
  int64_t touching, begins, ends, persisting;
  int64_t avatar_updates, avatar_tests, avatar_passed;
  int64_t body_box_updates, body_box_tests, body_box_passed;
  int64_t part_box_updates, part_box_tests, part_box_passed;
  int64_t part_updates, part_tests, part_passed;
  int64_t exact_updates, exact_tests, exact_passed;
  int64_t posed_bodies;
  double frame_ms, cull_ms;
};

std::vector<ProximityRow> proximity_rows(const ProximityRows& pairs);
std::vector<ContactPointRow> contact_point_rows(std::span<const ContactPoint> points);

inline EventRow event_row(int64_t frame, const PairEvent& event) {
  return {frame,
          event.pair.a(),
          event.pair.b(),
          static_cast<uint8_t>(event.pair.part_a()),
          static_cast<uint8_t>(event.pair.part_b()),
          static_cast<uint8_t>(event.kind),
          static_cast<uint8_t>(event.level)};
}

/// The contacts that events are begins and ends of, in the order in which they begin. `frames` is
/// where a run is over: whatever ends there, or not at all, has not ended.
std::vector<ContactRow> contacts_of(const std::vector<EventRow>& events, double step_s,
                                    int64_t frames);

/// Tells numpy about all of them.
void register_rows();

}  // namespace throng
