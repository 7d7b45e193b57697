// NearbyPoints returns given points that are about the nearest.
#include "culling/volumes/nearby_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace throng::nearby_points_test {
namespace {

using Eigen::Vector3f;

float min_distance_m(const std::vector<Vector3f>& points, const Vector3f& to) {
  float min_distance = std::numeric_limits<float>::max();
  for (const Vector3f& point : points) min_distance = std::min(min_distance, (point - to).norm());
  return min_distance;
}

std::vector<Vector3f> random_points(std::mt19937& rng, size_t count, const Vector3f& size_m) {
  std::uniform_real_distribution<float> within(-0.5f, 0.5f);
  std::vector<Vector3f> out(count);
  for (Vector3f& point : out)
    for (Eigen::Index axis = 0; axis < 3; ++axis) point[axis] = size_m[axis] * within(rng);
  return out;
}

/// A place in the box is at most half a cell's diagonal from the centre of its cell. The point is
/// therefore farther than the nearest by at most twice that.
TEST(NearbyPoints, AreGivenPointsAtMostACellFartherThanTheNearest) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 rng(seed);
    std::uniform_real_distribution<float> size(0.01f, 2.0f);
    const Vector3f size_m(size(rng), size(rng), size(rng));
    const std::vector<Vector3f> points = random_points(rng, 1 + 37 * seed, size_m);
    const NearbyPoints on(points);
    Vector3f low = points.front(), high = points.front();
    for (const Vector3f& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    const float diagonal_m =
        std::sqrt(3.0f) * (high - low).maxCoeff() / float{NearbyPoints::kMaxCells};
    for (const Vector3f& place : random_points(rng, 500, 1.5f * size_m)) {
      const Vector3f found = on.lookup(place);
      ASSERT_EQ(std::count(points.begin(), points.end(), found) > 0, true);
      const Vector3f inside = place.cwiseMax(low).cwiseMin(high);
      ASSERT_LE((found - inside).norm(), min_distance_m(points, inside) + 1.001f * diagonal_m);
    }
  }
}

TEST(NearbyPoints, AreFoundForOnePointAndAFlatPart) {
  const Vector3f one(1, -2, 3);
  const NearbyPoints alone(std::vector<Vector3f>{one});
  const std::vector<Vector3f> flat = {{0, 0, 1}, {2, 0, 1}, {0, 3, 1}};
  const NearbyPoints triangle(flat);
  for (const float far : {-1e30f, -1.0f, 0.0f, 1.0f, 1e30f}) {
    EXPECT_EQ(alone.lookup({far, -far, far}), one);
    EXPECT_EQ(triangle.lookup({-1, 4, far}), flat[2]);
  }
}

TEST(NearbyPoints, AreASubsetForAFineMesh) {
  std::mt19937 rng(1);
  const std::vector<Vector3f> points = random_points(rng, 100000, {1, 1, 1});
  const NearbyPoints on(points);
  EXPECT_LE(on.points.size(), on.point_of_cell.size());
  EXPECT_EQ(on.point_of_cell.size(), 16u * 16 * 16);
  for (const Vector3f& place : random_points(rng, 100, {1, 1, 1}))
    EXPECT_LE((on.lookup(place) - place).norm(), 0.25f);
}

}  // namespace
}  // namespace throng::nearby_points_test
