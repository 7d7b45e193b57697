// Tests of queues: first come, first served; positions along a line; limited capacity.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/portable_math.h"
#include "tests/crowd/crowd_world.h"
#include "tests/scenes/same_walk.h"

namespace throng::queues_test {
namespace {

constexpr int kStepsPerSecond = 30;
/// One run in ten or twenty shows failures that need unlucky meetings.
constexpr uint64_t kSeeds = 20;

double angle_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
}

/// A hall of 20 m by 14 m: agents are served at the north wall for some seconds and leave in the
/// east.
Scene hall(uint64_t seed, int people, std::vector<Rectangle> counters, double serves_s) {
  Scene scene;
  scene.seed = seed;
  scene.step_s = 1.0 / kStepsPerSecond;
  scene.ground = {{-10, -8}, {10, 6}};
  scene.groups = {group(people, {{-9, -7.5}, {9, -2}}, {{{8, -7}, {9.8, 5}}})};
  scene.groups[0].on_arrival = OnArrival::kLeave;
  Goal goal;
  goal.areas.assign(counters.begin(), counters.end());
  goal.has_queue = true;
  goal.wait_s = {serves_s, 0.3 * serves_s, 0.4 * serves_s, 2 * serves_s};
  scene.groups[0].goals.insert(scene.groups[0].goals.begin(), goal);
  return scene;
}

const Rectangle kCounter{{-0.5, 5}, {0.5, 5.8}};
const std::vector<Rectangle> kThreeCounters = {
    {{-3, 5}, {-2, 5.8}}, {{-0.5, 5}, {0.5, 5.8}}, {{2, 5}, {3, 5.8}}};

/// Observes the crowd and records which agents joined, were admitted and were served.
struct Watch {
  std::vector<uint32_t> joined, let_in, served, before;
  std::vector<uint8_t> was_served, was_out;
  size_t max_inside = 0;  ///< per area, by positions; without served agents that have left it
  size_t max_waiting = 0;

  void look(const SmallWorld& world) {
    const Goal& goal = world.scene.groups[0].goals[0];
    const std::span<const uint32_t> now = world.crowd.queues().waiting(0);
    was_served.resize(world.crowd.size(), 0);
    was_out.resize(world.crowd.size(), 0);
    // Agents that left the line were first in it; new ones are last.
    size_t gone = 0;
    while (gone < before.size() && (now.empty() || before[gone] != now[0])) ++gone;
    for (size_t i = 0; i < gone; ++i) let_in.push_back(before[i]);
    const size_t left = before.size() - gone;
    ASSERT_LE(left, now.size()) << "an agent left the middle of the line";
    for (size_t i = 0; i < left; ++i)
      ASSERT_EQ(now[i], before[gone + i]) << "an agent overtook another";
    for (size_t i = left; i < now.size(); ++i) joined.push_back(now[i]);
    before.assign(now.begin(), now.end());
    max_waiting = std::max(max_waiting, now.size());
    std::vector<size_t> inside(goal.areas.size(), 0);
    for (uint32_t id = 0; id < world.crowd.size(); ++id) {
      if (!world.crowd.journeys().is_present(id)) continue;
      const Eigen::Vector2d& at_m = world.crowd.positions_m()[id];
      double away_m = 1e9;
      for (size_t area = 0; area < inside.size(); ++area) {
        const Rectangle& r = goal.areas[area].bounds();
        away_m = std::min(away_m, (at_m - at_m.cwiseMax(r.min_m).cwiseMin(r.max_m)).norm());
        inside[area] += was_out[id] == 0 && r.contains(at_m);
      }
      if (was_served[id] != 0 && away_m > 0.25) was_out[id] = 1;
      if (was_served[id] != 0 || !world.crowd.journeys().has_visited(id, 1)) continue;
      was_served[id] = 1;
      served.push_back(id);
    }
    for (const size_t count : inside) max_inside = std::max(max_inside, count);
  }
};

class QueuesByModel : public testing::TestWithParam<SteeringKind> {
 protected:
  Scene with_model(Scene scene) const {
    scene.steering.model = GetParam();
    return scene;
  }
  /// Runs until all have left, at most for this time.
  static void run(SmallWorld& world, Watch& watch, double max_s) {
    for (int step = 0; step < max_s * kStepsPerSecond; ++step) {
      world.crowd.step();
      ASSERT_NO_FATAL_FAILURE(watch.look(world)) << "step " << step;
      if (world.crowd.population().counters().left == world.crowd.size()) return;
    }
  }
};

TEST_P(QueuesByModel, ServeAllInOrderOfArrival) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallWorld world(with_model(hall(seed, 30, {kCounter}, 4)), 2);
    Watch watch;
    ASSERT_NO_FATAL_FAILURE(run(world, watch, 400));
    EXPECT_EQ(world.crowd.population().counters().left, 30u);
    EXPECT_GT(watch.max_waiting, 15u);
    EXPECT_EQ(watch.max_inside, 1u);
    // One at a time: agents are served in the order of admission and of joining.
    ASSERT_LE(watch.joined.size(), watch.served.size());
    std::vector<uint32_t> served = watch.served;
    std::erase_if(served, [&](uint32_t id) {
      return std::find(watch.joined.begin(), watch.joined.end(), id) == watch.joined.end();
    });
    EXPECT_EQ(served, watch.joined);
    EXPECT_EQ(watch.let_in, watch.joined);
  }
}

