// HullDepth is never below the true value and at most 1 mm above it, for all kinds of hulls.
#include "culling/distance/hull_depth.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "bench/crowd.h"
#include "culling/triangles/triangle_bvh.h"
#include "tests/culling/depth_oracle.h"

namespace throng::hull_depth_test {
namespace {

using test::Cloud;
using test::Draw;
using test::HullDirections;

constexpr double kAllowed_m = 1e-3;
constexpr double kRounding_m = 1e-9;

/// Placed hull and its points.
struct Body {
  Body(std::vector<Eigen::Vector3f> shape, const PartPose& at, float size)
      : points(std::move(shape)), hull(points), pose(at), scale(size) {}

  std::vector<Eigen::Vector3f> points;
  ConvexHull hull;
  PartPose pose;
  float scale;

  PlacedHull placed() const { return {&hull, &pose, scale}; }
  Cloud cloud(const Eigen::Vector3f& shift = Eigen::Vector3f::Zero()) const {
    Cloud out;
    for (const Eigen::Vector3f& p : points)
      out.push_back(test::placed_exactly(pose, scale, p) + shift.cast<double>());
    return out;
  }
};

Depth depth_of(const Body& a, const Body& b,
               const Eigen::Vector3f& a_to_b_m = Eigen::Vector3f::Zero()) {
  DepthFinder finder;
  return finder.depth(a.placed(), b.placed(), a_to_b_m);
}

std::vector<Eigen::Vector3f> random_points(Draw& draw, int count, const Eigen::Vector3d& size) {
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < count; ++i) out.push_back(draw.in_box(1).cwiseProduct(size).cast<float>());
  return out;
}

PartPose at(const Eigen::Vector3d& place) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = place;
  return to_part_pose(pose);
}

double true_depth(const Body& a, const Body& b, const Eigen::Vector3f& a_to_b_m) {
  const Cloud cloud_a = a.cloud();
  const Cloud cloud_b = b.cloud(a_to_b_m);
  return depth_by_all_directions(cloud_a, test::all_directions(cloud_a), cloud_b,
                                 test::all_directions(cloud_b));
}

/// Error of the depth. Fails the test if a guarantee does not hold.
double checked_error(const Body& a, const Body& b, const Eigen::Vector3f& a_to_b_m,
                     const std::string& what) {
  const double truth = true_depth(a, b, a_to_b_m);
  const Depth found = depth_of(a, b, a_to_b_m);
  EXPECT_GE(found.depth_m, truth - kRounding_m) << what << ": too small";
  EXPECT_LE(found.depth_m, truth + kAllowed_m) << what << ": too large";
  EXPECT_LE(found.min_depth_m, truth + kRounding_m) << what << ": the proven bound is wrong";
  EXPECT_LE(found.depth_m - found.min_depth_m, 0.5 * kAllowed_m)
      << what << ": the proven bound is too low";
  return found.depth_m - truth;
}

TEST(HullDepth, IsTheLeastTranslationForRandomHulls) {
  double worst = 0;
  int deep = 0;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    Draw draw(seed);
    const auto body = [&] {
      const Eigen::Vector3d size(draw.uniform(0.02, 0.4), draw.uniform(0.02, 0.4),
                                 draw.uniform(0.02, 0.4));
      return Body(random_points(draw, draw.integer(4, 11), size), draw.pose(0.1),
                  static_cast<float>(draw.uniform(0.5, 1.5)));
    };
    const Body a = body();
    const Body b = body();
    const Eigen::Vector3f shift = draw.in_box(draw.uniform(0, 0.3)).cast<float>();
    worst = std::max(worst, checked_error(a, b, shift, fmt::format("seed {}", seed)));
    deep += true_depth(a, b, shift) > 0;
  }
  EXPECT_GT(deep, 150) << "most hulls are apart";
  RecordProperty("worst_um", static_cast<int>(worst * 1e6));
}

/// Distance of a point beyond a cloud along a direction: at most 0 inside a hull.
double beyond(const Cloud& cloud, const Eigen::Vector3d& direction, const Eigen::Vector3d& point) {
  double max = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& p : cloud) max = std::max(max, direction.dot(p));
  return direction.dot(point) - max;
}

