// Tests of population: each agent is outside, inside or gone; none is placed on another; each
// arrives or is reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "crowd/navigation/footprints.h"
#include "scenes/scenes.h"
#include "tests/crowd/crowd_world.h"

namespace throng::population_test {
namespace {

/// A room in the west, a door of 1 m, a room in the east. Agents start and enter in the west and
/// leave by one of two exits in the east.
Scene two_halls(uint64_t seed, int at_start, int later) {
  Scene scene;
  scene.name = "two rooms";
  scene.seed = seed;
  scene.step_s = 1.0 / 30;
  scene.ground = {{-8, -5}, {8, 5}};
  scene.obstacles = {box(0, -2.75, 0.2, 4.5), box(0, 2.75, 0.2, 4.5)};
  Group visitors = group(at_start, {{-7, -4.5}, {-2, 4.5}}, {});
  visitors.name = "visitors";
  Goal exits;
  exits.areas = {{{7, -4.5}, {7.9, -2}}, {{7, 2}, {7.9, 4.5}}};
  visitors.goals = {exits};
  visitors.sources = {{{{-7.9, -4.5}, {-7, 4.5}}, later, 2, 1, seed % 2 == 1}};
  visitors.on_arrival = OnArrival::kLeave;
  scene.groups = {visitors};
  return scene;
}

uint64_t sum(const PopulationCounters& counters) {
  return counters.entered + counters.waiting_to_enter + counters.scheduled;
}

TEST(Population, CountsEachAgentOnceThroughADoor) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallWorld world(two_halls(seed, 20, 30), 2);
    const PopulationCounters& now = world.crowd.population().counters();
    ASSERT_EQ(world.crowd.size(), 50u);
    uint64_t entered = now.entered;
    for (int step = 0; step < 30 * 90; ++step) {
      world.crowd.step();
      ASSERT_EQ(sum(now), 50u) << "step " << step;
      ASSERT_EQ(now.entered, now.present + now.left) << "step " << step;
      ASSERT_GE(now.entered, entered) << "step " << step;
      entered = now.entered;
      const auto present = world.crowd.population().present();
      ASSERT_EQ(static_cast<uint64_t>(std::count(present.begin(), present.end(), 1)), now.present);
    }
    EXPECT_EQ(now.left, 50u) << now.present << " are still inside, " << now.waiting_to_enter
                             << " wait";
  }
}

/// Speed of each agent of the source in the step in which it enters.
std::vector<double> entering_speeds_mps(const Scene& scene) {
  SmallWorld world(scene, 1);
  std::vector<uint8_t> known(world.crowd.population().present().begin(),
                             world.crowd.population().present().end());
  std::vector<double> out;
  for (int step = 0; step < 300; ++step) {
    world.crowd.step();
    for (uint32_t id = 0; id < world.crowd.size(); ++id) {
      if (known[id] != 0 || world.crowd.population().present()[id] == 0) continue;
      known[id] = 1;
      out.push_back(world.crowd.velocities_mps()[id].norm());
    }
  }
  return out;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

TEST(Population, AdmitsAgentsAtTheSpeedTheyHaveOrOthersAllow) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = two_halls(seed, 0, 10);
    scene.obstacles.clear();
    scene.groups[0].sources[0].area = {{-7.9, -0.5}, {-7.6, 0.5}};
    const std::vector<double> free_mps = entering_speeds_mps(scene);
    ASSERT_EQ(free_mps.size(), 10u);
    EXPECT_GT(mean_of(free_mps), 1);

    scene.groups[0].sources[0].enters_mps = 0.4;
    EXPECT_NEAR(mean_of(entering_speeds_mps(scene)), 0.4, 0.1);
    scene.groups[0].sources[0].enters_mps.reset();

    // Agents that stand at most a metre before the source.
    Group standing = group(12, {{-7.2, -1}, {-6.7, 1}}, {{{-7.2, -1}, {-6.7, 1}}});
    standing.name = "standing";
    standing.on_arrival = OnArrival::kStay;
    standing.premovement_s = {1000, 0, 1000, 1000};
    scene.groups.push_back(standing);
    const std::vector<double> behind_mps = entering_speeds_mps(scene);
    ASSERT_GT(behind_mps.size(), 0u);
    EXPECT_LT(mean_of(behind_mps), 0.6);
  }
}

TEST(Population, KeepsNarrowDiscsOutOfWalls) {
  Scene scene = two_halls(3, 40, 40);
  scene.obstacles.push_back(box(-5, 0, 2.5, 8, 0.3));
  scene.groups[0].radius_m = 0.05;
  scene.groups[0].sources[0].rate_per_s = 50;
  scene.groups[0].sources[0].area = scene.groups[0].spawn;
  SmallWorld world(scene, 1);
  ASSERT_GT(world.spawned.people.size(), 60u);
  const auto clearance_m = [&](uint32_t id) {
    return world.map.walkable().clearance_m(world.crowd.positions_m()[id]);
  };
  std::vector<uint8_t> known(world.crowd.size());
  int entered = 0;
  for (int step = 0; step < 90; ++step) {
    for (uint32_t id = 0; id < world.crowd.size(); ++id) {
      if (known[id] != 0 || world.crowd.population().present()[id] == 0) continue;
      known[id] = 1;
      ++entered;
      // Allows a centimetre walked since entry.
      EXPECT_GT(clearance_m(id), 0.125 * world.spawned.people[id].height_m / 1.7 - 0.06);
    }
    world.crowd.step();
  }
  EXPECT_GT(entered, 60);
}