TEST_P(QueuesByModel, ServeSeveralCountersFromOneLine) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallWorld world(with_model(hall(seed, 40, kThreeCounters, 8)), 2);
    Watch watch;
    std::array<int, 3> max{};
    for (int step = 0; step < 400 * kStepsPerSecond; ++step) {
      world.crowd.step();
      ASSERT_NO_FATAL_FAILURE(watch.look(world)) << "step " << step;
      for (uint32_t id = 0; id < world.crowd.size(); ++id)
        for (size_t area = 0; area < 3; ++area)
          max[area] +=
              world.crowd.journeys().state(id) == JourneyState::kWaiting &&
              std::abs(kThreeCounters[area].middle_m().x() - world.crowd.positions_m()[id].x()) < 1;
    }
    EXPECT_EQ(world.crowd.population().counters().left, 40u);
    EXPECT_EQ(watch.max_inside, 1u);
    EXPECT_EQ(watch.let_in, watch.joined);
    for (const int steps : max) EXPECT_GT(steps, 50 * kStepsPerSecond) << "a counter was idle";
  }
}

/// Spacing, turning and facing of the agents in a queue.
struct Looks {
  std::vector<double> apart_m, turns_degps, off_deg;
  double turned_rad = 0, stood_s = 0;
  int backwards = 0;

  void look(const SmallWorld& world, const std::vector<Eigen::Vector2d>& headings) {
    const std::span<const uint32_t> line = world.crowd.queues().waiting(0);
    for (size_t i = 0; i < std::min(line.size(), world.map.queues()[0].plan.places); ++i) {
      const uint32_t id = line[i];
      const Eigen::Vector2d& at_m = world.crowd.positions_m()[id];
      const double turn = angle_between(headings[id], world.crowd.headings()[id]);
      turns_degps.push_back(std::abs(turn) / kDegree / world.scene.step_s);
      turned_rad += turn;
      stood_s += world.scene.step_s;
      if (world.crowd.velocities_mps()[id].norm() > 0.05) continue;
      const Eigen::Vector2d front_m =
          i == 0 ? Eigen::Vector2d(0, 5.4) : world.crowd.positions_m()[line[i - 1]];
      off_deg.push_back(std::abs(angle_between(world.crowd.headings()[id], front_m - at_m)) /
                        kDegree);
      if (i > 0 && world.crowd.velocities_mps()[line[i - 1]].norm() < 0.05)
        apart_m.push_back((front_m - at_m).norm());
      // The default line leads south.
      backwards += i > 0 && front_m.y() < at_m.y() &&
                   world.crowd.velocities_mps()[line[i - 1]].norm() < 0.05;
    }
  }
};

