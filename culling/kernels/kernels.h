// Kernels holds the inner loops of culling for one SIMD target.
// Invariant: all targets give the same results bit for bit. The reference is kernels_scalar.cpp.
// Other sets use the same operations in the same order, never fused, or a shortcut with proven
// equal results.
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

/// Boxes of a body and its parts, relative to its root position, in one block of floats. First the
/// body's box (min x, y, z, -, max x, y, z, -), padded to kBoxLanes. Then six rows (min x, y, z,
/// max x, y, z) of padded_parts() floats. Padding lanes hold a box that overlaps nothing.
inline constexpr size_t kBoxLanes = 16;
constexpr size_t padded_parts(size_t parts) {
  return (parts + kBoxLanes - 1) / kBoxLanes * kBoxLanes;
}
constexpr size_t box_block_units(size_t parts) { return 1 + 6 * padded_parts(parts) / kBoxLanes; }

/// Box of a padding lane, inverted and far from everything.
inline constexpr float kEmptyLow = 1e30f;
inline constexpr float kEmptyHigh = -1e30f;

/// Spheres of a frame in slot order (sorted by grid cell). Radii include the float margin.
struct SphereRows {
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  const float* upright;  ///< radius of the upright cylinder, at most the sphere's radius
};

/// Ground rectangle of each slot: its upright prism, with the float margin, contains the body.
struct RectangleRows {
  const float* mid_x;
  const float* mid_y;
  const float* axis_x;  ///< unit vector along the first side
  const float* axis_y;
  const float* half_x;  ///< half side lengths
  const float* half_y;
};

struct SlotPair {
  uint32_t a, b;
};

/// Slots [begin, end).
struct SlotRun {
  uint32_t begin, end;
  /// First slot to test against `slot`: the next one if `slot` is in this run.
  uint32_t first_for(uint32_t slot) const { return begin <= slot && slot < end ? slot + 1 : begin; }
};
/// Maximum number of pairs that a kernel writes beyond those it finds.
inline constexpr size_t kPairSlack = 16;

/// Two bodies with overlapping spheres, body a before body b, with all data for the mid phase.
struct alignas(16) BodyPair {
  float shift_m[4];  ///< root of b minus root of a; then the margin for float rounding
  float scale_a, scale_b;
  uint32_t pose_a, pose_b;  ///< index of the body's first pose
  uint32_t box_a, box_b;    ///< index of the body's block of boxes, in units of kBoxLanes floats
  uint32_t body_a, body_b;  ///< indices into the BodiesView, a < b
  uint16_t type_a, type_b;
};

/// Two parts whose boxes overlap or are within the margin. Candidates of the same two part shapes
/// share a bucket, with the lower shape number first.
struct Candidate {
  uint32_t pair;  ///< index into the task's BodyPairs
  uint8_t part_a, part_b;
  uint16_t bucket_and_swap;

  static constexpr uint16_t kSwapped = 0x8000;
  uint16_t bucket() const { return bucket_and_swap & (kSwapped - 1); }
  /// True if the part of body b has the lower shape number.
  bool is_swapped() const { return (bucket_and_swap & kSwapped) != 0; }
};

/// Data of a frame for the box kernel, in addition to the pairs.
struct BoxFrame {
  const float* blocks;               ///< 64-byte aligned
  const uint16_t* type_parts;        ///< part count by type
  const uint16_t* type_first_shape;  ///< first shape number by type
  uint32_t shapes;                   ///< shapes with a number below this have their own buckets
  float margin_m = 0;                ///< maximum gap of candidate boxes along each axis
};

/// Candidates of shapes a <= b go to bucket a * shapes + b, the others to the last bucket.
constexpr uint32_t bucket_count(uint32_t shapes) { return shapes * shapes + 1; }
/// Limits bucket numbers to 15 bits and keeps the histogram of a task in the cache.
inline constexpr uint32_t kMaxBucketShapes = 180;
static_assert(bucket_count(kMaxBucketShapes) <= Candidate::kSwapped);

/// Computes the buckets of the candidates of one pair of bodies.
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

/// Capacity that box_pairs needs for a pair: kernels write sixteen candidates at a time.
inline size_t max_candidates(const BoxFrame& frame, const BodyPair& pair) {
  return size_t{frame.type_parts[pair.type_a]} * frame.type_parts[pair.type_b] + kBoxLanes;
}