TEST(Population, AdmitsIntoFreeSpaceOnly) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = two_halls(seed, 30, 150);
    scene.groups[0].sources[0].rate_per_s = 100;  // more than the room takes
    SmallWorld world(scene, 1);
    const Crowd& crowd = world.crowd;
    uint64_t max_waiting = 0, entries = 0;
    for (int step = 0; step < 30 * 20; ++step) {
      const std::vector<uint8_t> was(crowd.population().present().begin(),
                                     crowd.population().present().end());
      const std::vector<Eigen::Vector2d> before(crowd.positions_m().begin(),
                                                crowd.positions_m().end());
      world.crowd.step();
      max_waiting = std::max(max_waiting, crowd.population().counters().waiting_to_enter);
      for (uint32_t id = 0; id < crowd.size(); ++id) {
        if (crowd.population().present()[id] == 0) continue;
        const Eigen::Vector2d& place = crowd.positions_m()[id];
        ASSERT_GE(world.map.walkable().clearance_m(place), 0) << "person " << id;
        if (was[id] != 0) {
          ASSERT_FALSE(world.map.walkable().crosses(before[id], place)) << "person " << id;
          continue;
        }
        ++entries;
        for (uint32_t other = 0; other < crowd.size(); ++other) {
          if (other == id || crowd.population().present()[other] == 0) continue;
          // Placed clear of others, then all have made one step.
          const double apart_m = (crowd.positions_m()[other] - place).norm();
          ASSERT_GT(apart_m, 0.2) << id << " entered on " << other << ", step " << step;
        }
      }
    }
    EXPECT_GT(max_waiting, 5u) << "the entrance was never full";
    EXPECT_GT(entries, 10u);
  }
}

TEST(Population, IsIndependentOfThreads) {
  std::vector<Eigen::Vector2d> expected;
  for (const int threads : {1, 2, 5}) {
    SmallWorld world(two_halls(3, 60, 200), threads);
    for (int step = 0; step < 600; ++step) world.crowd.step();
    const std::vector<Eigen::Vector2d> found(world.crowd.positions_m().begin(),
                                             world.crowd.positions_m().end());
    if (threads == 1) expected = found;
    EXPECT_EQ(found, expected) << threads << " threads, seed 3";
  }
}

TEST(Population, EmitsAtTheRateOfSources) {
  for (const bool random : {false, true}) {
    Scene scene = two_halls(2, 0, 400);
    scene.groups[0].sources[0].is_poisson = random;
    scene.groups[0].sources[0].rate_per_s = 4;
    SmallWorld world(scene, 1);
    double last_s = 0;
    for (const AgentSpec& person : world.spawned.people) {
      EXPECT_GE(person.enters_s, last_s) << "ids of a source come in order";
      last_s = person.enters_s;
    }
    // 400 exponential gaps of 0.25 s: 100 s with a standard deviation of 5 s.
    EXPECT_NEAR(last_s, 1 + 400 / 4.0, random ? 20 : 0.26);
  }
}

TEST(Population, HoldsAgentsForTheirPremovementTime) {
  Scene scene = two_halls(1, 1, 0);
  scene.groups[0].sources.clear();
  for (const double premovement_s : {0.0, 3.0, 10.0}) {
    scene.groups[0].premovement_s = {premovement_s, 0, premovement_s, premovement_s};
    SmallWorld world(scene, 1);
    const Eigen::Vector2d start = world.crowd.positions_m()[0];
    double moved_s = -1;
    for (int step = 1; step < 600 && moved_s < 0; ++step) {
      world.crowd.step();
      if ((world.crowd.positions_m()[0] - start).norm() > 0.05) moved_s = step * scene.step_s;
    }
    EXPECT_GE(moved_s, premovement_s);
    EXPECT_LE(moved_s, premovement_s + 0.6) << "a decision and the time to pick up speed";
  }
}

