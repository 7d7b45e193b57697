// Tests of exits: agents take the exit with the least expected time, with individual patience.
#include "crowd/exits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/random.h"
#include "tests/crowd/crowd_world.h"
#include "tests/scenes/same_walk.h"

namespace throng::exits_test {
namespace {

constexpr int kStepsPerSecond = 20;
constexpr double kHall_m = 24;
constexpr double kDepth_m = 12;

struct Opening {
  double middle_m = 0;  ///< along the southern wall
  double width_m = 1;
};

/// A hall of 24 m by 12 m with doors in its southern wall. Behind it a strip of 3 m connects the
/// doors: the goal is an area before each of them, or the whole strip.
enum class Outside { kAreas, kStrip };
Scene hall(uint64_t seed, int people, const Rectangle& spawn, const std::vector<Opening>& doors,
           Outside outside = Outside::kAreas) {
  Scene scene;
  scene.seed = seed;
  scene.step_s = 1.0 / kStepsPerSecond;
  scene.ground = {{0, -3.2}, {kHall_m, kDepth_m}};
  double from = 0;
  Goal exits;
  const auto wall = [&](double to) {
    scene.obstacles.push_back(box(0.5 * (from + to), -0.1, to - from, 0.2));
  };
  for (const auto& [middle_m, width_m] : doors) {
    wall(middle_m - 0.5 * width_m);
    from = middle_m + 0.5 * width_m;
    if (outside == Outside::kAreas) exits.areas.push_back({{middle_m - 1, -3}, {middle_m + 1, -2}});
  }
  if (outside == Outside::kStrip) exits.areas = {{{0, -3}, {kHall_m, -2}}};
  wall(kHall_m);
  exits.waypoint = true;
  scene.groups = {group(people, spawn, {})};
  scene.groups[0].goals = {exits};
  scene.groups[0].on_arrival = OnArrival::kLeave;
  return scene;
}

const std::vector<Opening> kTwoDoors = {{4, 1}, {20, 1}};
const Rectangle kWesternHalf = {{0.3, 0.3}, {12, kDepth_m - 0.3}};

/// Runs a hall until all have left; records the doors used and changes of choice.
struct Leaving {
  Leaving(const Scene& scene, const std::vector<Opening>& doors) : world(scene, 2) {
    const uint32_t people = static_cast<uint32_t>(world.crowd.size());
    std::vector<uint32_t> chosen(people, Journeys::kNoExit);
    changes.assign(people, 0);
    for (int step = 0; step < 300 * kStepsPerSecond; ++step) {
      const std::vector<Eigen::Vector2d> before(world.crowd.positions_m().begin(),
                                                world.crowd.positions_m().end());
      world.crowd.step();
      for (uint32_t id = 0; id < people; ++id) {
        const uint32_t now = world.crowd.journeys().exit(id);
        const Eigen::Vector2d& place = world.crowd.positions_m()[id];
        if (before[id].y() >= -0.1 && place.y() < -0.1) {
          size_t door = 0;
          for (size_t i = 1; i < doors.size(); ++i)
            if (std::abs(doors[i].middle_m - place.x()) <
                std::abs(doors[door].middle_m - place.x()))
              door = i;
          ++by_door[door];
          by_other_door += chosen[id] != door;
        }
        if (now >= Journeys::kOpen) continue;
        changes[id] += chosen[id] < Journeys::kOpen && chosen[id] != now;
        chosen[id] = now;
        const uint32_t first = world.crowd.journeys().first_member(id);
        const uint32_t firsts = world.crowd.journeys().exit(first);
        apart += firsts < Journeys::kOpen && firsts != now;
      }
      seconds = step * scene.step_s;
      if (world.crowd.population().counters().left == people) break;
    }
  }
  int through(size_t door) const { return by_door.contains(door) ? by_door.at(door) : 0; }
  uint64_t left() const { return world.crowd.population().counters().left; }

