// The bundled scenes keep what every scene promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "scenes/scenes.h"
#include "tests/scenes/crowd_world.h"

namespace throng {
namespace {

class BundledScene : public testing::TestWithParam<const char*> {};

TEST_P(BundledScene, KeepsEverybodyOffWallsPlacedAndOnTheWay) {
  Scene scene = load_scene(GetParam());
  SmallWorld world(scene, 2);
  const Crowd& crowd = world.crowd;
  const std::vector<int>& unplaced = world.spawned.unplaced;
  EXPECT_EQ(std::accumulate(unplaced.begin(), unplaced.end(), 0), 0);
  int64_t total = 0;
  for (const Group& group : scene.groups) total += group.total();
  ASSERT_EQ(static_cast<int64_t>(crowd.size()), total);
  EXPECT_TRUE(world.ways.nav_mesh().is_built());
  EXPECT_TRUE(crowd.journeys().strandings(crowd.positions_m()).empty());
  const int steps = static_cast<int>(4 / scene.step_s);
  std::vector<Eigen::Vector2d> before;
  for (int step = 0; step < steps; ++step) {
    before.assign(crowd.positions_m().begin(), crowd.positions_m().end());
    const std::vector<uint8_t> was(crowd.traffic().present().begin(),
                                   crowd.traffic().present().end());
    world.crowd.step();
    for (uint32_t id = 0; id < crowd.size(); ++id) {
      if (was[id] == 0 || crowd.traffic().present()[id] == 0) continue;
      ASSERT_GE(world.ways.walkable().clearance_m(crowd.positions_m()[id]), 0) << "person " << id;
      ASSERT_FALSE(world.ways.walkable().crosses(before[id], crowd.positions_m()[id]))
          << "person " << id << ", step " << step;
    }
    const TrafficCounters& now = crowd.traffic().counters();
    ASSERT_EQ(static_cast<int64_t>(now.entered + now.waiting + now.to_come), total);
    ASSERT_EQ(now.entered, now.present + now.left);
  }
  EXPECT_TRUE(crowd.journeys().strandings(crowd.positions_m()).empty());
}

INSTANTIATE_TEST_SUITE_P(All, BundledScene,
                         testing::Values("plaza", "corridor", "crossing", "bottleneck",
                                         "evacuation", "station_platform", "stadium_exit", "ring",
                                         "robot_in_crowd"),
                         [](const auto& each) { return std::string(each.param); });

TEST(BundledScenes, LargeOnesPlaceEverybody) {
  for (const char* name : {"rush_hour", "city_square"}) {
    const Scene scene = load_scene(name);
    Workers workers(2);
    const Ways ways(scene, workers);
    const Spawned spawned = spawn(scene, ways);
    int64_t total = 0;
    for (const Group& group : scene.groups) total += group.total();
    EXPECT_EQ(static_cast<int64_t>(spawned.people.size()), total) << name;
  }
}

TEST(BundledScenes, EvacuationEmptiesTheHall) {
  SmallWorld world(load_scene("evacuation"), 2);
  int steps = 0;
  while (world.crowd.traffic().counters().present > 0 && steps < 30 * 120) {
    world.crowd.step();
    ++steps;
  }
  EXPECT_EQ(world.crowd.traffic().counters().left, 1000u) << "after " << steps / 30 << " s";
}

}  // namespace
}  // namespace throng
