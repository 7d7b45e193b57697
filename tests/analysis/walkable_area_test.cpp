// The walkable area agrees with the walls that steering obeys.
#include "analysis/trajectories/walkable_area.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/errors.h"
#include "tests/crowd/crowd_world.h"

namespace throng::walkable_area_test {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

double signed_area_m2(const Ring& ring) {
  double doubled = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& next = ring[(i + 1) % ring.size()];
    doubled += ring[i].x() * next.y() - next.x() * ring[i].y();
  }
  return 0.5 * doubled;
}

bool inside(const Ring& ring, const Eigen::Vector2d& p) {
  bool is_inside = false;
  for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector2d &a = ring[i], &b = ring[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      is_inside = !is_inside;
  }
  return is_inside;
}

bool inside(const Polygon& polygon, const Eigen::Vector2d& p) {
  if (!inside(polygon.outline, p)) return false;
  for (const Ring& hole : polygon.holes)
    if (inside(hole, p)) return false;
  return true;
}

Scene ground_of(double half_m) {
  Scene scene;
  scene.ground = {{-half_m, -half_m}, {half_m, half_m}};
  return scene;
}

TEST(WalkableArea, IsTheGroundWithoutObstacles) {
  EXPECT_EQ(trajectory_area(ground_of(2), {}).wkt,
            "POLYGON ((-2.0000 -2.0000, 2.0000 -2.0000, 2.0000 2.0000, -2.0000 2.0000, "
            "-2.0000 -2.0000))");
}

TEST(WalkableArea, HasAHoleForAFreeStandingObstacle) {
  Scene scene = ground_of(5);
  scene.obstacles = {box(0, 0, 2, 1)};
  const auto area = walkable_area(scene);
  ASSERT_EQ(area.size(), 1u);
  ASSERT_EQ(area[0].holes.size(), 1u);
  EXPECT_NEAR(signed_area_m2(area[0].outline), 100, 1e-3);
  EXPECT_NEAR(signed_area_m2(area[0].holes[0]), -2, 1e-2) << "holes run clockwise";
}

TEST(WalkableArea, IsSplitByAWall) {
  Scene scene = ground_of(5);
  scene.obstacles = {box(2, 0, 0.2, 10)};
  const auto area = walkable_area(scene);
  ASSERT_EQ(area.size(), 2u);
  EXPECT_GT(signed_area_m2(area[0].outline), signed_area_m2(area[1].outline));
}

TEST(WalkableArea, RequiresAChoiceBetweenPieces) {
  Scene scene = ground_of(5);
  scene.name = "cut";
  scene.obstacles = {box(2, 0, 0.2, 10)};
  EXPECT_THAT([&] { trajectory_area(scene, {}); },
              testing::ThrowsMessage<InputError>(
                  "--trajectory-area: expected the piece of the walkable area for the "
                  "trajectory, as SQLite holds only one, found 2 pieces, the largest of 69.0 and "
                  "29.0 m2; choose 'largest', or a number from 1 in order of size"));
  EXPECT_THAT([&] { trajectory_area(scene, 3, "trajectory_area"); },
              testing::ThrowsMessage<InputError>(
                  "trajectory_area: expected a piece of the walkable area of 'cut', from 1 to 2, "
                  "found 3"));
  EXPECT_THAT(trajectory_area(scene, 1).wkt, testing::StartsWith("POLYGON ((-5.0000 -5.0000, 1.8"));
  EXPECT_THAT(trajectory_area(scene, 2).wkt, testing::StartsWith("POLYGON ((2.1001 -5.0000, 5.0"));
  EXPECT_EQ(trajectory_piece("largest"), 1);
  EXPECT_EQ(trajectory_piece("2"), 2);
  for (const char* word : {"", "0", "-1", "1.5", "2nd", "all"})
    EXPECT_EQ(trajectory_piece(word), std::nullopt) << word;
}

TEST(WalkableArea, IgnoresPiecesTooSmallForADisc) {
  Scene scene = ground_of(5);
  // Squares of 5 cm remain between the boxes.
  scene.obstacles = {box(0, 0, 1, 0.05), box(0, 0.1, 1, 0.05), box(-0.025, 0.05, 0.05, 0.05),
                     box(0.075, 0.05, 0.05, 0.05)};
  EXPECT_EQ(walkable_area(scene).size(), 2u);
  EXPECT_EQ(trajectory_area(scene, {}).pieces, 1u);
}

