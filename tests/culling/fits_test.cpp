// Fitted spheres, boxes and slabs are tight.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdio>

#include "culling/volumes/polytope.h"
#include "culling/volumes/slabs.h"
#include "culling/volumes/volume_list.h"
#include "shapes.h"

namespace throng::test::fits_test {
namespace {

constexpr uint64_t kSeed = 20261;

/// Radius of the smallest ball around all points, by trying every ball through two, three or four.
double smallest_radius(const std::vector<Eigen::Vector3f>& points) {
  std::vector<Eigen::Vector3d> p;
  for (const Eigen::Vector3f& point : points) p.push_back(point.cast<double>());
  double best = p.size() == 1 ? 0 : 1e30;
  const auto consider = [&](const std::vector<size_t>& chosen) {
    const Eigen::Index n = static_cast<Eigen::Index>(chosen.size()) - 1;
    Eigen::MatrixXd edges(3, n);
    for (Eigen::Index i = 0; i < n; ++i)
      edges.col(i) = p[chosen[static_cast<size_t>(i) + 1]] - p[chosen[0]];
    const Eigen::MatrixXd gram = edges.transpose() * edges;
    const Eigen::VectorXd weights = gram.fullPivLu().solve(0.5 * gram.diagonal());
    const Eigen::Vector3d centre = p[chosen[0]] + edges * weights;
    double radius = 0;
    for (const Eigen::Vector3d& q : p) radius = std::max(radius, (q - centre).norm());
    best = std::min(best, radius);
  };
  for (size_t i = 0; i < p.size(); ++i)
    for (size_t j = i + 1; j < p.size(); ++j) {
      consider({i, j});
      for (size_t k = j + 1; k < p.size(); ++k) {
        consider({i, j, k});
        for (size_t l = k + 1; l < p.size(); ++l) consider({i, j, k, l});
      }
    }
  return best;
}

TEST(SphereFit, FindsTheSmallestBallOfFewPoints) {
  Draw draw(kSeed, 1);
  for (int i = 0; i < 600; ++i) {
    std::vector<Eigen::Vector3f> points;
    const int count = draw.integer(1, 9);
    const Eigen::Vector3d size(1, draw.integer(0, 3) == 0 ? 0 : 1,
                               draw.integer(0, 3) == 0 ? 0 : 0.3);
    for (int p = 0; p < count; ++p)
      points.push_back(draw.in_box(1).cwiseProduct(size).cast<float>());
    const double best = smallest_radius(points);
    const double found = static_cast<double>(Sphere::fit(points).radius_m);
    ASSERT_NEAR(found, best, 1e-6) << count << " points, case " << i << ", seed " << kSeed;
  }
}

TEST(SphereFit, FindsTheSmallestBallOfPointsOnASphere) {
  Draw draw(kSeed, 2);
  for (int i = 0; i < 100; ++i) {
    std::vector<Eigen::Vector3f> points;
    for (int p = 0; p < 400; ++p) {
      const Eigen::Vector3d d = draw.direction();
      points.push_back((d + Eigen::Vector3d(3, 0, 0)).cast<float>());
      points.push_back((-d + Eigen::Vector3d(3, 0, 0)).cast<float>());
    }
    ASSERT_NEAR(static_cast<double>(Sphere::fit(points).radius_m), 1, 2e-6) << "seed " << kSeed;
  }
}

TEST(SphereFit, ContainsEveryPoint) {
  for (const Shape& shape : special_shapes(kSeed)) {
    const Sphere::Fitted sphere = Sphere::fit(shape.points);
    for (const Eigen::Vector3f& p : shape.points)
      EXPECT_LE((p.cast<double>() - sphere.centre_m.cast<double>()).norm(),
                static_cast<double>(sphere.radius_m))
          << shape.name;
  }
}

TEST(ObbFit, FindsARotatedBox) {
  Draw draw(kSeed, 3);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d half(draw.uniform(0.02, 1), draw.uniform(0.02, 1), draw.uniform(0.02, 1));
    const Eigen::Matrix3d turn = draw.rotation().toRotationMatrix();
    const Eigen::Vector3d offset = draw.in_box(2);
    std::vector<Eigen::Vector3f> points;
    for (int p = 0; p < 300; ++p) {
      const Eigen::Vector3d inside = draw.in_box(1).cwiseProduct(half);
      const Eigen::Vector3d corner =
          Eigen::Vector3d((p & 1) ? 1 : -1, (p & 2) ? 1 : -1, (p & 4) ? 1 : -1).cwiseProduct(half);
      points.push_back((turn * (p < 8 ? corner : inside) + offset).cast<float>());
    }
    const double ratio = Obb::volume_m3(Obb::fit(points)) / (8 * half.prod());
    worst = std::max(worst, ratio);
    EXPECT_LT(ratio, 1.05) << "case " << i << ", half widths " << half.transpose() << ", seed "
                           << kSeed;
  }
  std::printf("obb: at worst %.4f times the volume of the rotated box\n", worst);
}

TEST(ObbFit, IsNeverLargerThanTheAxisAlignedBox) {
  for (const Shape& shape : special_shapes(kSeed)) {
    const Eigen::Vector3d box = Aabb::fit(shape.points).half_m.cast<double>();
    const Eigen::Vector3d turned_box = Obb::fit(shape.points).half_m.cast<double>();
    const double fat = 0.5e-3 * box.maxCoeff();  // as the fit weights flat boxes
    EXPECT_LE((turned_box.array() + fat).prod(), (box.array() + fat).prod() * (1 + 1e-5))
        << shape.name;
  }
}

TEST(SlabVolume, EqualsThatOfKnownSolids) {
  std::vector<Eigen::Vector3f> cube, octahedron;
  for (int i = 0; i < 8; ++i)
    cube.push_back({(i & 1) ? 2.0f : 1.0f, (i & 2) ? 2.0f : 1.0f, (i & 4) ? 2.0f : 1.0f});
  for (int i = 0; i < 3; ++i) {
    octahedron.push_back(Eigen::Vector3f::Unit(i));
    octahedron.push_back(-Eigen::Vector3f::Unit(i));
  }
  for (int k : {14, 18, 26}) EXPECT_NEAR(polytope_of(Slabs::around(cube), k).volume_m3, 1, 1e-5);
  const Slabs slabs = Slabs::around(octahedron);
  EXPECT_NEAR(Kdop<14>::volume_m3(slabs), 4.0 / 3, 1e-5);
  EXPECT_NEAR(Kdop<18>::volume_m3(slabs), 2, 1e-5);  // rhombic dodecahedron
  EXPECT_NEAR(Kdop<26>::volume_m3(slabs), 4.0 / 3, 1e-5);
  EXPECT_NEAR(Aabb::volume_m3(Aabb::fit(octahedron)), 8, 1e-5);
  EXPECT_NEAR(Sphere::volume_m3(Sphere::fit(octahedron)), 4.18879, 1e-4);
}

TEST(SlabVolume, ShrinksWithEveryDirection) {
  for (const Shape& shape : special_shapes(kSeed)) {
    const Slabs slabs = Slabs::around(shape.points);
    const double size = reach_of(shape.points);
    const double noise = 1e-9 * size * size * size + 1e-30;
    const double v14 = Ordop<14>::volume_m3(slabs), v18 = Ordop<18>::volume_m3(slabs);
    EXPECT_LE(std::max(v14, v18), Aabb::volume_m3(Aabb::fit(shape.points)) + noise) << shape.name;
    EXPECT_LE(Ordop<26>::volume_m3(slabs), std::min(v14, v18) + noise) << shape.name;
  }
}

/// Compares the conic bound with the support of its solid: never below; prints the mean difference.
template <int K>
void expect_bound_covers_solid() {
  Draw draw(kSeed, 4);
  double worst = 0, sum = 0;
  int count = 0;
  for (const Shape& shape : special_shapes(kSeed)) {
    const Slabs slabs = Slabs::around(shape.points);
    const std::vector<Eigen::Vector3d> corners = polytope_of(slabs, K).corners_m;
    const double size = reach_of(shape.points);
    if (size == 0) continue;
    for (int i = 0; i < 500; ++i) {
      const Eigen::Vector3d d = draw.uniform(0.3, 2) * draw.direction();
      const Slab bound = slabs.bound<K>(d.cast<float>());
      const double top = static_cast<double>(bound.centre) + static_cast<double>(bound.half);
      double points_top = -1e30, corners_top = -1e30;
      for (const Eigen::Vector3f& p : shape.points)
        points_top = std::max(points_top, d.dot(p.cast<double>()));
      for (const Eigen::Vector3d& p : corners) corners_top = std::max(corners_top, d.dot(p));
      const double allowed =
          static_cast<double>(rounding_margin_m(static_cast<float>(size))) * d.norm();
      ASSERT_GE(top, points_top - allowed) << shape.name << ", d " << d.transpose();
      if (shape.name != "ball" && shape.name != "limb" && shape.name != "cube") continue;
      ASSERT_GE(top, corners_top - 2 * allowed) << shape.name << ", d " << d.transpose();
      const double loose = (top - corners_top) / (d.norm() * size);
      worst = std::max(worst, loose);
      sum += loose;
      ++count;
    }
  }
  std::printf(
      "or-DOP %d: the conic bound is above the solid's support by %.3g of the size on "
      "average, %.3g at worst\n",
      K, sum / count, worst);
  EXPECT_LT(worst, 0.1);
}

TEST(ConicBound, IsNeverBelowTheSolid14) { expect_bound_covers_solid<14>(); }
TEST(ConicBound, IsNeverBelowTheSolid18) { expect_bound_covers_solid<18>(); }
TEST(ConicBound, IsNeverBelowTheSolid26) { expect_bound_covers_solid<26>(); }

}  // namespace
}  // namespace throng::test::fits_test
