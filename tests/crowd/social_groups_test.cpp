// Tests of social groups: members start and enter together, stay together, walk abreast or in file,
// and wait for each other for a limited time.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "tests/crowd/crowd_world.h"
#include "tests/scenes/same_walk.h"

namespace throng::social_groups_test {
namespace {

constexpr int kStepsPerSecond = 30;
constexpr SocialGroupRule kAllInPairs{1, {1, 0, 0}};
constexpr SocialGroupRule kAllInThrees{1, {0, 1, 0}};
constexpr SocialGroupRule kAllInFours{1, {0, 0, 1}};

/// Ids by social group.
std::vector<std::vector<uint32_t>> groups_of(const SmallWorld& world) {
  std::map<uint32_t, std::vector<uint32_t>> by_number;
  for (uint32_t id = 0; id < world.spawned.people.size(); ++id)
    if (world.spawned.people[id].social_group != AgentSpec::kAlone)
      by_number[world.spawned.people[id].social_group].push_back(id);
  std::vector<std::vector<uint32_t>> all;
  for (auto& [number, ids] : by_number) all.push_back(std::move(ids));
  return all;
}

bool walks(const SmallWorld& world, uint32_t id) {
  return world.crowd.journeys().state(id) == JourneyState::kWalking;
}

/// Distance to the nearest walking member; none without one.
std::optional<double> nearest_m(const SmallWorld& world, const std::vector<uint32_t>& social_group,
                                uint32_t id) {
  std::optional<double> min;
  for (const uint32_t other : social_group) {
    if (other == id || !walks(world, other)) continue;
    const double away_m = (world.crowd.positions_m()[other] - world.crowd.positions_m()[id]).norm();
    if (!min || away_m < *min) min = away_m;
  }
  return min;
}

/// Person-steps of walking members, and those within 3 m of another.
struct Togetherness {
  int steps = 0, near = 0;

