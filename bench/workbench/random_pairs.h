// RandomPairs generates pairs of meeting bodies with difficult parts from random numbers.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "base/random.h"
#include "culling/culling.h"
#include "culling/triangles/triangle_bvh.h"

namespace throng::bench {

// Random numbers, poses and closed bodies for trials of volumes and tests of culling.
// Invariant: all randomness comes from a seed that the caller prints.

/// Draw is a stream of random numbers of one seed.
class Draw {
 public:
  explicit Draw(uint64_t seed, uint64_t id = 0) : key_{seed, id, 0, Purpose::kBoxWorld} {}

  double uniform(double low, double high) {
    ++key_.step;
    return random_uniform(key_, low, high);
  }
  int integer(int low, int high) {  ///< both included
    return low + static_cast<int>(uniform(0, high - low + 1));
  }
  Eigen::Vector3d in_box(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half);
    return {x, y, uniform(-half, half)};
  }
  Eigen::Vector3d direction() {
    const double z = uniform(-1, 1), turn = uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  Eigen::Quaterniond rotation() {  ///< uniform (Shoemake 1992)
    const double u = uniform(0, 1), v = uniform(0, 2 * std::numbers::pi),
                 w = uniform(0, 2 * std::numbers::pi);
    return {std::sqrt(u) * std::cos(w), std::sqrt(1 - u) * std::sin(v),
            std::sqrt(1 - u) * std::cos(v), std::sqrt(u) * std::sin(w)};
  }
  PartPose pose(double reach_m) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = rotation().toRotationMatrix();
    out.translation() = in_box(reach_m);
    return to_part_pose(out);
  }

 private:
  RandomKey key_;
};

inline Eigen::Vector3d placed_exactly(const PartPose& pose, float scale, const Eigen::Vector3f& p) {
  return to_isometry(pose) * (static_cast<double>(scale) * p.cast<double>());
}

inline double reach_of(const std::vector<Eigen::Vector3f>& points) {
  double reach = 0;
  for (const Eigen::Vector3f& p : points) reach = std::max(reach, p.cast<double>().norm());
  return reach;
}

struct Solid {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3i> triangles;
};

