// Bodies in twos that meet, a frame of them, in every way in which parts can be odd: what the law
// of no misses is tried on, whatever claims to keep it. One rule: only near pairs of parts count,
// those whose axis-aligned boxes, widened by a centimetre, overlap; of the others the boxes prove
// that they are apart.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "bench/workbench/random_solids.h"
#include "culling/culling.h"
#include "culling/exact/triangle_bvh.h"

namespace throng::bench {

enum class Family {
  kBlobs,     ///< bumpy ellipsoids and boxes
  kAdult,     ///< the parts of the bundled adult
  kFlat,      ///< plates without thickness, tilted and axis-parallel
  kNeedle,    ///< a metre long, some micrometres thick
  kPoint,     ///< all corners in one place, and segments
  kNested,    ///< small parts inside large closed ones
  kFar,       ///< blobs and plates at 10 km and 100 km from the world's origin
  kTouching,  ///< boxes and plates that share a corner, an edge or a face, to the rounding
  kMixed      ///< solids and loose triangles in one part; triangles decide, each piece by itself
};
inline constexpr Family kFamilies[] = {Family::kBlobs,  Family::kAdult,    Family::kFlat,
                                       Family::kNeedle, Family::kPoint,    Family::kNested,
                                       Family::kFar,    Family::kTouching, Family::kMixed};
std::string_view name_of(Family family);

/// A body type and what the oracle knows of it.
struct BodyKind {
  std::shared_ptr<const BodyType> type;
  std::vector<TriangleBvh> trees;
  std::vector<Mixed> mixed;  ///< kMixed: the parts as they were put together
};
std::vector<BodyKind> kinds_of(Family family, Draw& draw);

/// Relative to the body's own root.
struct PartBox {
  Eigen::Vector3d low, high;
  /// b's root is at `a_to_b_m`, seen from a's.
  static bool near(const PartBox& a, const PartBox& b, const Eigen::Vector3d& a_to_b_m);
};

/// Bodies 2 i and 2 i + 1 meet: a corner of a part of one lies near a corner of one of the other.
/// Couples are far from each other.
class Couples : public PoseSource {
 public:
  static constexpr int kCouples = 192;

  /// Keeps a reference to `kinds`.
  Couples(Family family, const std::vector<BodyKind>& kinds, Draw& draw);

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  BodiesView view() const { return {ids_, types_, scales_, roots_}; }
  std::span<const PartPose> parts_of(uint32_t body) const {
    return {poses_.data() + first_[body], static_cast<size_t>(kind(body).type->part_count())};
  }
  const BodyKind& kind(uint32_t body) const { return kinds_[types_[body]]; }
  uint16_t type(uint32_t body) const { return types_[body]; }
  float scale(uint32_t body) const { return scales_[body]; }
  Eigen::Vector3d root(uint32_t body) const { return roots_[body].position_m; }
  PartBox box(uint32_t body, size_t part) const;

  /// The truth: by all triangles of small parts in double precision, with the roots as they are; of
  /// larger parts, and for one inside the other, by the tree of triangles.
  bool touch(uint32_t a, size_t part_a, uint32_t b, size_t part_b) const;

 private:
  void add(Draw& draw, const Eigen::Vector3d& where, int parity, bool is_lattice);
  void meet(Draw& draw, Family family);

  const std::vector<BodyKind>& kinds_;
  std::vector<uint32_t> ids_;
  std::vector<uint16_t> types_;
  std::vector<float> scales_;
  std::vector<RootPose> roots_;
  std::vector<size_t> first_;
  std::vector<PartPose> poses_;
};

}  // namespace throng::bench
