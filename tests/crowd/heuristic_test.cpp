// Tests of the heuristic: properties of one decision, and behaviour of crowds.
#include "crowd/steering/heuristic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "analysis/validation/recorded_setups.h"
#include "analysis/validation/trial.h"
#include "crowd/steering/heuristic_tuning.h"
#include "tests/crowd/steering_draws.h"

namespace throng::heuristic_test {
namespace {

constexpr float kFree_mps = 1.34f;
constexpr float kPeriod_s = 0.1f;

struct TestAgent {
  Eigen::Vector2f at_m, velocity_mps, preferred_mps;
  float impatience = 0, catch_up = 0;
};
struct Wall {
  Eigen::Vector2f away;
  float clearance_m;
};

/// A decision of the first agent; the walls are its own.
struct Moment {
  std::vector<TestAgent> people;
  std::vector<Wall> walls;

  std::vector<Eigen::Vector2f> decide(size_t begin = 0, size_t end = 1,
                                      SteeringFunction model = decide_heuristic_scalar) const {
    const size_t count = people.size();
    std::vector<NeighbourState> published;
    for (const TestAgent& each : people) {
      const float length = each.preferred_mps.norm();
      published.push_back({.x_m = each.at_m.x(),
                           .y_m = each.at_m.y(),
                           .vx_mps = each.velocity_mps.x(),
                           .vy_mps = each.velocity_mps.y(),
                           .preferred_x_mps = each.preferred_mps.x(),
                           .preferred_y_mps = each.preferred_mps.y(),
                           .direction_x = length > 0 ? each.preferred_mps.x() / length : 0,
                           .direction_y = length > 0 ? each.preferred_mps.y() / length : 0,
                           .radius_m = 0.22f,
                           .impatience = each.impatience,
                           .catch_up = each.catch_up,
                           .max_speed_mps = 1.2f * kFree_mps,
                           .horizon_s = 2});
    }
    std::vector<uint32_t> near(NeighbourGrid::kMaxNeighbours * count), starts(count + 1);
    std::vector<uint8_t> counts(count);
    for (uint32_t i = 0; i < count; ++i) {
      std::vector<uint32_t> others(count);
      std::iota(others.begin(), others.end(), 0);
      others.erase(others.begin() + i);
      std::stable_sort(others.begin(), others.end(), [&](uint32_t a, uint32_t b) {
        return (people[a].at_m - people[i].at_m).squaredNorm() <
               (people[b].at_m - people[i].at_m).squaredNorm();
      });
      others.resize(std::min(others.size(), NeighbourGrid::kMaxNeighbours));
      std::copy(others.begin(), others.end(), near.begin() + NeighbourGrid::kMaxNeighbours * i);
      counts[i] = static_cast<uint8_t>(others.size());
      starts[i + 1] = static_cast<uint32_t>(walls.size());
    }
    std::vector<float> wall_x, wall_y, clearances;
    for (const Wall& wall : walls) {
      wall_x.push_back(wall.away.x());
      wall_y.push_back(wall.away.y());
      clearances.push_back(wall.clearance_m);
    }
    SteeringView view;
    view.published = published.data();
    view.neighbours = near.data();
    view.neighbour_counts = counts.data();
    view.wall_x = wall_x.data();
    view.wall_y = wall_y.data();
    view.wall_clearance_m = clearances.data();
    view.wall_starts = starts.data();
    view.period_s = kPeriod_s;
    std::vector<float> next_x(count), next_y(count);
    std::vector<uint32_t> slots(end - begin);
    std::iota(slots.begin(), slots.end(), static_cast<uint32_t>(begin));
    view.wall_starts += begin;
    model(view, slots, next_x.data(), next_y.data());
    std::vector<Eigen::Vector2f> out;
    for (size_t i = begin; i < end; ++i) out.emplace_back(next_x[i], next_y[i]);
    return out;
  }
};

Moment random_moment(uint64_t seed) {
  Moment moment;
  const auto count = static_cast<size_t>(uniform(seed, 0, 1, 25));
  const double half_m = static_cast<double>(uniform(seed, 1, 0.4, 5));
  for (uint64_t i = 0; i < count; ++i) {
    const uint64_t id = 10 + 8 * i;
    TestAgent each;
    each.at_m = {uniform(seed, id, -half_m, half_m), uniform(seed, id + 1, -half_m, half_m)};
    each.velocity_mps = polar(uniform(seed, id + 2, 0, 1.5), uniform(seed, id + 3, -3.14, 3.14));
    each.preferred_mps = polar(uniform(seed, id + 4, 0, 1) < 0.2f ? 0 : kFree_mps,
                               uniform(seed, id + 5, -3.14, 3.14));
    if (uniform(seed, id + 7, 0, 1) < 0.2f) each.impatience = uniform(seed, 900 + i, 0, 1);
    if (uniform(seed, id + 7, 0, 1) < 0.4f) each.catch_up = uniform(seed, 950 + i, 0, 1);
    // Some agents share a place.
    if (i > 0 && uniform(seed, id + 6, 0, 1) < 0.05f) each.at_m = moment.people.back().at_m;
    moment.people.push_back(each);
  }
  const auto walls = static_cast<size_t>(uniform(seed, 2, 0, 4));
  for (uint64_t i = 0; i < walls; ++i)
    moment.walls.push_back(
        {polar(1, uniform(seed, 500 + i, -3.14, 3.14)), uniform(seed, 600 + i, -0.1, 1)});
  return moment;
}

TEST(Heuristic, KeepsTheDesiredSpeedAlone) {
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const Eigen::Vector2f preferred = polar(kFree_mps, uniform(seed, 0, -3.14, 3.14));
    const Moment moment{{{{0, 0}, preferred, preferred}}, {}};
    EXPECT_LE((moment.decide().front() - preferred).norm(), 1e-5f) << "seed " << seed;
  }
}

TEST(Heuristic, StopsAloneWithoutAPreferredVelocity) {
  const Moment stands{{{{0, 0}, {0, 0}, {0, 0}}}, {}};
  EXPECT_EQ(stands.decide().front().norm(), 0);
  Eigen::Vector2f velocity(1, 0);
  for (int i = 0; i < 30; ++i) velocity = Moment{{{{0, 0}, velocity, {0, 0}}}, {}}.decide().front();
  EXPECT_LE(velocity.norm(), 1e-3f);
}

TEST(Heuristic, LimitsSpeedAccelerationAndWallApproach) {
  for (uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Moment moment = random_moment(seed);
    const Eigen::Vector2f v = moment.decide().front();
    ASSERT_TRUE(v.allFinite());
    EXPECT_LE(v.norm(), 1.2f * kFree_mps + 1e-4f);
    constexpr float kMax_mps2 = 3.5f;
    if (moment.walls.empty() && moment.people.front().velocity_mps.norm() <= 1.2f * kFree_mps) {
      EXPECT_LE((v - moment.people.front().velocity_mps).norm(), kMax_mps2 * kPeriod_s + 1e-4f);
    }
    // Shoulders turn at a wall: two tenths of the radius.
    const SteeringView defaults;
    for (const Wall& wall : moment.walls)
      EXPECT_GE(v.dot(wall.away),
                -std::max(0.0f, wall.clearance_m + 0.2f * 0.22f) / defaults.wall_horizon_s - 1e-4f);
  }
}

TEST(Heuristic, LimitsSidewaysAcceleration) {
  constexpr float kMaxSpeed_mps = heuristic::kTuning.across_mps2 * kPeriod_s;
  float max_mps = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    const Eigen::Vector2f direction = polar(1, uniform(seed, 0, -3.14, 3.14)),
                          right(direction.y(), -direction.x());
    const Eigen::Vector2f now = polar(uniform(seed, 1, 0, 1.5), uniform(seed, 2, -3.14, 3.14));
    const Moment moment{{{{0, 0}, now, kFree_mps * direction}}, {}};
    const float across_mps = std::abs((moment.decide().front() - now).dot(right));
    EXPECT_LE(across_mps, kMaxSpeed_mps + 1e-5f) << "seed " << seed;
    max_mps = std::max(max_mps, across_mps);
  }
  EXPECT_GT(max_mps, 0.99f * kMaxSpeed_mps);
}

