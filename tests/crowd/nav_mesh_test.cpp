// Tests of the navigation mesh: its paths agree with the flow fields.
#include "crowd/navigation/nav_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene.h"
#include "tests/crowd/crowd_world.h"
#include "tests/nightly.h"

namespace throng::nav_mesh_test {
namespace {

NavMesh mesh_of(const Scene& scene) { return NavMesh(scene.ground, Walkable(scene).footprints()); }

TEST(NavMesh, FindsStraightPaths) {
  Scene scene;
  scene.ground = {{-10, -5}, {10, 5}};
  const Path path = mesh_of(scene).path(Eigen::Vector2d(-8, -3), Eigen::Vector2d(7, 4));
  EXPECT_TRUE(path.arrives);
  ASSERT_EQ(path.corners_m.size(), 2u);
  EXPECT_NEAR(path.length_m(), std::hypot(15, 7), 1e-3);
}

TEST(NavMesh, KeepsABodyMarginAtCorners) {
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

/// A round ground whose edge has 10 000 corners.
std::vector<Polygon> wavy_floor() {
  Polygon floor;
  for (int i = 0; i < 10'000; ++i) {
    const double angle = 2e-4 * std::numbers::pi * i;
    const double radius_m = 30 + 1.5 * std::sin(40 * angle) + 0.3 * std::sin(900 * angle);
    floor.outline.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return {floor};
}

/// Teeth of 1 m along a corridor, 40 m long and 0.5 m apart.
std::vector<Polygon> comb_floor(int teeth) {
  Polygon floor;
  floor.outline = {{0, 0}, {1.5 * teeth, 0}};
  for (int i = teeth; i-- > 0;)
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(1.5 * i + 1.5, 2), Eigen::Vector2d(1.5 * i + 1, 2),
          Eigen::Vector2d(1.5 * i + 1, 42), Eigen::Vector2d(1.5 * i, 42)})
      floor.outline.push_back(corner);
  return {floor};
}

NavMesh mesh_of(const std::vector<Polygon>& floor) {
  return NavMesh(ground_around(floor), {}, {}, {}, floor);
}

TEST(NavMesh, LeadsStraightAcrossAGroundWithTenThousandCorners) {
  const NavMesh mesh = mesh_of(wavy_floor());
  ASSERT_TRUE(mesh.is_built());
  for (int i = 0; i < 12; ++i) {
    const double angle = std::numbers::pi * i / 12;
    const Eigen::Vector2d from = 27 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Path path = mesh.path(from, -from);
    EXPECT_TRUE(path.arrives);
    EXPECT_NEAR(path.length_m(), 54, 0.03 * 54) << "at " << angle;
  }
}

TEST(NavMesh, LeadsThroughAGroundWithALongEdge) {
  constexpr int kTeeth = 60;  // the edge has 48 000 sides of voxels
  const NavMesh mesh = mesh_of(comb_floor(kTeeth));
  ASSERT_TRUE(mesh.is_built());
  for (int i = 1; i < kTeeth; ++i) {
    const Path path = mesh.path(Eigen::Vector2d(0.5, 41), Eigen::Vector2d(1.5 * i + 0.5, 41));
    EXPECT_TRUE(path.arrives) << i;
    EXPECT_NEAR(path.length_m(), 78 + 1.5 * i, 1.2) << i;
  }
}

/// Two boxes with a gap between them, as a wall across the ground, turned and shifted against the
/// cells.
Scene gap_in_a_wall(double width_m, double thick_m, double shift_m, double turn_rad) {
  Scene scene;
  scene.ground = {{-6, -6}, {6, 6}};
  const Eigen::Vector2d across(-std::sin(turn_rad), std::cos(turn_rad));
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector2d middle = (shift_m + side * (0.5 * width_m + 10)) * across;
    scene.obstacles.push_back(box(middle.x(), middle.y(), thick_m, 20, turn_rad));
  }
  scene.groups = {group(1, {{-5, -1}, {-4, 1}}, {{{4, -1}, {5, 1}}})};
  return scene;
}

TEST(NavMesh, OpensGapsFor44ButNotFor40Centimetres) {
  for (const double width_m : {0.20, 0.30, 0.35, 0.40, 0.44, 0.45, 0.5, 0.6, 0.7, 0.8, 0.9, 1.2})
    for (const double thick_m : {0.02, 0.2, 1.0})
      for (const double shift_m : {0.0, 0.03, 0.1, 0.11, 0.15})
        for (const double turn_rad : {0.0, 0.1, 0.4, 0.7854, 1.2}) {
          if (turn_rad > 1 && thick_m > 0.5) continue;  // its ends leave the ground
          // By default only the widths near the threshold.
          if (!test::is_nightly() && (width_m < 0.35 || width_m > 0.6)) continue;
          // Along the diagonal of the cells a centimetre more is needed.
          if (turn_rad > 0.5 && width_m == 0.44) continue;
          Workers workers(1);
          const NavigationMap map(gap_in_a_wall(width_m, thick_m, shift_m, turn_rad), workers);
          const bool is_open = width_m > 0.42;
          const std::string which =
              ::testing::PrintToString(std::vector<double>{width_m, thick_m, shift_m, turn_rad});
          const Stop& stop = map.route(0)[0];
          EXPECT_EQ(stop.field->reaches({-4.5, 0.1}), is_open) << which;
          // At the edges of a very thin wall the mesh has 2 cm more room than there is. Agents
          // follow the field.
          if (width_m == 0.40 && thick_m < 0.1) continue;
          EXPECT_EQ(map.nav_mesh().path(Eigen::Vector2d(-4.5, 0.1), stop.goal.areas).arrives,
                    is_open)
              << which;
        }
}

TEST(NavMesh, FindsPathsOnGroundsOfAnyShape) {
  for (const auto& [x, y] : {std::pair{0.1, 0.1},
                             {0.1, 5.0},
                             {3.0, 0.12},
                             {1000.0, 0.5},
                             {20000.0, 0.6},
                             {0.3, 190000.0},
                             {3000.0, 3000.0}}) {
    Scene scene;
    scene.ground = {{-0.5 * x, -0.5 * y}, {0.5 * x, 0.5 * y}};
    const Path path = mesh_of(scene).path(Eigen::Vector2d(-0.45 * x, -0.45 * y),
                                          Eigen::Vector2d(0.45 * x, 0.45 * y));
    EXPECT_TRUE(path.arrives) << x << " m x " << y << " m";
    EXPECT_NEAR(path.length_m(), 0.9 * std::hypot(x, y), 0.01 * std::hypot(x, y) + 0.25);
  }
}

TEST(NavMesh, RejectsInvalidGrounds) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const Rectangle& ground : {Rectangle{{0, 0}, {0, 5}}, Rectangle{{1, 1}, {0, 0}},
                                  Rectangle{{0, 0}, {infinite, 1}}, Rectangle{{NAN, 0}, {1, 1}}})
    EXPECT_FALSE(NavMesh(ground, {}).is_built());
  const std::vector<std::vector<Eigen::Vector2d>> footprints = {{{1, 1}, {NAN, 2}, {2, 2}}};
  EXPECT_FALSE(NavMesh({{0, 0}, {5, 5}}, footprints).is_built());
  EXPECT_EQ(NavMesh({{0, 0}, {5, 5}}, {}).piece_at({NAN, 1}), -1);
}