/// Bounds of the distance of two parts.
struct GapBounds {
  float lo_m;  ///< by a direction of their or-DOPs; 0: they may overlap
  float hi_m;  ///< distance of a point on one from a point on the other
};
/// Bounds of the relative rounding of a length. The lengths in its computation are at most this
/// length or those of the parts, whose rounding the margin covers.
inline constexpr float kGapDown = 1 - 0x1p-19f, kGapUp = 1 + 0x1p-19f;
/// or-DOPs proven to be this far apart do not overlap: the gap exceeds any rounding difference.
inline constexpr float kMinGap_m = 1e-3f;

struct OrdopLanes;

struct Kernels {
  /// Tests slot i against slots [begin, end), spheres and cylinders. Appends overlapping pairs to
  /// `out`, which must hold end - begin + kPairSlack pairs. Returns their number.
  size_t (*sphere_run)(const SphereRows& spheres, uint32_t i, uint32_t begin, uint32_t end,
                       SlotPair* out);

  /// Tests each slot of `own` against the slots of every run: spheres, cylinders and rectangles. If
  /// `own` is within the first run, a slot is tested against later ones only; other runs do not
  /// contain it. Appends overlapping pairs to `out`, by slot, run and other slot; it must hold all
  /// tested pairs and kPairSlack more. Returns their number. Adds the number of pairs with
  /// overlapping spheres and cylinders to *spheres_passed. The order of a pair's slots does not
  /// matter.
  size_t (*body_runs)(const SphereRows& spheres, const RectangleRows& rectangles, SlotRun own,
                      const SlotRun* runs, size_t run_count, SlotPair* out,
                      uint64_t* spheres_passed);

  /// Computes boxes of `bodies` bodies of one type. poses: body-major, one per part; scales,
  /// margins: one per body; blocks[i]: block of body i.
  void (*part_boxes)(const OrdopTable* tables, size_t parts, const PartPose* poses,
                     const float* scales, const float* margins, size_t bodies,
                     float* const* blocks);

  /// Writes overlapping or near part boxes of pairs [first, count) to `out`. Stops if less than one
  /// pair's maximum capacity is left. Returns the first pair not processed and sets *found.
  /// Candidates of a pair are in the order (part_a, part_b).
  size_t (*box_pairs)(const BoxFrame& frame, const BodyPair* pairs, size_t first, size_t count,
                      Candidate* out, size_t capacity, size_t* found);

  /// Tests or-DOPs for candidates order[0 .. count) of one bucket. Sets overlaps[order[i]]. `a` is
  /// the table of part a, or of part b if a candidate is swapped.
  using OrdopPairs = void (*)(const OrdopTable& a, const OrdopTable& b, const BodyPair* pairs,
                              const PartPose* poses, const Candidate* candidates,
                              const uint32_t* order, size_t count, uint8_t* overlaps);
  OrdopPairs ordop_pairs_14, ordop_pairs_18, ordop_pairs_26;

  /// Computes distance bounds for candidates of one bucket, as ordop_pairs_26. Sets
  /// bounds[order[i]] and overlaps[order[i]] unless a pair is proven farther apart than margin_m.
  /// If margin_m >= kMinGap_m, no other pairs overlap. `on_a` belongs to the part of `a`.
  void (*ordop_gaps)(const OrdopTable& a, const OrdopTable& b, const NearbyPoints& on_a,
                     const NearbyPoints& on_b, const BodyPair* pairs, const PartPose* poses,
                     const Candidate* candidates, const uint32_t* order, size_t count,
                     float margin_m, GapBounds* bounds, uint8_t* overlaps);

  /// Tests one of the paper's or-DOPs against another; see OrdopLanes. shift_m: root of b minus
  /// root of a, then the margin for float rounding.
  using OrdopPair = bool (*)(const OrdopLanes& a, const PartPose& pose_a, float scale_a,
                             const OrdopLanes& b, const PartPose& pose_b, float scale_b,
                             const float (&shift_m)[4]);
  OrdopPair ordop_pair_14, ordop_pair_18, ordop_pair_26;
};

/// Kernels of a target that this machine supports (asserted); kBest selects the best.
const Kernels& kernels_for(SimdTarget target);

// KernelsOf names the kernels of a volume. Other volumes are placed and tested pair by pair.

/// Kernels of a volume: one tests pairs of the same two parts as lanes, the other one pair.
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

// Scalar reference: plain loops, one pair at a time. Tests compare SIMD kernels bit for bit.

const Kernels& scalar_kernels();

}  // namespace throng
