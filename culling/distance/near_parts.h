// The parts of two bodies that may be within a margin of each other, from boxes to or-DOPs and
// hulls to triangles. One rule: a pair of parts is dropped only by a proof that it is farther
// apart.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/grow_buffer.h"
#include "culling/body_type.h"
#include "culling/distance/hull_depth.h"
#include "culling/exact/triangle_bvh.h"
#include "culling/near.h"
#include "culling/stages/posed_bodies.h"

namespace throng {

/// Two bodies that may be near, a before b by index into the BodiesView.
struct NearBodies {
  const PosedBody* a;
  const PosedBody* b;
  Eigen::Vector3f a_to_b_m;
  float margin_m;  ///< bounds all float rounding
};

/// Two parts that may be near: what their volumes prove.
struct NearCandidate {
  float lo_m, hi_m;
  std::array<float, 3> direction;  ///< along which lo_m is proven; unit, world axes, from a to b
  std::array<float, 3> near_m;     ///< where a's hull is nearest to b's, relative to a's root
  uint8_t part_a, part_b;
  uint16_t parts() const { return static_cast<uint16_t>(PairKey::parts_of(part_a, part_b)); }
};

struct NearCounters {
  uint64_t volume_tests = 0, exact_tests = 0;
  ExactCounters primitives;
};

/// Makes what is read here of a type; once, before steps.
void fit_for_near(const BodyType& type, bool exact);

/// What all bodies of a frame share.
struct NearFrame {
  std::span<const std::shared_ptr<const BodyType>> types;
  const PosedBodies& posed;
  float near_m;
};

/// Whether the boxes of the two bodies, in their poses, are within the margin.
bool may_be_near(const NearFrame& frame, const NearBodies& bodies);

/// Appends the parts that are not proven farther apart than the margin, in the order of
/// (part_a, part_b).
void find_near_parts(const NearFrame& frame, const NearBodies& bodies,
                     GrowBuffer<NearCandidate>& out, size_t& count, NearCounters& counters);

/// What triangles say of a candidate.
struct NearVerdict {
  bool is_near = false;  ///< false: proven farther apart than asked
  double lo_m = 0, hi_m = 0;
  Eigen::Vector3d on_a_m, on_b_m;  ///< relative to a's root, in world axes
  Eigen::Vector3d normal;
  double depth_m = 0;
};

/// Asks the triangles. One a thread: keeps memory.
class NearDecider {
 public:
  NearVerdict decide(const NearFrame& frame, const NearBodies& bodies,
                     const NearCandidate& candidate, double within_m, NearCounters& counters);

 private:
  DepthFinder depths_;
};

}  // namespace throng
