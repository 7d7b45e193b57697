// The loops that decide the speed of culling, one set a SIMD target, all with the same answers.
// One rule: kernels_scalar.cpp is the reference; every other set gives the same answers, by the
// same operations in the same order, nothing fused, or by a shortcut that proves what they would
// give.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "base/simd.h"
#include "culling/volumes/nearby_points.h"
#include "culling/volumes/ordop.h"
#include "culling/volumes/ordop_table.h"

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

/// The spheres of a frame in slot order (sorted by grid cell), radii inflated by the float margin.
struct SphereRows {
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  const float* upright;  ///< radius of the upright cylinder, at most the sphere's
};

/// A rectangle on the ground for each slot whose upright prism holds the body in its pose, inflated
/// by the float margin.
struct RectangleRows {
  const float* mid_x;
  const float* mid_y;
  const float* axis_x;  ///< unit vector along the first side
  const float* axis_y;
  const float* half_x;  ///< half the sides
  const float* half_y;
};

struct SlotPair {
  uint32_t a, b;
};

/// Slots [begin, end).
struct SlotRun {
  uint32_t begin, end;
  /// The first slot that `slot` is tested against: the next one of the run that it lies in.
  uint32_t first_for(uint32_t slot) const { return begin <= slot && slot < end ? slot + 1 : begin; }
};
/// Pairs that a kernel may write beyond those it finds.
inline constexpr size_t kPairSlack = 16;

/// Two bodies whose spheres overlap, body a before body b, all that the part stages need of them.
struct alignas(16) BodyPair {
  float shift_m[4];  ///< root of b minus root of a; then the margin that bounds all float rounding
  float scale_a, scale_b;
  uint32_t pose_a, pose_b;  ///< first pose of the body
  uint32_t box_a, box_b;    ///< the body's block of boxes, in units of kBoxLanes floats
  uint32_t body_a, body_b;  ///< indices into the BodiesView, a < b
  uint16_t type_a, type_b;
};

/// Two parts whose boxes overlap, or are near. Candidates of the same two part shapes share a
/// bucket: the lower shape number first, so (thigh of a, hand of b) and (hand of a, thigh of b)
/// meet there.
struct Candidate {
  uint32_t pair;  ///< index into the task's BodyPairs
  uint8_t part_a, part_b;
  uint16_t bucket_and_swap;

  static constexpr uint16_t kSwapped = 0x8000;
  uint16_t bucket() const { return bucket_and_swap & (kSwapped - 1); }
  /// The part of body b has the lower shape number.
  bool is_swapped() const { return (bucket_and_swap & kSwapped) != 0; }
};

/// What the box kernel reads of the frame besides the pairs.
struct BoxFrame {
  const float* blocks;               ///< 64-byte aligned
  const uint16_t* type_parts;        ///< part count by type
  const uint16_t* type_first_shape;  ///< first shape number by type
  uint32_t shapes;                   ///< shapes with a number below this have buckets of their own
  float margin_m = 0;                ///< boxes so near each other along every axis are candidates
};

/// Candidates of shapes a <= b go to bucket a * shapes + b; the rest share the last one, as they
/// are.
constexpr uint32_t bucket_count(uint32_t shapes) { return shapes * shapes + 1; }
/// Keeps every bucket number within 15 bits and the histogram of a task in the cache.
inline constexpr uint32_t kMaxBucketShapes = 180;
static_assert(bucket_count(kMaxBucketShapes) <= Candidate::kSwapped);

/// Sorts the candidates of one pair of bodies.
class BucketRule {
 public:
  BucketRule(const BoxFrame& frame, size_t type_a, size_t type_b)
      : shapes_(frame.shapes),
        first_a_(frame.type_first_shape[type_a]),
        first_b_(frame.type_first_shape[type_b]) {}
  uint16_t operator()(uint32_t part_a, uint32_t part_b) const {
    const uint32_t a = first_a_ + part_a, b = first_b_ + part_b;
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    if (high >= shapes_) return static_cast<uint16_t>(bucket_count(shapes_) - 1);
    return static_cast<uint16_t>((low * shapes_ + high) | (b < a ? Candidate::kSwapped : 0u));
  }
  uint32_t shapes() const { return shapes_; }
  uint32_t first_a() const { return first_a_; }  ///< shape number of body a's first part
  uint32_t first_b() const { return first_b_; }

 private:
  uint32_t shapes_, first_a_, first_b_;
};

/// The room that box_pairs wants for a pair: kernels write sixteen candidates at once.
inline size_t max_candidates(const BoxFrame& frame, const BodyPair& pair) {
  return size_t{frame.type_parts[pair.type_a]} * frame.type_parts[pair.type_b] + kBoxLanes;
}

/// Holds how far apart two parts are.
struct GapBounds {
  float lo_m;  ///< by a direction of their or-DOPs; 0: perhaps they overlap
  float hi_m;  ///< from a point on one to a point on the other
};
/// The share of a length that rounding leaves at least, where it was worked out from lengths no
/// greater than it and the parts', whose rounding the margin bounds.
inline constexpr float kGapDown = 1 - 0x1p-19f, kGapUp = 1 + 0x1p-19f;
/// Or-DOPs proven to be this far apart do not overlap: more than rounding can tell one from the
/// other.
inline constexpr float kMinGap_m = 1e-3f;

