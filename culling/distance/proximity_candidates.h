// ProximityCandidates lists the parts of two bodies that may be within a margin. It tests boxes,
// or-DOPs and a few points of each, then hulls and triangles.
// Invariant: a pair of parts is dropped only by a proof that it is farther apart.
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

/// Fits the data of a type that candidates read. Call once, before steps.
void fit_for_proximity(const BodyType& type);

/// Nearest float that preserves a lower or upper bound.
inline float rounded_down(double x) {
  const float rounded = static_cast<float>(x);
  return static_cast<double>(rounded) > x ? std::nextafter(rounded, 0.0f) : rounded;
}
inline float rounded_up(double x) {
  const float rounded = static_cast<float>(x);
  return static_cast<double>(rounded) < x
             ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
             : rounded;
}

/// Earlier result of the triangle test.
enum class TouchState : uint8_t { kUntested, kNo, kYes };

/// Two parts that may be within the margin, with distance bounds.
struct ProximityCandidate {
  float lo_m, hi_m;
  uint8_t part_a, part_b;
  TouchState touch;
  bool is_inner;  ///< within the inner margin of a search with two margins
  uint16_t parts() const { return static_cast<uint16_t>(PairKey::parts_of(part_a, part_b)); }
};

struct ProximityCounters {
  uint64_t volume_tests = 0, triangle_queries = 0;
  double ns = 0;
  TriangleCounters primitives;
};

/// Candidates of a task, by boxes and or-DOPs. Use one instance per worker.
class ProximityCandidates {
 public:
  void begin(const MidPhaseFrame& frame, const PosedBodies& bodies, float margin_m);
  void add(const MidPhaseFrame& frame, std::span<const SlotPair> pairs,
           std::span<const uint8_t> inner) {
    parts_.add(frame, pairs, inner);
  }
  /// Finds candidates by boxes, then their bounds by or-DOPs and points.
  void find_candidates(const MidPhaseFrame& frame) { parts_.find(frame); }
  void find_bounds(const MidPhaseFrame& frame);

  const PosedBodies& posed() const { return *bodies_; }
  const PartCandidates& parts() const { return parts_; }
  std::span<const BodyPair> pairs() const { return parts_.pairs(); }
  /// Candidates of a pair are consecutive and sorted; pairs are in the order of add().
  std::span<const Candidate> candidates() const { return parts_.candidates(); }
  /// Bounds per candidate; infinite if proven farther apart than the margin.
  std::span<const GapBounds> bounds() const { return {bounds_.data(), parts_.candidates().size()}; }
  /// Flag per candidate: the or-DOPs overlap, as without a margin.
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

/// Tightens both bounds by the convex hulls. They are within 0.2 mm of each other if the parts are
/// convex and a corner of each is nearest to the other.
void tighten_by_hulls(const PartPair& pair, ProximityCandidate& candidate);
/// Tightens both bounds by the triangles, which both parts must have: within 1 mm of each other.
void tighten_by_triangles(const PartPair& pair, ProximityCandidate& candidate,
                          ProximityCounters& counters);

/// Result of the triangle tests of a candidate.
struct DistanceResult {
  bool is_within = false;  ///< false: proven farther apart than requested
  bool touches = false;
  double lo_m = 0, hi_m = 0;
  Eigen::Vector3d on_a_m, on_b_m;  ///< relative to a's root, in world axes
  Eigen::Vector3d normal;
  double depth_m = 0;
};

/// Computes distances between triangle meshes. Keeps scratch memory: use one instance per thread.
class TriangleQuery {
 public:
  /// The bounds of a pair within the distance do not depend on `within_m`.
  DistanceResult decide(const PartPair& pair, const ProximityCandidate& candidate, double within_m,
                        ProximityCounters& counters);
  /// As decide(), for touching parts only; all others are not within the distance.
  DistanceResult decide_touch(const PartPair& pair, TouchState known, ProximityCounters& counters);

 private:
  DistanceResult touching(const PartPair& pair, ProximityCounters& counters);

  DepthFinder depths_;
};

}  // namespace throng