/// The first agent walks slowly; a fast one comes up a metre behind, a little to the right.
Eigen::Vector2f overtaken(bool is_in_crowd, bool is_overtaken) {
  const Eigen::Vector2f slowly(0.7f, 0);
  Moment moment{{{{0, 0}, slowly, slowly}}, {}};
  if (is_overtaken) moment.people.push_back({{-1, -0.05f}, {kFree_mps, 0}, {kFree_mps, 0}});
  // Three to each side, far enough to block no direction.
  for (const float angle_rad : {1.4f, 1.5f, 1.6f, -1.4f, -1.5f, -1.6f})
    if (is_in_crowd) moment.people.push_back({polar(3, angle_rad), slowly, slowly});
  return moment.decide().front();
}

TEST(Heuristic, IgnoresAgentsFromBehindInACrowd) {
  EXPECT_EQ(overtaken(true, true), overtaken(true, false));
  EXPECT_GT(overtaken(false, true).y(), overtaken(false, false).y() + 0.01f)
      << "with room, agents avoid it";
}

TEST(Heuristic, KeepsWaitingAgentsInPlace) {
  const auto pushed_mps = [](float apart_m) {
    const Moment moment{{{{0, 0}, {0, 0}, {0, 0}}, {{apart_m, 0}, {0, 0}, {0, 0}}}, {}};
    return -moment.decide().front().x();
  };
  EXPECT_EQ(pushed_mps(0.6f), 0);
  EXPECT_GT(pushed_mps(0.45f), 0);
}

