// Bundled scenes keep general and documented properties.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "scenes/scenes.h"
#include "tests/crowd/crowd_world.h"

namespace throng::bundled_test {
namespace {

class BundledScene : public testing::TestWithParam<const char*> {};

TEST_P(BundledScene, KeepsAgentsPlacedMovingAndOffWalls) {
  Scene scene = load_scene(GetParam());
  SmallWorld world(scene, 2);
  const Crowd& crowd = world.crowd;
  const std::vector<int>& unplaced = world.spawned.unplaced;
  EXPECT_EQ(std::accumulate(unplaced.begin(), unplaced.end(), 0), 0);
  int64_t total = 0;
  for (const Group& group : scene.groups) total += group.total();
  ASSERT_EQ(static_cast<int64_t>(crowd.size()), total);
  EXPECT_TRUE(world.map.nav_mesh().is_built());
  EXPECT_TRUE(crowd.journeys().strandings(crowd.positions_m()).empty());
  const int steps = static_cast<int>(4 / scene.step_s);
  std::vector<Eigen::Vector2d> before;
  for (int step = 0; step < steps; ++step) {
    before.assign(crowd.positions_m().begin(), crowd.positions_m().end());
    const std::vector<uint8_t> was(crowd.population().present().begin(),
                                   crowd.population().present().end());
    world.crowd.step();
    for (uint32_t id = 0; id < crowd.size(); ++id) {
      if (was[id] == 0 || crowd.population().present()[id] == 0) continue;
      ASSERT_GE(world.map.walkable().clearance_m(crowd.positions_m()[id]), 0) << "person " << id;
      ASSERT_FALSE(world.map.walkable().crosses(before[id], crowd.positions_m()[id]))
          << "person " << id << ", step " << step;
    }
    const PopulationCounters& now = crowd.population().counters();
    ASSERT_EQ(static_cast<int64_t>(now.entered + now.waiting_to_enter + now.scheduled), total);
    ASSERT_EQ(now.entered, now.present + now.left);
  }
  EXPECT_TRUE(crowd.journeys().strandings(crowd.positions_m()).empty());
}

INSTANTIATE_TEST_SUITE_P(All, BundledScene,
                         testing::Values("plaza", "corridor", "crossing", "bottleneck",
                                         "evacuation", "metro", "concert", "ticket_office",
                                         "station_platform", "stadium_exit", "ring",
                                         "robot_in_crowd"),
                         [](const auto& each) { return std::string(each.param); });

TEST(BundledScenes, PlaceAllAgents) {
  for (const char* name : {"rush_hour", "city_square"}) {
    const Scene scene = load_scene(name);
    Workers workers(2);
    const NavigationMap map(scene, workers);
    const SpawnResult spawned = spawn(scene, map);
    int64_t total = 0;
    for (const Group& group : scene.groups) total += group.total();
    EXPECT_EQ(static_cast<int64_t>(spawned.people.size()), total) << name;
  }
}

TEST(BundledScenes, MetroLetsPassengersOffThenOn) {
  for (const SteeringKind model : {SteeringKind::kOrca, SteeringKind::kHeuristic})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(testing::Message() << name_of(model) << ", seed " << seed);
      Scene scene = load_scene("metro");
      scene.seed = seed;
      scene.steering.model = model;
      SmallWorld world(scene, 2);
      for (int step = 0; step < 60 * 60; ++step) world.crowd.step();
      for (const DoorState door : world.map.doors()) EXPECT_EQ(door, DoorState::kShut);
      int off = 0, on = 0, late_in = 0, late_on_platform = 0;
      for (uint32_t id = 0; id < world.crowd.size(); ++id) {
        if (world.crowd.journeys().state(id) == JourneyState::kOutside) continue;
        const std::string& name = scene.groups[world.spawned.people[id].group].name;
        const bool is_in = world.crowd.positions_m()[id].y() > 2;
        off += name.starts_with("off") && world.crowd.journeys().state(id) == JourneyState::kGone;
        on += name.starts_with("on") && is_in;
        late_in += name == "late" && is_in;
        late_on_platform += name == "late" && !is_in;
      }
      EXPECT_EQ(off, 60);
      EXPECT_EQ(on, 48);
      EXPECT_EQ(late_in, 0);
      EXPECT_GE(late_on_platform, 15);
    }
}

TEST(BundledScenes, TicketOfficeKeepsLinesAndCapacity) {
  for (const SteeringKind model : {SteeringKind::kOrca, SteeringKind::kHeuristic}) {
    int in_line = 0, in_place = 0;
    for (uint64_t seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(testing::Message() << name_of(model) << ", seed " << seed);
      Scene scene = load_scene("ticket_office");
      scene.seed = seed;
      scene.steering.model = model;
      SmallWorld world(scene, 2);
      const Crowd& crowd = world.crowd;
      const QueuePlan& plan = world.map.queues()[0].plan;
      const Rectangle& bakery = world.map.queues()[1].plan.areas[0].bounds();
      int max_inside = 0;
      std::vector<uint8_t> was_in(crowd.size(), 0), was_out(crowd.size(), 0);
      for (int step = 0; step < 300 * 60; ++step) {
        world.crowd.step();
        int inside = 0;
        for (uint32_t id = 0; id < crowd.size(); ++id) {
          const bool is_in =
              crowd.journeys().is_present(id) && bakery.contains(crowd.positions_m()[id]);
          // Customers who have left may be pushed back across the threshold for a moment.
          was_out[id] |= was_in[id] != 0 && !is_in;
          was_in[id] |= is_in;
          inside += is_in && was_out[id] == 0;
        }
        max_inside = std::max(max_inside, inside);
        const std::span<const uint32_t> line = crowd.queues().waiting(0);
        for (size_t place = 0; place < line.size(); ++place) {
          const Eigen::Vector2d own_m = plan.line.at(plan.along_m(place));
          ++in_line;
          in_place += (crowd.positions_m()[line[place]] - own_m).norm() < 2 * plan.spacing_m;
        }
      }
      EXPECT_EQ(max_inside, 4);
      EXPECT_EQ(crowd.population().counters().left, crowd.size())
          << "some customers were not served";
    }
    EXPECT_GT(in_line, 12 * 100 * 60) << "no queues";
    fmt::print(
        "ticket_office {}: {:.0f} % of {:.0f} s in line within two spacings of their place\n",
        name_of(model), 100.0 * in_place / in_line, in_line / 60.0);
    EXPECT_GT(in_place, 0.9 * in_line);
  }
}

TEST(BundledScenes, ConcertAudienceFacesTheStageThenLeaves) {
  for (const SteeringKind model : {SteeringKind::kOrca, SteeringKind::kHeuristic}) {
    SCOPED_TRACE(name_of(model));
    Scene scene = load_scene("concert");
    scene.steering.model = model;
    SmallWorld world(scene, 2);
    for (int step = 0; step < 9 * 30; ++step) world.crowd.step();
    size_t face = 0;
    for (uint32_t id = 0; id < world.crowd.size(); ++id) {
      const Eigen::Vector2d way = *scene.groups[0].look_at_m - world.crowd.positions_m()[id];
      face += world.crowd.headings()[id].dot(way.normalized()) > 0.9397;
    }
    EXPECT_GE(static_cast<double>(face), 0.95 * static_cast<double>(world.crowd.size()));
    int steps = 9 * 30;
    while (world.crowd.population().counters().present > 0 && steps < 30 * 300) {
      world.crowd.step();
      ++steps;
    }
    std::printf("%s: the last of %zu leaves after %d s\n", std::string(name_of(model)).c_str(),
                world.crowd.size(), steps / 30);
    EXPECT_EQ(world.crowd.population().counters().present, 0u);
  }
}

TEST(BundledScenes, EvacuationEmptiesTheHall) {
  SmallWorld world(load_scene("evacuation"), 2);
  int steps = 0;
  while (world.crowd.population().counters().present > 0 && steps < 30 * 120) {
    world.crowd.step();
    ++steps;
  }
  EXPECT_EQ(world.crowd.population().counters().left, 1000u) << "after " << steps / 30 << " s";
}

}  // namespace
}  // namespace throng::bundled_test
