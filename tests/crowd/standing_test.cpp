// Tests of standing people: they face what they wait for, turn in steps, breathe and shift weight.
#include "avatars/stepping/standing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "avatars/gait/gait.h"
#include "base/portable_math.h"
#include "scenes/run/posing.h"
#include "scenes/run/simulation.h"
#include "tests/crowd/crowd_world.h"
#include "tests/scenes/person_pairs.h"

namespace throng::standing_test {
namespace {

double angle_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
}

/// Turn rates and facing of agents that stand or creep in a queue.
struct Queue {
  std::vector<double> turns_degps;
  double turned_rad = 0, standing_time_s = 0;
  int off = 0, faced = 0;

  void watch(const SmallWorld& world, const std::vector<Eigen::Vector2d>& before) {
    const Crowd& crowd = world.crowd;
    for (uint32_t id = 0; id < crowd.size(); ++id) {
      if (crowd.journeys().state(id) != JourneyState::kWalking) continue;
      if (crowd.velocities_mps()[id].norm() >= 0.2) continue;
      const double turn = std::abs(angle_between(before[id], crowd.headings()[id]));
      turns_degps.push_back(turn / kDegree / world.scene.step_s);
      turned_rad += turn;
      standing_time_s += world.scene.step_s;
      const Eigen::Vector2d direction = crowd.journeys().direction(id, crowd.positions_m()[id]);
      off += std::abs(angle_between(crowd.headings()[id], direction)) > 45 * kDegree;
      ++faced;
    }
  }
};

TEST(StandingPeople, FaceAheadAndTurnSlowlyInQueues) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    Scene scene = load_scene("bottleneck");
    scene.seed = seed;
    SmallWorld world(scene, 2);
    Queue queue;
    for (int step = 0; step < 30 * 60; ++step) {
      const std::vector<Eigen::Vector2d> before(world.crowd.headings().begin(),
                                                world.crowd.headings().end());
      world.crowd.step();
      queue.watch(world, before);
    }
    std::sort(queue.turns_degps.begin(), queue.turns_degps.end());
    const double fast = queue.turns_degps[queue.turns_degps.size() * 99 / 100];
    const double off = static_cast<double>(queue.off) / queue.faced;
    std::printf(
        "seed %d: %.0f s of standing, 99 %% turn less than %.0f degrees/s, %.2f turns per minute, "
        "%.1f %% face more than 45 degrees off the path\n",
        static_cast<int>(seed), queue.standing_time_s, fast,
        queue.turned_rad / (360 * kDegree) / (queue.standing_time_s / 60), 100 * off);
    ASSERT_GT(queue.standing_time_s, 300);
    EXPECT_LT(fast, 60);
    EXPECT_LT(off, 0.1);
  }
}

/// Twenty agents that wait in the middle of a hall of 20 m.
Scene hall(double premovement_s, const Eigen::Vector2d& look_at_m) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 20}};
  scene.groups = {group(20, {{4, 4}, {16, 16}}, {{{6, 6}, {14, 14}}})};
  scene.groups[0].premovement_s = {premovement_s, 0, premovement_s, premovement_s};
  scene.groups[0].look_at_m = look_at_m;
  scene.groups[0].on_arrival = OnArrival::kStay;
  return scene;
}

void expect_all_face(const SmallWorld& world, const Eigen::Vector2d& look_at_m, double within_deg) {
  for (uint32_t id = 0; id < world.crowd.size(); ++id) {
    const Eigen::Vector2d direction = look_at_m - world.crowd.positions_m()[id];
    const double off = std::abs(angle_between(world.crowd.headings()[id], direction)) / kDegree;
    EXPECT_LT(off, within_deg) << "person " << id << " looks " << off << " degrees past it";
  }
}