TEST(Heuristic, PassesOnTheLeftWhenStuck) {
  const auto to_left_mps = [](float impatience) {
    const Moment moment{{{{0, 0}, {0, 0}, {kFree_mps, 0}, impatience},
                         {{0.45f, 0.02f}, {0, 0}, {0, 0}},
                         {{0.25f, -0.4f}, {0, 0}, {0, 0}}},
                        {}};
    return moment.decide().front().y();
  };
  EXPECT_GT(to_left_mps(1), to_left_mps(0) + 0.05f);
}

TEST(Heuristic, IsIndependentOfTheBlock) {
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    Moment moment = random_moment(seed);
    moment.walls.clear();
    const size_t count = moment.people.size();
    const std::vector<Eigen::Vector2f> all = moment.decide(0, count);
    for (size_t i = 0; i < count; ++i)
      EXPECT_EQ(moment.decide(i, i + 1).front(), all[i]) << "seed " << seed << ", agent " << i;
  }
}

/// Covers the lanes of both models; some planes contradict each other.
TEST(Heuristic, IsBitwiseEqualOnEverySimdTarget) {
  for (const SimdTarget target : simd_targets_of_this_machine())
    for (uint64_t seed = 1; seed <= 2000; ++seed) {
      const Moment moment = random_moment(seed);
      const size_t count = moment.people.size();
      EXPECT_EQ(moment.decide(0, count, heuristic_on(target)), moment.decide(0, count))
          << name_of(target) << ", seed " << seed;
      EXPECT_EQ(moment.decide(0, count, orca_on(target)),
                moment.decide(0, count, decide_orca_scalar))
          << name_of(target) << ", seed " << seed;
    }
}

TEST(Heuristic, IsRotationInvariant) {
  for (uint64_t seed = 1; seed <= 500; ++seed) {
    const Moment moment = random_moment(seed);
    // By a quarter turn, which is exact.
    const auto turned = [](const Eigen::Vector2f& v) { return Eigen::Vector2f(-v.y(), v.x()); };
    Moment quarter = moment;
    for (TestAgent& each : quarter.people)
      each = {turned(each.at_m), turned(each.velocity_mps), turned(each.preferred_mps),
              each.impatience, each.catch_up};
    for (Wall& wall : quarter.walls) wall.away = turned(wall.away);
    bool one_place = false;  // agents at one place separate along x
    for (size_t i = 1; i < moment.people.size(); ++i)
      one_place = one_place || moment.people[i].at_m == moment.people[0].at_m;
    if (one_place) continue;
    EXPECT_LE((quarter.decide().front() - turned(moment.decide().front())).norm(), 1e-3f)
        << "seed " << seed;
  }
}

