// Tests of detours: directions avoid slow crowds while that saves time, and never lead back.
#include "crowd/detours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "base/errors.h"
#include "base/random.h"
#include "tests/crowd/crowd_world.h"
#include "tests/scenes/same_walk.h"

namespace throng::detours_test {
namespace {

using Walkers = std::vector<Detours::AgentSample>;
const Eigen::Vector2d kStand = Eigen::Vector2d::Zero();

/// Ground of 40 m by 40 m; the goal is its upper side.
Scene field_of(std::vector<Obstacle> obstacles = {}) {
  Scene scene;
  scene.ground = {{0, 0}, {40, 40}};
  scene.obstacles = std::move(obstacles);
  scene.groups = {group(1, {{1, 1}, {39, 2}}, {{{0, 38}, {40, 40}}})};
  return scene;
}

/// Agents at this density in an area.
Walkers crowd(const Rectangle& area, double per_m2, const Eigen::Vector2d& relative_velocity) {
  Walkers walkers;
  const double apart_m = 1 / std::sqrt(per_m2);
  const Eigen::Vector2i count = ((area.size_m() / apart_m).array() - 0.5).ceil().cast<int>();
  for (int row = 0; row < count.y(); ++row)
    for (int column = 0; column < count.x(); ++column)
      walkers.push_back(
          {area.min_m + apart_m * Eigen::Vector2d(column + 0.5, row + 0.5), relative_velocity});
  return walkers;
}

struct Field {
  explicit Field(Scene scene_in, const Walkers& walkers = {})
      : scene(std::move(scene_in)), map(scene, workers) {
    look_at(walkers);
  }

  /// Updates the detours until they are constant.
  void look_at(const Walkers& walkers) {
    for (uint64_t period = 0; period < 20 * Detours::kRound; ++period)
      detours.update(
          period, walkers.size(), [&](size_t i) { return walkers[i]; }, workers);
  }
  Eigen::Vector2d straight(const Eigen::Vector2d& place_m) const {
    return map.field(0).direction(place_m);
  }
  Eigen::Vector2d detoured(const Eigen::Vector2d& place_m, double delay_weight = 1) const {
    return detours.detoured_direction(0, place_m, straight(place_m), delay_weight);
  }
  /// Walks to the goal in steps along detoured directions; returns the path, ending early without
  /// arrival.
  std::vector<Eigen::Vector2d> follow(Eigen::Vector2d place_m) const {
    std::vector<Eigen::Vector2d> places_m = {place_m};
    for (int step = 0; step < 2000 && !scene.groups[0].goals[0].contains(place_m); ++step) {
      place_m += 0.1 * detoured(place_m);
      places_m.push_back(place_m);
    }
    return places_m;
  }