struct OrdopLanes;

struct Kernels {
  /// Tests slot i against slots [begin, end), spheres and cylinders; appends the overlapping pairs
  /// to out (which has room for end - begin and kPairSlack more); returns how many.
  size_t (*sphere_run)(const SphereRows& spheres, uint32_t i, uint32_t begin, uint32_t end,
                       SlotPair* out);

  /// Tests each slot of `own` against the slots of every run (of the first run, if it lies there,
  /// against those after it; it lies in no other), spheres, cylinders and rectangles; appends the
  /// overlapping pairs to out (which has room for all tests and kPairSlack more), by slot, run and
  /// other slot; returns how many. Adds those whose spheres and cylinders overlap to
  /// *spheres_passed. The order of a pair's slots does not matter.
  size_t (*body_runs)(const SphereRows& spheres, const RectangleRows& rectangles, SlotRun own,
                      const SlotRun* runs, size_t run_count, SlotPair* out,
                      uint64_t* spheres_passed);

  /// Boxes of `bodies` bodies of one type. poses: body-major, parts a row; scales, margins: one a
  /// body; blocks[i]: where the block of body i starts.
  void (*part_boxes)(const OrdopTable* tables, size_t parts, const PartPose* poses,
                     const float* scales, const float* margins, size_t bodies,
                     float* const* blocks);

  /// Writes the overlapping or near part boxes of pairs [first, count) to out until less than one
  /// pair's worst case of room is left; returns the first pair not done and sets *found. Candidates
  /// of a pair come in the order (part_a, part_b).
  size_t (*box_pairs)(const BoxFrame& frame, const BodyPair* pairs, size_t first, size_t count,
                      Candidate* out, size_t capacity, size_t* found);

  /// or-DOP against or-DOP for candidates of one bucket, order[0 .. count): sets
  /// overlaps[order[i]]. `a` is the table of part a, or of part b where a candidate is turned.
  using OrdopPairs = void (*)(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                              const PartPose* poses, const Candidate* candidates,
                              const uint32_t* order, size_t count, uint8_t* overlaps);
  OrdopPairs ordop_pairs_14, ordop_pairs_18, ordop_pairs_26;

  /// How far apart candidates of one bucket are, as ordop_pairs_26: sets bounds[order[i]] and
  /// overlaps[order[i]] of those that are not proven farther apart than margin_m; no others overlap
  /// if that is kMinGap_m or more. `on_a` is of the part that `a` is of.
  void (*ordop_gaps)(const OrdopTable& a, const OrdopTable& b, const NearbyPoints& on_a,
                     const NearbyPoints& on_b, const BodyPair* pairs, const PartPose* poses,
                     const Candidate* candidates, const uint32_t* order, size_t count,
                     float margin_m, GapBounds* bounds, uint8_t* overlaps);

  /// One or-DOP of the paper's against one other; see OrdopLanes. shift_m: root of b minus
  /// root of a, then the margin that bounds all float rounding.
  using OrdopPair = bool (*)(const OrdopLanes& a, const PartPose& pose_a, float scale_a,
                             const OrdopLanes& b, const PartPose& pose_b, float scale_b,
                             const float (&shift_m)[4]);
  OrdopPair ordop_pair_14, ordop_pair_18, ordop_pair_26;
};

/// The kernels of a target that this machine has (asserted); kBest is the best.
const Kernels& kernels_for(SimdTarget target);

// Which kernels test a volume.
// One rule: a volume that is not named here is placed and tested pair by pair.

/// The kernels of a volume that has some: pairs of the same two parts as lanes, and one pair.
template <typename V>
struct KernelsOf {
  static constexpr bool kExist = false;
};
template <>
struct KernelsOf<Ordop<14>> {
  static constexpr bool kExist = true;
  static constexpr auto kPairs = &Kernels::ordop_pairs_14;
  static constexpr auto kPair = &Kernels::ordop_pair_14;
  static constexpr int kDirectionCount = 14;
};
template <>
struct KernelsOf<Ordop<18>> {
  static constexpr bool kExist = true;
  static constexpr auto kPairs = &Kernels::ordop_pairs_18;
  static constexpr auto kPair = &Kernels::ordop_pair_18;
  static constexpr int kDirectionCount = 18;
};
template <>
struct KernelsOf<Ordop<26>> {
  static constexpr bool kExist = true;
  static constexpr auto kPairs = &Kernels::ordop_pairs_26;
  static constexpr auto kPair = &Kernels::ordop_pair_26;
  static constexpr int kDirectionCount = 26;
};

// The reference kernels: plain loops, one pair at a time.
// One rule: slow and obvious; every SIMD kernel is tested against these to the bit.

const Kernels& scalar_kernels();

}  // namespace throng
