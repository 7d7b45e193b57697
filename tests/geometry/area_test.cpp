// Areas: a point that is asked for lies inside, and equal parts of the unit square cover equal
// areas.
#include "geometry/area.h"

#include <gtest/gtest.h>

#include "tests/geometry/random_polygons.h"

namespace throng::area_test {
namespace {

TEST(Area, BehavesAsARectangleIfItsPolygonIsOne) {
  const Area area(std::vector<Polygon>{{{{3, 1}, {3, 5}, {1, 5}, {1, 1}}, {}}});
  EXPECT_TRUE(area.is_rectangle());
  EXPECT_EQ(area, Area({1, 1}, {3, 5}));
}

TEST(Area, HasItsPointsInside) {
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    RandomPolygons random(seed);
    const Polygon polygon = random.polygon();
    if (fault_of(polygon)) continue;
    const Area area(std::vector<Polygon>{polygon});
    EXPECT_TRUE(area.contains(area.middle_m()));
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector2d share(random.uniform(0, 1), random.uniform(0, 1));
      EXPECT_TRUE(area.contains(area.at(share), 1e-6)) << share.transpose();
      const Eigen::Vector2d outside =
          area.middle_m() + 30 * (share - Eigen::Vector2d::Constant(0.5));
      const Eigen::Vector2d nearest = area.nearest_m(outside);
      EXPECT_TRUE(area.contains(nearest, 1e-6));
      EXPECT_TRUE(!area.contains(outside) || nearest == outside);
    }
  }
}

TEST(Area, IsCoveredEvenly) {
  const Area area(std::vector<Polygon>{
      {{{0, 0}, {8, 0}, {8, 2}, {2, 2}, {2, 8}, {0, 8}}, {{{0.5, 0.5}, {1.5, 0.5}, {1.5, 1.5}}}}});
  int in_left = 0;
  constexpr int kSide = 200;
  for (int i = 0; i < kSide; ++i)
    for (int k = 0; k < kSide; ++k)
      in_left += area.at(Eigen::Vector2d(i + 0.5, k + 0.5) / kSide).x() < 2 ? 1 : 0;
  const double left_m2 = 16 - 0.5;
  EXPECT_NEAR(in_left / double{kSide * kSide}, left_m2 / area.area_m2(), 0.01);
}

TEST(Area, GrowsAboutAPoint) {
  const Area area(std::vector<Polygon>{{{{0, 0}, {4, 0}, {0, 4}}, {}}});
  const Area twice = area.scaled({0, 0}, 2);
  EXPECT_NEAR(twice.area_m2(), 4 * area.area_m2(), 1e-9);
  EXPECT_EQ(twice.bounds().max_m, Eigen::Vector2d(8, 8));
}

}  // namespace
}  // namespace throng::area_test
