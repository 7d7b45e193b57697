// Distances of triangles and surfaces are between their bounds, and the bounds are close.
#include "culling/distance/triangle_distance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "culling/distance/surface_distance.h"
#include "tests/culling/distance_oracle.h"
#include "tests/culling/shapes.h"

namespace throng::triangle_distance_test {
namespace {

using Eigen::Vector3d;
using test::Draw;

constexpr uint64_t kSeed = 20261125;
constexpr double kRounding_m = 1e-9;

/// Half are segments, points, slivers or axis-aligned, for parallel edges and common planes.
Triangle draw_triangle(Draw& draw) {
  Triangle t;
  for (Vector3d& corner : t.corner) corner = draw.in_box(1);
  switch (draw.integer(0, 9)) {
    case 0:
      t.corner[2] = t.corner[1];
      break;
    case 1:
      t.corner[1] = t.corner[2] = t.corner[0];
      break;
    case 2:
      t.corner[2] = 0.5 * (t.corner[0] + t.corner[1]) + draw.in_box(1e-7);
      break;
    case 3:
    case 4:
      for (Vector3d& corner : t.corner) corner = (4 * corner).array().round() / 4;
      break;
    default:
      break;
  }
  return t;
}

TEST(TriangleDistance, IsBetweenItsBounds) {
  Draw draw(kSeed);
  int touching = 0, apart = 0;
  for (int i = 0; i < 20'000; ++i) {
    Triangle a = draw_triangle(draw), b = draw_triangle(draw);
    const Vector3d shift = (i % 3) * draw.in_box(1);
    for (Vector3d& corner : b.corner) corner += shift;
    const double truth = test::triangle_distance_by_features(a, b);
    const TriangleGap gap = triangle_gap(a, b);
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", pair " << i);
    ASSERT_LE(gap.lo, truth + kRounding_m);
    if (truth < 1e-6) {
      ++touching;
      continue;
    }
    ++apart;
    ASSERT_NEAR(gap.hi, truth, kRounding_m);
    ASSERT_NEAR(gap.lo, truth, 1e-7);
    ASSERT_NEAR((gap.points.on_b - gap.points.on_a).norm(), gap.hi, kRounding_m);
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GT(apart, 10'000);
}

struct Placed {
  PartShape shape;
  TriangleBvh surface;
  ConvexHull hull;
  PartPose pose;
  float scale;

  explicit Placed(PartShape of, const PartPose& at, float size)
      : shape(std::move(of)),
        surface(shape.points, shape.triangles),
        hull(shape.points),
        pose(at),
        scale(size) {}
  PlacedSurface placed() const { return {&surface, &hull, &pose, scale}; }
  std::vector<Triangle> triangles(const Vector3d& root_m) const {
    return test::placed_triangles(shape, pose, scale, root_m);
  }
};

Placed draw_part(Draw& draw) {
  test::MixedPart part = test::mixed_part(draw, draw.uniform(0.05, 0.4), true);
  return Placed({part.mesh.points, part.mesh.triangles}, draw.pose(0.3),
                static_cast<float>(draw.uniform(0.7, 1.3)));
}

TEST(SurfaceDistance, IsThatOfTheNearestTriangles) {
  int found = 0, farther = 0;
  for (int i = 0; i < 600; ++i) {
    Draw draw(kSeed, static_cast<uint64_t>(i));
    const Placed a = draw_part(draw), b = draw_part(draw);
    const Eigen::Vector3f a_to_b = (draw.uniform(0.2, 1.5) * draw.direction()).cast<float>();
    TriangleCounters counters;
    if (solids_touch(a.surface, a.pose, a.scale, b.surface, b.pose, b.scale, a_to_b, counters))
      continue;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", pair " << i);
    const double truth = test::surface_distance_by_brute_force(a.triangles(Vector3d::Zero()),
                                                               b.triangles(a_to_b.cast<double>()));
    const double within = draw.uniform(0, 1);
    const auto gap = surface_gap(a.placed(), b.placed(), a_to_b, within, {}, counters);
    if (!gap) {
      ++farther;
      ASSERT_GT(truth, within - 1e-6);
      continue;
    }
    ++found;
    ASSERT_LE(gap->lo_m, truth + kRounding_m);
    ASSERT_GE(gap->hi_m, truth - kRounding_m);
    ASSERT_LT(gap->hi_m - gap->lo_m, 1.1 * kDistanceTolerance_m);
    ASSERT_LE(truth, within + 1e-5);
    ASSERT_NEAR((gap->points_m.on_b - gap->points_m.on_a).norm(), gap->hi_m, kRounding_m);
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(farther, 100);
}

bool is_on(const Placed& part, const Vector3d& point, const Vector3d& root_m) {
  return test::is_on_part(point, part.shape, part.surface, part.pose, part.scale, root_m);
}

TEST(ContactPoint, BelongsToBothParts) {
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    Draw draw(kSeed, 1000 + static_cast<uint64_t>(i));
    const Placed a = draw_part(draw), b = draw_part(draw);
    const Eigen::Vector3f a_to_b = draw.in_box(0.3).cast<float>();
    TriangleCounters counters;
    const bool touch =
        solids_touch(a.surface, a.pose, a.scale, b.surface, b.pose, b.scale, a_to_b, counters);
    const auto point_near = [&](const Vector3d& target) {
      return contact_point(a.placed(), b.placed(), a_to_b, target, counters);
    };
    const auto point = point_near(Vector3d::Zero());
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", pair " << i);
    ASSERT_EQ(point.has_value(), touch);
    if (!touch) continue;
    ++touching;
    ASSERT_TRUE(is_on(a, *point, Vector3d::Zero()));
    ASSERT_TRUE(is_on(b, *point, a_to_b.cast<double>()));
    // No contact point found from other positions is closer by more than the tolerance.
    for (int other = 0; other < 20; ++other)
      ASSERT_LE(point->norm(),
                point_near(draw.in_box(0.3))->norm() + kContactPointTolerance_m + kRounding_m);
  }
  EXPECT_GT(touching, 50);
}

}  // namespace
}  // namespace throng::triangle_distance_test