TEST(StandingPeople, FaceTheStageFromTheStart) {
  const Eigen::Vector2d stage_m(10, 25);
  SmallWorld waiting(hall(100, stage_m), 1);
  expect_all_face(waiting, stage_m, 15);
  for (int step = 0; step < 300; ++step) waiting.crowd.step();
  expect_all_face(waiting, stage_m, 26);
  SmallWorld coming(hall(0, stage_m), 1);
  for (int step = 0; step < 40 * 60; ++step) coming.crowd.step();
  for (uint32_t id = 0; id < coming.crowd.size(); ++id)
    ASSERT_EQ(coming.crowd.journeys().state(id), JourneyState::kStaying);
  expect_all_face(coming, stage_m, 26);
}

TEST(StandingPeople, FaceTheStageWithin20DegreesIn95PercentOfCases) {
  for (const SteeringKind model : all_steering_kinds())
    for (const double premovement_s : {0.0, 100.0}) {  // arriving; before setting out
      int near = 0, all = 0;
      for (uint64_t seed = 1; seed <= 5; ++seed) {
        Scene scene = hall(premovement_s, {10, 25});
        scene.seed = seed;
        scene.steering.model = model;
        scene.groups[0].count = 60;
        SmallWorld world(scene, 2);
        for (int step = 0; step < 40 * 60; ++step) world.crowd.step();
        for (uint32_t id = 0; id < world.crowd.size(); ++id) {
          if (world.crowd.journeys().state(id) == JourneyState::kWalking) continue;
          const Eigen::Vector2d direction =
              *scene.groups[0].look_at_m - world.crowd.positions_m()[id];
          near += std::abs(angle_between(world.crowd.headings()[id], direction)) < 20 * kDegree;
          ++all;
        }
      }
      std::printf("%s, %.0f s: %d of %d face the stage within 20 degrees\n",
                  std::string(name_of(model)).c_str(), premovement_s, near, all);
      EXPECT_GT(all, 280);
      EXPECT_GE(near, 0.95 * all) << name_of(model) << ", seeds 1 to 5";
    }
}

TEST(StandingPeople, TurnHeadFirstAndCompletely) {
  for (const double behind_deg : {20.0, 60.0, 120.0, 179.0}) {
    SCOPED_TRACE(testing::Message() << behind_deg << " degrees to the left");
    Scene scene = hall(100, {0, 0});
    scene.groups[0].count = 1;
    SmallWorld world(scene, 1);
    SpawnResult spawned = world.spawned;
    const Eigen::Vector2d ahead = spawned.people[0].heading;
    const double angle = behind_deg * kDegree;
    spawned.people[0].look_at_m =
        spawned.people[0].position_m + 5 * (Eigen::Rotation2Dd(angle) * ahead);
    Crowd crowd(world.map, spawned.people, {1, scene.step_s, scene.steering, SimdTarget::kBest},
                world.workers);
    double fastest = 0, before = 0, head_first = 0;
    int starts = 0;
    bool turned = false;
    for (int step = 0; step < 6 * 60; ++step) {
      crowd.step();
      const double now = angle_between(ahead, crowd.headings()[0]);
      const double turn = std::remainder(now - before, 360 * kDegree);
      EXPECT_GE(turn, -1e-9) << "back and forth";
      fastest = std::max(fastest, turn / scene.step_s / kDegree);
      starts += turn > 0 && !turned;
      turned = turn > 0;
      if (std::abs(now) < 3 * kDegree) head_first = static_cast<double>(crowd.head_yaws_rad()[0]);
      before = now;
    }
    if (behind_deg < 25) {
      EXPECT_EQ(starts, 0) << "only the head turns";
      EXPECT_NEAR(static_cast<double>(crowd.head_yaws_rad()[0]), std::sin(angle), 0.01);
      continue;
    }
    EXPECT_EQ(starts, 1) << "in one go";
    EXPECT_LT(fastest, 60);
    EXPECT_GT(head_first, 0.1) << "the head leads";
    EXPECT_NEAR(std::remainder(before - angle, 360 * kDegree), 0, 3 * kDegree);
  }
}