TEST(HullDepth, HasPointsOfBothHullsAtTheProvenDistance) {
  int deep = 0;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Draw draw(seed, 7);
    const Body a(random_points(draw, 12, {0.3, 0.2, 0.1}), draw.pose(0.1), 1.2f);
    const Body b(random_points(draw, 12, {0.1, 0.3, 0.2}), draw.pose(0.1), 0.8f);
    const Eigen::Vector3f shift = draw.in_box(0.2).cast<float>();
    const Depth found = depth_of(a, b, shift);
    if (found.depth_m == 0) continue;
    ++deep;
    ASSERT_GE((found.points_m.on_a - found.points_m.on_b).norm(), found.min_depth_m);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d direction = draw.direction();
      ASSERT_LE(beyond(a.cloud(), direction, found.points_m.on_a), 1e-4);
      ASSERT_LE(beyond(b.cloud(shift), direction, found.points_m.on_b), 1e-4);
    }
  }
  EXPECT_GT(deep, 150);
}

TEST(HullDepth, HasTheDeepestPoints) {
  std::vector<Eigen::Vector3f> cube;
  for (const float x : {-0.1f, 0.1f})
    for (const float y : {-0.1f, 0.1f})
      for (const float z : {-0.1f, 0.1f}) cube.emplace_back(x, y, z);
  const Body a(cube, at({0, 0, 0}), 1), b(cube, at({0, 0, 0}), 1);
  const Depth found = depth_of(a, b, {0.17f, 0.05f, -0.04f});  // 3 cm deep, along x
  EXPECT_NEAR(found.depth_m, 0.03, kAllowed_m);
  EXPECT_NEAR(found.points_m.on_a.x(), 0.1, kAllowed_m);
  EXPECT_NEAR(found.points_m.on_b.x(), 0.07, kAllowed_m);
  EXPECT_NEAR(found.points_m.on_a.y(), found.points_m.on_b.y(), 0.01);
  EXPECT_NEAR(found.points_m.on_a.z(), found.points_m.on_b.z(), 0.01);
}

// Points, needles, sheets, huge and tiny hulls, against each other and themselves.
TEST(HullDepth, HandlesAllKindsOfHulls) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    Draw draw(seed);
    std::vector<test::Shape> shapes = test::special_shapes(seed);
    for (test::Shape& shape : shapes)
      if (shape.points.size() > 7) shape.points.resize(7);
    for (const test::Shape& first : shapes)
      for (const test::Shape& second : shapes) {
        const Body a(first.points, draw.pose(0.05), 1);
        const Body b(second.points, draw.pose(0.05), static_cast<float>(draw.uniform(0.5, 1.5)));
        // A point of each on a point of the other.
        const Eigen::Vector3f shift =
            (a.cloud().back() - b.cloud().front() + draw.in_box(0.01)).cast<float>();
        const std::string what = fmt::format("seed {}, {} and {}", seed, first.name, second.name);
        checked_error(a, b, shift, what);
        const Body same(first.points, a.pose, 1);
        checked_error(a, same, Eigen::Vector3f::Zero(), what + ", the first on itself");
      }
  }
}

TEST(HullDepth, IsKnownForBoxes) {
  const std::vector<Eigen::Vector3f> box = test::box_solid({0.2, 0.1, 0.5}).points;
  const std::vector<Eigen::Vector3f> small = test::box_solid({0.02, 0.01, 0.03}).points;
  const Body a(box, at({0, 0, 0}), 1);
  const auto depth = [&](const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& place) {
    return depth_of(a, Body(points, at(place), 1)).depth_m;
  };
  EXPECT_NEAR(depth(box, {0.35, 0, 0}), 0.05, 1e-6);
  EXPECT_NEAR(depth(box, {0, 0, 0}), 0.2, 1e-6) << "on itself";
  EXPECT_NEAR(depth(small, {0, 0, 0}), 0.11, 1e-6) << "inside";
  EXPECT_NEAR(depth(small, {0.1, 0.05, 0.2}), 0.06, 1e-6) << "inside, not in the middle";
  EXPECT_NEAR(depth(box, {0.4, 0, 0}), 0, 1e-6) << "touching faces";
  EXPECT_NEAR(depth(box, {0.4, 0.2, 1.0}), 0, 1e-6) << "touching corners";
  EXPECT_EQ(depth(box, {0.401, 0, 0}), 0);
  EXPECT_EQ(depth(box, {0.41, 0.3, 0}), 0);
  EXPECT_EQ(depth(small, {5, 5, 5}), 0);
}