  void look(const SmallWorld& world, const std::vector<std::vector<uint32_t>>& groups) {
    for (const std::vector<uint32_t>& social_group : groups)
      for (const uint32_t id : social_group) {
        if (!walks(world, id)) continue;
        const std::optional<double> away_m = nearest_m(world, social_group, id);
        if (!away_m) continue;
        ++steps;
        near += *away_m < 3;
      }
  }
  double share() const { return static_cast<double>(near) / steps; }
};

class SocialGroupsByModel : public testing::TestWithParam<SteeringKind> {
 protected:
  Scene with_model(Scene scene) const {
    scene.steering.model = GetParam();
    scene.step_s = 1.0 / kStepsPerSecond;
    return scene;
  }
  static void print(const char* what, double value) {
    fmt::print("social_groups {} {} {:.3f}\n", name_of(GetParam()), what, value);
  }
};

Scene open_square(uint64_t seed, const SocialGroupRule& rule, int people) {
  Scene scene;
  scene.seed = seed;
  scene.ground = {{-30, -12}, {30, 12}};
  scene.groups = {group(people, {{-29, -11}, {-20, 11}}, {{{20, -11}, {29, 11}}})};
  scene.groups[0].on_arrival = OnArrival::kLeave;
  scene.groups[0].social_groups = rule;
  return scene;
}

/// Means over neighbours in a row: distance, angle to abreast, and lag of the inner ones.
struct RowMeasure {
  double distance_m = 0, off_deg = 0, behind_m = 0;
  int pairs = 0, inner = 0;
};

RowMeasure measure_rows(SmallWorld& world, double from_s, double to_s) {
  RowMeasure m;
  const auto groups = groups_of(world);
  for (int step = 0; step < to_s * kStepsPerSecond; ++step) {
    world.crowd.step();
    if (step < from_s * kStepsPerSecond) continue;
    for (const std::vector<uint32_t>& social_group : groups) {
      if (!std::all_of(social_group.begin(), social_group.end(),
                       [&](uint32_t id) { return walks(world, id); }))
        continue;
      std::vector<Eigen::Vector2d> at;
      for (const uint32_t id : social_group) at.push_back(world.crowd.positions_m()[id]);
      std::sort(at.begin(), at.end(), [](const auto& a, const auto& b) { return a.y() < b.y(); });
      for (size_t i = 1; i < at.size(); ++i) {
        const Eigen::Vector2d apart = at[i] - at[i - 1];
        m.distance_m += apart.norm();
        m.off_deg += std::abs(std::atan2(apart.x(), apart.y())) * 180 / std::numbers::pi;
        ++m.pairs;
      }
      for (size_t i = 1; i + 1 < at.size(); ++i) {
        m.behind_m += 0.5 * (at.front().x() + at.back().x()) - at[i].x();
        ++m.inner;
      }
    }
  }
  m.distance_m /= m.pairs;
  m.off_deg /= m.pairs;
  if (m.inner > 0) m.behind_m /= m.inner;
  return m;
}

TEST_P(SocialGroupsByModel, WalkAbreastAndThreesInAFlatV) {
  // Moussaid et al. (2010) and Zanlungo et al. (2014) observed 0.75 to 0.8 m between neighbours.
  for (const SocialGroupRule& rule : {kAllInPairs, kAllInThrees, kAllInFours}) {
    double mean_m = 0;
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      SmallWorld world(with_model(open_square(seed, rule, 24)), 1);
      const RowMeasure m = measure_rows(world, 5, 25);
      EXPECT_GT(m.distance_m, 0.7);
      EXPECT_LT(m.distance_m, 0.9);
      EXPECT_LT(m.off_deg, rule.sizes[0] > 0 ? 10 : 20);
      if (m.inner > 0) {
        EXPECT_GT(m.behind_m, 0.02) << "no V";
        EXPECT_LT(m.behind_m, 0.3);
      }
      mean_m += m.distance_m / 3;
    }
    print("apart_m", mean_m);
  }
}

TEST_P(SocialGroupsByModel, StayTogetherInACrossingCrowd) {
  Togetherness found;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    Scene scene = with_model(crossing(seed, 160));
    for (Group& each : scene.groups) each.social_groups = SocialGroupRule{};
    SmallWorld world(scene, 2);
    const auto groups = groups_of(world);
    for (int step = 0; step < 60 * kStepsPerSecond; ++step) {
      world.crowd.step();
      if (step % 10 == 0) found.look(world, groups);
    }
    EXPECT_LT(world.crowd.counters().longest_stall_s, 10) << "seed " << seed;
  }
  EXPECT_GT(found.steps, 40'000);
  EXPECT_GT(found.share(), 0.95);
  print("crossing", found.share());
}

/// Two rooms with a door in a wall of this thickness; then 20 m more to the goal.
Scene behind_a_door(uint64_t seed, double width_m, double thick_m, const SocialGroupRule& rule,
                    int people) {
  Scene scene;
  scene.seed = seed;
  scene.ground = {{-10, -4}, {25 + thick_m, 4}};
  const double side_m = 4 - width_m / 2;
  scene.obstacles = {box(thick_m / 2, -4 + side_m / 2, thick_m, side_m),
                     box(thick_m / 2, 4 - side_m / 2, thick_m, side_m)};
  scene.groups = {
      group(people, {{-9, -3.5}, {-3, 3.5}}, {{{22 + thick_m, -3}, {24 + thick_m, 3}}})};
  scene.groups[0].on_arrival = OnArrival::kLeave;
  scene.groups[0].social_groups = rule;
  return scene;
}

TEST_P(SocialGroupsByModel, PassADoorTogether) {
  Togetherness all, behind;
  for (const SocialGroupRule& rule : {kAllInPairs, kAllInThrees, kAllInFours})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SmallWorld world(with_model(behind_a_door(seed, 1, 0.3, rule, 24)), 1);
      const auto groups = groups_of(world);
      for (int step = 0;
           step < 120 * kStepsPerSecond && world.crowd.population().counters().present > 0;
           ++step) {
        world.crowd.step();
        all.look(world, groups);
        for (const std::vector<uint32_t>& social_group : groups)
          if (std::all_of(social_group.begin(), social_group.end(),
                          [&](uint32_t id) { return world.crowd.positions_m()[id].x() > 10; }))
            behind.look(world, {social_group});
      }
      EXPECT_EQ(world.crowd.population().counters().left, 24u) << "seed " << seed;
    }
  EXPECT_GT(all.share(), 0.95);
  EXPECT_GT(behind.share(), 0.98);
  print("door", all.share());
}