TEST(StandingPeople, FaceTheNextGoal) {
  Scene scene;
  scene.ground = {{0, 0}, {20, 20}};
  scene.groups = {group(4, {{4, 9}, {6, 11}}, {{{8, 8}, {11, 11}}, {{9, 18}, {11, 20}}})};
  scene.groups[0].goals[0].wait_s = {30, 0, 30, 30};
  SmallWorld world(scene, 1);
  for (int step = 0; step < 20 * 60; ++step) world.crowd.step();
  for (uint32_t id = 0; id < world.crowd.size(); ++id) {
    ASSERT_EQ(world.crowd.journeys().state(id), JourneyState::kWaiting);
    EXPECT_GT(world.crowd.headings()[id].y(), 0.85) << "person " << id << " does not look north";
  }
}

/// The audience of a bundled scene before it sets out.
Scene audience(bool body_avoidance) {
  Scene scene = load_scene("evacuation");
  scene.body_avoidance = body_avoidance;
  scene.groups[0].premovement_s = {100, 0, 100, 100};
  std::vector<std::string> notes;
  scale_to(scene, 60, notes);
  return scene;
}

TEST(StandingPeople, BreatheAndShiftWeightUnlessDisabled) {
  for (const bool body_avoidance : {true, false}) {
    Simulation simulation(audience(body_avoidance), {.postures = true});
    const auto& kinematics = simulation.info().models.front()->kinematics;
    const auto lateral = static_cast<size_t>(kinematics.column_of("pelvis_lateral"));
    const auto arm = static_cast<size_t>(kinematics.column_of("left_shoulder_abduction"));
    std::vector<float> low_m(60, 1), high_m(60, -1), low_rad(60, 9), high_rad(60, -9);
    for (int i = 0; i < 60 * 30; ++i) {
      const Frame& frame = simulation.step();
      for (size_t id = 0; id < 60; ++id) {
        const float* row = &frame.postures[frame.posture_offsets[id]];
        low_m[id] = std::min(low_m[id], row[lateral]);
        high_m[id] = std::max(high_m[id], row[lateral]);
        low_rad[id] = std::min(low_rad[id], row[arm]);
        high_rad[id] = std::max(high_rad[id], row[arm]);
      }
    }
    for (size_t id = 0; id < 60; ++id) {
      if (body_avoidance) {
        EXPECT_GT(high_m[id] - low_m[id], 0.01f) << "person " << id << " never shifts weight";
        EXPECT_NEAR(high_rad[id] - low_rad[id], 0.01f, 0.001f) << "person " << id;
      } else {
        // Symmetry-breaking noise is up to a millimetre per second, which the gait follows.
        EXPECT_NEAR(high_m[id], low_m[id], 0.001f);
        EXPECT_NEAR(high_rad[id], low_rad[id], 0.001f);
      }
    }
  }
}

TEST(StandingPeople, HoldPosturesUntilTheySetOut) {
  Scene scene = audience(true);
  scene.groups[0].premovement_s = {3, 0, 3, 3};
  Simulation simulation(scene, {.postures = true});
  const auto& kinematics = simulation.info().models.front()->kinematics;
  const auto elbow = static_cast<size_t>(kinematics.column_of("left_elbow_flexion"));
  std::vector<float> walked_s(60, 0);
  std::vector<float> elbows_rad;
  int walking = 0;
  for (int i = 0; i < 60 * 8; ++i) {
    const Frame& frame = simulation.step();
    for (size_t id = 0; id < 60; ++id) {
      const float standing = simulation.bodies().avoidance[id].standing;
      if (i < 60) {
        EXPECT_EQ(standing, 1) << "person " << id << " in frame " << i;
      }
      if (i == 60) elbows_rad.push_back(frame.postures[frame.posture_offsets[id] + elbow]);
      walked_s[id] = frame.speeds_mps[id] > 0.3f ? walked_s[id] + 1.0f / 60 : 0;
      if (walked_s[id] < 1.2f) continue;
      EXPECT_EQ(standing, 0) << "person " << id << " walks for " << walked_s[id] << " s";
      ++walking;
    }
  }
  EXPECT_GT(walking, 1000);
  std::sort(elbows_rad.begin(), elbows_rad.end());
  EXPECT_GT(elbows_rad[55] - elbows_rad[5], 0.5f) << "all arm postures are equal";
  EXPECT_EQ(std::adjacent_find(elbows_rad.begin(), elbows_rad.end()), elbows_rad.end());
}