TEST(HullDepth, SeparatesAlongItsDirectionAndNoShorterPathDoes) {
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Draw draw(seed);
    const Body a(random_points(draw, 40, {0.2, 0.1, 0.3}), draw.pose(0.05), 1);
    const Body b(random_points(draw, 40, {0.1, 0.3, 0.1}), draw.pose(0.05), 1.2f);
    const Depth found = depth_of(a, b);
    const auto moved = [&](const Eigen::Vector3d& by) {
      return depth_of(a, b, by.cast<float>()).depth_m;
    };
    EXPECT_EQ(moved((found.depth_m + 1e-6) * found.direction), 0) << "seed " << seed;
    for (int i = 0; i < 20; ++i)
      EXPECT_GT(moved((found.min_depth_m - 1e-6) * draw.direction()), 0) << "seed " << seed;
    const double swapped = depth_of(b, a).depth_m;
    EXPECT_NEAR(swapped, found.depth_m, 0.5 * kAllowed_m) << "seed " << seed;
  }
}

TEST(ConvexHull, HasCornersThatEncloseAllPoints) {
  for (uint64_t seed = 1; seed <= 3; ++seed)
    for (const test::Shape& shape : test::special_shapes(seed)) {
      const ConvexHull hull(shape.points);
      Draw draw(seed);
      const double size = 2 * test::reach_of(shape.points);
      for (int i = 0; i < 200; ++i) {
        const Eigen::Vector3d n = draw.direction();
        double max = -1e9;
        for (const Eigen::Vector3f& p : shape.points) max = std::max(max, n.dot(p.cast<double>()));
        EXPECT_NEAR(hull.extent(n), max, 1e-12 * size) << shape.name;
        EXPECT_LE(hull.support(n).dot(n), max + 1e-12 * size) << shape.name;
        EXPECT_GE(hull.support(n).dot(n), max - ConvexHull::kShare * size) << shape.name;
      }
    }
}

/// Proven faces and edges of the hull: no point is in front of a face.
HullDirections hull_directions(const Cloud& cloud) {
  GrowingPolytope hull;
  size_t i = 1;
  double reach = 0;
  for (const Eigen::Vector3d& p : cloud) reach = std::max(reach, p.norm());
  const auto volume = [&](size_t j, size_t k, size_t l) {
    return std::fabs((cloud[j] - cloud[0]).cross(cloud[k] - cloud[0]).dot(cloud[l] - cloud[0]));
  };
  while (volume(i, i + 1, i + 2) < 1e-7) ++i;
  hull.start({cloud[0], cloud[i], cloud[i + 1], cloud[i + 2]}, reach);
  for (const Eigen::Vector3d& p : cloud) hull.add(p);
  HullDirections out;
  for (uint32_t slot = 0; slot < hull.faces().size(); ++slot) {
    if (!hull.is_face(slot)) continue;
    const GrowingPolytope::Face& face = hull.faces()[slot];
    for (size_t c = 0; c < 3; ++c)
      if (face.corners[c] < face.corners[(c + 1) % 3])
        out.edges.push_back(
            {hull.points()[face.corners[c]], hull.points()[face.corners[(c + 1) % 3]]});
    out.normals.push_back(face.normal);
    for (const Eigen::Vector3d& p : cloud)
      EXPECT_LE(face.normal.dot(p), hull.distances()[slot] + 1e-9);
  }
  return out;
}

/// Corners of a hull in random order, so that the first few exclude most directions.
Cloud shuffled_corners(const ConvexHull& hull, uint64_t seed) {
  Cloud out;
  for (int i = 0; i < hull.corner_count(); ++i) out.push_back(hull.points().row(i));
  Draw draw(seed);
  for (int i = hull.corner_count() - 1; i > 0; --i)
    std::swap(out[static_cast<size_t>(i)], out[static_cast<size_t>(draw.integer(0, i))]);
  return out;
}

