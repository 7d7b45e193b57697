#include "tests/culling/degenerate_hulls.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "culling/distance/hull_corners.h"
#include "culling/distance/hull_depth.h"
#include "tests/culling/shapes.h"

namespace throng::test {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Eigen::Vector3f>;

constexpr double kTau = 2 * std::numbers::pi;
/// Rounding of sums of doubles, relative to the size of the summands.
constexpr double kRounding = 1e-13;

/// Distance of points from their plane or line, above rounding, in metres: 1e-9 to 1e-5.
double thickness(Draw& draw) { return std::pow(10.0, draw.uniform(-9, -5)); }

Points turned(Draw& draw, const std::vector<Vector3d>& cloud, const Vector3d& shift) {
  const Eigen::Matrix3d turn =
      draw.integer(0, 2) == 0 ? Eigen::Matrix3d::Identity() : draw.rotation().toRotationMatrix();
  Points out;
  for (const Vector3d& p : cloud) out.push_back((turn * p + shift).cast<float>());
  return out;
}

std::vector<Vector3d> sheet(Draw& draw, int count, double thick_m) {
  std::vector<Vector3d> out;
  const int shape = draw.integer(0, 2), side = std::max(1, static_cast<int>(std::sqrt(count)));
  for (int i = 0; i < count; ++i) {
    const double z = draw.uniform(-thick_m, thick_m);
    if (shape == 0) {
      out.emplace_back(draw.uniform(-0.2, 0.2), draw.uniform(-0.1, 0.1), z);
    } else if (shape == 1) {  // a rim
      out.emplace_back(0.2 * std::cos(kTau * i / count), 0.2 * std::sin(kTau * i / count), z);
    } else {
      out.emplace_back(0.4 * (i % side) / side, 0.4 * (i / side) / side, z);
    }
  }
  return out;
}

std::vector<Vector3d> line(Draw& draw, int count, double thick_m) {
  std::vector<Vector3d> out;
  for (int i = 0; i < count; ++i)
    out.push_back(Vector3d(draw.uniform(-0.3, 0.3), 0, 0) + draw.in_box(thick_m));
  return out;
}

std::vector<Vector3d> ball(Draw& draw, int count, bool is_filled) {
  std::vector<Vector3d> out;
  const Vector3d half(draw.uniform(0.01, 0.3), draw.uniform(0.01, 0.3), draw.uniform(0.01, 0.3));
  for (int i = 0; i < count; ++i)
    out.push_back((is_filled ? std::cbrt(draw.uniform(0, 1)) : 1) *
                  draw.direction().cwiseProduct(half));
  return out;
}

/// Rings around an axis, like a turned part; points of the flat end are at 0, 1e-15 or 2e-7.
std::vector<Vector3d> turned_part(Draw& draw, int count) {
  constexpr std::array<double, 3> kEnds = {0, 1e-15, 2e-7};
  const int spokes = draw.integer(3, 72), rings = std::max(2, count / spokes);
  std::vector<double> along = {0}, radius = {draw.uniform(0.01, 0.05)};
  for (int ring = 1; ring < rings; ++ring) {
    along.push_back(draw.integer(0, 3) == 0 ? along.back() : along.back() + draw.uniform(0, 0.01));
    radius.push_back(draw.integer(0, 3) == 0 ? radius.back() : draw.uniform(0.005, 0.05));
  }
  std::vector<Vector3d> out;
  for (size_t ring = 0; ring < along.size(); ++ring)
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double end = kEnds[static_cast<size_t>(draw.integer(0, 2))];
      const double turn = kTau * spoke / spokes;
      out.emplace_back(along[ring] > 0 ? along[ring] : end, radius[ring] * std::cos(turn),
                       radius[ring] * std::sin(turn));
    }
  return out;
}

/// Points of a lattice in a box: all, or those on its sides.
std::vector<Vector3d> lattice(Draw& draw, int count, double thick_m) {
  const int n = std::max(2, static_cast<int>(std::cbrt(count)));
  const bool is_hollow = draw.integer(0, 1) == 0;
  std::vector<Vector3d> out;
  for (int i = 0; i < n * n * n; ++i) {
    const std::array<int, 3> at = {i % n, i / n % n, i / n / n};
    const bool is_on_side =
        std::any_of(at.begin(), at.end(), [&](int c) { return c == 0 || c == n - 1; });
    if (is_hollow && !is_on_side) continue;
    out.push_back(0.1 * Vector3d(at[0], at[1], at[2]) / n + draw.in_box(thick_m));
  }
  return out;
}

