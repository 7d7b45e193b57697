// MidPhase refines pairs of bodies with overlapping spheres to pairs of parts.
// Invariant: it uses only its own buffers; tasks may run on any thread in any order.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>

#include "culling/fitted.h"
#include "culling/part_tally.h"
#include "culling/stages/part_candidates.h"

namespace throng {

/// Counts and times of one worker. Sums do not depend on the order.
struct MidPhaseCounters {
  StageCounters body_box, part_box, part_volume, triangles;
  uint64_t primitive_tests = 0;
  void add(const MidPhaseCounters& other);
};

/// Overlapping parts of one pair of bodies, consecutive and sorted.
struct PartRun {
  uint32_t body_a, body_b;  ///< indices into the BodiesView, a < b
  uint32_t first, count;
};

struct PartPairs {
  GrowBuffer<uint16_t> parts;  ///< PairKey::parts_of()
  GrowBuffer<PartRun> runs;
  size_t run_count = 0;
  uint32_t times_grown() const { return parts.times_grown() + runs.times_grown(); }
};

/// Fits the volumes of a type that the stage reads, for each of `volumes`. Call before steps.
void fit_for_mid_phase(const BodyType& type, std::span<const VolumeKind> volumes, bool exact);

class MidPhase {
 public:
  /// Runs a task: begin() with the posed bodies, add() for pairs of their slots, finish().
  void begin(const MidPhaseFrame& frame, const PosedBodies& bodies) {
    bodies_ = &bodies;
    tested_ = &parts_;
    parts_.begin(frame, bodies);
  }
  void add(const MidPhaseFrame& frame, std::span<const SlotPair> pairs) {
    parts_.add(frame, pairs);
  }
  void finish(const MidPhaseFrame& frame, PartPairs& out);
  /// finish() without add(), for candidates found within a margin. `overlaps`: flag per candidate,
  /// whether the part volumes overlap. Nothing is counted per pair of parts.
  void finish(const MidPhaseFrame& frame, const PartCandidates& wider,
              std::span<const uint8_t> overlaps, PartPairs& out);

  /// Steps of finish(), for callers that may stop in between: find_candidates(), test_parts(), then
  /// decide_by_triangles() if enabled.
  void find_candidates(const MidPhaseFrame& frame) { parts_.find(frame); }
  void test_parts(const MidPhaseFrame& frame);
  /// Decides the first `max_count` overlapping candidates; returns how many candidates are decided.
  size_t decide_by_triangles(const MidPhaseFrame& frame, uint64_t max_count);

  /// Candidates to refine. Callers may remove some between steps.
  PartCandidates& parts() { return parts_; }
  const PartCandidates& parts() const { return parts_; }
  /// Flag per candidate, after test_parts().
  std::span<const uint8_t> overlaps() const {
    return {overlaps_.data(), tested_->candidates().size()};
  }
  /// Result of triangles per candidate, after finish(). Empty if triangles were not tested.
  std::span<const uint8_t> touches(const MidPhaseFrame& frame) const {
    return frame.exact ? overlaps() : std::span<const uint8_t>();
  }

  /// Makes finish() count per pair of parts from now on.
  void tally_parts() { tally_ = std::make_unique<PartTally>(); }
  const PartTally* tally() const { return tally_.get(); }

  MidPhaseCounters counters() const;
  void clear_counters();
  /// Reserves the memory that another worker's task needed: any worker may run that task next time.
  void reserve_like(const MidPhase& other);
  uint32_t times_grown() const;

 private:
  template <typename Volume>
  void test_by_kernel(const MidPhaseFrame& frame);
  void test_mixture(const MidPhaseFrame& frame);
  template <typename Volume>
  bool overlap(const MidPhaseFrame& frame, uint32_t candidate) const;
  template <typename Volume>
  void test_scalar(const MidPhaseFrame& frame);
  template <typename Volume>
  void test_scalar(const MidPhaseFrame& frame, std::span<const uint32_t> candidates);
  template <typename Volume>
  void test_by_reference(const MidPhaseFrame& frame, uint32_t candidate);
  std::span<uint32_t> still_overlapping(std::span<uint32_t> candidates) const;
  void tally_tests(const MidPhaseFrame& frame);
  void tally_touching(const MidPhaseFrame& frame);
  void write_runs(PartPairs& out) const;

  const PosedBodies* bodies_ = nullptr;
  PartCandidates parts_;
  const PartCandidates* tested_ = nullptr;  // parts_ or the caller's candidates
  GrowBuffer<uint8_t> overlaps_;            // flag per candidate of tested_
  std::unique_ptr<PartTally> tally_;        // null: off
  MidPhaseCounters counters_;               // counters of volumes and triangles
};

// PartPair refers to two parts of a candidate for a single test. It is not stored.

struct PartRef {
  const BodyType::Volumes* volumes;
  size_t part;
  const PartPose* pose;
  float scale;
};

/// Two parts of a candidate and the vector between their roots.
struct PartPair {
  PartRef a, b;
  Eigen::Vector3f a_to_b_m;
  float margin_m;
};

inline PartPair part_pair(const MidPhaseFrame& frame, const PartPose* poses, const BodyPair& pair,
                          uint8_t part_a, uint8_t part_b) {
  return {
      {&frame.types[pair.type_a]->volumes(), part_a, &poses[pair.pose_a + part_a], pair.scale_a},
      {&frame.types[pair.type_b]->volumes(), part_b, &poses[pair.pose_b + part_b], pair.scale_b},
      {pair.shift_m[0], pair.shift_m[1], pair.shift_m[2]},
      pair.shift_m[3]};
}
inline PartPair part_pair(const MidPhaseFrame& frame, const PartPose* poses, const BodyPair& pair,
                          const Candidate& c) {
  return part_pair(frame, poses, pair, c.part_a, c.part_b);
}

/// Updates both volumes, then tests them: two updates per test, as in the paper.
template <typename Volume>
bool placed_overlap(const PartPair& p) {
  const auto place = [&](const PartRef& part) {
    return Volume::place(part.volumes->of<Volume>()[part.part], *part.pose, part.scale);
  };
  return Volume::overlaps(place(p.a), place(p.b), p.a_to_b_m, p.margin_m);
}

inline bool parts_touch(const PartPair& p, TriangleCounters& primitive) {
  return solids_touch(p.a.volumes->surfaces()[p.a.part], *p.a.pose, p.a.scale,
                      p.b.volumes->surfaces()[p.b.part], *p.b.pose, p.b.scale, p.a_to_b_m,
                      primitive);
}

/// Shape with buckets, as a part of its type.
struct ShapePart {
  const BodyType::Volumes& volumes;
  size_t part;
  const OrdopTable& table() const { return volumes.tables()[part]; }
  const NearbyPoints& nearby_points() const { return volumes.nearby_points()[part]; }
};
inline ShapePart shape_part(const MidPhaseFrame& frame, size_t shape) {
  const uint16_t type = frame.shape_type[shape];
  return {frame.types[type]->volumes(), shape - frame.type_first_shape[type]};
}
inline const OrdopTable& table_of(const MidPhaseFrame& frame, size_t shape) {
  return shape_part(frame, shape).table();
}

}  // namespace throng