TEST_P(SocialGroupsByModel, WalkInFileInANarrowPassage) {
  for (const SocialGroupRule& rule : {kAllInPairs, kAllInThrees, kAllInFours})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      const int people = rule.sizes[1] > 0 ? 3 : 4;
      SmallWorld world(with_model(behind_a_door(seed, 1, 6, rule, people)), 1);
      const auto groups = groups_of(world);
      Togetherness all;
      double along_m = 0, aside_m = 0;
      int count = 0;
      const auto is_inside = [&](uint32_t id) {
        const double x_m = world.crowd.positions_m()[id].x();
        return x_m > 1 && x_m < 5;
      };
      for (int step = 0; step < 60 * kStepsPerSecond; ++step) {
        world.crowd.step();
        all.look(world, groups);
        for (const std::vector<uint32_t>& social_group : groups)
          for (size_t i = 1; i < social_group.size(); ++i) {
            if (!is_inside(social_group[i]) || !is_inside(social_group[i - 1])) continue;
            const Eigen::Vector2d apart = world.crowd.positions_m()[social_group[i]] -
                                          world.crowd.positions_m()[social_group[i - 1]];
            along_m += std::abs(apart.x());
            aside_m += std::abs(apart.y());
            ++count;
          }
      }
      EXPECT_GT(along_m / count, 0.65);
      EXPECT_LT(aside_m / count, 0.35);
      EXPECT_GT(all.share(), 0.95);
      EXPECT_EQ(world.crowd.population().counters().present, 0u);
    }
}

TEST_P(SocialGroupsByModel, TurnACornerTogether) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene;
    scene.seed = seed;
    scene.ground = {{0, 0}, {20, 20}};
    scene.obstacles = {box(8, 12, 16, 16)};
    scene.groups = {group(24, {{0.5, 0.5}, {6, 3.5}}, {{{16.5, 17}, {19.5, 19.5}}})};
    scene.groups[0].on_arrival = OnArrival::kLeave;
    scene.groups[0].social_groups = SocialGroupRule{1, {1, 1, 1}};
    SmallWorld world(with_model(scene), 1);
    const auto groups = groups_of(world);
    Togetherness all;
    for (int step = 0; step < 90 * kStepsPerSecond; ++step) {
      world.crowd.step();
      all.look(world, groups);
    }
    EXPECT_EQ(world.crowd.population().counters().present, 0u);
    EXPECT_GT(all.share(), 0.98);
  }
}

/// One member is stopped after some seconds.
TEST_P(SocialGroupsByModel, WaitForAStoppedMemberForALimitedTime) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallWorld world(with_model(open_square(seed, kAllInThrees, 3)), 1);
    ASSERT_EQ(groups_of(world).size(), 1u);
    const uint32_t stopped = 1, other = 2;
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    for (int step = 0; step < 120 * kStepsPerSecond; ++step) {
      world.crowd.step();
      const double now_s = static_cast<double>(step) / kStepsPerSecond;
      if (now_s < 8) place = world.crowd.positions_m()[stopped];
      if (now_s >= 8)
        world.crowd.override_motion(stopped, place, Eigen::Vector2d::UnitX(),
                                    Eigen::Vector2d::Zero());
      const double ahead_m = (world.crowd.positions_m()[other] - place).norm();
      if (now_s > 14 && now_s < 35) {
        EXPECT_LT(ahead_m, 5) << "went on without after " << now_s << " s";
        EXPECT_LT(world.crowd.velocities_mps()[other].norm(), 0.3) << "after " << now_s << " s";
      }
      if (now_s > 30 && now_s < 35) {
        EXPECT_GT(world.crowd.headings()[other].dot(
                      (place - world.crowd.positions_m()[other]).normalized()),
                  0.8)
            << "does not look back";
      }
    }
    EXPECT_EQ(world.crowd.population().counters().left, 2u);
    EXPECT_LT(world.crowd.counters().longest_stall_s, 125);
  }
}

TEST_P(SocialGroupsByModel, ContinueWhenADoorDividesThem) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = with_model(behind_a_door(seed, 1, 0.3, kAllInFours, 8));
    scene.doors = {{"door", {0.15, -0.5}, {0.15, 0.5}, {}, {{6, "", 0}}}};
    SmallWorld world(scene, 1);
    for (int step = 0; step < 120 * kStepsPerSecond; ++step) world.crowd.step();
    int through = 0;
    for (uint32_t id = 0; id < 8; ++id) through += world.crowd.positions_m()[id].x() > 0.5;
    EXPECT_EQ(world.crowd.population().counters().left, static_cast<uint64_t>(through));
  }
}

