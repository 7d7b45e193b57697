// The parts of two bodies that may be within a margin of each other: boxes, then or-DOPs and a few
// points of each, then hulls and triangles.
// One rule: a pair of parts is dropped only by a proof that it is farther apart.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "base/memory.h"
#include "culling/distance/hull_depth.h"
#include "culling/proximity.h"
#include "culling/stages/mid_phase.h"
#include "culling/stages/part_candidates.h"
#include "culling/triangles/triangle_bvh.h"

namespace throng {

/// Makes what is read here of a type; once, before steps.
void fit_for_proximity(const BodyType& type);

/// The float next to a bound that holds it.
inline float rounded_down(double x) {
  const float near = static_cast<float>(x);
  return static_cast<double>(near) > x ? std::nextafter(near, 0.0f) : near;
}
inline float rounded_up(double x) {
  const float near = static_cast<float>(x);
  return static_cast<double>(near) < x
             ? std::nextafter(near, std::numeric_limits<float>::infinity())
             : near;
}

/// What triangles have said already.
enum class TouchState : uint8_t { kUntested, kNo, kYes };

/// Two parts that may be near: what is proven of their distance.
struct ProximityCandidate {
  float lo_m, hi_m;
  uint8_t part_a, part_b;
  TouchState touch;
  bool is_inner;  ///< within the inner margin of a search with two
  uint16_t parts() const { return static_cast<uint16_t>(PairKey::parts_of(part_a, part_b)); }
};

struct ProximityCounters {
  uint64_t volume_tests = 0, triangle_queries = 0;
  double ns = 0;
  TriangleCounters primitives;
};

/// Candidates of a task by boxes and or-DOPs. One a worker.
class ProximityCandidates {
 public:
  void begin(const MidPhaseFrame& frame, const PosedBodies& bodies, float margin_m);
  void add(const MidPhaseFrame& frame, std::span<const SlotPair> pairs,
           std::span<const uint8_t> inner) {
    parts_.add(frame, pairs, inner);
  }
  /// Candidates by boxes, then what or-DOPs and points say of them.
  void find_candidates(const MidPhaseFrame& frame) { parts_.find(frame); }
  void find_bounds(const MidPhaseFrame& frame);

  const PosedBodies& posed() const { return *bodies_; }
  const PartCandidates& parts() const { return parts_; }
  std::span<const BodyPair> pairs() const { return parts_.pairs(); }
  /// Those of a pair are consecutive and sorted, pairs in their order.
  std::span<const Candidate> candidates() const { return parts_.candidates(); }
  /// One a candidate; infinite for those that are farther apart than the margin.
  std::span<const GapBounds> bounds() const { return {bounds_.data(), parts_.candidates().size()}; }
  /// Whether the or-DOPs of each overlap, as without a margin.
  std::span<const uint8_t> overlaps() const {
    return {overlaps_.data(), parts_.candidates().size()};
  }
  void clear_counters() { parts_.clear_counters(); }

  void reserve_like(const ProximityCandidates& other);
  uint32_t times_grown() const {
    return parts_.times_grown() + bounds_.times_grown() + overlaps_.times_grown();
  }

 private:
  const PosedBodies* bodies_ = nullptr;
  float margin_m_ = 0;
  PartCandidates parts_;
  GrowBuffer<GapBounds> bounds_;
  GrowBuffer<uint8_t> overlaps_;
};

/// Both bounds by the convex hulls: within 0.2 mm of each other where the parts are convex and a
/// corner of each is nearest to the other.
void tighten_by_hulls(const PartPair& pair, ProximityCandidate& candidate);
/// Both bounds by the triangles, which both parts have: within 1 mm of each other.
void tighten_by_triangles(const PartPair& pair, ProximityCandidate& candidate,
                          ProximityCounters& counters);

/// What triangles say of a candidate.
struct DistanceResult {
  bool is_within = false;  ///< false: proven farther apart than asked
  bool touches = false;
  double lo_m = 0, hi_m = 0;
  Eigen::Vector3d on_a_m, on_b_m;  ///< relative to a's root, in world axes
  Eigen::Vector3d normal;
  double depth_m = 0;
};

/// Asks the triangles. One a thread: keeps memory.
class TriangleQuery {
 public:
  /// What is proven of a pair that is near does not depend on `within_m`.
  DistanceResult decide(const PartPair& pair, const ProximityCandidate& candidate, double within_m,
                        ProximityCounters& counters);
  /// Of those that touch alone; all others are not near.
  DistanceResult decide_touch(const PartPair& pair, TouchState known, ProximityCounters& counters);

 private:
  DistanceResult touching(const PartPair& pair, ProximityCounters& counters);

  DepthFinder depths_;
};

}  // namespace throng