TEST(StandingPeople, HoldNoPosturesWhileWalking) {
  for (const char* name : {"plaza", "crossing"}) {
    Simulation simulation(load_scene(name), {});
    std::vector<uint8_t> has_stopped;
    size_t walked = 0;
    for (int i = 0; i < 300; ++i) {
      const Frame& frame = simulation.step();
      has_stopped.resize(frame.speeds_mps.size());
      for (size_t id = 0; id < has_stopped.size(); ++id) {
        has_stopped[id] |= frame.speeds_mps[id] < 2 * kStanding_mps;
        if (has_stopped[id] != 0) continue;
        ASSERT_EQ(simulation.bodies().avoidance[id].standing, 0)
            << name << ": person " << id << " in frame " << i;
        ++walked;
      }
    }
    EXPECT_GT(walked, 20000u) << name;
  }
}

TEST(StandingPeople, HoldPosturesWhereTheyStop) {
  Scene scene = hall(0, {10, 25});
  scene.groups[0].model = audience(true).groups[0].model;
  Simulation simulation(scene, {});
  int standing = 0, before = 0;
  for (int i = 0; i < 40 * 60; ++i) {
    const Frame& frame = simulation.step();
    for (size_t id = 0; id < 20; ++id) {
      const AvoidancePosture& avoidance = simulation.bodies().avoidance[id];
      standing += i == 40 * 60 - 1 && avoidance.standing > 0.99f;
      before += i > 60 && frame.speeds_mps[id] > 0.5f && avoidance.standing > 0.5f;
    }
  }
  EXPECT_GE(standing, 18);
  EXPECT_EQ(before, 0);
}

TEST(StandingPeople, AreIndependentOfThreadsAndSimdTarget) {
  const auto run = [](int threads, SimdTarget simd) {
    SimulationOptions options;
    options.threads = threads;
    options.culler.simd = simd;
    options.postures = true;
    Simulation simulation(audience(true), options);
    std::vector<float> all;
    for (int i = 0; i < 400; ++i) {
      const Frame& frame = simulation.step();
      if (i % 20 == 0) all.insert(all.end(), frame.postures.begin(), frame.postures.end());
    }
    return all;
  };
  const std::vector<float> reference = run(1, SimdTarget::kScalar);
  for (const SimdTarget simd : simd_targets_of_this_machine())
    EXPECT_EQ(run(3, simd), reference) << name_of(simd);
}

/// Closer than people stand voluntarily.
TEST(StandingPeople, MissNoContactWhileShiftingWeight) {
  Scene scene = load_scene("evacuation");
  Group& group = scene.groups[0];
  group.count = 110;
  group.spawn = {{-4, 4}, {0.5, 7.5}};
  group.radius_m = 0.08;
  group.premovement_s = {100, 0, 100, 100};
  Simulation simulation(scene, {.threads = 2});
  test::PersonPairs people(simulation);
  for (int i = 0; i < 1200; ++i) {
    const Frame& frame = simulation.step();
    if (i % 60 == 59) people.check(frame);
  }
  EXPECT_GT(people.touching, 500u);
  EXPECT_EQ(people.missed, 0u) << people.first_miss;
}

}  // namespace
}  // namespace throng::standing_test