TEST_P(SocialGroupsByModel, AreIndependentOfThreadsAndCheckpoints) {
  Scene scene = with_model(crossing(7, 200));
  for (Group& each : scene.groups) each.social_groups = SocialGroupRule{0.8, {1, 1, 1}};
  scene.groups[0].sources = {{{{-14, 11}, {14, 14.5}}, 30, 4, 1, true}};
  scene.groups[1].on_arrival = OnArrival::kLeave;
  expect_same_walk(scene, 400, 400);
}

INSTANTIATE_TEST_SUITE_P(Models, SocialGroupsByModel,
                         testing::Values(SteeringKind::kOrca, SteeringKind::kCollisionFreeSpeed,
                                         SteeringKind::kHeuristic),
                         [](const auto& each) { return std::string(name_of(each.param)); });

TEST(SocialGroups, FollowTheRuleAndShareSpeedAndDelay) {
  int people = 0, together = 0;
  std::array<int, 5> groups_by_size{};
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Scene scene;
    scene.seed = seed;
    scene.ground = {{-40, -40}, {40, 40}};
    scene.groups = {group(500, {{-39, -39}, {0, 39}}, {{{20, -39}, {39, 39}}})};
    scene.groups[0].social_groups = SocialGroupRule{0.6, {0.5, 0.3, 0.2}};
    scene.groups[0].premovement_s = {3, 2, 0, 8};
    SmallWorld world(scene, 1);
    people += static_cast<int>(world.spawned.people.size());
    for (const std::vector<uint32_t>& social_group : groups_of(world)) {
      ++groups_by_size.at(social_group.size());
      together += static_cast<int>(social_group.size());
      const AgentSpec& first = world.spawned.people[social_group[0]];
      EXPECT_EQ(social_group.back() - social_group.front(), social_group.size() - 1)
          << "ids with a gap";
      for (const uint32_t id : social_group) {
        EXPECT_EQ(world.spawned.people[id].desired_speed_mps, first.desired_speed_mps);
        EXPECT_EQ(world.spawned.people[id].premovement_s, first.premovement_s);
        EXPECT_LT((world.spawned.people[id].position_m - first.position_m).norm(), 3);
      }
    }
  }
  EXPECT_EQ(people, 5000);
  // Three standard deviations.
  EXPECT_NEAR(static_cast<double>(together) / people, 0.6, 0.04);
  const double groups = groups_by_size[2] + groups_by_size[3] + groups_by_size[4];
  EXPECT_NEAR(groups_by_size[2] / groups, 0.5, 0.05);
  EXPECT_NEAR(groups_by_size[3] / groups, 0.3, 0.045);
}

TEST(SocialGroups, EnterTogether) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = open_square(seed, kAllInPairs, 0);
    scene.step_s = 1.0 / kStepsPerSecond;
    scene.groups[0].sources = {{{{-29, -11}, {-26, 11}}, 30, 2, 0, true}};
    SmallWorld world(scene, 1);
    const auto groups = groups_of(world);
    ASSERT_EQ(groups.size(), 15u);
    std::vector<uint8_t> seen(30, 0);
    int near = 0, entered = 0;
    for (int step = 0; step < 40 * kStepsPerSecond; ++step) {
      world.crowd.step();
      for (const std::vector<uint32_t>& social_group : groups) {
        if (seen[social_group[0]] != 0 || world.crowd.population().present()[social_group[1]] == 0)
          continue;
        seen[social_group[0]] = 1;
        ++entered;
        near += (world.crowd.positions_m()[social_group[0]] -
                 world.crowd.positions_m()[social_group[1]])
                    .norm() < 2;
      }
    }
    EXPECT_EQ(entered, 15);
    EXPECT_GE(near, 14);
  }
}

TEST(SocialGroups, ChooseNearbyPlaces) {
  Scene scene = open_square(3, kAllInFours, 40);
  scene.groups[0].on_arrival = OnArrival::kStay;
  scene.step_s = 1.0 / kStepsPerSecond;
  SmallWorld world(scene, 1);
  for (int step = 0; step < 150 * kStepsPerSecond; ++step) world.crowd.step();
  for (const std::vector<uint32_t>& social_group : groups_of(world))
    for (const uint32_t id : social_group) {
      EXPECT_EQ(world.crowd.journeys().state(id), JourneyState::kStaying);
      EXPECT_LT((world.crowd.positions_m()[id] - world.crowd.positions_m()[social_group[0]]).norm(),
                3);
    }
}

}  // namespace
}  // namespace throng::social_groups_test