/// Returns a closed, outward-oriented, bumpy ellipsoid with `rings` by `spokes` vertices.
inline Solid bumpy_ellipsoid(Draw& draw, int rings, int spokes, const Eigen::Vector3d& half_m,
                             double bump) {
  Solid out;
  const auto add = [&](double polar, double turn) {
    const Eigen::Vector3d d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                            std::cos(polar));
    out.points.push_back((draw.uniform(1 - bump, 1 + bump) * d.cwiseProduct(half_m)).cast<float>());
  };
  add(0, 0);
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < spokes; ++s)
      add(std::numbers::pi * r / rings, 2 * std::numbers::pi * s / spokes);
  add(std::numbers::pi, 0);
  const auto at = [&](int r, int s) { return 1 + (r - 1) * spokes + s % spokes; };
  const int last = static_cast<int>(out.points.size()) - 1;
  for (int s = 0; s < spokes; ++s) {
    out.triangles.push_back({0, at(1, s), at(1, s + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      out.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      out.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
    out.triangles.push_back({last, at(rings - 1, s + 1), at(rings - 1, s)});
  }
  return out;
}

inline Solid box_solid(const Eigen::Vector3d& half_m,
                       const Eigen::Vector3d& centre_m = Eigen::Vector3d::Zero()) {
  Solid out;
  for (int i = 0; i < 8; ++i)
    out.points.push_back(
        (centre_m +
         Eigen::Vector3d((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1).cwiseProduct(half_m))
            .cast<float>());
  out.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return out;
}

/// Reverses the orientation of all triangles.
inline Solid inside_out(Solid solid) {
  for (Eigen::Vector3i& t : solid.triangles) std::swap(t[0], t[1]);
  return solid;
}

/// Returns one mesh of both, without shared vertices.
inline Solid both(const Solid& a, const Solid& b) {
  Solid out = a;
  const int shift = static_cast<int>(a.points.size());
  out.points.insert(out.points.end(), b.points.begin(), b.points.end());
  for (const Eigen::Vector3i& t : b.triangles)
    out.triangles.push_back(t + Eigen::Vector3i::Constant(shift));
  return out;
}

/// Returns the solid angle of the surface around a point over 4 pi (Van Oosterom and Strackee
/// 1983): 1 inside, 0 outside; -1 inside an inverted surface.
inline double winding_number(const Solid& solid, const Eigen::Vector3d& p) {
  double sum = 0;
  for (const Eigen::Vector3i& t : solid.triangles) {
    Eigen::Vector3d c[3];
    for (int i = 0; i < 3; ++i) c[i] = solid.points[static_cast<size_t>(t[i])].cast<double>() - p;
    const double a = c[0].norm(), b = c[1].norm(), d = c[2].norm();
    sum += std::atan2(c[0].cross(c[1]).dot(c[2]),
                      a * b * d + c[0].dot(c[1]) * d + c[1].dot(c[2]) * a + c[2].dot(c[0]) * b);
  }
  return sum / (2 * std::numbers::pi);
}

/// A part of several pieces, with the pieces for tests.
struct MixedPart {
  std::vector<Solid> solids;  ///< closed solids of any orientation
  std::vector<Solid> loose;   ///< triangles next to them, or attached to a corner or an edge
  Solid mesh;                 ///< all pieces, with shuffled triangles

  /// Slow oracle: tests each solid separately.
  bool contains(const Eigen::Vector3d& p) const {
    for (const Solid& solid : solids)
      if (std::fabs(winding_number(solid, p)) > 0.5) return true;
    return false;
  }
};

/// Draws one or two solids of up to `size_m`, apart, overlapping or nested, and up to three loose
/// triangles. With `may_be_open`, loose triangles may be alone.
inline MixedPart mixed_part(Draw& draw, double size_m, bool may_be_open) {
  MixedPart out;
  const auto solid = [&](double size) {
    const Eigen::Vector3d half(draw.uniform(0.5, 1) * size, draw.uniform(0.5, 1) * size,
                               draw.uniform(0.5, 1) * size);
    Solid shape =
        draw.integer(0, 1) == 0 ? box_solid(half) : bumpy_ellipsoid(draw, 3, 4, half, 0.2);
    return draw.integer(0, 1) == 0 ? shape : inside_out(std::move(shape));
  };
  const bool is_open = may_be_open && draw.integer(0, 1) == 0;
  if (!is_open) out.solids.push_back(solid(size_m));
  if (!is_open && draw.integer(0, 1) == 0) {
    Solid second = solid(draw.uniform(0.2, 1) * size_m);
    const Eigen::Vector3f aside = draw.in_box(draw.uniform(0, 1.5) * size_m).cast<float>();
    for (Eigen::Vector3f& point : second.points) point += aside;
    out.solids.push_back(std::move(second));
  }
  const int loose = draw.integer(is_open || out.solids.size() > 1 ? 1 : 0, 3);
  for (int i = 0; i < loose; ++i) {
    Solid triangle;
    for (int c = 0; c < 3; ++c) triangle.points.push_back(draw.in_box(1.5 * size_m).cast<float>());
    triangle.triangles = {{0, 1, 2}};
    // Attaches it to a corner or an edge of a solid by equal positions.
    for (int c = 0; !out.solids.empty() && c < draw.integer(0, 2); ++c) {
      const Solid& from = out.solids.front();
      triangle.points[static_cast<size_t>(c)] =
          from.points[static_cast<size_t>(from.triangles.front()[c])];
    }
    out.loose.push_back(std::move(triangle));
  }
  for (const auto* pieces : {&out.solids, &out.loose})
    for (const Solid& piece : *pieces) out.mesh = both(out.mesh, piece);
  for (int i = static_cast<int>(out.mesh.triangles.size()) - 1; i > 0; --i)
    std::swap(out.mesh.triangles[static_cast<size_t>(i)],
              out.mesh.triangles[static_cast<size_t>(draw.integer(0, i))]);
  return out;
}

// Input of the no-miss check. Only near pairs of parts count: those whose axis-aligned boxes, grown
// by one centimetre, overlap. For all others the boxes prove that they are apart.

enum class Family {
  kBlobs,     ///< bumpy ellipsoids and boxes
  kAdult,     ///< the parts of the bundled adult
  kFlat,      ///< plates without thickness, tilted and axis-parallel
  kNeedle,    ///< one metre long, some micrometres thick
  kPoint,     ///< all corners in one point, and segments
  kNested,    ///< small parts inside large closed ones
  kFar,       ///< blobs and plates at 10 km and 100 km from the world's origin
  kTouching,  ///< boxes and plates that share a corner, an edge or a face, up to rounding
  kMixed      ///< solids and loose triangles in one part, whose pieces count separately
};
inline constexpr Family kFamilies[] = {Family::kBlobs,  Family::kAdult,    Family::kFlat,
                                       Family::kNeedle, Family::kPoint,    Family::kNested,
                                       Family::kFar,    Family::kTouching, Family::kMixed};
std::string_view name_of(Family family);

/// A body type with the data of the oracle.
struct BodyKind {
  std::shared_ptr<const BodyType> type;
  std::vector<TriangleBvh> trees;
  std::vector<MixedPart> mixed;  ///< kMixed: the parts with their pieces
};
std::vector<BodyKind> kinds_of(Family family, Draw& draw);

/// The bounds of a part relative to its body's root.
struct PartBox {
  Eigen::Vector3d low, high;
  /// `a_to_b_m`: b's root relative to a's.
  static bool is_within_margin(const PartBox& a, const PartBox& b, const Eigen::Vector3d& a_to_b_m);
};

/// Bodies 2 i and 2 i + 1 meet: a corner of a part of one lies near a corner of a part of the
/// other. Different pairs are far from each other.
class RandomPairs : public PoseSource {
 public:
  static constexpr int kPairs = 192;

  /// Keeps a reference to `kinds`.
  RandomPairs(Family family, const std::vector<BodyKind>& kinds, Draw& draw);

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

  /// Oracle: tests all triangles of small parts in double precision, with unrounded roots. For
  /// larger parts, and for one part inside the other, it uses the tree of triangles.
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
