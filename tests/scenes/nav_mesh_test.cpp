// The navigation mesh and the flow fields tell the same ways.
#include "scenes/nav_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "scenes/shapes.h"
#include "tests/scenes/crowd_world.h"

namespace throng {
namespace {

NavMesh mesh_of(const Scene& scene) { return NavMesh(scene.ground, Walkable(scene).footprints()); }

TEST(NavMesh, GoesStraightWhereNothingIsInTheWay) {
  Scene scene;
  scene.ground = {{-10, -5}, {10, 5}};
  const Path path = mesh_of(scene).path(Eigen::Vector2d(-8, -3), Eigen::Vector2d(7, 4));
  EXPECT_TRUE(path.arrives);
  ASSERT_EQ(path.corners_m.size(), 2u);
  EXPECT_NEAR(path.length_m(), std::hypot(15, 7), 1e-3);
}

TEST(NavMesh, TurnsAtTheCornersOfAWallAndKeepsABodyAway) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 20}};
  scene.obstacles = {box(10, 8, 0.2, 16)};
  const Path path = mesh_of(scene).path(Eigen::Vector2d(3, 2), Eigen::Vector2d(17, 2));
  EXPECT_TRUE(path.arrives);
  ASSERT_GE(path.corners_m.size(), 3u);
  const Walkable walkable(scene);
  for (size_t i = 1; i < path.corners_m.size(); ++i)
    for (int k = 0; k <= 100; ++k) {
      const Eigen::Vector2d point =
          path.corners_m[i - 1] + k / 100.0 * (path.corners_m[i] - path.corners_m[i - 1]);
      ASSERT_GT(walkable.nearest(0, point).distance_m, 0.05) << point.transpose();
    }
  EXPECT_NEAR(path.length_m(), 2 * std::hypot(7, 14.2), 0.3);
}

TEST(NavMesh, ADoorwayOf80CentimetresIsAWayAndAGapOf30IsNone) {
  for (const double width_m : {0.8, 0.9, 1.0, 1.2, 0.3}) {
    for (const double shift_m : {0.0, 0.03, 0.07, 0.11}) {
      Scene scene;
      scene.ground = {{-6, -5}, {6, 5}};
      const double wall_m = 5 - 0.5 * width_m;
      scene.obstacles = {
          box(0, shift_m + 0.5 * width_m + 0.5 * (wall_m - shift_m), 0.2, wall_m - shift_m),
          box(0, shift_m - 0.5 * width_m - 0.5 * (wall_m + shift_m), 0.2, wall_m + shift_m)};
      scene.groups = {group(1, {{-5, -1}, {-4, 1}}, {{{4, -1}, {5, 1}}})};
      Workers workers(1);
      const Ways ways(scene, workers);
      const bool is_way = width_m > 0.5;
      EXPECT_EQ(ways.route(0)[0].field->reaches({-4, 0}), is_way) << width_m << " " << shift_m;
      EXPECT_EQ(ways.nav_mesh().path(Eigen::Vector2d(-4, 0), Eigen::Vector2d(4, 0)).arrives, is_way)
          << width_m << " " << shift_m;
    }
  }
}

TEST(NavMesh, AgreesWithFlowFieldsAboutWaysAndTheirLengths) {
  int asked = 0, differently = 0, ways_found = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene;
    scene.ground = {{-12, -12}, {12, 12}};
    for (uint32_t i = 0; i < 14; ++i) {
      const RandomKey key{seed, i, 0, Purpose::kBoxWorld};
      scene.obstacles.push_back(
          box(random_uniform(key, -9.0, 9.0, 0), random_uniform(key, -9.0, 9.0, 1),
              random_uniform(key, 0.5, 8.0, 2), 0.3, random_uniform(key, 0.0, 3.0, 3)));
    }
    scene.groups = {group(1, {{-11, -11}, {-10, -10}}, {{{9.5, 9.5}, {11.5, 11.5}}})};
    Workers workers(1);
    const Ways ways(scene, workers);
    const Stop& stop = ways.route(0)[0];
    for (uint32_t i = 0; i < 40; ++i) {
      const RandomKey key{seed, i, 1, Purpose::kBoxWorld};
      const Eigen::Vector2d from(random_uniform(key, -11.0, 11.0, 0),
                                 random_uniform(key, -11.0, 11.0, 1));
      if (ways.walkable().clearance_m(from) < 0.5) continue;
      const bool field_leads = stop.field->reaches(from);
      const Path path = ways.nav_mesh().path(from, stop.goal.areas);
      ++asked;
      ways_found += field_leads && path.arrives;
      if (!field_leads || !path.arrives) {
        differently += field_leads != path.arrives;
        continue;
      }
      // The field ends at the rim of the goal, the path in its middle; metres beside walls count
      // longer in the field, whose directions are of first order.
      const double field_m = stop.field->distance_m(from);
      differently += path.length_m() > field_m + 2.5 || path.length_m() < 0.6 * field_m - 0.5;
    }
  }
  // A gap wider than 0.4 m, which nobody passes, and below 0.8 m, which everybody does, may be a
  // way to one and none to the other.
  EXPECT_GT(ways_found, 200);
  EXPECT_LE(differently, asked / 25) << "of " << asked;
}

TEST(NavMesh, PiecesAreWhatAWallDivides) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 10}};
  scene.obstacles = {box(10, 5, 0.1, 10)};
  const NavMesh mesh = mesh_of(scene);
  EXPECT_GE(mesh.piece_at({2, 2}), 0);
  EXPECT_EQ(mesh.piece_at({2, 2}), mesh.piece_at({8, 9}));
  EXPECT_NE(mesh.piece_at({2, 2}), mesh.piece_at({12, 2}));
  const Path path = mesh.path(Eigen::Vector2d(2, 5), Eigen::Vector2d(18, 5));
  EXPECT_FALSE(path.arrives);
  ASSERT_FALSE(path.corners_m.empty());
  EXPECT_NEAR(path.corners_m.back().x(), 9.75, 0.2) << "as near as the wall allows";
}

TEST(NavMesh, IsTheSameEveryTimeItIsBuilt) {
  const Scene scene = crossing(1, 0);
  const NavMesh first = mesh_of(scene);
  const NavMesh second = mesh_of(scene);
  EXPECT_EQ(first.polygon_count(), second.polygon_count());
  EXPECT_GT(first.polygon_count(), 4);
  for (uint32_t i = 0; i < 50; ++i) {
    const RandomKey key{9, i, 0, Purpose::kBoxWorld};
    const Eigen::Vector2d from(random_uniform(key, -14.0, 14.0, 0),
                               random_uniform(key, -14.0, 14.0, 1));
    const Eigen::Vector2d to(random_uniform(key, -14.0, 14.0, 2),
                             random_uniform(key, -14.0, 14.0, 3));
    EXPECT_EQ(first.path(from, to).corners_m, second.path(from, to).corners_m);
  }
}

}  // namespace
}  // namespace throng
