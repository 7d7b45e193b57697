// Voronoi cells cut at walls match areas that are sampled point by point.
#include "analysis/measures/voronoi.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <queue>

#include "base/random.h"
#include "tests/crowd/crowd_world.h"

namespace throng::voronoi_test {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Scene hall(double width_m, double depth_m, std::vector<Obstacle> obstacles = {}) {
  Scene scene;
  scene.ground = {{0, 0}, {width_m, depth_m}};
  scene.obstacles = std::move(obstacles);
  return scene;
}

Points random_people(uint64_t seed, int count, const Scene& scene) {
  const Walkable walkable(scene);
  Points people;
  for (uint64_t draw = 0; static_cast<int>(people.size()) < count; ++draw) {
    const RandomKey key{seed, draw, 0, Purpose::kSpawnPosition};
    const Eigen::Vector2d size = scene.ground.size_m();
    const Eigen::Vector2d place(random_uniform(key, 0, size.x()),
                                random_uniform(key, 0, size.y(), 1));
    if (walkable.clearance_m(place) > 0.02) people.push_back(place);
  }
  return people;
}

Points all_but(const Points& people, size_t person) {
  Points others = people;
  others.erase(others.begin() + static_cast<ptrdiff_t>(person));
  return others;
}

/// Area of the squares of a fine grid that are nearest to the person and connected to their
/// position.
double area_by_asking(const Scene& scene, const Points& people, size_t person) {
  constexpr double kStep_m = 0.02;
  const Walkable walkable(scene);
  const int columns = static_cast<int>(scene.ground.size_m().x() / kStep_m);
  const int rows = static_cast<int>(scene.ground.size_m().y() / kStep_m);
  const auto is_hers = [&](int column, int row) {
    const Eigen::Vector2d at(kStep_m * (column + 0.5), kStep_m * (row + 0.5));
    const double distance_m = (people[person] - at).norm();
    if (distance_m > VoronoiCells::kCap_m || walkable.clearance_m(at) < 0) return false;
    for (const Eigen::Vector2d& other : people)
      if ((other - at).norm() < distance_m) return false;
    return true;
  };
  std::vector<char> visited(static_cast<size_t>(columns) * static_cast<size_t>(rows), 0);
  std::queue<std::pair<int, int>> open;
  open.emplace(static_cast<int>(people[person].x() / kStep_m),
               static_cast<int>(people[person].y() / kStep_m));
  double area_m2 = 0;
  while (!open.empty()) {
    const auto [column, row] = open.front();
    open.pop();
    if (column < 0 || column >= columns || row < 0 || row >= rows) continue;
    const int square = row * columns + column;
    char& known = visited[static_cast<size_t>(square)];
    if (known != 0) continue;
    known = 1;
    if (!is_hers(column, row)) continue;
    area_m2 += kStep_m * kStep_m;
    open.emplace(column + 1, row);
    open.emplace(column - 1, row);
    open.emplace(column, row + 1);
    open.emplace(column, row - 1);
  }
  return area_m2;
}

TEST(VoronoiCells, ContainTheNearestReachablePoints) {
  const Scene scene = hall(
      6, 4, {box(3, 2.6, 0.1, 2.8), box(1.3, 1.2, 0.5, 0.7, 0.4), box(4.6, 2.1, 1.2, 0.2, -0.7)});
  VoronoiCells cells(scene);
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const Points people = random_people(seed, 2 + 3 * static_cast<int>(seed), scene);
    for (size_t i = 0; i < people.size(); ++i) {
      const auto cell = cells.cell(people[i], all_but(people, i));
      ASSERT_TRUE(cell) << "seed " << seed << ", person " << i;
      const double asked = area_by_asking(scene, people, i);
      EXPECT_NEAR(cell->area_m2, asked, 0.03 + 0.02 * asked) << "seed " << seed << ", person " << i;
    }
  }
}

TEST(VoronoiCells, FillTheAreaUnlessCapped) {
  const Scene empty = hall(6, 4);
  const Scene pillar = hall(6, 4, {box(3, 2, 0.4, 0.4, 0.3)});
  for (const auto& [scene, area_m2] : {std::pair(&empty, 24.0), std::pair(&pillar, 24 - 0.16)})
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      VoronoiCells cells(*scene);
      const Points people = random_people(seed, 60, *scene);
      double sum = 0;
      bool some_capped = false;
      for (size_t i = 0; i < people.size(); ++i) {
        const auto cell = cells.cell(people[i], all_but(people, i));
        ASSERT_TRUE(cell) << "seed " << seed;
        sum += cell->area_m2;
        some_capped |= cell->is_capped;
      }
      ASSERT_FALSE(some_capped) << "seed " << seed;
      EXPECT_LE(sum, area_m2 + 1e-9) << "seed " << seed;
      // A pillar leaves areas behind it that are in no cell.
      EXPECT_GE(sum, area_m2 - (scene == &empty ? 1e-9 : 0.1)) << "seed " << seed;
    }
}

TEST(VoronoiCells, AreLimitedToTheCapAndTheGround) {
  const Scene scene = hall(20, 20, {box(10, 10, 2, 2)});
  VoronoiCells cells(scene);
  const auto alone = cells.cell({4, 4}, {});
  ASSERT_TRUE(alone);
  EXPECT_NEAR(alone->area_m2, std::numbers::pi * 4, 1e-9);
  EXPECT_TRUE(alone->is_capped);
  const auto corner = cells.cell({0, 0}, {});
  ASSERT_TRUE(corner);
  EXPECT_NEAR(corner->area_m2, std::numbers::pi, 1e-9);
  EXPECT_FALSE(cells.cell({10, 10}, {})) << "in an obstacle";
  EXPECT_FALSE(cells.cell({-0.1, 3}, {})) << "off the ground";
}

TEST(VoronoiCells, AreSharedByPeopleAtOnePoint) {
  const Scene scene = hall(20, 20);
  VoronoiCells cells(scene);
  const Points both = {{5, 5}, {6, 5}};
  const auto one = cells.cell({5, 5}, std::span(both).subspan(1));
  const auto two = cells.cell({5, 5}, both);
  ASSERT_TRUE(one && two);
  EXPECT_DOUBLE_EQ(one->area_m2, two->area_m2);
}

}  // namespace
}  // namespace throng::voronoi_test
