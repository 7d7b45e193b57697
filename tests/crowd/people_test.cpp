// Tests of people: speeds and heights by age, and frequencies of ages.
#include "crowd/people.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "crowd/spawn.h"
#include "scenes/file/scene.h"
#include "scenes/run/simulation.h"

namespace throng::people_test {
namespace {

constexpr uint64_t kSeed = 77;
constexpr uint64_t kDraws = 4000;

double mean_of(const Distribution& distribution, Purpose purpose) {
  double sum = 0;
  for (uint64_t id = 0; id < kDraws; ++id) {
    const double value = draw(distribution, kSeed, id, purpose);
    EXPECT_GE(value, distribution.min);
    EXPECT_LE(value, distribution.max);
    sum += value;
  }
  return sum / static_cast<double>(kDraws);
}

TEST(People, FollowTheDistributionsOfTheirAge) {
  for (size_t i = 0; i < kAgeCount; ++i) {
    const AgeGroup& age = age_group(static_cast<Age>(i));
    SCOPED_TRACE(fmt::format("{}, seed {}", age.name, kSeed));
    // Five standard errors, plus the shift of the mean by truncating an asymmetric range.
    const auto allowed = [](const Distribution& d) {
      return (5 / std::sqrt(static_cast<double>(kDraws)) + 0.03) * d.std_dev;
    };
    EXPECT_NEAR(mean_of(age.speed_mps, Purpose::kDesiredSpeed), age.speed_mps.mean,
                allowed(age.speed_mps));
    EXPECT_NEAR(mean_of(age.height_m, Purpose::kHeight), age.height_m.mean, allowed(age.height_m));
  }
}

TEST(People, HaveAgesByShare) {
  const AgeShares shares = {0, 1, 0, 3, 4, 0};
  std::map<Age, int> drawn;
  for (uint64_t id = 0; id < kDraws; ++id) ++drawn[draw_age(shares, kSeed, id)];
  ASSERT_EQ(drawn.size(), 3u);
  for (const auto& [age, count] : drawn) {
    const double share = shares[static_cast<size_t>(age)] / 8;
    const double deviation = std::sqrt(kDraws * share * (1 - share));
    EXPECT_NEAR(count, kDraws * share, 5 * deviation) << age_group(age).name << ", seed " << kSeed;
  }
}

TEST(People, HaveSeveralAgesInAMixOnly) {
  EXPECT_FALSE(ages_of("old").has_value());
  EXPECT_FALSE(only_age(*ages_of("mixed")).has_value());
  for (size_t i = 0; i < kAgeCount; ++i) {
    const std::optional<AgeShares> only = ages_of(age_names()[i]);
    ASSERT_TRUE(only.has_value());
    EXPECT_EQ(only_age(*only), static_cast<Age>(i));
    EXPECT_EQ(draw_age(*only, kSeed, i), static_cast<Age>(i));
  }
}

/// All agents of a bundled scene with a change applied to each group.
template <typename Change>
std::vector<AgentSpec> people_of(const Change& change) {
  Scene scene = load_scene("corridor");
  for (Group& group : scene.groups) change(group);
  Workers workers(1);
  const NavigationMap map(scene, workers);
  return spawn(scene, map).people;
}

TEST(People, TakeTheAgesOfTheirGroup) {
  const std::vector<AgentSpec> adults = people_of([](Group&) {});
  const std::vector<AgentSpec> children =
      people_of([](Group& group) { group.ages = *ages_of("children"); });
  ASSERT_FALSE(children.empty());
  for (const AgentSpec& child : children) {
    EXPECT_LE(child.height_m, 1.6);
    EXPECT_LE(child.desired_speed_mps, 1.61);
    EXPECT_LT(child.radius_m, 0.21);
  }
  const std::vector<AgentSpec> marching = people_of([](Group& group) {
    group.ages = *ages_of("children");
    group.speed_mps = Distribution{1, 0, 1, 1};
  });
  for (const AgentSpec& child : marching) {
    EXPECT_LE(child.height_m, 1.6);
    EXPECT_EQ(child.desired_speed_mps, 1);
  }
  // A mix draws the age separately: its adults equal those of a group of adults.
  const std::vector<AgentSpec> mixed =
      people_of([](Group& group) { group.ages = {1, 1, 0, 0, 0, 0}; });
  int alike = 0;
  for (size_t i = 0; i < std::min(adults.size(), mixed.size()); ++i)
    alike += adults[i].height_m == mixed[i].height_m;
  EXPECT_GT(alike, 20);
}

TEST(People, HaveGaitStylesByShare) {
  std::map<GaitStyle, int> drawn;
  const StyleShares& shares = age_group(Age::kAdult).styles;
  double sum = 0;
  for (const double share : shares) sum += share;
  for (uint64_t id = 0; id < kDraws; ++id) ++drawn[draw_style(shares, kSeed, id)];
  ASSERT_EQ(drawn.size(), kGaitStyleCount) << "a crowd has agents of every style";
  for (const auto& [style, count] : drawn) {
    const double share = shares[static_cast<size_t>(style)] / sum;
    const double deviation = std::sqrt(kDraws * share * (1 - share));
    EXPECT_NEAR(count, kDraws * share, 5 * deviation)
        << parameters_of(style).name << ", seed " << kSeed;
  }
}

TEST(People, TakeTheGaitStylesOfTheirGroupUnlessExternal) {
  const std::vector<AgentSpec> marching =
      people_of([](Group& group) { group.gait_styles = styles_of("stiff"); });
  for (const AgentSpec& person : marching) EXPECT_EQ(person.style, GaitStyle::kStiff);
  const std::vector<AgentSpec> external =
      people_of([](Group& group) { group.control_channel = "MINE"; });
  for (const AgentSpec& person : external) EXPECT_EQ(person.style, GaitStyle::kPlain);
}

TEST(People, ChangeTheRunIdWithGaitStyles) {
  Scene scene = load_scene("corridor");
  const uint64_t by_age = content_hash_of(scene);
  scene.groups[0].gait_styles = age_group(Age::kAdult).styles;
  EXPECT_NE(content_hash_of(scene), by_age);
}

TEST(People, ChangeTheRunIdWithAges) {
  Scene scene = load_scene("corridor");
  const uint64_t adults = content_hash_of(scene);
  scene.groups[0].ages = *ages_of("elderly");
  EXPECT_NE(content_hash_of(scene), adults);
  scene.groups[0].ages = kAdultsOnly;
  EXPECT_EQ(content_hash_of(scene), adults);
}

}  // namespace
}  // namespace throng::people_test