/// Speed at which a standing agent sets out behind one that walks off at 0.1 m/s.
float sets_out_mps(float ahead_m, float catch_up) {
  const Eigen::Vector2f preferred(kFree_mps, 0);
  // Walls on both sides leave no room to pass.
  const Moment moment{
      {{{0, 0}, {0, 0}, preferred, 0, catch_up}, {{ahead_m, 0}, {0.06f, 0}, preferred}},
      {{{0, 1}, 0.03f}, {{0, -1}, 0.03f}}};
  return moment.decide().front().x();
}

TEST(Heuristic, FollowsCloserWithCatchUp) {
  const float calm_mps = sets_out_mps(0.6f, 0), catch_up_mps = sets_out_mps(0.6f, 1);
  EXPECT_GT(calm_mps, 0);
  EXPECT_GT(catch_up_mps, 1.3f * calm_mps);
  const float between_mps = sets_out_mps(0.6f, 0.05f);
  EXPECT_GT(between_mps, calm_mps);
  EXPECT_LT(between_mps, catch_up_mps);
}

TEST(Heuristic, IgnoresCatchUpAtContact) {
  EXPECT_EQ(sets_out_mps(0.3f, 1), sets_out_mps(0.3f, 0));
}

TEST(Heuristic, StopsBehindAStandingAgentInANarrowPassage) {
  // Walls on both sides, half a metre apart, leave no room to pass.
  Eigen::Vector2f at(0, 0), velocity(kFree_mps, 0);
  const Eigen::Vector2f other(5, 0);
  for (int i = 0; i < 100; ++i) {
    const Moment moment{{{at, velocity, {kFree_mps, 0}}, {other, {0, 0}, {0, 0}}},
                        {{{0, 1}, 0.03f + at.y()}, {{0, -1}, 0.03f - at.y()}}};
    velocity = moment.decide().front();
    at += kPeriod_s * velocity;
  }
  EXPECT_LE(velocity.norm(), 0.05f);
  EXPECT_GT(other.x() - at.x(), 0.3f) << "walked into the other";
  EXPECT_LT(other.x() - at.x(), 0.9f) << "stopped far away";
}

/// Walks all agents for a time; returns the least distance of two.
float walk(std::vector<TestAgent>& people, double seconds) {
  float min_m = 1e9f;
  const auto decisions = static_cast<int>(seconds / static_cast<double>(kPeriod_s));
  for (int i = 0; i < decisions; ++i) {
    const std::vector<Eigen::Vector2f> next = Moment{people, {}}.decide(0, people.size());
    for (size_t k = 0; k < people.size(); ++k) {
      people[k].at_m += 0.5f * kPeriod_s * (people[k].velocity_mps + next[k]);
      people[k].velocity_mps = next[k];
    }
    for (size_t a = 0; a < people.size(); ++a)
      for (size_t b = 0; b < a; ++b)
        min_m = std::min(min_m, (people[a].at_m - people[b].at_m).norm());
  }
  return min_m;
}

/// Two agents that walk to each other's start.
float nearest_m(float lateral_m) {
  std::vector<TestAgent> two = {{{0, 0}, {kFree_mps, 0}, {kFree_mps, 0}},
                                {{10, lateral_m}, {-kFree_mps, 0}, {-kFree_mps, 0}}};
  const float min = walk(two, 10);
  EXPECT_GT(two[0].at_m.x(), two[1].at_m.x()) << "they never passed, lateral " << lateral_m;
  return min;
}