TEST(WalkableArea, IgnoresStripsTooNarrowForADisc) {
  // A strip of this width, 10 m long, between a wall and the edge of the ground.
  const auto pieces_beside = [](double width_m, double heading_rad) {
    Scene scene = ground_of(5);
    scene.obstacles = {box(0, 4.9 - width_m, 12, 0.2, heading_rad)};
    EXPECT_EQ(walkable_area(scene).size(), 2u) << width_m;
    return trajectory_area(scene, std::nullopt).pieces;
  };
  for (const double width_m : {0.001, 0.03, 0.08, 0.099}) EXPECT_EQ(pieces_beside(width_m, 0), 1u);
  EXPECT_THROW(pieces_beside(0.11, 0), InputError) << "two pieces";
  EXPECT_THROW(pieces_beside(0.11, 0.01), InputError);

  // A strip larger than the smallest usable piece.
  Scene scene = ground_of(5);
  scene.obstacles = {box(0, 4.87, 12, 0.2), box(0, 4, 12, 0.1), box(4.7, 4.4, 0.1, 0.8)};
  ASSERT_EQ(walkable_area(scene).size(), 4u);
  EXPECT_THAT(trajectory_area(scene, 3).pieces, 3u);
  EXPECT_THROW(trajectory_area(scene, 4), InputError);
  EXPECT_THAT(trajectory_area(scene, 3).wkt, testing::StartsWith("POLYGON ((4.7501 4.05"));

  // A frame around a pillar, narrow everywhere.
  scene.obstacles = {box(0, 0, 2, 0.1), box(0, 2, 2, 0.1), box(-1, 1, 0.1, 2), box(1, 1, 0.1, 2),
                     box(0, 1, 1.8, 1.8)};
  ASSERT_EQ(walkable_area(scene).size(), 2u);
  EXPECT_EQ(trajectory_area(scene, {}).pieces, 1u);
}

TEST(WalkableArea, ContainsAnIslandInAHoleOfARecordedArea) {
  Scene scene = ground_of(5);
  scene.floor = {{{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}, {{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}}},
                 {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {}}};
  const auto area = walkable_area(scene);
  ASSERT_EQ(area.size(), 2u);
  EXPECT_NEAR(signed_area_m2(area[0].outline) + signed_area_m2(area[0].holes.at(0)), 48, 1e-3);
  EXPECT_NEAR(signed_area_m2(area[1].outline), 4, 1e-3);
}

TEST(WalkableArea, IsEmptyIfObstaclesCoverTheGround) {
  Scene scene = ground_of(1);
  scene.obstacles = {box(0, 0, 4, 4)};
  EXPECT_TRUE(walkable_area(scene).empty());
  EXPECT_THROW(trajectory_area(scene, 1), InputError);
}

TEST(WalkableArea, JoinsBoxesThatTouchAtACorner) {
  Scene scene = ground_of(5);
  scene.obstacles = {box(-1, -1, 2, 2), box(1, 1, 2, 2)};
  const auto area = walkable_area(scene);
  ASSERT_EQ(area.size(), 1u);
  EXPECT_EQ(area[0].holes.size(), 1u);
}

TEST(WalkableArea, ContainsAllPointsWherePeopleMayStand) {
  const Scene scene = crossing(1, 0);
  const Walkable walkable(scene);
  const auto area = walkable_area(scene);
  ASSERT_EQ(area.size(), 1u);
  EXPECT_EQ(area[0].holes.size(), 4u);
  int walkable_points = 0;
  for (uint32_t i = 0; i < 4000; ++i) {
    const Eigen::Vector2d point(random_uniform({5, i}, -15, 15, 0),
                                random_uniform({5, i}, -15, 15, 1));
    const double clearance_m = walkable.clearance_m(point);
    if (std::abs(clearance_m) < 1e-3) continue;  // too close to an edge
    walkable_points += clearance_m > 0;
    EXPECT_EQ(inside(area[0], point), clearance_m > 0) << point.transpose();
  }
  EXPECT_GT(walkable_points, 3000);
}

}  // namespace
}  // namespace throng::walkable_area_test
