// Tests of triggers and doors: doors follow their triggers, agents wait before closed ones, and no
// door shuts on an agent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/crowd/crowd_world.h"
#include "tests/scenes/same_walk.h"

namespace throng::doors_test {
namespace {

constexpr int kStepsPerSecond = 30;

/// Two rooms of 8 m with a gap of 1.2 m in the wall between them; all agents walk east.
Scene two_halls(uint64_t seed, int people) {
  Scene scene;
  scene.seed = seed;
  scene.step_s = 1.0 / kStepsPerSecond;
  scene.ground = {{-8, -4}, {8, 4}};
  scene.obstacles = {box(0, -2.3, 0.3, 3.4), box(0, 2.3, 0.3, 3.4)};
  scene.groups = {group(people, {{-7, -3}, {-3, 3}}, {{{5, -3}, {7.5, 3}}})};
  scene.groups[0].name = "first";
  scene.groups[0].on_arrival = OnArrival::kLeave;
  return scene;
}

Door door(std::vector<TriggerRule> opens, std::vector<TriggerRule> closes) {
  return {"door", {0, -0.6}, {0, 0.6}, std::move(opens), std::move(closes)};
}

void walk(SmallWorld& world, double seconds) {
  for (int step = 0; step < seconds * kStepsPerSecond; ++step) world.crowd.step();
}

int in_the_east(const SmallWorld& world) {
  int count = 0;
  for (uint32_t id = 0; id < world.crowd.size(); ++id)
    count += world.crowd.positions_m()[id].x() > 0.3;
  return count;
}

class Doors : public testing::TestWithParam<SteeringKind> {
 protected:
  Scene with_model(Scene scene) const {
    scene.steering.model = GetParam();
    return scene;
  }
};

TEST_P(Doors, HoldAgentsUntilTheyOpen) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_model(two_halls(seed, 24));
    scene.doors = {door({{25, "", 0}}, {})};
    SmallWorld world(scene, 2);
    walk(world, 15);
    EXPECT_EQ(in_the_east(world), 0);
    const std::vector<Eigen::Vector2d> before(world.crowd.positions_m().begin(),
                                              world.crowd.positions_m().end());
    double min_gap_m = 9, nearest_m = 9, farthest_m = 0, moved_m = 0;
    int faces_door = 0;
    walk(world, 9);
    for (uint32_t id = 0; id < world.crowd.size(); ++id) {
      const Eigen::Vector2d& place = world.crowd.positions_m()[id];
      const Eigen::Vector2d leaf(0, std::clamp(place.y(), -0.6, 0.6));
      min_gap_m = std::min(min_gap_m, (place - leaf).norm() - world.spawned.people[id].radius_m);
      nearest_m = std::min(nearest_m, place.norm());
      farthest_m = std::max(farthest_m, place.norm());
      moved_m = std::max(moved_m, (place - before[id]).norm());
      faces_door += world.crowd.headings()[id].dot(-place.normalized()) > 0.5;
    }
    EXPECT_EQ(in_the_east(world), 0);
    EXPECT_GT(min_gap_m, 0) << "an agent touches the door";
    EXPECT_LT(nearest_m, 1);
    EXPECT_LT(farthest_m, 5) << "an agent stays far from the door";
    EXPECT_LT(moved_m, 0.4) << "an agent does not stand still";
    EXPECT_GE(faces_door, 22);
    EXPECT_LT(world.crowd.counters().longest_stall_s, 3) << "waiting agents are not stuck";
    walk(world, 50);
    EXPECT_EQ(world.crowd.population().counters().left, 24u);
  }
}

TEST_P(Doors, NeverShutOnAgents) {
  int stood_in = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_model(two_halls(seed, 40));
    scene.doors = {door({}, {{6.0 + 0.3 * static_cast<double>(seed), "", 0}})};
    SmallWorld world(scene, 1);
    bool was_closing = false;
    for (int step = 0; step < 30 * kStepsPerSecond; ++step) {
      world.crowd.step();
      was_closing |= world.map.doors()[0] == DoorState::kClosing;
      if (world.map.doors()[0] != DoorState::kShut) continue;
      for (uint32_t id = 0; id < world.crowd.size(); ++id) {
        if (world.crowd.population().present()[id] == 0) continue;
        ASSERT_GT(world.map.nearest_door(0, world.crowd.positions_m()[id]).distance_m, 0.05)
            << "person " << id << ", step " << step;
      }
    }
    stood_in += was_closing;
    EXPECT_EQ(world.map.doors()[0], DoorState::kShut);
    const int left = static_cast<int>(world.crowd.population().counters().left);
    EXPECT_GT(left, 0);
    EXPECT_LT(left, 40);
    EXPECT_EQ(in_the_east(world), left) << "agents keep the position at which they left";
  }
  EXPECT_GT(stood_in, 0) << "no agent stood in any door";
}

