#include "culling/distance/hull_depth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "culling/distance/hull_corners.h"
#include "culling/distance/simplex.h"

namespace throng {

// PlacedPoints transforms the corners and points of a hull into a frame that two parts share, in
// double precision from the float pose.

struct PlacedPoints {
  explicit PlacedPoints(const PlacedHull& placed,
                        const Eigen::Vector3d& root_m = Eigen::Vector3d::Zero())
      : hull(*placed.hull) {
    const Eigen::Isometry3d pose = to_isometry(*placed.pose);
    scale = static_cast<double>(placed.scale);
    linear = scale * pose.linear();
    shift = pose.translation() + root_m;
  }
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const {
    return linear * hull.support(linear.transpose() * direction) + shift;
  }
  double extent(const Eigen::Vector3d& direction) const {
    return hull.extent(linear.transpose() * direction) + direction.dot(shift);
  }
  /// Largest distance of a point from the placed origin of the part, except for rounding.
  double reach_m() const { return scale * hull.reach_m(); }
  /// Maximum distance of a point beyond support(), along any unit direction.
  double beyond_support_m() const { return scale * hull.beyond_corners_m(); }

  const ConvexHull& hull;
  double scale;
  Eigen::Matrix3d linear;
  Eigen::Vector3d shift;
};

namespace {

using Eigen::Vector3d;

/// Maximum angle of a direction beyond the edge of its cell, by rounding, in rad.
constexpr double kAngleRounding = 1e-9;

/// Cone around a cell: unit direction of its middle, sine of the angle to its farthest corner.
struct Cone {
  Vector3d middle;
  double sine;
};

/// Tests whether a corner is behind another along all directions of a cone, by their difference.
struct Behind {
  explicit Behind(const Cone& cone) : middle(cone.middle), sine2(cone.sine * cone.sine) {}
  bool operator()(double x, double y, double z) const {
    const double along = middle.x() * x + middle.y() * y + middle.z() * z;
    return (along < 0) & (along * along > sine2 * (x * x + y * y + z * z));
  }
  Vector3d middle;
  double sine2;
};

/// Maximum number of corners to compare pairwise, because the time grows with the square.
constexpr size_t kMaxComparedCorners = 256;

constexpr double kEighth = std::numbers::pi / 4;

std::vector<Vector3d> directions_of(const Cone& cone) {
  std::vector<Vector3d> out;
  const Vector3d u = cone.middle.unitOrthogonal(), v = cone.middle.cross(u);
  for (const double tilt : {0.5 * cone.sine, 2 * cone.sine, 6 * cone.sine})
    for (int turn = 0; turn < 8; ++turn)
      out.push_back(
          (cone.middle + tilt * (std::cos(turn * kEighth) * u + std::sin(turn * kEighth) * v))
              .normalized());
  return out;
}

Cone cone_of(size_t cell, int side) {
  const size_t per_face = static_cast<size_t>(side) * static_cast<size_t>(side);
  const size_t face = cell / per_face, row = cell % per_face / static_cast<size_t>(side),
               column = cell % static_cast<size_t>(side);
  const auto axis = static_cast<Eigen::Index>(face / 2);
  const auto at = [&](double u, double v) {
    Vector3d out;
    out[axis] = face % 2 == 0 ? 1 : -1;
    out[(axis + 1) % 3] = 2 * (static_cast<double>(row) + u) / side - 1;
    out[(axis + 2) % 3] = 2 * (static_cast<double>(column) + v) / side - 1;
    return Vector3d(out.normalized());
  };
  Cone out{at(0.5, 0.5), 0};
  for (const double u : {0.0, 1.0})
    for (const double v : {0.0, 1.0})
      out.sine = std::max(out.sine, at(u, v).cross(out.middle).norm() + kAngleRounding);
  return out;
}

}  // namespace

size_t SupportMap::cell_of(const Vector3d& direction) {
  Eigen::Index axis = 0;
  const double max = direction.cwiseAbs().maxCoeff(&axis);
  if (!(max > 0)) return 0;  // along a null vector all corners are equal
  const auto along = [&](Eigen::Index other) {
    const double share = direction[other] / max;  // -1 to 1
    return static_cast<size_t>(
        std::clamp(static_cast<int>((share + 1) * (0.5 * kSide)), 0, kSide - 1));
  };
  const size_t face = 2 * static_cast<size_t>(axis) + (direction[axis] < 0 ? 1 : 0);
  return (face * kSide + along((axis + 1) % 3)) * kSide + along((axis + 2) % 3);
}

SupportMap::SupportMap(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points,
                       Eigen::Index corners) {
  if (corners <= kFewCorners || corners > kMaxCorners) return;
  start_.reserve(kCells + 1);
  for (size_t cell = 0; cell < kCells; ++cell) add_cell(points, corners, cell);
  start_.push_back(static_cast<uint32_t>(corners_.size()));
}

/// Omits a corner if another is farther along every direction of the cell. Then the angle from the
/// vector between them to the cell's middle exceeds 90 degrees by more than the cell's own angle.
/// Few corners are compared pairwise, many only with the farthest along some directions.
void SupportMap::add_cell(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points,
                          Eigen::Index corners, size_t cell) {
  const Cone cone = cone_of(cell, kSide);
  start_.push_back(static_cast<uint32_t>(corners_.size()));
  Eigen::Index farthest = 0;
  (points.topRows(corners) * cone.middle).maxCoeff(&farthest);
  std::vector<Vector3d> places;
  std::vector<uint16_t> left;
  const Behind is_behind(cone);
  const double *x = points.data(), *y = x + points.rows(), *z = y + points.rows();
  for (Eigen::Index corner = 0; corner < corners; ++corner) {
    if (is_behind(x[corner] - x[farthest], y[corner] - y[farthest], z[corner] - z[farthest]))
      continue;
    left.push_back(static_cast<uint16_t>(corner));
    places.emplace_back(x[corner], y[corner], z[corner]);
  }
  const auto leave_out_behind = [&](const std::vector<Vector3d>& others) {
    size_t count = 0;
    const std::vector<Vector3d> all = places;
    for (size_t i = 0; i < left.size(); ++i) {
      const auto hides = [&](const Vector3d& other) {
        const Vector3d between = all[i] - other;
        return is_behind(between.x(), between.y(), between.z());
      };
      if (std::any_of(others.begin(), others.end(), hides)) continue;
      left[count] = left[i];
      places[count++] = all[i];
    }
    left.resize(count);
    places.resize(count);
  };
  if (left.size() > kMaxComparedCorners) {
    std::vector<Vector3d> ahead;
    for (const Vector3d& direction : directions_of(cone))
      ahead.push_back(*std::max_element(places.begin(), places.end(),
                                        [&](const Vector3d& p, const Vector3d& q) {
                                          return p.dot(direction) < q.dot(direction);
                                        }));
    leave_out_behind(ahead);
  }
  if (left.size() <= kMaxComparedCorners) leave_out_behind(std::vector(places));
  corners_.insert(corners_.end(), left.begin(), left.end());
}

namespace {

/// Pairs of bodies need some tens, two balls in each other with 10 000 corners each some thousands.
/// A pair that needs more gets the bounds found by then.
constexpr size_t kMaxCorners = 20'000;

Eigen::Vector3d cube_corner(const Eigen::Vector3d& direction, double half_m) {
  return direction.unaryExpr([half_m](double x) { return x < 0 ? -half_m : half_m; });
}

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Eigen::Index farthest(const Points& points, Eigen::Index count, const Eigen::Vector3d& direction) {
  constexpr Eigen::Index kBlock = 64;
  std::array<double, kBlock> along;
  double max = -std::numeric_limits<double>::infinity();
  Eigen::Index best = 0;
  for (Eigen::Index first = 0; first < count; first += kBlock) {
    const Eigen::Index block = std::min(kBlock, count - first);
    const double* x = points.data() + first;
    const double* y = x + points.rows();
    const double* z = y + points.rows();
    for (Eigen::Index i = 0; i < block; ++i)
      along[static_cast<size_t>(i)] =
          direction.x() * x[i] + direction.y() * y[i] + direction.z() * z[i];
    for (Eigen::Index i = 0; i < block; ++i) {
      if (along[static_cast<size_t>(i)] <= max) continue;
      max = along[static_cast<size_t>(i)];
      best = first + i;
    }
  }
  return best;
}

}  // namespace

ConvexHull::ConvexHull(std::span<const Eigen::Vector3f> points)
    : points_(static_cast<Eigen::Index>(points.size()), 3) {
  assert(!points.empty());
  for (size_t i = 0; i < points.size(); ++i)
    points_.row(static_cast<Eigen::Index>(i)) = points[i].cast<double>();
  const double size_m = (points_.colwise().maxCoeff() - points_.colwise().minCoeff()).maxCoeff();
  beyond_corners_m_ = kShare * size_m;
  reach_m_ = std::sqrt(points_.rowwise().squaredNorm().maxCoeff());
  const std::vector<Eigen::Index> corners = hull_corners(points_, beyond_corners_m_).indices;
  corner_count_ = static_cast<int>(corners.size());
  for (size_t i = 0; i < corners.size(); ++i)  // ascending, so that none is overwritten
    points_.row(static_cast<Eigen::Index>(i)).swap(points_.row(corners[i]));
  supports_ = SupportMap(points_, corner_count_);
}

Eigen::Vector3d ConvexHull::support(const Eigen::Vector3d& direction) const {
  if (supports_.is_empty()) return points_.row(farthest(points_, corner_count_, direction));
  Eigen::Index best = 0;
  double max = -std::numeric_limits<double>::infinity();
  for (const uint16_t corner : supports_.along(direction)) {
    const double along = points_.row(corner).dot(direction);
    if (along <= max) continue;
    max = along;
    best = corner;
  }
  return points_.row(best);
}

double ConvexHull::extent(const Eigen::Vector3d& direction) const {
  return direction.dot(points_.row(farthest(points_, points_.rows(), direction)));
}

namespace {

/// Points of A and B whose difference is the point of the face nearest to the origin.
NearestPoints points_of(const GrowingPolytope::Face& face,
                        std::span<const Eigen::Vector3d> differences,
                        std::span<const Eigen::Vector3d> on_a) {
  const std::array<double, 3> weights = weights_of_nearest(
      differences[face.corners[0]], differences[face.corners[1]], differences[face.corners[2]]);
  NearestPoints out{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (size_t i = 0; i < 3; ++i) {
    const uint32_t corner = face.corners[i];
    out.on_a += weights[i] * on_a[corner];
    out.on_b += weights[i] * (on_a[corner] - differences[corner]);
  }
  return out;
}

}  // namespace

/// Tolerances of the search for a depth, in metres.
struct DepthFinder::Tolerances {
  /// Distance that the hull may exceed a face that counts as final.
  double gap_m;
  /// Half edge of the cube added to the difference of the hulls, so that flat hulls also span a
  /// volume. Gap and half the cube's diagonal together bound the error.
  double cube_m;
};

uint32_t DepthFinder::lowest_face() {
  while (inside_.distances()[lowest_.front().slot] != lowest_.front().distance) {
    std::pop_heap(lowest_.begin(), lowest_.end());
    lowest_.pop_back();
  }
  return lowest_.front().slot;
}

// An expanding polytope (van den Bergen 2001) with two changes. It is inside the difference of the
// hulls from the start, but need not contain the origin. The face whose plane is lowest is pushed
// out; if the difference ends before the origin does, the hulls are apart. A small cube is added to
// the difference, so that flat hulls need no special cases.
Depth DepthFinder::find(const PlacedPoints& a, const PlacedPoints& b,
                        const Tolerances& tolerances) {
  const double reach_m = 2 * (a.reach_m() + b.reach_m() + tolerances.cube_m) +
                         (b.shift - a.shift).norm();  // float rotations are slightly askew
  const double grid_m = GrowingPolytope::grid_m(reach_m);
  const double cube_m = std::max(tolerances.cube_m, 4 * grid_m);
  const auto cube = [&](const Eigen::Vector3d& n) { return cube_corner(n, cube_m); };
  const auto put = [&](uint32_t slot) {
    lowest_.push_back({inside_.distances()[slot], slot});
    std::push_heap(lowest_.begin(), lowest_.end());
  };
  const Eigen::Vector3d first = a.support(b.shift - a.shift);
  const Eigen::Vector3d middle = first - b.support(a.shift - b.shift);
  on_a_.assign(4, first);
  inside_.start({middle + cube({1, 1, 1}), middle + cube({1, -1, -1}), middle + cube({-1, 1, -1}),
                 middle + cube({-1, -1, 1})},
                reach_m);
  lowest_.clear();
  for (uint32_t slot = 0; slot < 4; ++slot) put(slot);
  Depth out;
  double min_reach = std::numeric_limits<double>::infinity();
  for (;;) {
    const uint32_t lowest = lowest_face();
    const Eigen::Vector3d normal = inside_.faces()[lowest].normal;
    const double inner = inside_.distances()[lowest];
    const Eigen::Vector3d far_on_a = a.support(normal);
    const Eigen::Vector3d far = far_on_a - b.support(-normal);
    if (const double reach = normal.dot(far); reach < min_reach) {
      min_reach = reach;
      out.direction = normal;
    }
    const Eigen::Vector3d corner = far + cube(normal);
    const bool is_known = normal.dot(corner) - inner <= tolerances.gap_m;
    if (min_reach > 0 && !is_known && inside_.points().size() < kMaxCorners &&
        inside_.add(corner, lowest)) {
      on_a_.push_back(far_on_a);
      for (const uint32_t slot : inside_.added()) put(slot);
      continue;
    }
    out.min_depth_m = std::max(0.0, inner - std::sqrt(3.0) * (cube_m + grid_m));
    // Includes the corners left out.
    out.depth_m = std::max(0.0, a.extent(out.direction) + b.extent(-out.direction));
    out.points_m = points_of(inside_.faces()[lowest], inside_.points(), on_a_);
    return out;
  }
}

Depth DepthFinder::depth(const PlacedHull& a, const PlacedHull& b,
                         const Eigen::Vector3f& a_to_b_m) {
  constexpr Tolerances kCoarse{4e-4, 2e-5};
  // For depths that may be 0.
  constexpr Tolerances kFine{1e-7, 1e-7};
  constexpr double kMaxShallowDepth_m = 1e-3;
  const PlacedPoints placed_a(a), placed_b(b, a_to_b_m.cast<double>());
  Depth coarse = find(placed_a, placed_b, kCoarse);
  if (coarse.depth_m == 0 || coarse.depth_m > kMaxShallowDepth_m) return coarse;
  return find(placed_a, placed_b, kFine);
}

namespace {

using Eigen::Vector3d;

constexpr int kMaxSteps = 32;
constexpr double kConverged_m = 1e-4;

NearestPoints points_of(const Simplex& simplex) {
  NearestPoints out{Vector3d::Zero(), Vector3d::Zero()};
  for (int i = 0; i < simplex.count; ++i) {
    const Simplex::Corner& corner = simplex.corners[static_cast<size_t>(i)];
    out.on_a += simplex.weights[static_cast<size_t>(i)] * corner.on_a;
    out.on_b += simplex.weights[static_cast<size_t>(i)] * corner.on_b;
  }
  return out;
}

}  // namespace

HullGap hull_gap(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m,
                 const Eigen::Vector3d& direction) {
  const PlacedPoints there_a(a), there_b(b, a_to_b_m.cast<double>());
  HullGap out;
  out.direction = direction;
  out.corner_distance_m = out.distance_m = std::numeric_limits<double>::max();
  Simplex simplex;
  Vector3d towards = direction;
  double max = -std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxSteps; ++step) {
    simplex.add(there_a.support(towards), there_b.support(-towards));
    const Vector3d& between = simplex.corners[static_cast<size_t>(simplex.count - 1)].between;
    out.corner_distance_m = std::min(out.corner_distance_m, between.norm());
    if (const double gap = towards.dot(between); gap > max) {
      max = gap;
      out.direction = towards;
    }
    const Vector3d nearest = simplex.reduce();
    if (simplex.count == 4) {  // the origin is inside
      out.distance_m = 0;
      break;
    }
    const double distance = nearest.norm();
    if (!(distance < out.distance_m)) break;
    out.distance_m = distance;
    out.points_m = points_of(simplex);
    if (distance - max < kConverged_m) break;
    towards = nearest / distance;
  }
  out.lo_m = std::max(0.0, max - there_a.beyond_support_m() - there_b.beyond_support_m());
  return out;
}

}  // namespace throng
