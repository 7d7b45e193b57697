// Run descriptions allow posing on another machine; unsound ones are rejected.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/random.h"
#include "lcm_io/codec/message_validation.h"
#include "synthetic_run.h"

namespace throng::description_test {
namespace {

run_description_t sent_and_received(const run_description_t& description) {
  std::vector<uint8_t> bytes(static_cast<size_t>(description.getEncodedSize()));
  description.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  run_description_t out;
  EXPECT_EQ(decode(bytes, out), "");
  return out;
}

TEST(RunDescription, ContainsSceneModelsAndMeshes) {
  SyntheticRun run({.avatars = 7, .seed = 42});
  const run_description_t got = sent_and_received(describe(run.info()));
  EXPECT_EQ(got.scene, "synthetic");
  EXPECT_EQ(got.seed, 42);
  EXPECT_EQ(got.part_volume, "ordop26");
  EXPECT_EQ(got.avatar_count, 7);
  EXPECT_EQ(got.ground_max_m[0], 60);
  EXPECT_THAT(got.groups, testing::ElementsAre("walkers", "robots"));
  EXPECT_THAT(got.control_channels, testing::ElementsAre("", "ROBOT_DRIVE"));
  EXPECT_THAT(got.group_of_avatar, testing::ElementsAre(0, 0, 1, 0, 0, 1, 0));
  ASSERT_EQ(got.obstacles.size(), 1u);
  EXPECT_EQ(got.obstacles[0].mesh.index_count, 36);
  ASSERT_EQ(got.models.size(), 2u);
  ASSERT_EQ(got.models[0].parts.size(), adult()->parts.size());
  for (size_t i = 0; i < got.models[0].parts.size(); ++i) {
    const Part& part = adult()->parts[i];
    EXPECT_EQ(got.models[0].parts[i].name, part.name);
    EXPECT_EQ(got.models[0].parts[i].mesh.coordinates_m.size(), 3 * part.mesh.vertices.size());
    EXPECT_EQ(got.models[0].parts[i].mesh.indices.size(), 3 * part.mesh.triangles.size());
  }
}

TEST(RunDescription, NamesBodiesAndParts) {
  SyntheticRun run({.avatars = 7});
  const run_description_t got = sent_and_received(describe(run.info()));
  EXPECT_EQ(body_name(got, 0), "walkers 0");
  EXPECT_EQ(body_name(got, 5), "robots 5");
  EXPECT_EQ(body_name(got, 7), "kiosk");
  EXPECT_EQ(body_name(got, 8), "body 8");
  EXPECT_EQ(part_name(got, 0, 1), adult()->parts[1].name);
  EXPECT_EQ(part_name(got, 0, kWholeBody), "");
  EXPECT_EQ(part_name(got, 0, 77), "part 77");
  EXPECT_EQ(part_name(got, 7, 0), "");
  EXPECT_TRUE(has_pair(got, PairKey(0, 5, 14, 0)));
  EXPECT_TRUE(has_pair(got, PairKey(0, 7, kWholeBody, kWholeBody)));
  EXPECT_FALSE(has_pair(got, PairKey(0, 1, 15, 0))) << "an adult has 15 parts";
  EXPECT_FALSE(has_pair(got, PairKey(0, 7, 0, 1))) << "an obstacle has one";
  EXPECT_FALSE(has_pair(got, PairKey(0, 8, 0, 0)));
}

TEST(RunDescription, GivesModelsWithEqualPoses) {
  constexpr uint64_t kSeed = 8;
  SyntheticRun run({.avatars = 3});
  const run_description_t got = sent_and_received(describe(run.info()));
  for (size_t m = 0; m < run.info().models.size(); ++m) {
    const Model& expected = *run.info().models[m];
    const auto found = to_model(got.models[m]);
    ASSERT_EQ(found->kinematics.column_count(), expected.kinematics.column_count());
    const auto columns = static_cast<size_t>(expected.kinematics.column_count());
    std::vector<PartPose> a(expected.parts.size()), b(expected.parts.size());
    for (uint64_t trial = 0; trial < 200; ++trial) {
      std::vector<float> posture(columns);
      for (size_t c = 0; c < columns; ++c) {
        const JointColumn& column = expected.kinematics.columns()[c];
        posture[c] = static_cast<float>(
            random_uniform({kSeed, trial, m, Purpose::kStyle}, static_cast<double>(column.lower),
                           static_cast<double>(column.upper), static_cast<uint32_t>(c)));
        ASSERT_EQ(found->kinematics.columns()[c].name, column.name);
      }
      const RootFrame root{Eigen::Quaternionf::Identity(), 1.1f};
      forward_kinematics(expected.kinematics, posture, {&root, 1}, a);
      forward_kinematics(found->kinematics, posture, {&root, 1}, b);
      for (size_t p = 0; p < a.size(); ++p)
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 4; ++c)
            ASSERT_NEAR(a[p].rows[r][c], b[p].rows[r][c], 2e-6)
                << expected.name << " part " << p << ", seed " << kSeed << " trial " << trial;
    }
  }
}

TEST(RunDescription, HasRangesThatCoverTheLimits) {
  const auto ranges = column_ranges(*rover());
  const FlatModel& flat = rover()->kinematics;
  const auto at = [&](const char* name) {
    return ranges[static_cast<size_t>(flat.column_of(name))];
  };
  EXPECT_TRUE(at("axle").wraps);
  EXPECT_FALSE(at("mast").wraps);
  EXPECT_NEAR(at("mast").middle, 0.4, 1e-7);
  EXPECT_NEAR(at("mast").half, 0.4, 1e-7);
  EXPECT_NEAR(at("shoulder").middle, 0.45, 1e-7);
  EXPECT_NEAR(at("shoulder").half, 1.65, 1e-7);
}

TEST(RunDescription, IsRejectedWithAReasonForEveryDefect) {
  SyntheticRun run({.avatars = 4, .crowd = SyntheticRun::Crowd::kRovers});
  const run_description_t sound = describe(run.info());
  ASSERT_EQ(defect_of(sound), "");
  using Breaker = std::function<void(run_description_t&)>;
  const std::pair<const char*, Breaker> cases[] = {
      {"schema", [](auto& d) { d.schema = 99; }},
      {"step", [](auto& d) { d.step_s = std::nan(""); }},
      {"number", [](auto& d) { d.ground_min_m[0] = 1e300; }},
      {"obstacle kind", [](auto& d) { d.obstacles[0].kind = 4; }},
      {"without an outline", [](auto& d) { d.floor.emplace_back(); }},
      {"ring of 2",
       [](auto& d) {
         d.floor.push_back({1, {2}, 4, {0, 0, 1, 0}});
       }},
      {"4 coordinates for 3",
       [](auto& d) {
         d.floor.push_back({1, {3}, 4, {0, 0, 1, 0}});
       }},
      {"number",
       [](auto& d) {
         d.floor.push_back({1, {3}, 6, {0, 0, 1, 0, 1, 1e300}});
       }},
      {"vertex 8 of 8", [](auto& d) { d.obstacles[0].mesh.indices[0] = 8; }},
      {"coordinate", [](auto& d) { d.obstacles[0].mesh.coordinates_m[0] = std::nanf(""); }},
      {"model 1 of 1", [](auto& d) { d.model_of_avatar[0] = 1; }},
      {"model -1 of 1", [](auto& d) { d.model_of_avatar[0] = -1; }},
      {"group 2 of 2", [](auto& d) { d.group_of_avatar[3] = 2; }},
      {"scale", [](auto& d) { d.scale_of_avatar[0] = 0; }},
      {"joint kind", [](auto& d) { d.models[0].joints[0].kind = 4; }},
      {"parent link", [](auto& d) { d.models[0].joints[0].parent_link = 1; }},
      {"axis", [](auto& d) { d.models[0].joints[0].axis[1] = 0; }},
      {"rotation", [](auto& d) { d.models[0].joints[0].rotation_wxyz[0] = 2; }},
      {"limit", [](auto& d) { d.models[0].joints[2].lower = 9; }},
      {"same name", [](auto& d) { d.models[0].joints[1].name = d.models[0].joints[0].name; }},
      {"empty name", [](auto& d) { d.models[0].root_link.clear(); }},
      {"mimic of joint 77", [](auto& d) { d.models[0].joints[3].mimic_joint = 77; }},
      {"mimic of joint 3", [](auto& d) { d.models[0].joints[3].mimic_joint = 3; }},
      {"mimic of a fixed", [](auto& d) { d.models[0].joints[3].mimic_joint = 4; }},
      {"column", [](auto& d) { d.models[0].joints[0].column = 5; }},
      {"link 6", [](auto& d) { d.models[0].parts[0].link = 6; }},
  };
  for (const auto& [reason, damage] : cases) {
    run_description_t broken = sound;
    damage(broken);
    EXPECT_THAT(defect_of(broken), testing::HasSubstr(reason));
  }
}

}  // namespace
}  // namespace throng::description_test
