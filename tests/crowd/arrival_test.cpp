// Tests of arrival: agents reach every goal with a path to it, however shallow, and are stranded at
// once otherwise.
#include "crowd/navigation/arrival.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "tests/crowd/crowd_world.h"
#include "tests/scenes/same_walk.h"

namespace throng::arrival_test {
namespace {

constexpr int kStepsPerSecond = 20;
constexpr int kMaxDuration_s = 120;
constexpr int kPeople = 24;
/// Runs per kind of goal, depth and model.
constexpr uint64_t kSeeds = 1;
constexpr std::array<double, 9> kDepths_m = {0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5};

struct Plan {
  std::string name;
  Rectangle goal;
  std::vector<Obstacle> obstacles;
  bool is_reached = true;
};

/// Goals of one depth on a ground of 12 m by 9 m with agents in its north.
std::vector<Plan> plans(double depth_m) {
  const Obstacle wall = box(6, 0.9, 12, 0.2);  // up to y = 1
  const auto along = [&](double y) { return Rectangle{{2, y}, {10, y + depth_m}}; };
  std::vector<Plan> all;
  all.push_back({"edge", along(0), {}});
  all.push_back({"short_edge", {{5, 0}, {6.5, depth_m}}, {}});
  all.push_back({"western_edge", {{0, 2}, {depth_m, 6}}, {}});
  all.push_back({"wall", along(1), {wall}});
  all.push_back({"short_wall", {{5, 1}, {6.5, 1 + depth_m}}, {wall}});
  for (const double off_m : {0.05, 0.15, 0.3, 0.6, 1.5})
    all.push_back({"before_a_wall", along(1 + off_m), {wall}});
  all.push_back({"turned_wall", along(2), {box(6, 0.6, 14, 2.4, 0.03)}});
  all.push_back({"corner", {{0, 0}, {depth_m, depth_m}}, {}});
  all.push_back({"walled_corner",
                 {{1, 1}, {1 + depth_m, 1 + depth_m}},
                 {box(0.9, 4, 0.2, 10), box(6, 0.9, 12, 0.2)}});
  all.push_back({"middle", {{6, 3}, {6 + depth_m, 3 + depth_m}}, {}});
  all.push_back({"line", along(3), {}});
  all.push_back({"door",
                 {{5.5, 1.95}, {6.5, 1.95 + depth_m}},
                 {box(2.75, 2, 5.5, 0.2), box(9.25, 2, 5.5, 0.2)}});
  all.push_back(
      {"slot", {{5.85, 2 - depth_m}, {6.15, 2}}, {box(2.925, 1, 5.85, 2), box(9.075, 1, 5.85, 2)}});
  all.push_back({"behind_a_wall", {{2, 0.8 - depth_m}, {10, 0.8}}, {wall}, false});
  all.push_back({"in_an_obstacle", {{5, 1}, {7, 1 + depth_m}}, {box(6, 1.5, 2, 1)}, false});
  all.push_back({"over_a_wall", {{2, 0.75}, {10, 1 + depth_m}}, {wall}});
  return all;
}

Scene scene_of(const Plan& plan, SteeringKind model, uint64_t seed) {
  Scene scene;
  scene.seed = seed;
  scene.step_s = 1.0 / kStepsPerSecond;
  scene.ground = {{0, 0}, {12, 9}};
  scene.steering.model = model;
  scene.obstacles = plan.obstacles;
  scene.groups = {group(kPeople, {{1.5, 4.5}, {11, 8.5}}, {plan.goal})};
  scene.groups[0].ages = {0.3, 0.4, 0.3};
  scene.groups[0].on_arrival = OnArrival::kLeave;
  return scene;
}

int stranded(const SmallWorld& world) {
  int people = 0;
  for (const Stranding& each : world.crowd.journeys().strandings(world.crowd.positions_m()))
    people += each.people;
  return people;
}

/// Steps until this number has left, at most for `max_s`; returns the time.
double leave(SmallWorld& world, uint64_t people, int max_s = kMaxDuration_s) {
  int step = 0;
  for (; step < max_s * kStepsPerSecond && world.crowd.population().counters().left < people;
       ++step)
    world.crowd.step();
  return step / double{kStepsPerSecond};
}

class Arrival : public testing::TestWithParam<SteeringKind> {};

TEST_P(Arrival, ReachesShallowGoalsOrStrandsAllAtOnce) {
  double max_s = 0;
  int runs = 0;
  for (const double depth_m : kDepths_m)
    for (const Plan& plan : plans(depth_m))
      for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
        SCOPED_TRACE(testing::Message() << plan.name << " at " << plan.goal.min_m.transpose()
                                        << ", " << depth_m << " m deep, seed " << seed);
        SmallWorld world(scene_of(plan, GetParam(), seed), 1);
        ++runs;
        if (!plan.is_reached) {
          EXPECT_EQ(stranded(world), kPeople);
          continue;
        }
        EXPECT_EQ(stranded(world), 0);
        max_s = std::max(max_s, leave(world, kPeople));
        EXPECT_EQ(world.crowd.population().counters().left, kPeople);
      }
  printf("goals %s: %d runs, all arrived within %.1f s\n", std::string(name_of(GetParam())).c_str(),
         runs, max_s);
}

/// Between two walls, and between a wall and the corner of a box turned by 45 degrees.
TEST_P(Arrival, ReachesGoalsThroughOpeningsOfBodyWidth) {
  for (const double width_m : {0.52, 0.57, 0.6, 0.65, 0.8})
    for (const bool is_turned : {false, true}) {
      SCOPED_TRACE(testing::Message() << width_m << " m wide" << (is_turned ? ", turned box" : ""));
      Plan plan{"opening", {{2, 0}, {10, 1}}, {box(2.75, 2, 5.5, 0.2)}};
      const double east_m = 5.5 + width_m;
      if (is_turned) {
        plan.obstacles.push_back(box(east_m + std::sqrt(0.5), 2, 1, 1, std::numbers::pi / 4));
        plan.obstacles.push_back(box((east_m + 0.7 + 12) / 2, 2, 12 - east_m - 0.7, 0.2));
      } else {
        plan.obstacles.push_back(box((east_m + 12) / 2, 2, 12 - east_m, 0.2));
      }
      SmallWorld world(scene_of(plan, GetParam(), 7), 1);
      leave(world, kPeople);
      EXPECT_EQ(world.crowd.population().counters().left, kPeople);
    }
}

/// Number of staying agents.
int staying(const SmallWorld& world) {
  int people = 0;
  for (uint32_t id = 0; id < world.crowd.size(); ++id)
    people += world.crowd.journeys().state(id) == JourneyState::kStaying;
  return people;
}

TEST_P(Arrival, StopsAgentsBehindStayingOnes) {
  for (const double depth_m : {0.02, 0.3, 0.5})
    for (const Plan& plan : plans(depth_m)) {
      if (!plan.is_reached) continue;
      SCOPED_TRACE(testing::Message() << plan.name << " at " << plan.goal.min_m.transpose() << ", "
                                      << depth_m << " m deep");
      Scene scene = scene_of(plan, GetParam(), 3);
      scene.groups[0].on_arrival = OnArrival::kStay;
      SmallWorld world(scene, 1);
      for (int step = 0; step < kMaxDuration_s * kStepsPerSecond && staying(world) < kPeople;
           ++step)
        world.crowd.step();
      EXPECT_EQ(staying(world), kPeople);
    }
}

/// Cells are 1 m wide here, and the first free one before a wall is up to 1.7 m away.
TEST_P(Arrival, ReachesGoalsOnCoarseCells) {
  for (const Plan& plan : plans(0.01)) {
    if (plan.name != "wall" && plan.name != "walled_corner") continue;
    SCOPED_TRACE(plan.name);
    Scene scene = scene_of(plan, GetParam(), 2);
    scene.ground.max_m = {1000, 1000};
    SmallWorld world(scene, 1);
    leave(world, kPeople);
    EXPECT_EQ(world.crowd.population().counters().left, kPeople);
  }
}

TEST_P(Arrival, IsIndependentOfThreadsAndCheckpoints) {
  for (const char* const name : {"wall", "middle", "short_edge"})
    for (const Plan& plan : plans(0.1)) {
      if (plan.name != name) continue;
      SCOPED_TRACE(name);
      Scene scene = scene_of(plan, GetParam(), 4);
      scene.groups[0].on_arrival = OnArrival::kStay;
      expect_same_walk(scene, 6 * kStepsPerSecond + 3, 10 * kStepsPerSecond);
    }
}

/// Without corners and a door of 1 m, where departing agents meet arriving ones.
TEST_P(Arrival, ReachesShallowWaypoints) {
  for (const double depth_m : {0.01, 0.1, 0.3})
    for (const Plan& plan : plans(depth_m)) {
      if (!plan.is_reached || plan.name == "door" || plan.name.ends_with("corner")) continue;
      SCOPED_TRACE(testing::Message() << plan.name << " at " << plan.goal.min_m.transpose() << ", "
                                      << depth_m << " m deep");
      Scene scene = scene_of(plan, GetParam(), 6);
      Goal passed = plan.goal, waited = plan.goal;
      passed.waypoint = true;
      waited.wait_s = {1, 0, 1, 1};
      scene.groups[0].goals = {passed, Rectangle{{2, 5}, {10, 8}}, waited,
                               Rectangle{{2, 5}, {10, 8}}};
      SmallWorld world(scene, 1);
      leave(world, kPeople, 2 * kMaxDuration_s);
      EXPECT_EQ(world.crowd.population().counters().left, kPeople);
    }
}

TEST_P(Arrival, ReachesGoalsForEveryDiscSize) {
  for (const double radius_m : {0.1, 0.4, 0.8})
    for (const double depth_m : {0.01, 0.1, 0.3, 0.5})
      for (const Plan& plan : plans(depth_m)) {
        if (!plan.is_reached || plan.name == "door") continue;
        SCOPED_TRACE(testing::Message()
                     << plan.name << " at " << plan.goal.min_m.transpose() << ", " << depth_m
                     << " m deep, discs of " << radius_m << " m");
        Scene scene = scene_of(plan, GetParam(), 5);
        scene.groups[0].count = 6;
        scene.groups[0].radius_m = radius_m;
        SmallWorld world(scene, 1);
        leave(world, 6);
        EXPECT_EQ(world.crowd.population().counters().left, 6u);
      }
}

INSTANTIATE_TEST_SUITE_P(Models, Arrival,
                         testing::Values(SteeringKind::kHeuristic, SteeringKind::kOrca,
                                         SteeringKind::kCollisionFreeSpeed),
                         [](const auto& each) { return std::string(name_of(each.param)); });

}  // namespace
}  // namespace throng::arrival_test