double share_of(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST_P(QueuesByModel, StandInOrderAndTurnSlowly) {
  Looks looks;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SmallWorld world(with_model(hall(seed, 24, {kCounter}, 10)), 2);
    for (int step = 0; step < 150 * kStepsPerSecond; ++step) {
      const std::vector<Eigen::Vector2d> before(world.crowd.headings().begin(),
                                                world.crowd.headings().end());
      world.crowd.step();
      if (step > 30 * kStepsPerSecond) looks.look(world, before);
    }
  }
  const double turns = std::abs(looks.turned_rad) / (2 * std::numbers::pi) / (looks.stood_s / 60);
  fmt::print(
      "queue {} {:.0f} s, apart {:.2f} to {:.2f} m in 90 %, 99 % turn less than {:.0f} degrees/s, "
      "{:.2f} turns per minute, 95 % face within {:.0f} degrees\n",
      name_of(GetParam()), looks.stood_s, share_of(looks.apart_m, 0.05),
      share_of(looks.apart_m, 0.95), share_of(looks.turns_degps, 0.99), turns,
      share_of(looks.off_deg, 0.95));
  EXPECT_GT(looks.stood_s, 2000);
  // If two agents come at once, the second may stand ahead until the first has passed.
  EXPECT_LT(looks.backwards, 0.02 * static_cast<double>(looks.apart_m.size()));
  EXPECT_GT(share_of(looks.apart_m, 0.05), 0.6);
  EXPECT_LT(share_of(looks.apart_m, 0.95), 1.3);
  EXPECT_LT(share_of(looks.turns_degps, 0.99), 60);
  EXPECT_LT(turns, 1);
  EXPECT_LT(share_of(looks.off_deg, 0.95), 45);
}

/// Steps after which a queue has moved on, from the first to the last standing agent.
TEST_P(QueuesByModel, FollowALineRoundCornersAndBeyondItsEnd) {
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_model(hall(seed, 22, {kCounter}, 1000));
    // Lanes of 1.4 m between barriers; beyond the end, 3 m to the edge.
    scene.groups[0].goals[0].queue = {0.8, {{0, 4}, {4, 4}, {4, 2.6}, {-6, 2.6}}};
    scene.obstacles = {box(-0.5, 3.3, 7, 0.06)};
    SmallWorld world(scene, 2);
    for (int step = 0; step < 120 * kStepsPerSecond; ++step) world.crowd.step();
    const QueuePlan& plan = world.map.queues()[0].plan;
    const std::span<const uint32_t> line = world.crowd.queues().waiting(0);
    ASSERT_EQ(line.size(), 21u);
    EXPECT_GT(plan.line.length_m(), 15.4 + 3);
    for (size_t place = 0; place < line.size(); ++place)
      EXPECT_LT((world.crowd.positions_m()[line[place]] - plan.line.at(plan.along_m(place))).norm(),
                0.5)
          << "place " << place;
    EXPECT_LT(world.crowd.counters().longest_stall_s, 5) << "waiting agents are not stuck";
  }
}

TEST_P(QueuesByModel, KeepTheirOrderBeyondAShortLine) {
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_model(hall(seed, 30, {kCounter}, 3));
    // Room for five, then a wall.
    scene.groups[0].goals[0].queue = {0.8, {{0, 4}, {0, 1}}};
    scene.obstacles = {box(0, 0.2, 3, 0.2)};
    SmallWorld world(scene, 2);
    ASSERT_EQ(world.map.queues()[0].plan.places, 5u);
    Watch watch;
    ASSERT_NO_FATAL_FAILURE(run(world, watch, 500));
    EXPECT_GT(watch.max_waiting, 12u);
    EXPECT_EQ(world.crowd.population().counters().left, 30u);
    EXPECT_EQ(watch.let_in, watch.joined);
    EXPECT_EQ(watch.max_inside, 1u);
  }
}

/// A room with a small capacity and a door in the west.
Scene limited_hall(uint64_t seed, int people, int capacity) {
  Scene scene = hall(seed, people, {{{4.2, 0.9}, {9.9, 5.9}}}, 10);
  Goal& goal = scene.groups[0].goals[0];
  goal.has_queue = false;
  goal.capacity = capacity;
  goal.queue.line_m = {{3, 3}, {-5, 3}};
  scene.obstacles = {box(4, 1.5, 0.2, 1.6), box(4, 4.85, 0.2, 2.3), box(7, 0.7, 6, 0.2)};
  scene.groups[0].goals[1] = Rectangle{{-9.5, -7}, {9.5, -6}};
  return scene;
}

TEST_P(QueuesByModel, RespectTheCapacity) {
  for (uint64_t seed = 1; seed <= 3; ++seed)
    for (const int capacity : {1, 3, 8}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", capacity " << capacity);
      SmallWorld world(with_model(limited_hall(seed, 25, capacity)), 2);
      Watch watch;
      ASSERT_NO_FATAL_FAILURE(run(world, watch, 600));
      EXPECT_EQ(watch.max_inside, static_cast<size_t>(capacity));
      EXPECT_EQ(watch.let_in, watch.joined);
      EXPECT_EQ(world.crowd.population().counters().left, 25u);
    }
}