TEST(Heuristic, PassesHeadOnAtRecordedDistances) {
  // Recorded people are 0.4 m abreast when they pass, 1 in 100 nearer.
  for (int i = -10; i <= 10; ++i)
    EXPECT_GE(nearest_m(0.06f * static_cast<float>(i)), 0.4f) << "lateral " << 6 * i << " cm";
}

TEST(Heuristic, KeepsRightOfOncomingAgents) {
  for (const float others_sign : {-1.0f, 1.0f}) {
    const Eigen::Vector2f own(kFree_mps, 0), other(others_sign * kFree_mps, 0);
    // Far enough to the side that no agent has to be passed.
    const Moment moment{{{{0, 0}, own, own},
                         {{3, 2.0f}, other, other},
                         {{3, -2.0f}, other, other},
                         {{4, 2.0f}, other, other}},
                        {}};
    const float left_mps = moment.decide().front().y();
    if (others_sign < 0) {
      EXPECT_LT(left_mps, -0.1f);
    } else {
      EXPECT_NEAR(left_mps, 0, 1e-5) << "agents of the same direction have no effect";
    }
  }
}

TEST(Heuristic, ResolvesCrossingsFromAllSides) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<TestAgent> people;
    for (uint64_t i = 0; i < 10; ++i) {
      const Eigen::Vector2f from = polar(uniform(seed, i, 5, 9), 0.628f * static_cast<float>(i));
      const Eigen::Vector2f preferred = -kFree_mps * from.normalized();
      people.push_back({from, preferred, preferred});
    }
    EXPECT_GE(walk(people, 20), 0.3f);
    for (const TestAgent& each : people)
      EXPECT_GT(each.at_m.dot(each.preferred_mps), 3) << "did not get to the other side";
  }
}

}  // namespace
}  // namespace throng::heuristic_test

namespace throng::validation::heuristic_test {
namespace {

/// Preferred velocities that lag behind the direction cause oscillation before such a door. In the
/// last three seeds the field leads straight aside to its middle.
TEST(HeuristicCrowd, PassesANarrowDoorAlone) {
  for (const double half_m : {0.3, 0.35})
    for (const uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 89, 140, 197}) {
      Plan plan =
          carved("door", {{{0, -3}, {4, 3}}, {{4, -half_m}, {6.8, half_m}}, {{6.8, -3}, {12, 3}}},
                 {SteeringKind::kHeuristic}, seed);
      plan.people(1, {{3, -1.5}, {3.8, 1.5}}, {{{11, -3}, {12, 3}}});
      Trial trial(plan);
      while (trial.step(40)) {
      }
      EXPECT_EQ(trial.present(), 0u) << 2 * half_m << " m, seed " << seed;
    }
}

TEST(HeuristicCrowd, OvertakesSlowAgents) {
  for (uint64_t seed = 11; seed <= 12; ++seed) {
    Outcome outcome;
    EXPECT_TRUE(
        judge_overtaking(measure_overtaking(20, SteeringKind::kHeuristic, seed, outcome)).passed)
        << "seed " << seed;
  }
}

TEST(HeuristicCrowd, FormsWalkingLanesInACorridor) {
  Outcome outcome;
  const std::vector<double> flows = measure_counterflow(2, SteeringKind::kHeuristic, 3, outcome);
  for (const double flow : flows) EXPECT_GE(flow, 0.8) << "seed 3";
  EXPECT_EQ(outcome.wall_crossings, 0);
}

TEST(HeuristicCrowd, PassesMoreAgentsThroughAWiderDoor) {
  Outcome outcome;
  double before = 0;
  for (const double width_m : {0.6, 1.2, 2.2}) {
    const DoorFlow flow = measure_door_flow(width_m, 90, SteeringKind::kHeuristic, 2, outcome);
    EXPECT_GT(flow.flow_per_s, 1.3 * before) << width_m << " m, seed 2";
    EXPECT_EQ(flow.through, 90) << width_m << " m, seed 2";
    before = flow.flow_per_s;
  }
  EXPECT_EQ(outcome.wall_crossings, 0);
}

}  // namespace
}  // namespace throng::validation::heuristic_test