  Scene scene;
  Workers workers{2};
  NavigationMap map;
  Detours detours{map, workers};
};

double left_of_straight(const Field& field, const Eigen::Vector2d& place_m) {
  const Eigen::Vector2d straight = field.straight(place_m), detoured = field.detoured(place_m);
  return straight.x() * detoured.y() - straight.y() * detoured.x();
}

TEST(Detours, IgnoreLooseCrowds) {
  const Field field(field_of(), crowd({{0, 0}, {40, 40}}, 0.5, kStand));
  EXPECT_FALSE(field.detours.is_detoured(0));
  EXPECT_EQ(field.detoured({20, 10}), field.straight({20, 10}));
}

TEST(Detours, LeadRoundStandingCrowdsByTheNearerSide) {
  const Rectangle block{{14, 18}, {26, 24}};
  Field field(field_of(), crowd(block, 3, kStand));
  EXPECT_GT(left_of_straight(field, {16, 12}), 0.3);
  EXPECT_LT(left_of_straight(field, {24, 12}), -0.3);
  EXPECT_NEAR(left_of_straight(field, {5, 12}), 0, 0.05) << "is past it anyway";
  EXPECT_NEAR(left_of_straight(field, {20, 30}), 0, 0.05) << "has passed it";
  for (const double x : {15.0, 17.0, 23.0, 25.0}) {
    const std::vector<Eigen::Vector2d> places_m = field.follow({x, 4});
    EXPECT_GT(places_m.back().y(), 38);
    for (const Eigen::Vector2d& place_m : places_m)
      EXPECT_FALSE(block.grown(-1.5).contains(place_m)) << "from " << x;
  }
}

TEST(Detours, AvoidLongDetoursAroundSmallCrowds) {
  const Field field(field_of(), crowd({{2, 18}, {38, 20}}, 3, kStand));
  EXPECT_NEAR(left_of_straight(field, {20, 8}), 0, 0.2);
}

TEST(Detours, CountOncomingAgentsOnly) {
  const Rectangle block{{14, 18}, {26, 24}};
  Field field(field_of(), crowd(block, 3, {0, 1}));
  EXPECT_NEAR(left_of_straight(field, {16, 12}), 0, 0.02);
  field.look_at(crowd(block, 3, {0, -1}));
  EXPECT_GT(left_of_straight(field, {16, 12}), 0.3);
}

TEST(Detours, KeepPlainDirectionsInsideTheCrowd) {
  const Field field(field_of(), crowd({{8, 14}, {32, 26}}, 3, kStand));
  EXPECT_GT(left_of_straight(field, {14, 9}), 0.1);
  EXPECT_NEAR(left_of_straight(field, {14, 20}), 0, 0.01);
}

TEST(Detours, EndWhenTheCrowdIsGone) {
  Field field(field_of(), crowd({{14, 18}, {26, 24}}, 3, kStand));
  ASSERT_TRUE(field.detours.is_detoured(0));
  field.look_at({});
  EXPECT_FALSE(field.detours.is_detoured(0));
}

TEST(Detours, IgnoreCrowdsBehindWalls) {
  // Two halls with a wall of 0.2 m between them that does not coincide with a cell border.
  Field field(field_of({box(20.3, 16, 0.2, 32)}), crowd({{20.5, 0}, {40, 34}}, 3, kStand));
  ASSERT_TRUE(field.detours.is_detoured(0));
  for (int y = 2; y < 28; ++y) EXPECT_NEAR(left_of_straight(field, {16, y}), 0, 0.02) << "at " << y;
}

/// Random boxes and agents.
Field random_field(uint64_t seed) {
  uint32_t draws = 0;
  const auto draw = [&](double low, double high) {
    return random_uniform({seed, 0, 0, Purpose::kStudy}, low, high, draws++);
  };
  std::vector<Obstacle> boxes;
  for (int i = 0; i < 8; ++i)
    boxes.push_back(box(draw(4, 36), draw(6, 34), draw(0.3, 9), draw(0.3, 3), draw(0, 3.1)));
  Walkers walkers;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector2d at(draw(0, 30), draw(4, 30));
    const double angle = draw(0, 6.28), relative_velocity = draw(0, 1);
    const Walkers more =
        crowd({at, at + Eigen::Vector2d(draw(2, 10), draw(2, 10))}, draw(0.5, 5),
              relative_velocity * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    walkers.insert(walkers.end(), more.begin(), more.end());
  }
  return Field(field_of(std::move(boxes)), walkers);
}

TEST(Detours, GiveUnitDirectionsThatNeverLeadBack) {
  int detoured = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Field field = random_field(seed);
    constexpr int kAcross = 57;
    for (int row = 0; row < kAcross; ++row)
      for (int column = 0; column < kAcross; ++column) {
        const double x = 0.7 * column + 0.4, y = 0.7 * row + 0.4;
        const Eigen::Vector2d straight = field.straight({x, y});
        if (straight.isZero()) continue;
        for (const double delay_weight : {0.5, 1.5, 100.0}) {
          const Eigen::Vector2d direction = field.detoured({x, y}, delay_weight);
          ASSERT_NEAR(direction.norm(), 1, 1e-9);
          ASSERT_GT(direction.dot(straight), 0);
          detoured += direction.dot(straight) < 0.98;
        }
      }
  }
  EXPECT_GT(detoured, 5000);
}

/// Least cost of a path with one corner through a standing block, by brute force.
double min_cost(const Rectangle& block, double costs, const Eigen::Vector2d& from_m) {
  const auto cost = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    constexpr int kPieces = 200;
    double sum = 0;
    for (int i = 0; i < kPieces; ++i) {
      const Eigen::Vector2d at = a + (i + 0.5) / kPieces * (b - a);
      sum += (block.contains(at) ? costs : 1) * (b - a).norm() / kPieces;
    }
    return sum;
  };
  double min = std::numeric_limits<double>::infinity();
  for (int row = 0; row < 2 * 36; ++row)
    for (int column = 0; column < 2 * 40; ++column) {
      const Eigen::Vector2d by(0.5 * column + 0.25, 0.5 * row + 2.25);
      min = std::min(min, cost(from_m, by) + cost(by, {by.x(), 38}));
    }
  return min;
}

