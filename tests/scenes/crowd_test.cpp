// How people walk: alone, head on, in a throng, beside walls.
#include "scenes/crowd.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "scenes/hasher.h"
#include "tests/scenes/crowd_world.h"

namespace throng {
namespace {

constexpr Distribution kExactly134{1.34, 0, 1.34, 1.34};

uint64_t hash_of(const Crowd& crowd) {
  Hasher hash;
  for (size_t i = 0; i < crowd.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      hash.add(crowd.positions_m()[i][axis]).add(crowd.velocities_mps()[i][axis]);
      hash.add(crowd.headings()[i][axis]);
    }
    hash.add(crowd.walked_m()[i]);
  }
  return hash.value();
}

TEST(Crowd, SomebodyAloneWalksAtTheFreeSpeed) {
  Scene scene;
  scene.ground = {{0, 0}, {44, 2}};
  scene.groups = {group(1, {{0.5, 0.5}, {1.5, 1.5}}, {{{42, 0}, {44, 2}}})};
  scene.groups[0].speed_mps = {1.33, 0, 1.33, 1.33};
  World world(scene, 1);
  ASSERT_EQ(world.crowd.size(), 1u);
  const double start_m = world.crowd.positions_m()[0].x();
  int steps = 0;
  while (world.crowd.positions_m()[0].x() < start_m + 40 && steps < 6000) {
    world.crowd.step();
    ++steps;
  }
  const double seconds = steps * scene.step_s;
  EXPECT_NEAR(40 / seconds, 1.33, 0.01) << "40 m took " << seconds << " s";
}

TEST(Crowd, WhatIsWalkedIsTheWayBetweenPositions) {
  World world(crossing(2, 40), 1);
  for (int step = 0; step < 200; ++step) {
    const std::vector<Eigen::Vector2d> before(world.crowd.positions_m().begin(),
                                              world.crowd.positions_m().end());
    world.crowd.step();
    for (size_t i = 0; i < before.size(); ++i)
      ASSERT_NEAR(world.crowd.walked_m()[i], (world.crowd.positions_m()[i] - before[i]).norm(),
                  1e-12);
  }
}

TEST(Crowd, TwoWhoMeetHeadOnPassEachOther) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene;
    scene.seed = seed;
    scene.ground = {{0, 0}, {20, 4}};
    scene.groups = {group(1, {{1.999, 1.999}, {2, 2}}, {{{18.5, 1.9}, {19.5, 2.1}}}),
                    group(1, {{17.999, 1.999}, {18, 2}}, {{{0.5, 1.9}, {1.5, 2.1}}})};
    for (Group& each : scene.groups) each.speed_mps = kExactly134;
    World world(scene, 1);
    ASSERT_EQ(world.crowd.size(), 2u);
    double nearest_m = 1e9;
    for (int step = 0; step < 60 * 14; ++step) {
      world.crowd.step();
      nearest_m =
          std::min(nearest_m, (world.crowd.positions_m()[0] - world.crowd.positions_m()[1]).norm());
    }
    EXPECT_GT(world.crowd.positions_m()[0].x(), 17) << "the first did not get past";
    EXPECT_LT(world.crowd.positions_m()[1].x(), 3) << "the second did not get past";
    EXPECT_GT(nearest_m, 0.36) << "they ran into each other";
  }
}

TEST(Crowd, NobodyEntersOrCrossesAWall) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    World world(crossing(seed, 600), 2);
    const Walkable& walkable = world.ways.walkable();
    double nearest_m = 1e9;
    for (int step = 0; step < 600; ++step) {
      const std::vector<Eigen::Vector2d> before(world.crowd.positions_m().begin(),
                                                world.crowd.positions_m().end());
      world.crowd.step();
      for (size_t i = 0; i < before.size(); ++i) {
        const Eigen::Vector2d& now = world.crowd.positions_m()[i];
        nearest_m = std::min(nearest_m, walkable.clearance_m(now));
        ASSERT_FALSE(walkable.crosses(before[i], now)) << "person " << i << " step " << step;
      }
      ASSERT_GE(nearest_m, 0) << "step " << step;
    }
    RecordProperty("nearest_to_a_wall_m", std::to_string(nearest_m));
  }
}

