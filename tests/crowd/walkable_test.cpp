// Tests of walls, flow fields and footprints.
#include "crowd/navigation/walkable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/portable_math.h"
#include "base/random.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/scene.h"
#include "tests/crowd/crowd_world.h"

namespace throng::walkable_test {
namespace {

TEST(Footprint, RotatesWithTheObstacle) {
  const Obstacle turned = box(10, 0, 4, 2, std::numbers::pi / 2);
  double widest = 0;
  double highest = 0;
  for (const Eigen::Vector2d& corner : footprint_of(turned)) {
    widest = std::max(widest, std::abs(corner.x() - 10));
    highest = std::max(highest, std::abs(corner.y()));
  }
  EXPECT_NEAR(widest, 1, 1e-6);
  EXPECT_NEAR(highest, 2, 1e-6);
}

TEST(Footprint, ExcludesSignsOverhead) {
  Obstacle sign = box(0, 0, 1, 1);
  EXPECT_TRUE(blocks_people(sign, 2.1));
  sign.centre_m.z() = 5;  // its lower side at 3.5 m
  EXPECT_FALSE(blocks_people(sign, 2.1));
  EXPECT_FALSE(blocks_people(sign, 3.5));
  EXPECT_TRUE(blocks_people(sign, 3.6));
}

Walkable two_boxes() {
  Scene scene;
  scene.ground = {{-10, -10}, {10, 10}};
  scene.obstacles = {box(0, 0, 3, 2, 0.4), box(2.2, 1.8, 0.1, 4, 0.3)};
  return Walkable(scene);
}

/// Distance from a point to the nearest edge of a footprint, by sampling all edges.
double sampled_distance_m(const Obstacle& obstacle, const Eigen::Vector2d& point) {
  const std::vector<Eigen::Vector2d> corners = footprint_of(obstacle);
  double nearest = 1e9;
  for (size_t i = 0; i < corners.size(); ++i)
    for (int k = 0; k <= 2000; ++k) {
      const Eigen::Vector2d on =
          corners[i] + k / 2000.0 * (corners[(i + 1) % corners.size()] - corners[i]);
      nearest = std::min(nearest, (on - point).norm());
    }
  return nearest;
}

TEST(Walkable, FindsTheNearestEdge) {
  const Obstacle obstacle = box(0.3, -0.2, 3, 2, 0.4);
  const Walkable walkable({{-10, -10}, {10, 10}}, {footprint_of(obstacle)});
  for (uint64_t i = 0; i < 300; ++i) {
    const RandomKey key{7, i, 0, Purpose::kBoxWorld};
    const Eigen::Vector2d point(random_uniform(key, -3.0, 3.0, 0),
                                random_uniform(key, -3.0, 3.0, 1));
    const Walkable::Nearest found = walkable.nearest(0, point);
    const double expected_m = sampled_distance_m(obstacle, point);
    ASSERT_NEAR(std::abs(found.distance_m), expected_m, 2e-3) << "point " << point.transpose();
    // The distance along the normal leads to the border, from inside and outside.
    const Eigen::Vector2d border = point - found.distance_m * found.normal;
    ASSERT_NEAR(walkable.nearest(0, border).distance_m, 0, 1e-9) << "point " << point.transpose();
  }
}

TEST(Walkable, SlidesWithoutEnteringWalls) {
  const Walkable walkable = two_boxes();
  int stopped_or_slid = 0;
  for (uint64_t i = 0; i < 20000; ++i) {
    const RandomKey key{11, i, 0, Purpose::kBoxWorld};
    const Eigen::Vector2d from(random_uniform(key, -4.0, 10.0, 0),
                               random_uniform(key, -4.0, 10.0, 1));
    if (walkable.clearance_m(from) < 0) continue;
    const Eigen::Vector2d preferred = from + Eigen::Vector2d(random_uniform(key, -0.7, 0.7, 2),
                                                             random_uniform(key, -0.7, 0.7, 3));
    const Eigen::Vector2d to = walkable.slide(from, preferred, 0.1);
    stopped_or_slid += to != preferred;
    ASSERT_GE(walkable.clearance_m(to), 0) << "try " << i;
    for (int k = 1; k < 50; ++k)
      ASSERT_GE(walkable.clearance_m(from + k / 50.0 * (to - from)), -1e-9)
          << "try " << i << ": from " << from.transpose() << " to " << to.transpose();
  }
  EXPECT_GT(stopped_or_slid, 1000) << "too few walls were met";
}

TEST(FlowField, GivesStraightDistancesOnOpenGround) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 10}};
  const Walkable walkable(scene);
  const FlowGrid grid(walkable);
  const FlowField field(grid, Area({15, 4}, {16, 6}));
  for (int column = 0; column < 20; ++column)
    for (int row = 0; row < 13; ++row) {
      const Eigen::Vector2d point(0.6 + 0.7 * column, 0.6 + 0.7 * row);
      const Eigen::Vector2d on =
          point.cwiseMax(Eigen::Vector2d(15, 4)).cwiseMin(Eigen::Vector2d(16, 6));
      // The upwind scheme is of first order: a cell, and some per cent.
      ASSERT_NEAR(field.distance_m(point), (on - point).norm(), 0.25 + 0.05 * (on - point).norm())
          << "at " << point.transpose();
      ASSERT_GT(field.direction(point).dot((on - point).normalized()), 0.97)
          << "at " << point.transpose();
    }
}

TEST(FlowField, LeadsRoundWallsButNotOutOfAClosedCell) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 20}};
  // A wall across with one door at the top, and a closed cell of four walls.
  scene.obstacles = {box(10, 8.5, 0.2, 17), box(4, 2, 4, 0.2), box(4, 6, 4, 0.2),
                     box(2, 4, 0.2, 4.2), box(6, 4, 0.2, 4.2)};
  const Walkable walkable(scene);
  const FlowGrid grid(walkable);
  const FlowField field(grid, Area({15, 1}, {18, 3}));
  EXPECT_FALSE(field.reaches({4, 4})) << "a path leads out of a closed cell";
  Eigen::Vector2d point(8, 3);
  double path_m = 0;
  for (int i = 0; i < 2000 && !(point.x() > 15 && point.y() < 3); ++i) {
    const Eigen::Vector2d next = point + 0.05 * field.direction(point);
    ASSERT_FALSE(walkable.crosses(point, next)) << "at " << point.transpose();
    ASSERT_GE(walkable.clearance_m(next), 0.1) << "at " << next.transpose();
    path_m += (next - point).norm();
    point = next;
  }
  EXPECT_GT(point.x(), 14.9);
  // Up to the door's lower corner at (10, 17) and down again: 14.1 + 14.9 m, plus wall clearance.
  EXPECT_NEAR(path_m, 29.5, 1.5);
}

}  // namespace
}  // namespace throng::walkable_test