TEST(Detours, CostLittleMoreThanTheBestPath) {
  constexpr double kStands = 1 / 0.15;  // cost of a metre among standing agents
  double sum = 0, best = 0, straight = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto draw = [&](double low, double high, uint32_t index) {
      return random_uniform({seed, 1, 0, Purpose::kStudy}, low, high, index);
    };
    const Eigen::Vector2d low(draw(6, 14, 0), draw(14, 20, 1));
    const Rectangle block{low, low + Eigen::Vector2d(draw(6, 16, 2), draw(4, 10, 3))};
    const Eigen::Vector2d from(draw(block.min_m.x(), block.max_m.x(), 4), 2);
    const Field field(field_of(), crowd(block, 3, kStand));
    const std::vector<Eigen::Vector2d> places_m = field.follow(from);
    ASSERT_GT(places_m.back().y(), 38);
    double cost = 0;
    for (const Eigen::Vector2d& place_m : places_m)
      cost += 0.1 * (block.contains(place_m) ? kStands : 1);
    sum += cost;
    best += min_cost(block, kStands, from);
    straight += 36 + (kStands - 1) * block.size_m().y();
  }
  std::printf("straight on %.0f m, bent %.0f m, the best %.0f m\n", straight, sum, best);
  EXPECT_LT(sum, 1.25 * best);
  EXPECT_LT(sum, 0.75 * straight);
}

/// A stream along a wide corridor and round its corner.
Scene wide_corner(uint64_t seed) {
  Scene scene;
  scene.seed = seed;
  scene.step_s = 0.05;
  scene.ground = {{0, 0}, {30, 45}};
  scene.obstacles = {box(25, 32.5, 10, 25)};  // leaves 20 m
  scene.groups = {group(400, {{1, 30}, {19, 44}}, {{{28, 0}, {30, 20}}})};
  scene.groups[0].on_arrival = OnArrival::kLeave;
  return scene;
}

TEST(Detours, SpreadACrowdOverAWideCorner) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallWorld world(wide_corner(seed), 2);
    std::vector<double> away_m;  // distance of passing agents from the inner edge
    for (int step = 0; step < 150 * 20; ++step) {
      const std::vector<Eigen::Vector2d> before(world.crowd.positions_m().begin(),
                                                world.crowd.positions_m().end());
      world.crowd.step();
      for (size_t id = 0; id < before.size(); ++id) {
        const Eigen::Vector2d edge(20, 20), now = world.crowd.positions_m()[id];
        const auto is_round = [&](const Eigen::Vector2d& at) {
          return at.x() - edge.x() > at.y() - edge.y();
        };
        if (!is_round(before[id]) && is_round(now)) away_m.push_back((now - edge).norm());
      }
    }
    ASSERT_GE(away_m.size(), 400u);
    std::sort(away_m.begin(), away_m.end());
    std::printf("half of them within %.1f m of the edge, 90 %% within %.1f m\n",
                away_m[away_m.size() / 2], away_m[away_m.size() * 9 / 10]);
    EXPECT_GT(away_m[away_m.size() * 9 / 10], 3.5) << "2.2 if all went the shortest way";
    EXPECT_EQ(world.crowd.population().counters().left, 400u);
  }
}

TEST(Detours, AreIndependentOfThreadsAndCheckpoints) {
  for (uint64_t seed = 1; seed <= 3; ++seed) expect_same_walk(wide_corner(seed), 15 * 20 + 7, 200);
}

TEST(Detours, RejectDamagedCheckpoints) {
  Field field(field_of(), crowd({{14, 18}, {26, 24}}, 3, kStand));
  Archive out;
  field.detours.archive(out);
  for (const size_t at : {size_t{8}, out.bytes().size() - 4}) {
    std::vector<uint8_t> bytes = out.bytes();
    for (size_t i = 0; i < 4; ++i) bytes[at + i] = 0xff;  // not a number
    Archive in(bytes, "test");
    EXPECT_THROW(field.detours.archive(in), InputError);
  }
}

}  // namespace
}  // namespace throng::detours_test