TEST(Crowd, WalksTheSameForEveryNumberOfThreads) {
  uint64_t expected = 0;
  for (const int threads : {1, 2, 3, 8}) {
    World world(crossing(5, 1200), threads);
    for (int step = 0; step < 300; ++step) world.crowd.step();
    const uint64_t found = hash_of(world.crowd);
    if (threads == 1) expected = found;
    EXPECT_EQ(found, expected) << threads << " threads, seed 5";
  }
}

TEST(Crowd, HeadingsAreUnitAndTurnNoFasterThanTheLimit) {
  World world(crossing(3, 400), 1);
  std::vector<Eigen::Vector2d> before(world.crowd.headings().begin(), world.crowd.headings().end());
  for (int step = 0; step < 300; ++step) {
    world.crowd.step();
    for (size_t i = 0; i < before.size(); ++i) {
      const Eigen::Vector2d& now = world.crowd.headings()[i];
      ASSERT_NEAR(now.norm(), 1, 1e-12);
      ASSERT_LE(std::acos(std::min(1.0, now.dot(before[i]))), 3.0 / 60 + 1e-6);
      before[i] = now;
    }
  }
}

TEST(Crowd, AThrongKeepsMovingAndHardlyOverlaps) {
  World world(crossing(1, 480), 2);
  double deepest_m = 0;
  double stall_s = 0;
  double turned_rad = 0;
  const int steps = 60 * 60;
  std::vector<Eigen::Vector2d> before(world.crowd.headings().begin(), world.crowd.headings().end());
  for (int step = 0; step < steps; ++step) {
    world.crowd.step();
    deepest_m = std::max(deepest_m, world.crowd.counters().deepest_overlap_m);
    stall_s = std::max(stall_s, world.crowd.counters().longest_stall_s);
    for (size_t i = 0; i < before.size(); ++i) {
      turned_rad += std::acos(std::min(1.0, world.crowd.headings()[i].dot(before[i])));
      before[i] = world.crowd.headings()[i];
    }
  }
  const double turn_radps = turned_rad / (60.0 * static_cast<double>(before.size()));
  std::printf(
      "[ figures ] seed 1, %zu people, 60 s: deepest overlap %.3f m, longest stall %.1f s, "
      "mean heading rate %.3f rad/s\n",
      before.size(), deepest_m, stall_s, turn_radps);
  EXPECT_LT(deepest_m, 0.1);
  EXPECT_LT(stall_s, 5);
  EXPECT_LT(turn_radps, 0.5);
}

TEST(Spawn, NobodyStandsInAnObstacleOrInAnotherPerson) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const World world(crossing(seed, 1600), 1);
    const std::vector<Person>& people = world.spawned.people;
    int unplaced = 0;
    for (const int count : world.spawned.unplaced) unplaced += count;
    EXPECT_EQ(people.size() + static_cast<size_t>(unplaced), 1600u) << "somebody vanished";
    for (size_t i = 0; i < people.size(); ++i) {
      ASSERT_GE(world.ways.walkable().clearance_m(people[i].position_m), people[i].radius_m);
      for (size_t j = 0; j < i; ++j)
        ASSERT_GE((people[i].position_m - people[j].position_m).norm(),
                  people[i].radius_m + people[j].radius_m);
    }
  }
}

TEST(Spawn, SaysHowManyItCouldNotPlace) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 10}};
  scene.groups = {group(50, {{1, 1}, {3, 3}}, {{{15, 1}, {18, 9}}})};
  scene.groups[0].name = "packed";
  World world(scene, 1);
  ASSERT_EQ(world.spawned.notes.size(), 1u);
  EXPECT_GT(world.spawned.unplaced[0], 20);
  const std::string expected =
      "group 'packed': placed " + std::to_string(world.crowd.size()) + " of 50 people";
  EXPECT_EQ(world.spawned.notes[0].substr(0, expected.size()), expected);
}

}  // namespace
}  // namespace throng
