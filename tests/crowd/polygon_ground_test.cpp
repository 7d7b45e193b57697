// Grounds of any shape: no agent crosses an edge, and each one arrives or is counted as stranded
// because no path exists. Oracles: segments against segments, and a flood fill.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/floor.h"
#include "tests/crowd/crowd_world.h"
#include "tests/crowd/random_worlds.h"
#include "tests/nightly.h"

namespace throng::polygon_ground_test {
namespace {

bool do_cross(const test::WallPiece& a, const test::WallPiece& b) {
  const auto side = [](const test::WallPiece& s, const Eigen::Vector2d& p) {
    return cross(s.to - s.from, p - s.from);
  };
  return side(a, b.from) * side(a, b.to) < 0 && side(b, a.from) * side(b, a.to) < 0;
}

/// Free cells of 5 cm at which a disc fits, and what of them is connected to a point.
class FloodFill {
 public:
  FloodFill(const Scene& scene, const std::vector<test::WallPiece>& walls, double radius_m)
      : low_(scene.ground.min_m) {
    columns_ = static_cast<int>(scene.ground.size_m().x() / kCell_m) + 1;
    rows_ = static_cast<int>(scene.ground.size_m().y() / kCell_m) + 1;
    blocked_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0);
    for (const test::WallPiece& wall : walls) block(wall, radius_m);
  }

  std::vector<uint8_t> reached_from(const Eigen::Vector2d& start) const {
    std::vector<uint8_t> reached(blocked_.size(), 0);
    std::vector<int> front;
    // A start in the margin counts from the free cells around it.
    for (size_t cell = 0; cell < blocked_.size(); ++cell)
      if (blocked_[cell] == 0 && (centre(static_cast<int>(cell)) - start).norm() < 0.3) {
        reached[cell] = 1;
        front.push_back(static_cast<int>(cell));
      }
    while (!front.empty()) {
      const int cell = front.back();
      front.pop_back();
      const int column = cell % columns_;
      for (const int next : {cell - 1, cell + 1, cell - columns_, cell + columns_}) {
        if (next < 0 || next >= columns_ * rows_) continue;
        if (std::abs(next % columns_ - column) > 1) continue;
        const auto at = static_cast<size_t>(next);
        if (blocked_[at] != 0 || reached[at] != 0) continue;
        reached[at] = 1;
        front.push_back(next);
      }
    }
    return reached;
  }

  bool reaches(const Eigen::Vector2d& start, const Area& area, double margin_m = 0) const {
    const std::vector<uint8_t> reached = reached_from(start);
    for (size_t cell = 0; cell < reached.size(); ++cell)
      if (reached[cell] != 0 && area.contains(centre(static_cast<int>(cell)), margin_m))
        return true;
    return false;
  }

 private:
  static constexpr double kCell_m = 0.05;

  Eigen::Vector2d centre(int cell) const {
    return low_ + kCell_m * Eigen::Vector2d(cell % columns_, cell / columns_);
  }
  void block(const test::WallPiece& wall, double radius_m) {
    const Eigen::Vector2d low = (wall.from.cwiseMin(wall.to) - low_).array() - radius_m;
    const Eigen::Vector2d high = (wall.from.cwiseMax(wall.to) - low_).array() + radius_m;
    const int left = std::max(0, static_cast<int>(low.x() / kCell_m));
    const int right = std::min(columns_ - 1, static_cast<int>(high.x() / kCell_m) + 1);
    const int bottom = std::max(0, static_cast<int>(low.y() / kCell_m));
    const int top = std::min(rows_ - 1, static_cast<int>(high.y() / kCell_m) + 1);
    for (int row = bottom; row <= top; ++row)
      for (int column = left; column <= right; ++column) {
        const int cell = row * columns_ + column;
        if (distance_to_segment_m(centre(cell), wall.from, wall.to) < std::max(radius_m, kCell_m))
          blocked_[static_cast<size_t>(cell)] = 1;
      }
  }