TEST(Journeys, PassWaypointsWaitAtGoalsAndStayAtTheLast) {
  Scene scene;
  scene.step_s = 1.0 / 30;
  scene.ground = {{0, 0}, {30, 6}};
  Group walker =
      group(1, {{1, 2}, {2, 4}}, {{{8, 1}, {9, 5}}, {{15, 1}, {18, 5}}, {{24, 1}, {28, 5}}});
  walker.goals[0].waypoint = true;
  walker.goals[1].wait_s = {5, 0, 5, 5};
  walker.on_arrival = OnArrival::kStay;
  scene.groups = {walker};
  SmallWorld world(scene, 1);
  double waited_s = 0, passed_mps = 0;
  for (int step = 0; step < 30 * 60; ++step) {
    world.crowd.step();
    const double x = world.crowd.positions_m()[0].x();
    const double speed = world.crowd.velocities_mps()[0].norm();
    if (x > 8 && x < 9) passed_mps = std::max(passed_mps, speed);
    if (world.crowd.journeys().state(0) == JourneyState::kWaiting) {
      waited_s += scene.step_s;
      EXPECT_GT(x, 15);
      EXPECT_LT(x, 18) << "carried out of the goal while slowing down";
    }
  }
  EXPECT_GT(passed_mps, 0.5) << "a waypoint is passed without stopping";
  EXPECT_NEAR(waited_s, 5, 0.15) << "at the second goal, to a decision";
  EXPECT_EQ(world.crowd.journeys().state(0), JourneyState::kStaying);
  EXPECT_GT(world.crowd.positions_m()[0].x(), 24);
  EXPECT_LT(world.crowd.velocities_mps()[0].norm(), 0.05);
}

TEST(Journeys, ReportStrandedAgentsWithPlaceAndCause) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 10}};
  // A closed cell around the second goal.
  scene.obstacles = {box(15, 3, 4.2, 0.2), box(15, 7, 4.2, 0.2), box(13, 5, 0.2, 4.2),
                     box(17, 5, 0.2, 4.2)};
  const char* names[] = {"south", "north", "west", "east"};
  for (int i = 0; i < 4; ++i) scene.obstacles[static_cast<size_t>(i)].name = names[i];
  scene.groups = {group(3, {{1, 1}, {3, 9}}, {{{8, 4}, {9, 6}}, {{14, 4}, {16, 6}}})};
  scene.groups[0].name = "lost";
  SmallWorld world(scene, 1);
  ASSERT_EQ(world.crowd.size(), 3u);
  EXPECT_TRUE(world.crowd.journeys().strandings(world.crowd.positions_m()).empty())
      << "they can reach the first goal";
  for (int step = 0; step < 60 * 30; ++step) world.crowd.step();
  const auto strandings = world.crowd.journeys().strandings(world.crowd.positions_m());
  ASSERT_EQ(strandings.size(), 1u);
  EXPECT_EQ(strandings[0].people, 3);
  EXPECT_EQ(strandings[0].stop, 1u);
  EXPECT_THAT(describe(strandings[0], scene),
              testing::MatchesRegex("group 'lost': 3 people cannot reach goal 2 from .* m; the "
                                    "path ends at .* m at '(west|south|north)'"));
}

TEST(Journeys, CountQueuingAgentsAsNotStalled) {
  SmallWorld world(two_halls(4, 60, 0), 2);
  uint64_t queuing = 0;
  double stall_s = 0;
  for (int step = 0; step < 30 * 60; ++step) {
    world.crowd.step();
    queuing = std::max(queuing, world.crowd.counters().queuing);
    stall_s = std::max(stall_s, world.crowd.counters().longest_stall_s);
  }
  EXPECT_GT(queuing, 15u) << "sixty people at a door of 1 m";
  EXPECT_LT(stall_s, 15) << "only agents in front can stall";
  EXPECT_EQ(world.crowd.population().counters().left, 60u);
}

TEST(Simulation, EndsPairsOfLeavingAgentsAndKeepsIds) {
  Scene scene = load_scene("bottleneck");
  scene.groups[0].count = 60;
  scene.duration_s = 45;
  scene.step_s = 1.0 / 30;
  Simulation simulation(scene, {.threads = 2});
  std::vector<uint64_t> open;
  uint64_t absent = 0;
  for (int frame = 0; frame < 30 * 45; ++frame) {
    const Frame& now = simulation.step();
    ASSERT_EQ(now.present.size(), 60u);
    ASSERT_EQ(now.roots.size(), 60u);
    for (const PairKey& pair : now.pairs) {
      if (pair.a() < 60) {
        ASSERT_EQ(now.present[pair.a()], 1) << "frame " << frame;
      }
      if (pair.b() < 60) {
        ASSERT_EQ(now.present[pair.b()], 1) << "frame " << frame;
      }
    }
    for (const PairEvent& event : now.events) {
      const auto at = std::find(open.begin(), open.end(), event.pair.bits());
      ASSERT_EQ(at == open.end(), event.kind == EventKind::kBegin);
      if (at == open.end())
        open.push_back(event.pair.bits());
      else
        open.erase(at);
    }
    ASSERT_EQ(open.size(), now.pairs.size());
    absent = static_cast<uint64_t>(std::count(now.present.begin(), now.present.end(), 0));
  }
  EXPECT_EQ(absent, simulation.population().left);
  EXPECT_GT(absent, 20u);
  const RunEnd end = simulation.finish();
  EXPECT_EQ(end.begins, end.ends);
}

}  // namespace
}  // namespace throng::population_test