TEST_P(Doors, SendAgentsToAnotherDoorUnlessItIsFar) {
  for (const double far_m : {5.0, 60.0}) {
    SCOPED_TRACE(testing::Message() << "the other door " << far_m << " m off");
    Scene scene;
    scene.step_s = 1.0 / kStepsPerSecond;
    scene.ground = {{-8, -4}, {8, far_m + 4}};
    // From the south edge to the first gap, between the gaps, and to the north edge.
    scene.obstacles = {box(0, -2.3, 0.3, 3.4), box(0, far_m / 2, 0.3, far_m - 1.2),
                       box(0, far_m + 2.3, 0.3, 3.4)};
    scene.groups = {group(6, {{-7, -3}, {-3, 3}}, {{{5, -3}, {7.5, 3}}})};
    scene.groups[0].on_arrival = OnArrival::kLeave;
    scene.doors = {door({{100, "", 0}}, {})};
    SmallWorld world(with_model(scene), 1);
    walk(world, 40);
    EXPECT_EQ(world.crowd.population().counters().left, far_m < 10 ? 6u : 0u);
  }
}

TEST(DoorTriggers, CloseAfterOpeningAtEqualTimes) {
  Scene scene = two_halls(1, 1);
  scene.groups[0].premovement_s = {100, 0, 100, 100};
  scene.doors = {door({{1, "", 0}, {3, "", 0}}, {{2, "", 0}, {3, "", 0}})};
  SmallWorld world(scene, 1);
  EXPECT_EQ(world.map.doors()[0], DoorState::kShut);
  walk(world, 1.2);
  EXPECT_EQ(world.map.doors()[0], DoorState::kOpen);
  walk(world, 1);
  EXPECT_EQ(world.map.doors()[0], DoorState::kShut);
  walk(world, 2);
  EXPECT_EQ(world.map.doors()[0], DoorState::kShut);
}

/// Sixteen agents walk east, and ten that stand in the east wait for them.
Scene exchange(uint64_t seed) {
  Scene scene = two_halls(seed, 16);
  scene.groups.push_back(group(10, {{1, 2}, {4, 3.6}}, {{{-7.5, -3}, {-5, 3}}}));
  scene.groups[1].name = "second";
  scene.groups[1].on_arrival = OnArrival::kLeave;
  scene.groups[0].goals.insert(scene.groups[0].goals.begin(), Rectangle{{0.5, -3}, {2, 3}});
  scene.groups[0].goals[0].waypoint = true;
  scene.groups[1].after = TriggerRule{1, "first", 1};
  return scene;
}

TEST_P(Doors, StartAGroupAfterAnotherHasVisitedItsGoal) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_model(exchange(seed));
    scene.groups[1].sources = {{{{4.5, 2}, {6, 3.6}}, 3, 1, 0, false}};
    SmallWorld world(scene, 1);
    double all_out_s = -1, sets_out_s = -1;
    for (int step = 0; step < 90 * kStepsPerSecond; ++step) {
      world.crowd.step();
      const double now_s = static_cast<double>(step) / kStepsPerSecond;
      bool all_out = true, one_walks = false;
      for (uint32_t id = 0; id < 16; ++id) all_out &= world.crowd.journeys().has_visited(id, 1);
      for (uint32_t id = 16; id < world.crowd.size(); ++id)
        one_walks |= world.crowd.journeys().state(id) == JourneyState::kWalking;
      if (all_out && all_out_s < 0) all_out_s = now_s;
      if (one_walks && sets_out_s < 0) sets_out_s = now_s;
    }
    EXPECT_GT(all_out_s, 3);
    EXPECT_NEAR(sets_out_s, all_out_s + 1, 0.25) << "a second later, at the next decision";
    EXPECT_EQ(world.crowd.population().counters().left, world.crowd.size());
  }
}

TEST_P(Doors, AreIndependentOfThreadsAndCheckpoints) {
  Scene scene = with_model(exchange(7));
  scene.doors = {
      door({{4, "", 0}}, {{1, "first", 1}}),
  };
  scene.doors[0].opens.push_back({3, "first", 1});
  expect_same_walk(scene, 12 * kStepsPerSecond, 20 * kStepsPerSecond);
}

INSTANTIATE_TEST_SUITE_P(Models, Doors,
                         testing::Values(SteeringKind::kOrca, SteeringKind::kHeuristic),
                         [](const auto& each) { return std::string(name_of(each.param)); });

}  // namespace
}  // namespace throng::doors_test