  Eigen::Vector2d low_;
  int columns_ = 0, rows_ = 0;
  std::vector<uint8_t> blocked_;
};

TEST(PolygonGround, StopsAllAgentsAtItsEdgesAndLeadsThemToTheirGoals) {
  constexpr double kEnough_s = 240;
  // A body passes a gap of twice the upper radius for certain, of the lower one never.
  // Bodies may pass gaps between corners that no plane measures: 0.3 m.
  constexpr double kFits_m = 0.42, kDoesNotFit_m = 0.1;
  int worlds = 0, large = 0, arrived = 0, stranded = 0, late = 0, unclear = 0;
  for (uint64_t seed = 1; seed <= test::part_of(test::is_nightly() ? 2000u : 180u); ++seed) {
    SCOPED_TRACE(seed);
    test::RandomWorld built = test::random_world(seed);
    if (built.scene.groups.empty()) continue;
    ++worlds;
    large += built.walls.size() > 9000;
    SmallWorld world(built.scene, 1);
    Crowd& crowd = world.crowd;
    const size_t people = crowd.size();
    const std::vector<Eigen::Vector2d> starts(crowd.positions_m().begin(),
                                              crowd.positions_m().end());
    std::vector<Eigen::Vector2d> before = starts;
    std::vector<uint8_t> was_present(people);
    for (uint32_t id = 0; id < people; ++id) was_present[id] = crowd.journeys().is_present(id);
    double time_s = 0;
    const auto all_done = [&] {
      for (uint32_t id = 0; id < people; ++id)
        if (crowd.journeys().is_present(id) &&
            crowd.journeys().state(id) != JourneyState::kStranded)
          return false;
      return true;
    };
    for (; time_s < kEnough_s && !all_done(); time_s += built.scene.step_s) {
      crowd.step();
      for (uint32_t id = 0; id < people; ++id) {
        const Eigen::Vector2d& now = crowd.positions_m()[id];
        if (was_present[id] != 0 && crowd.journeys().is_present(id)) {
          for (const test::WallPiece& wall : built.walls)
            ASSERT_FALSE(do_cross({before[id], now}, wall))
                << "agent " << id << " at " << now.transpose() << " after " << time_s << " s";
        }
        before[id] = now;
        was_present[id] = crowd.journeys().is_present(id);
      }
    }
    const FloodFill generous(built.scene, built.walls, kDoesNotFit_m);
    const FloodFill strict(built.scene, built.walls, kFits_m);
    const Area& goal = built.scene.groups[0].goals[0].areas[0];
    for (uint32_t id = 0; id < people; ++id) {
      const bool is_stranded =
          crowd.journeys().is_present(id) && crowd.journeys().state(id) == JourneyState::kStranded;
      const bool has_arrived = !crowd.journeys().is_present(id);
      arrived += has_arrived;
      stranded += is_stranded;
      if (is_stranded) {
        EXPECT_FALSE(strict.reaches(starts[id], goal))
            << "agent " << id << " from " << starts[id].transpose() << " has a wide path";
      } else if (!has_arrived) {
        ++late;
        unclear += strict.reaches(starts[id], goal) ? 0 : 1;
        ADD_FAILURE() << "agent " << id << " walks for ever, now at "
                      << crowd.positions_m()[id].transpose();
      } else {
        // An area that obstacles cover is reached next to it, see has_reached().
        constexpr double kNextTo_m = 0.75;
        EXPECT_TRUE(generous.reaches(starts[id], goal, kNextTo_m))
            << "agent " << id << " went through a wall";
      }
    }
  }
  std::printf(
      "%d worlds, %d of 10 000 corners: %d agents arrived, %d stranded, %d late (%d of them with a "
      "narrow path)\n",
      worlds, large, arrived, stranded, late, unclear);
  EXPECT_GT(worlds, 20);
  EXPECT_GT(large, 0);
  EXPECT_GT(arrived, 2 * worlds);
  EXPECT_GT(stranded, worlds / 10);
}

TEST(PolygonGround, EqualsARectangleIfItIsOne) {
  const auto positions_of = [](bool is_polygon) {
    Scene scene = crossing(3, 60);
    if (is_polygon) {
      const Area ground(std::vector<Polygon>{polygon_of(scene.ground)});
      scene.ground = ground.bounds();
      for (Group& group : scene.groups) group.spawn = Area(group.spawn.polygons());
    }
    SmallWorld world(std::move(scene), 1);
    for (int i = 0; i < 300; ++i) world.crowd.step();
    return std::vector<Eigen::Vector2d>(world.crowd.positions_m().begin(),
                                        world.crowd.positions_m().end());
  };
  EXPECT_EQ(positions_of(true), positions_of(false));
}

/// Mean speed (m/s) of people along a corridor of 30 m, after its rotation by `turn_rad`.
double corridor_speed_mps(double turn_rad, int pieces, uint64_t seed) {
  const auto turned = [&](double x, double y) {
    return Eigen::Vector2d(std::cos(turn_rad) * x - std::sin(turn_rad) * y,
                           std::sin(turn_rad) * x + std::cos(turn_rad) * y);
  };
  const auto turned_box = [&](double left, double low, double right, double high) {
    Polygon out;
    for (int i = 0; i < pieces; ++i)
      out.outline.push_back(turned(left + (right - left) * i / pieces, low));
    for (int i = 0; i < pieces; ++i)
      out.outline.push_back(turned(right - (right - left) * i / pieces, high));
    out.outline.push_back(turned(left, high));
    out.outline.insert(out.outline.begin() + pieces, turned(right, low));
    return out;
  };
  Scene scene;
  scene.seed = seed;
  scene.step_s = 1.0 / 60;
  const Polygon corridor = turned_box(0, 0, 30, 3);
  scene.floor = {corridor};
  scene.ground = ground_around(scene.floor);
  Group group;
  group.count = 30;
  group.spawn = Area(std::vector<Polygon>{turned_box(1, 0.5, 12, 2.5)});
  group.goals.emplace_back(Area(std::vector<Polygon>{turned_box(28, 0.2, 29.5, 2.8)}));
  group.on_arrival = OnArrival::kLeave;
  scene.groups.push_back(std::move(group));
  SmallWorld world(std::move(scene), 1);
  double sum_m = 0;
  int64_t steps = 0;
  for (int i = 0; i < 60 * 15; ++i) {
    world.crowd.step();
    for (uint32_t id = 0; id < world.crowd.size(); ++id) {
      if (!world.crowd.journeys().is_present(id)) continue;
      sum_m += world.crowd.displacements_m()[id];
      ++steps;
    }
  }
  return sum_m * 60 / static_cast<double>(steps);
}

TEST(PolygonGround, DoesNotSlowPeopleDownIfItsWallsHaveManyPieces) {
  double straight_mps = 0, divided_mps = 0;
  constexpr uint64_t kSeeds = 12;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    straight_mps += corridor_speed_mps(0.4, 1, seed) / kSeeds;
    divided_mps += corridor_speed_mps(0.4, 60, seed) / kSeeds;
  }
  std::printf("walls in one piece: %.3f m/s, in 60: %.3f m/s\n", straight_mps, divided_mps);
  EXPECT_NEAR(divided_mps, straight_mps, 0.02 * straight_mps);
}

}  // namespace
}  // namespace throng::polygon_ground_test