/// Few places with many points each.
std::vector<Vector3d> duplicates(Draw& draw, int count, double thick_m) {
  std::vector<Vector3d> places, out;
  for (int i = 0; i < draw.integer(1, 12); ++i) places.push_back(draw.in_box(0.2));
  for (int i = 0; i < count; ++i)
    out.push_back(
        places[static_cast<size_t>(draw.integer(0, static_cast<int>(places.size()) - 1))] +
        (draw.integer(0, 1) == 0 ? Vector3d(0, 0, 0) : draw.in_box(thick_m)));
  return out;
}

/// A ring and a point in front of it: every point is a neighbour of the tip.
std::vector<Vector3d> cone(Draw& draw, int count, double thick_m) {
  std::vector<Vector3d> out = sheet(draw, std::max(1, count - 1), thick_m);
  out.emplace_back(0, 0, draw.uniform(-0.3, 0.3));
  return out;
}

Points cloud_of(Draw& draw, int max_points) {
  const int count = std::max(
      1, static_cast<int>(std::pow(static_cast<double>(max_points), draw.uniform(0, 1)) + 0.5));
  const double thick_m = thickness(draw);
  std::vector<Vector3d> cloud;
  switch (draw.integer(0, 9)) {
    case 0:
      cloud = sheet(draw, count, thick_m);
      break;
    case 1:
      cloud = sheet(draw, count, 0);
      break;
    case 2:
      cloud = line(draw, count, draw.integer(0, 1) * thick_m);
      break;
    case 3:
      cloud = ball(draw, count, false);
      break;
    case 4:
      cloud = ball(draw, count, true);
      break;
    case 5:
      cloud = turned_part(draw, count);
      break;
    case 6:
      cloud = lattice(draw, count, 0);
      break;
    case 7:
      cloud = lattice(draw, count, thick_m);
      break;
    case 8:
      cloud = duplicates(draw, count, thick_m);
      break;
    default:
      cloud = cone(draw, count, draw.integer(0, 1) * thick_m);
  }
  const double size = std::pow(10.0, draw.uniform(-2, 2));
  for (Vector3d& p : cloud) p *= draw.integer(0, 3) == 0 ? size : 1;
  return turned(draw, cloud, draw.integer(0, 1) * draw.in_box(draw.uniform(0, 10)));
}

struct Hull {
  explicit Hull(Points cloud) : points(std::move(cloud)), hull(points) {}
  Points points;
  ConvexHull hull;

  double size_m() const { return hull.beyond_corners_m() / ConvexHull::kShare; }
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class Judge {
 public:
  explicit Judge(DegenerateHullsTally& tally) : tally_(tally) {}

  void judge(const Hull& cloud, Draw& draw, const std::string& name) {
    const ConvexHull& hull = cloud.hull;
    const double rounding = kRounding * (cloud.size_m() + hull.reach_m());
    std::vector<Vector3d> directions;
    for (int i = 0; i < 30; ++i) directions.push_back(draw.direction());
    for (const Vector3d& axis :
         {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitY()), Vector3d(Vector3d::UnitZ())})
      for (const double sign : {-1, 1}) directions.push_back(sign * axis);
    const auto corner = [&] {
      return Vector3d(hull.points().row(draw.integer(0, hull.corner_count() - 1)));
    };
    for (int i = 0; i < 30; ++i) {  // includes nearly parallel planes through corners
      const Vector3d p = corner(), normal = (corner() - p).cross(corner() - p);
      if (!(normal.norm() > 0)) continue;
      directions.push_back(normal.normalized());
      directions.push_back((normal.normalized() + 1e-6 * draw.direction()).normalized());
    }
    double beyond = 0;
    for (const Vector3d& n : directions) {
      const double max = (hull.points() * n).maxCoeff();
      beyond = std::max(beyond, max - hull.support(n).dot(n));
      expect((hull.points().topRows(hull.corner_count()) * n).maxCoeff() <=
                 hull.support(n).dot(n) + rounding,
             name, [] { return std::string("another corner is farther along a direction"); });
    }
    // Distances from single points, along the direction that separates them most from the corners.
    const PartPose here = to_part_pose(Eigen::Isometry3d::Identity());
    for (int i = 0; i < 20; ++i) {
      const Points alone = {
          cloud.points[static_cast<size_t>(draw.integer(0, int(cloud.points.size()) - 1))]};
      const ConvexHull point(alone);
      const HullGap gap = hull_gap({&hull, &here, 1}, {&point, &here, 1}, {0, 0, 0}, directions[0]);
      beyond = std::max(beyond, gap.direction.dot(alone[0].cast<double>()) -
                                    hull.support(gap.direction).dot(gap.direction));
    }
    if (hull.beyond_corners_m() > 0)
      tally_.worst_beyond = std::max(tally_.worst_beyond, beyond / hull.beyond_corners_m());
    expect(beyond <= hull.beyond_corners_m() + rounding, name, [&] {
      return fmt::format("a point lies {} m beyond the corners, allowed {}", beyond,
                         hull.beyond_corners_m());
    });
  }