// Every touching pair of parts of people who walk through each other.
TEST(HullDepth, IsTheLeastTranslationForWalkingPeople) {
  const std::shared_ptr<const Model> model = load_model(adult_urdf());
  bench::Crowd crowd(model, {.avatars = 24, .per_m2 = 5, .seed = 3});
  for (int step = 0; step < 40; ++step) crowd.advance();
  const auto type = crowd.body_type();
  const size_t parts = type->parts().size();
  std::vector<ConvexHull> hulls;
  std::vector<TriangleBvh> surfaces;
  std::vector<HullDirections> directions;
  std::vector<Cloud> corners;
  int max_corners = 0;
  for (const PartShape& part : type->parts()) {
    hulls.emplace_back(part.points);
    surfaces.emplace_back(part.points, part.triangles);
    corners.push_back(shuffled_corners(hulls.back(), 1));
    directions.push_back(hull_directions(corners.back()));
    max_corners = std::max(max_corners, hulls.back().corner_count());
  }
  const BodiesView bodies = crowd.view();
  std::vector<PartPose> poses(bodies.ids.size() * parts);
  for (uint32_t i = 0; i < bodies.ids.size(); ++i)
    crowd.poses({&i, 1}, {poses.data() + i * parts, parts});

  DepthFinder finder;
  TriangleCounters counters;
  double worst = 0, deepest = 0, spent_us = 0;
  int touching = 0, checked = 0;
  for (size_t a = 0; a < bodies.ids.size(); ++a)
    for (size_t b = a + 1; b < bodies.ids.size(); ++b) {
      const Eigen::Vector3f shift =
          (bodies.roots[b].position_m - bodies.roots[a].position_m).cast<float>();
      if (shift.norm() > 1.5f) continue;
      for (size_t pa = 0; pa < parts; ++pa)
        for (size_t pb = 0; pb < parts; ++pb) {
          const PartPose& pose_a = poses[a * parts + pa];
          const PartPose& pose_b = poses[b * parts + pb];
          if (!solids_touch(surfaces[pa], pose_a, bodies.scales[a], surfaces[pb], pose_b,
                            bodies.scales[b], shift, counters))
            continue;
          ++touching;
          const auto start = std::chrono::steady_clock::now();
          const Depth found = finder.depth({&hulls[pa], &pose_a, bodies.scales[a]},
                                           {&hulls[pb], &pose_b, bodies.scales[b]}, shift);
          spent_us +=
              std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
                  .count();
          EXPECT_LE(found.depth_m - found.min_depth_m, 0.5 * kAllowed_m);
          if (touching % 3 != 0) continue;
          ++checked;
          const auto placed = [&](const Cloud& cloud, HullDirections of, const PartPose& pose,
                                  float scale, const Eigen::Vector3d& by) {
            const Eigen::Isometry3d map = to_isometry(pose);
            const double s = static_cast<double>(scale);
            Cloud out;
            for (const Eigen::Vector3d& p : cloud) out.push_back(map * (s * p) + by);
            // Float rotations are slightly askew: normals follow the inverse transpose.
            const Eigen::Matrix3d turn = map.linear().inverse().transpose();
            for (Eigen::Vector3d& n : of.normals) n = turn * n;
            for (auto& edge : of.edges)
              for (Eigen::Vector3d& p : edge) p = map * (s * p);
            return std::pair(out, of);
          };
          const auto [cloud_a, of_a] =
              placed(corners[pa], directions[pa], pose_a, bodies.scales[a], {0, 0, 0});
          const auto [cloud_b, of_b] =
              placed(corners[pb], directions[pb], pose_b, bodies.scales[b], shift.cast<double>());
          const double truth = depth_by_all_directions(cloud_a, of_a, cloud_b, of_b);
          EXPECT_GE(found.depth_m, truth - kRounding_m);
          EXPECT_LE(found.depth_m, truth + kAllowed_m);
          worst = std::max(worst, found.depth_m - truth);
          deepest = std::max(deepest, truth);
        }
    }
  EXPECT_GT(checked, 20);
  EXPECT_GT(deepest, 0.05);
  fmt::print(
      "{} pairs touch, {:.0f} us each; {} checked: at most {:.3f} mm above the truth, "
      "deepest {:.0f} mm; hulls of up to {} corners\n",
      touching, spent_us / touching, checked, 1e3 * worst, 1e3 * deepest, max_corners);
}

}  // namespace
}  // namespace throng::hull_depth_test