  SmallWorld world;
  std::map<size_t, int> by_door;
  int by_other_door = 0;  ///< through another door than the chosen one
  std::vector<int> changes;
  int apart = 0;  ///< times that an agent heads for another exit than the first of its group
  double seconds = 0;
};

class ExitChoice : public testing::TestWithParam<std::tuple<SteeringKind, Outside>> {
 protected:
  Scene scene(uint64_t seed, int people, const Rectangle& spawn,
              const std::vector<Opening>& doors) const {
    Scene out = hall(seed, people, spawn, doors, std::get<Outside>(GetParam()));
    out.steering.model = std::get<SteeringKind>(GetParam());
    return out;
  }
  Leaving leave(uint64_t seed, int people, const Rectangle& spawn,
                const std::vector<Opening>& doors) const {
    return {scene(seed, people, spawn, doors), doors};
  }
};

TEST_P(ExitChoice, TakesTheNearExitWithoutAQueue) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Leaving few = leave(seed, 6, kWesternHalf, kTwoDoors);
    EXPECT_EQ(few.through(0), 6);
    EXPECT_EQ(std::count(few.changes.begin(), few.changes.end(), 0), 6);
  }
}

TEST_P(ExitChoice, SendsAThirdToTheFarExitInACrowd) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Leaving many = leave(seed, 180, kWesternHalf, kTwoDoors);
    EXPECT_EQ(many.left(), many.world.crowd.size());
    EXPECT_GE(many.through(1), 60);
    EXPECT_GE(many.through(0), 60);
    EXPECT_LE(many.by_other_door, 4) << "they left by the near door while walking to the far one";
  }
}

TEST_P(ExitChoice, UsesEqualExitsEqually) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Leaving all = leave(seed, 160, {{4, 4}, {20, 11}}, kTwoDoors);
    EXPECT_EQ(all.left(), all.world.crowd.size());
    EXPECT_NEAR(all.through(0), 80, 16);
  }
}

TEST_P(ExitChoice, SendsMoreToAWiderExit) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Leaving all = leave(seed, 260, {{2, 2}, {22, 11.7}}, {{4, 0.8}, {20, 2.4}});
    EXPECT_EQ(all.left(), all.world.crowd.size());
    EXPECT_GT(all.through(1), 1.4 * all.through(0));
  }
}

TEST_P(ExitChoice, BalancesThreeExits) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Leaving all = leave(seed, 240, {{0.3, 1}, {10, 11.7}}, {{3, 1}, {12, 1}, {21, 1}});
    EXPECT_EQ(all.left(), all.world.crowd.size());
    for (size_t door = 0; door < 3; ++door) EXPECT_GE(all.through(door), 30) << door;
    // With only the near exit it takes at least twice as long.
    const Leaving one = leave(seed, 240, {{0.3, 1}, {10, 11.7}}, {{3, 1}});
    EXPECT_LT(all.seconds, 0.6 * one.seconds);
  }
}

TEST_P(ExitChoice, ChangesRarely) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Leaving many = leave(seed, 180, kWesternHalf, kTwoDoors);
    int sum = 0;
    for (const int each : many.changes) sum += each;
    EXPECT_LE(*std::max_element(many.changes.begin(), many.changes.end()), 3);
    EXPECT_LE(sum, 60) << "in a minute";
  }
}

TEST_P(ExitChoice, KeepsSocialGroupsTogether) {
  int changed = 0;
  for (const uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    Scene crowded = scene(seed, 160, kWesternHalf, kTwoDoors);
    crowded.groups[0].social_groups = {1, {1, 1, 1}};
    const Leaving leaving(crowded, kTwoDoors);
    const Journeys& journeys = leaving.world.crowd.journeys();
    int group_count = 0;
    for (uint32_t id = 0; id < leaving.changes.size(); ++id) {
      group_count += journeys.first_member(id) == id;
      changed += leaving.changes[id];
    }
    EXPECT_EQ(leaving.left(), 160u);
    EXPECT_GT(leaving.through(1), 40);
    EXPECT_GT(group_count, 40);
    EXPECT_EQ(leaving.apart, 0);
  }
  EXPECT_GT(changed, 0);  // they change their choice together
}

TEST_P(ExitChoice, IsIndependentOfThreadsAndCheckpoints) {
  const Scene scene = this->scene(4, 150, kWesternHalf, kTwoDoors);
  expect_same_walk(scene, 12 * kStepsPerSecond + 3, 15 * kStepsPerSecond + 3);
}