  void judge(const Hull& a, const Hull& b, Draw& draw, const std::string& name) {
    const double reach = a.size_m() + b.size_m() + a.hull.reach_m() + b.hull.reach_m();
    const double rounding = kRounding * reach + 1e-6 * (a.size_m() + b.size_m()) * 1e-6;
    const PartPose pose_a = draw.pose(0), pose_b = draw.pose(0);
    const auto placed = [](const Points& points, const PartPose& pose, const Vector3d& shift) {
      Eigen::Matrix<double, Eigen::Dynamic, 3> out(static_cast<Eigen::Index>(points.size()), 3);
      for (size_t i = 0; i < points.size(); ++i)
        out.row(static_cast<Eigen::Index>(i)) = placed_exactly(pose, 1, points[i]) + shift;
      return out;
    };
    // Moves a point of one near a point of the other.
    const auto any_point = [&](const Points& points) {
      return points[static_cast<size_t>(draw.integer(0, int(points.size()) - 1))];
    };
    const Eigen::Vector3f shift =
        (placed_exactly(pose_a, 1, any_point(a.points)) -
         placed_exactly(pose_b, 1, any_point(b.points)) + draw.in_box(draw.uniform(0, 0.1)))
            .cast<float>();
    const auto points_a = placed(a.points, pose_a, {0, 0, 0}),
               points_b = placed(b.points, pose_b, shift.cast<double>());
    const PlacedHull hull_a{&a.hull, &pose_a, 1}, hull_b{&b.hull, &pose_b, 1};
    const auto start = std::chrono::steady_clock::now();
    const HullGap gap = hull_gap(hull_a, hull_b, shift, draw.direction());
    const Depth depth = depths_.depth(hull_a, hull_b, shift);
    tally_.longest_pair_s = std::max(tally_.longest_pair_s, seconds_since(start));
    const auto parts_by = [&](const Vector3d& n) {
      return (points_b * n).minCoeff() - (points_a * n).maxCoeff();
    };
    const double gap_short = gap.lo_m - std::max(0.0, parts_by(gap.direction));
    tally_.worst_gap_m = std::max(tally_.worst_gap_m, gap_short);
    expect(gap_short <= rounding, name,
           [&] { return fmt::format("a proven gap is {} m too wide", gap_short); });
    expect(gap.lo_m <= gap.corner_distance_m + rounding, name,
           [] { return std::string("two corners are nearer than the proven gap"); });
    double depth_off = -parts_by(depth.direction) - depth.depth_m;
    for (int i = 0; i < 30 && depth.min_depth_m > 0; ++i)
      depth_off = std::max(depth_off, depth.min_depth_m + parts_by(draw.direction()));
    tally_.worst_depth_m = std::max(tally_.worst_depth_m, depth_off);
    expect(depth_off <= 1e-9 + rounding, name,
           [&] { return fmt::format("a depth is off by {} m", depth_off); });
    const double allowed = 5e-4 + a.hull.beyond_corners_m() + b.hull.beyond_corners_m();
    tally_.widest_depth_m =
        std::max(tally_.widest_depth_m, depth.depth_m - depth.min_depth_m - allowed + 5e-4);
    expect(depth.depth_m - depth.min_depth_m <= allowed, name, [&] {
      return fmt::format("a depth of {} m is proven to {} m", depth.depth_m, depth.min_depth_m);
    });
  }

