// Tests of dense placement: all bodies placed, without overlap, lattice or jerks at the start.
#include "crowd/dense_placement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scenes/file/density.h"
#include "tests/crowd/crowd_world.h"

namespace throng::dense_placement_test {
namespace {

/// A crowd of a density on 6 m x 6 m in the middle of a hall that faces north and stays.
Scene close(double per_m2, uint64_t seed, SteeringKind model = SteeringKind::kOrca) {
  Scene scene;
  scene.seed = seed;
  scene.steering.model = model;
  scene.ground = {{-10, -10}, {10, 14}};
  scene.groups = {group(0, {{-3, -3}, {3, 3}}, {{{-9, -9.5}, {9, -8}}})};
  scene.groups[0].density_per_m2 = per_m2;
  scene.groups[0].look_at_m = Eigen::Vector2d(0, 13);
  scene.groups[0].premovement_s = {3, 0, 3, 3};
  scene.groups[0].count = static_cast<int>(count_by_density(scene, scene.groups[0]));
  return scene;
}

std::vector<StandingBody> bodies_of(const SpawnResult& spawned) {
  std::vector<StandingBody> bodies;
  for (const AgentSpec& person : spawned.people)
    bodies.push_back({person.position_m, person.heading, person.height_m / 1.70});
  return bodies;
}

TEST(DensePlacement, PlacesAllBodiesWithoutOverlap) {
  for (const double per_m2 : {0.5, 2.0, 4.0, 6.0})
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(testing::Message() << per_m2 << " per m2, seed " << seed);
      SmallWorld world(close(per_m2, seed), 1);
      const std::vector<StandingBody> bodies = bodies_of(world.spawned);
      EXPECT_EQ(bodies.size(), static_cast<size_t>(std::lround(36 * per_m2)));
      EXPECT_EQ(world.spawned.unplaced[0], 0);
      for (const StandingBody& body : bodies)
        EXPECT_TRUE(world.scene.groups[0].spawn.contains(body.place_m));
      EXPECT_LT(max_overlap_m(bodies), 0.01);
    }
}

/// In a lattice the nearest neighbours lie in few directions and at few distances.
TEST(DensePlacement, ShowsNoLattice) {
  for (const double per_m2 : {1.0, 4.0, 6.0})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(testing::Message() << per_m2 << " per m2, seed " << seed);
      Scene scene = close(per_m2, seed);
      scene.groups[0].spawn = {{-9, -7}, {9, 12}};
      scene.groups[0].count = static_cast<int>(count_by_density(scene, scene.groups[0]));
      SmallWorld world(scene, 1);
      std::vector<double> sectors(12);
      for (const AgentSpec& person : world.spawned.people) {
        const AgentSpec* next = nullptr;
        for (const AgentSpec& other : world.spawned.people)
          if (&other != &person &&
              (next == nullptr || (other.position_m - person.position_m).norm() <
                                      (next->position_m - person.position_m).norm()))
            next = &other;
        // Touching bodies have their nearest ahead or behind; in units of the body directions are
        // even.
        const Eigen::Vector2d offset = next->position_m - person.position_m;
        const double angle = std::atan2(offset.y() / 0.15, offset.x() / 0.26);
        sectors[static_cast<size_t>(std::floor((angle / (2 * M_PI) + 1) * 12)) % 12] += 1;
      }
      const auto people = static_cast<double>(world.spawned.people.size());
      const double max = *std::max_element(sectors.begin(), sectors.end());
      std::printf("%.0f per m2: the fullest of 12 directions has %.0f %% of next neighbours\n",
                  per_m2, 100 * max / people);
      EXPECT_LT(max / people, 0.25) << "a lattice has half of them in one direction";
    }
}

TEST(DensePlacement, DependsOnTheSeed) {
  const auto places = [](uint64_t seed) {
    SmallWorld world(close(6, seed), 1);
    std::vector<Eigen::Vector2d> all;
    for (const AgentSpec& person : world.spawned.people) all.push_back(person.position_m);
    return all;
  };
  EXPECT_EQ(places(3), places(3));
  EXPECT_NE(places(3), places(4));
}

TEST(DensePlacement, KeepsClearanceAndCountsFreeGroundOnly) {
  Scene scene = close(5, 1);
  scene.obstacles = {box(0, 0, 3, 1), box(-3, 1, 0.3, 4)};
  scene.groups.insert(scene.groups.begin(), group(6, {{-3, -3}, {3, 3}}, {{{-9, -9}, {9, -8}}}));
  const double area_m2 = standing_area_m2(scene, scene.groups[1].spawn);
  // A margin of 0.22 m around both boxes, with round corners: computed by hand.
  EXPECT_NEAR(area_m2, 36 - (3.44 * 1.44 - 0.042) - (0.37 * 4.22 - 0.01), 0.05);
  scene.groups[1].count = static_cast<int>(count_by_density(scene, scene.groups[1]));
  EXPECT_EQ(scene.groups[1].count, static_cast<int>(std::lround(5 * area_m2)));
  SmallWorld world(scene, 1);
  for (size_t i = 0; i < world.spawned.people.size(); ++i) {
    const AgentSpec& person = world.spawned.people[i];
    EXPECT_GE(world.map.walkable().clearance_m(person.position_m), 0.2) << "person " << i;
    for (size_t k = 0; k < 6 && i >= 6; ++k)
      EXPECT_GE((person.position_m - world.spawned.people[k].position_m).norm(), 0.35)
          << "agent " << i << " on " << k;
  }
}