TEST_P(ExitChoice, SendsAThirdToADoorInTheOppositeWall) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = this->scene(seed, 160, {{0.3, 0.3}, {12, 8}}, {{4, 1}});
    scene.ground.max_m.y() = kDepth_m + 3.2;
    scene.obstacles.push_back(box(8.7, kDepth_m + 0.1, 17.4, 0.2));
    scene.obstacles.push_back(box(21.5, kDepth_m + 0.1, 5, 0.2));
    scene.groups[0].goals[0].areas.push_back({{1, kDepth_m + 2}, {kHall_m - 1, kDepth_m + 3}});
    SmallWorld world(scene, 2);
    ASSERT_EQ(world.map.exits().size(), 2u);
    for (int step = 0; step < 200 * kStepsPerSecond; ++step) world.crowd.step();
    EXPECT_EQ(world.crowd.population().counters().left, world.crowd.size());
    int north = 0;
    for (const Eigen::Vector2d& place : world.crowd.positions_m()) north += place.y() > kDepth_m;
    EXPECT_GE(3 * north, static_cast<int>(world.crowd.size()));
    EXPECT_LE(3 * north, 2 * static_cast<int>(world.crowd.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ExitChoice,
                         testing::Combine(testing::Values(SteeringKind::kOrca,
                                                          SteeringKind::kHeuristic),
                                          testing::Values(Outside::kAreas, Outside::kStrip)),
                         [](const auto& each) {
                           return std::string(name_of(std::get<SteeringKind>(each.param))) +
                                  (std::get<Outside>(each.param) == Outside::kAreas ? "_areas"
                                                                                    : "_strip");
                         });

TEST(Exits, NeedAtLeastTwoDoors) {
  for (const Outside outside : {Outside::kAreas, Outside::kStrip}) {
    SmallWorld world(hall(1, 5, kWesternHalf, {{4, 1}}, outside), 1);
    EXPECT_TRUE(world.map.exits().empty());
    world.crowd.step();
    for (uint32_t id = 0; id < 5; ++id)
      EXPECT_EQ(world.crowd.journeys().exit(id), Journeys::kNoExit);
  }
}

/// A ground of 24 m by 20 m with obstacles and a goal along its south.
std::vector<Exit> exits_among(std::vector<Obstacle> obstacles) {
  Scene scene;
  scene.ground = {{0, 0}, {kHall_m, 20}};
  scene.obstacles = std::move(obstacles);
  scene.groups = {group(1, {{1, 17}, {23, 19}}, {{{0, 0}, {kHall_m, 1}}})};
  return SmallWorld(scene, 1).map.exits();
}

TEST(Exits, AreDoorsBeforeAGoalButNotColumns) {
  // A wall from west to east at y, with doors.
  const auto wall = [](double y, const std::vector<Opening>& doors) {
    std::vector<Obstacle> out;
    double from = 0;
    for (const auto& [middle_m, width_m] : doors) {
      const double to = middle_m - 0.5 * width_m;
      out.push_back(box(0.5 * (from + to), y, to - from, 0.2));
      from = middle_m + 0.5 * width_m;
    }
    out.push_back(box(0.5 * (from + kHall_m), y, kHall_m - from, 0.2));
    return out;
  };
  EXPECT_TRUE(exits_among({}).empty());
  EXPECT_TRUE(
      exits_among({box(6, 5, 0.6, 0.6), box(12, 5, 0.8, 0.8), box(18, 5, 0.6, 0.6)}).empty());
  EXPECT_TRUE(exits_among({box(6, 5, 2.4, 0.6), box(18, 5, 2.4, 0.6)}).empty()) << "benches";
  EXPECT_TRUE(exits_among({box(12, 6, 5, 5)}).empty()) << "a fountain in the open";
  EXPECT_TRUE(exits_among(wall(3, {{12, 1}})).empty());
  EXPECT_TRUE(exits_among(wall(14, {{4, 1}, {20, 1}})).empty()) << "far from the goal";
  for (const double y : {1.5, 2.0, 3.3, 6.1, 9.0}) {
    SCOPED_TRACE(testing::Message() << "wall at " << y << " m");
    const std::vector<Exit> two = exits_among(wall(y, {{5, 1}, {17, 2}}));
    ASSERT_EQ(two.size(), 2u);
    EXPECT_NEAR(two[0].width_m, 1, 0.6);
    EXPECT_NEAR(two[1].width_m, 2, 0.8);
    EXPECT_EQ(exits_among(wall(y, {{3, 0.9}, {12, 1.2}, {21, 3}})).size(), 3u);
  }
}

TEST(Exits, AreDoorsAndAreasOfBundledScenes) {
  const std::map<std::string, size_t> expected = {
      {"evacuation", 6},
      {"concert", 2},
      {"metro", 2 + 4},
      {"museum", 32},  // doors of rooms
      {"station_hall", 2 + 3 + 3 + 2 + 2},
      {"station_platform", 2 + 8 + 8},
      {"ticket_office", 3}};  // to the trains, between barriers and walls
  for (const SceneEntry& entry : bundled_scenes()) {
    const Scene scene = load_scene(entry.name);
    Workers workers(2);
    const NavigationMap map(scene, workers);
    const auto known = expected.find(entry.name);
    EXPECT_EQ(map.exits().size(), known == expected.end() ? 0 : known->second) << entry.name;
  }
}

TEST(Exits, LeadThroughTheirDoors) {
  for (const Outside outside : {Outside::kAreas, Outside::kStrip}) {
    const SmallWorld world(hall(1, 1, kWesternHalf, kTwoDoors, outside), 1);
    ASSERT_EQ(world.map.exits().size(), 2u);
    for (uint64_t draw = 0; draw < 50; ++draw)
      for (size_t exit = 0; exit < 2; ++exit) {
        const RandomKey key{3, draw, 0, Purpose::kGoal};
        Eigen::Vector2d at(random_uniform(key, 1, kHall_m - 1, 0), random_uniform(key, 1, 11, 1));
        const FlowField& field = *world.map.exits()[exit].field;
        for (int step = 0; step < 600 && at.y() > -0.1; ++step) at += 0.1 * field.direction(at);
        EXPECT_NEAR(at.x(), kTwoDoors[exit].middle_m, 0.5) << "draw " << draw;
      }
  }
}

TEST(DistanceHistogram, CountsAgentsAhead) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    DistanceHistogram histogram;
    std::vector<float> distances_m;
    for (uint32_t i = 0; i < 300; ++i) {
      const RandomKey key{seed, i, 0, Purpose::kGoal};
      const auto distance_m = static_cast<float>(random_uniform(key, 0, i % 10 == 0 ? 900 : 60));
      distances_m.push_back(distance_m);
      histogram.add(distance_m, 1);
      if (i % 3 == 0) continue;
      histogram.add(distances_m[i / 2], -1);
      distances_m.erase(distances_m.begin() + static_cast<ptrdiff_t>(i / 2));
      distances_m.insert(distances_m.begin() + static_cast<ptrdiff_t>(i / 2), distance_m);
      histogram.add(distance_m, 1);
    }
    for (const float distance_m : {0.0f, 3.2f, 30.0f, 55.0f, 64.0f, 300.0f, 2000.0f}) {
      // Up to the bins' resolution: counts with the distance one bin shorter and one bin longer.
      const float bin_m = distance_m < 64 ? 0.5f : distance_m < 570 ? 4.0f : 2000.0f;
      const auto nearer = std::count_if(distances_m.begin(), distances_m.end(),
                                        [&](float each) { return each < distance_m - bin_m; });
      const auto not_farther =
          std::count_if(distances_m.begin(), distances_m.end(),
                        [&](float each) { return each <= distance_m + bin_m; });
      EXPECT_GE(histogram.ahead_of(distance_m), static_cast<double>(nearer)) << distance_m;
      EXPECT_LE(histogram.ahead_of(distance_m), static_cast<double>(not_farther)) << distance_m;
    }
  }
}

}  // namespace
}  // namespace throng::exits_test
