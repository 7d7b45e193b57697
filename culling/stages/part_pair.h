// Two parts that a candidate names, and what is asked of them one by one.
// One rule: for the part stage alone; a pair is made where it is tested and kept nowhere.
#pragma once

#include <Eigen/Core>

#include "culling/fitted.h"
#include "culling/stages/part_stage.h"

namespace throng {

struct PartOf {
  const BodyType::Volumes* volumes;
  size_t part;
  const PartPose* pose;
  float scale;
};

/// Two parts that a candidate names, and how far apart their roots are.
struct PartPair {
  PartOf a, b;
  Eigen::Vector3f a_to_b_m;
  float margin_m;
};

inline PartPair part_pair(const PartStageFrame& frame, const PartPose* poses, const BodyPair& pair,
                          uint8_t part_a, uint8_t part_b) {
  return {
      {&frame.types[pair.type_a]->volumes(), part_a, &poses[pair.pose_a + part_a], pair.scale_a},
      {&frame.types[pair.type_b]->volumes(), part_b, &poses[pair.pose_b + part_b], pair.scale_b},
      {pair.shift_m[0], pair.shift_m[1], pair.shift_m[2]},
      pair.shift_m[3]};
}
inline PartPair part_pair(const PartStageFrame& frame, const PartPose* poses, const BodyPair& pair,
                          const Candidate& c) {
  return part_pair(frame, poses, pair, c.part_a, c.part_b);
}

/// Updates both volumes, then tests them: two updates a test, as the paper counts.
template <typename Volume>
bool placed_overlap(const PartPair& p) {
  const auto place = [&](const PartOf& part) {
    return Volume::place(part.volumes->of<Volume>()[part.part], *part.pose, part.scale);
  };
  return Volume::overlaps(place(p.a), place(p.b), p.a_to_b_m, p.margin_m);
}

inline bool parts_touch(const PartPair& p, ExactCounters& primitive) {
  return solids_touch(p.a.volumes->surfaces()[p.a.part], *p.a.pose, p.a.scale,
                      p.b.volumes->surfaces()[p.b.part], *p.b.pose, p.b.scale, p.a_to_b_m,
                      primitive);
}

/// A shape that has buckets, as a part of its type.
struct ShapePart {
  const BodyType::Volumes& volumes;
  size_t part;
  const OrdopTable& table() const { return volumes.tables()[part]; }
  const NearbyPoints& nearby_points() const { return volumes.nearby_points()[part]; }
};
inline ShapePart shape_part(const PartStageFrame& frame, size_t shape) {
  const uint16_t type = frame.shape_type[shape];
  return {frame.types[type]->volumes(), shape - frame.type_first_shape[type]};
}
inline const OrdopTable& table_of(const PartStageFrame& frame, size_t shape) {
  return shape_part(frame, shape).table();
}

}  // namespace throng
