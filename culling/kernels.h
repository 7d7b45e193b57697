// The loops that decide the speed of culling, one set a SIMD target, all with the same answers.
// One rule: kernels_scalar.cpp is the reference; every other set gives the same bits, because each
// result is computed by the same operations in the same order and nothing is fused.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/pose.h"
#include "base/simd.h"
#include "culling/slabs.h"

namespace throng {

/// Boxes of a body and its parts, relative to its root position, in one block of floats: the body's
/// own box (min x, y, z, -, max x, y, z, -), padded to kBoxLanes; then six rows (min x, y, z, max
/// x, y, z) of padded_parts() floats. Padding lanes hold a box that overlaps nothing.
inline constexpr size_t kBoxLanes = 16;
constexpr size_t padded_parts(size_t parts) {
  return (parts + kBoxLanes - 1) / kBoxLanes * kBoxLanes;
}
constexpr size_t box_block_units(size_t parts) { return 1 + 6 * padded_parts(parts) / kBoxLanes; }

/// The box of a padding lane, far from everything and inside out.
inline constexpr float kEmptyLow = 1e30f;
inline constexpr float kEmptyHigh = -1e30f;

/// A part's or-DOP laid out for lookup by the sign bits of a direction (bit 0: x negative, ...),
/// and recentred: its slabs are taken around `origin`, the centre of its box, so that the three
/// axis slabs have centre zero and drop out of every sum.
struct alignas(64) OrdopTable {
  explicit OrdopTable(const Slabs& fitted);
  // Sixteen entries, the second eight a copy of the first: one register of any width up to 512
  // bits.
  float corner_half[16], corner_centre[16];
  float edge_half[3][16], edge_centre[3][16];  ///< by the axis that the edge direction leaves out
  Slabs slabs;                                 ///< recentred
  float origin[3];
};

/// The spheres of a frame in slot order (sorted by grid cell), radii inflated by the float margin.
struct SphereRows {
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  const float* upright;  ///< radius of the upright cylinder, at most the sphere's
};

struct SlotPair {
  uint32_t a, b;
};

/// Two bodies whose spheres overlap, body a before body b, all that the part stages need of them.
struct alignas(16) BodyPair {
  float shift_m[4];  ///< root of b minus root of a; then the margin that bounds all float rounding
  float scale_a, scale_b;
  uint32_t pose_a, pose_b;  ///< first pose of the body
  uint32_t box_a, box_b;    ///< the body's block of boxes, in units of kBoxLanes floats
  uint32_t body_a, body_b;  ///< indices into the BodiesView, a < b
  uint16_t type_a, type_b;
};

/// Two parts whose boxes overlap.
struct Candidate {
  uint32_t pair;  ///< index into the block's BodyPairs
  uint8_t part_a, part_b;
  uint16_t bucket;  ///< candidates of the same two part shapes share a bucket
};

/// What the box kernel reads of the frame besides the pairs.
struct BoxFrame {
  const float* blocks;               ///< 64-byte aligned
  const uint16_t* type_parts;        ///< part count by type
  const uint16_t* type_first_shape;  ///< first shape number by type
  uint32_t shapes;                   ///< shapes with a number below this have buckets of their own
};

/// Candidates of shapes (a, b) go to bucket a * shapes + b; the rest share the last one.
constexpr uint32_t bucket_count(uint32_t shapes) { return shapes * shapes + 1; }
/// Keeps every bucket number within 16 bits and the histogram of a block in the cache.
inline constexpr uint32_t kMaxBucketShapes = 200;

inline uint16_t bucket_of(const BoxFrame& frame, size_t type_a, size_t part_a, size_t type_b,
                          size_t part_b) {
  const size_t shape_a = frame.type_first_shape[type_a] + part_a;
  const size_t shape_b = frame.type_first_shape[type_b] + part_b;
  const bool own = shape_a < frame.shapes && shape_b < frame.shapes;
  return static_cast<uint16_t>(own ? shape_a * frame.shapes + shape_b
                                   : bucket_count(frame.shapes) - 1);
}

struct Kernels {
  /// Tests slot i against slots [begin, end), spheres and cylinders; appends the overlapping pairs
  /// to out (which has room for end - begin more); returns how many.
  size_t (*sphere_run)(const SphereRows& spheres, uint32_t i, uint32_t begin, uint32_t end,
                       SlotPair* out);

  /// Boxes of `bodies` bodies of one type. poses: body-major, parts a row; scales, margins: one a
  /// body; blocks[i]: where the block of body i starts.
  void (*part_boxes)(const OrdopTable* tables, size_t parts, const PartPose* poses,
                     const float* scales, const float* margins, size_t bodies,
                     float* const* blocks);

  /// Writes the overlapping part boxes of pairs [first, count) to out until less than one pair's
  /// worst case of room is left; returns the first pair not done and sets *found. Candidates of a
  /// pair come in the order (part_a, part_b).
  size_t (*box_pairs)(const BoxFrame& frame, const BodyPair* pairs, size_t first, size_t count,
                      Candidate* out, size_t room, size_t* found);

  /// or-DOP against or-DOP for candidates of one bucket, order[0 .. count): sets
  /// overlaps[order[i]].
  using OrdopPairs = void (*)(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                              const PartPose* poses, const Candidate* candidates,
                              const uint32_t* order, size_t count, uint8_t* overlaps);
  OrdopPairs ordop_pairs_14, ordop_pairs_18, ordop_pairs_26;
};

/// The kernels of a target that this machine has (asserted); kBest is the best.
const Kernels& kernels_for(SimdTarget target);

}  // namespace throng