  template <typename Describe>
  void expect(bool is_right, const std::string& name, const Describe& describe) {
    if (is_right) return;
    ++tally_.wrong;
    if (tally_.first_wrong.empty()) tally_.first_wrong = name + ": " + describe();
  }

 private:
  DegenerateHullsTally& tally_;
  DepthFinder depths_;
};

}  // namespace

void DegenerateHullsTally::add(const DegenerateHullsTally& other) {
  clouds += other.clouds;
  pairs += other.pairs;
  points += other.points;
  incomplete += other.incomplete;
  wrong += other.wrong;
  for (double DegenerateHullsTally::*worst :
       {&DegenerateHullsTally::max_tests, &DegenerateHullsTally::max_faces,
        &DegenerateHullsTally::worst_beyond, &DegenerateHullsTally::worst_gap_m,
        &DegenerateHullsTally::worst_depth_m, &DegenerateHullsTally::widest_depth_m,
        &DegenerateHullsTally::longest_start_s, &DegenerateHullsTally::longest_per_point_us,
        &DegenerateHullsTally::longest_pair_s})
    this->*worst = std::max(this->*worst, other.*worst);
  if (first_wrong.empty()) first_wrong = other.first_wrong;
}

DegenerateHullsTally check_degenerate_hulls(uint64_t clouds, int max_points, uint64_t seed) {
  DegenerateHullsTally tally;
  Judge judge(tally);
  std::optional<Hull> before;
  for (uint64_t number = 0; number < clouds; ++number) {
    Draw draw(seed, number);
    const std::string name = fmt::format("seed {}, cloud {}", seed, number);
    const Points points = cloud_of(draw, max_points);
    const double count = static_cast<double>(points.size());
    const auto start = std::chrono::steady_clock::now();
    Hull cloud(points);
    const double start_s = seconds_since(start);
    tally.longest_start_s = std::max(tally.longest_start_s, start_s);
    if (count >= 1000)
      tally.longest_per_point_us = std::max(tally.longest_per_point_us, 1e6 * start_s / count);
    const HullCorners corners = hull_corners(cloud.hull.points(), cloud.hull.beyond_corners_m());
    tally.max_tests = std::max(tally.max_tests, static_cast<double>(corners.tests) / count);
    tally.max_faces = std::max(tally.max_faces, static_cast<double>(corners.max_faces) / count);
    tally.incomplete += !corners.is_complete;
    judge.expect(static_cast<double>(corners.max_faces) <= 2 * count, name,
                 [] { return std::string("more than two faces per point"); });
    judge.judge(cloud, draw, name);
    if (before) {
      judge.judge(*before, cloud, draw, name);
      ++tally.pairs;
    }
    ++tally.clouds;
    tally.points += points.size();
    before.emplace(std::move(cloud));
  }
  return tally;
}

void print_degenerate_hulls(const DegenerateHullsTally& tally) {
  fmt::print(
      "{} clouds of {} points, {} pairs: {} wrong; {} starts cut short, at most {:.0f} tests and "
      "{:.2f} faces per point; a start takes {:.1f} ms at most ({:.2f} us per point), a pair "
      "{:.1f} ms; worst: {:.3f} of what may lie beyond the corners, gap {:.2g} m, depth {:.2g} m "
      "off, {:.2g} m wide\n",
      tally.clouds, tally.points, tally.pairs, tally.wrong, tally.incomplete, tally.max_tests,
      tally.max_faces, 1e3 * tally.longest_start_s, tally.longest_per_point_us,
      1e3 * tally.longest_pair_s, tally.worst_beyond, tally.worst_gap_m, tally.worst_depth_m,
      tally.widest_depth_m);
  if (tally.wrong > 0) fmt::print("first: {}\n", tally.first_wrong);
}

}  // namespace throng::test