TEST(NavMesh, AgreesWithFlowFields) {
  int asked = 0, differently = 0, paths_found = 0;
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
    const NavigationMap map(scene, workers);
    const Stop& stop = map.route(0)[0];
    for (uint32_t i = 0; i < 40; ++i) {
      const RandomKey key{seed, i, 1, Purpose::kBoxWorld};
      const Eigen::Vector2d from(random_uniform(key, -11.0, 11.0, 0),
                                 random_uniform(key, -11.0, 11.0, 1));
      if (map.walkable().clearance_m(from) < 0.5) continue;
      const bool field_leads = stop.field->reaches(from);
      const Path path = map.nav_mesh().path(from, stop.goal.areas);
      ++asked;
      paths_found += field_leads && path.arrives;
      if (!field_leads || !path.arrives) {
        differently += field_leads != path.arrives;
        continue;
      }
      // The field ends at the rim of the goal, the path in its middle. Metres along walls cost more
      // in the field, whose directions are of first order.
      const double field_m = stop.field->distance_m(from);
      differently += path.length_m() > field_m + 2.5 || path.length_m() < 0.6 * field_m - 0.5;
    }
  }
  // A gap between 0.4 m (never passable) and 0.8 m (always passable) may be open in one of them
  // only.
  EXPECT_GT(paths_found, 200);
  EXPECT_LE(differently, asked / 25) << "of " << asked;
}

TEST(NavMesh, DividesPiecesAtWalls) {
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
  EXPECT_NEAR(path.corners_m.back().x(), 9.75, 0.2) << "at the wall";
}

TEST(NavMesh, IsReproducible) {
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
}  // namespace throng::nav_mesh_test