TEST_P(QueuesByModel, ServeGroupsThatReturn) {
  Scene scene = with_model(hall(3, 12, kThreeCounters, 5));
  scene.groups.push_back(scene.groups[0]);
  scene.groups[1].count = 8;
  scene.groups[1].spawn = {{-9, 0}, {-5, 4}};
  for (Group& each : scene.groups) each.on_arrival = OnArrival::kLoop;
  scene.groups[1].social_groups = SocialGroupRule{1, {1, 0, 0}};
  SmallWorld world(scene, 1);
  ASSERT_EQ(world.map.queues().size(), 1u);
  for (int step = 0; step < 300 * kStepsPerSecond; ++step) {
    world.crowd.step();
    ASSERT_LE(world.crowd.queues().inside(0), 3u) << "step " << step;
  }
  for (uint32_t id = 0; id < world.crowd.size(); ++id)
    EXPECT_GE(world.crowd.journeys().visits(id), 4u) << "person " << id;
}

TEST_P(QueuesByModel, AreIndependentOfThreadsAndCheckpoints) {
  Scene scene = with_model(hall(7, 40, kThreeCounters, 6));
  scene.groups[0].sources = {{{{-9, -7.5}, {-7, -2}}, 30, 1, 5, true}};
  scene.groups[0].goals[0].queue = {0.8, {{0, 4}, {0, 1}}};
  scene.obstacles = {box(0, 0.2, 3, 0.2)};
  expect_same_walk(scene, 40 * kStepsPerSecond, 60 * kStepsPerSecond);
}

INSTANTIATE_TEST_SUITE_P(Models, QueuesByModel,
                         testing::Values(SteeringKind::kOrca, SteeringKind::kCollisionFreeSpeed,
                                         SteeringKind::kHeuristic),
                         [](const auto& each) { return std::string(name_of(each.param)); });

TEST(Queues, DrawServiceTimesFromTheSeed) {
  const auto served_s = [](uint64_t seed) {
    SmallWorld world(hall(seed, 1, {kCounter}, 20), 1);
    int steps = 0;
    for (int step = 0; step < 100 * kStepsPerSecond; ++step) {
      world.crowd.step();
      steps += world.crowd.journeys().state(0) == JourneyState::kWaiting;
    }
    return static_cast<double>(steps) / kStepsPerSecond;
  };
  std::vector<double> all_s;
  for (uint64_t seed = 1; seed <= 40; ++seed) all_s.push_back(served_s(seed));
  EXPECT_GE(share_of(all_s, 0), 0.4 * 20);
  EXPECT_LE(share_of(all_s, 1), 2 * 20 + 0.2);
  // Three standard errors of the mean.
  double mean_s = 0;
  for (const double each_s : all_s) mean_s += each_s / 40;
  EXPECT_NEAR(mean_s, 20, 3 * 6 / std::sqrt(40.0) + 0.1);
  EXPECT_GT(share_of(all_s, 0.9) - share_of(all_s, 0.1), 6);
}

TEST(Queues, RejectCheckpointsWithDuplicateAgents) {
  SmallWorld world(hall(1, 12, {kCounter}, 30), 1);
  for (int step = 0; step < 40 * kStepsPerSecond; ++step) world.crowd.step();
  const std::span<const uint32_t> line = world.crowd.queues().waiting(0);
  ASSERT_GT(line.size(), 5u);
  Archive out;
  world.crowd.archive(out);
  std::vector<uint8_t> bytes = out.bytes();
  // The list as stored: its length, then ids.
  Archive pattern;
  std::vector<uint32_t> ids(line.begin(), line.end());
  pattern(ids);
  const auto at =
      std::search(bytes.begin(), bytes.end(), pattern.bytes().begin(), pattern.bytes().end());
  ASSERT_NE(at, bytes.end());
  std::copy(at + 8, at + 12, at + 12);
  SmallWorld other(hall(1, 12, {kCounter}, 30), 1);
  Archive in(bytes, "test");
  EXPECT_THROW(other.crowd.archive(in), InputError);
}

}  // namespace
}  // namespace throng::queues_test