/// No body may be rejected for standing at a wall of a full room.
TEST(DensePlacement, FillsARoomToItsWalls) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = close(1.9, seed);
    scene.obstacles = {box(-3.1, 0, 0.2, 6), box(3.1, 0, 0.2, 6), box(0, 3.1, 6, 0.2)};
    SmallWorld world(scene, 1);
    EXPECT_EQ(world.spawned.unplaced[0], 0);
    EXPECT_EQ(world.spawned.people.size(), static_cast<size_t>(scene.groups[0].count));
    for (const AgentSpec& person : world.spawned.people)
      EXPECT_GT(world.map.walkable().clearance_m(person.position_m), 0.2);
  }
}

/// Steering discs overlap widely at first: no agent may jump, standing or setting out.
TEST(DensePlacement, StartsWithoutJerks) {
  for (const SteeringKind model : all_steering_kinds())
    for (const double per_m2 : {4.0, 6.0}) {
      SCOPED_TRACE(testing::Message() << name_of(model) << ", " << per_m2 << " per m2, seed 2");
      SmallWorld world(close(per_m2, 2, model), 2);
      const Crowd& crowd = world.crowd;
      // Acceleration over a tenth of a second, while all stand and in the six seconds after.
      std::vector<double> standing_mps2, walking_mps2;
      double farthest_m = 0;
      std::vector<Eigen::Vector2d> before(crowd.size(), Eigen::Vector2d::Zero());
      std::vector<Eigen::Vector2d> last(crowd.positions_m().begin(), crowd.positions_m().end());
      for (int tenth = 0; tenth < 90; ++tenth) {
        for (int step = 0; step < 6; ++step) world.crowd.step();
        for (uint32_t id = 0; id < crowd.size(); ++id) {
          const Eigen::Vector2d now = (crowd.positions_m()[id] - last[id]) / 0.1;
          (tenth < 29 ? standing_mps2 : walking_mps2).push_back((now - before[id]).norm() / 0.1);
          before[id] = now;
          last[id] = crowd.positions_m()[id];
          if (tenth == 28)
            farthest_m =
                std::max(farthest_m, (last[id] - world.spawned.people[id].position_m).norm());
        }
      }
      const auto of_999 = [](std::vector<double>& values) {
        std::sort(values.begin(), values.end());
        return values[values.size() * 999 / 1000];
      };
      const double standing = of_999(standing_mps2), walking = of_999(walking_mps2);
      std::printf(
          "%s at %.0f per m2: 99.9 %% below %.2f m/s2 standing (%.2f m), %.1f setting out\n",
          std::string(name_of(model)).c_str(), per_m2, standing, farthest_m, walking);
      EXPECT_LT(standing, 1);
      EXPECT_LT(farthest_m, 0.1);
      // The collision-free speed model changes velocities at once in any case.
      if (model == SteeringKind::kOrca) {
        EXPECT_LT(walking, 7);
      } else if (model == SteeringKind::kHeuristic) {
        EXPECT_LT(walking, 4);
      }
    }
}

TEST(DensePlacement, KeepsStandingAgentsClose) {
  for (const SteeringKind model : all_steering_kinds()) {
    Scene scene = close(6, 4, model);
    scene.groups[0].premovement_s = {100, 0, 100, 100};
    SmallWorld world(scene, 1);
    for (int step = 0; step < 60 * 60; ++step) world.crowd.step();
    double farthest_m = 0;
    for (uint32_t id = 0; id < world.crowd.size(); ++id)
      farthest_m = std::max(
          farthest_m, (world.crowd.positions_m()[id] - world.spawned.people[id].position_m).norm());
    EXPECT_LT(farthest_m, 0.1) << name_of(model) << ", seed 4, after a minute";
  }
}

TEST(DensePlacement, GrowsDiscsWhereThereIsRoom) {
  SmallWorld world(close(6, 1), 1);
  for (int step = 0; step < 60 * 40; ++step) world.crowd.step();
  // They walk in the south by now: discs are apart.
  const Crowd& crowd = world.crowd;
  EXPECT_LT(crowd.counters().max_overlap_m, 0.05);
  int close_pairs = 0;
  for (uint32_t a = 0; a < crowd.size(); ++a)
    for (uint32_t b = a + 1; b < crowd.size(); ++b)
      close_pairs += (crowd.positions_m()[a] - crowd.positions_m()[b]).norm() < 0.35;
  EXPECT_LT(close_pairs, 20);
}

}  // namespace
}  // namespace throng::dense_placement_test
