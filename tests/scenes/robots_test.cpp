// Robots and people: scale, height above the ground and steering discs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "base/errors.h"
#include "base/random.h"
#include "scenes/scenes.h"

namespace throng::robots_test {
namespace {

using testing::HasSubstr;

/// Writes a temporary robot and a scene with it.
class Robots : public testing::Test {
 protected:
  Robots()
      : folder_(std::filesystem::path(testing::TempDir()) /
                (std::string("throng_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }
  ~Robots() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  Scene scene_with(const std::string& keys) const {
    write("s.yaml",
          "ground: {min_m: [-20, -20], max_m: [20, 20]}\n"
          "groups:\n  - {name: g, count: 2, spawn: {min_m: [-9, -9], max_m: [9, 9]}, goals: "
          "[{min_m: [10, -9], max_m: [19, 9]}], " +
              keys + "}\n");
    return load_scene((folder_ / "s.yaml").string());
  }
  std::string rejection_of(const std::string& keys) const {
    try {
      scene_with(keys);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

 private:
  std::filesystem::path folder_;
};

/// Three boxes on root, lift and arm, at random positions.
std::string random_robot(uint64_t seed) {
  uint32_t index = 0;
  const auto draw = [&](double low, double high) {
    return random_uniform({seed, 0, 0, Purpose::kBoxWorld}, low, high, index++);
  };
  const auto link = [&](const char* name) {
    return fmt::format(
        "<link name='{}'><collision><origin xyz='{} {} {}' rpy='{} {} 0'/><geometry>"
        "<box size='{} {} {}'/></geometry></collision></link>",
        name, draw(-1, 1), draw(-1, 1), draw(-2, 2), draw(-3, 3), draw(-3, 3), draw(0.01, 1),
        draw(0.01, 1), draw(0.01, 1));
  };
  const double low = draw(-1, 1);
  return "<robot name='r'>" + link("base") + link("lift") + link("arm") +
         fmt::format(
             "<joint name='j' type='prismatic'><parent link='base'/><child link='lift'/>"
             "<axis xyz='0 0.6 0.8'/><limit lower='{}' upper='{}' effort='1' velocity='1'/></joint>"
             "<joint name='k' type='revolute'><parent link='lift'/><child link='arm'/>"
             "<axis xyz='0 1 0'/><limit lower='{}' upper='3' effort='1' velocity='1'/></joint>"
             "</robot>",
             low, low + 0.5, draw(-1, 1));
}

/// Lowest and highest vertex of an avatar above the ground.
std::pair<double, double> extent_of(const Simulation& simulation, const Frame& frame, size_t id) {
  const RunInfo& info = simulation.info();
  const Model& model = *info.models[info.model_of_avatar[id]];
  const size_t first = frame.posture_offsets[id];
  const RootFrame root{frame.roots[id].world_from_root, info.scale_of_avatar[id]};
  std::vector<PartPose> poses(model.parts.size());
  forward_kinematics(model.kinematics,
                     frame.postures.subspan(first, frame.posture_offsets[id + 1] - first),
                     {&root, 1}, poses);
  double low = std::numeric_limits<double>::max(), high = -low;
  for (size_t p = 0; p < poses.size(); ++p)
    for (const Eigen::Vector3f& vertex : model.parts[p].mesh.vertices) {
      const double z =
          (to_isometry(poses[p]) * (static_cast<double>(root.scale) * vertex.cast<double>())).z() +
          frame.roots[id].position_m.z();
      low = std::min(low, z);
      high = std::max(high, z);
    }
  return {low, high};
}

TEST_F(Robots, StandOnTheirLowestPoint) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    write("r.urdf", random_robot(seed));
    Simulation simulation(scene_with("model: r.urdf"), {});
    const auto height_m = static_cast<double>(simulation.info().models[0]->height_m);
    for (int i = 0; i < 3; ++i) {
      const Frame& frame = simulation.step();
      ASSERT_EQ(frame.roots.size(), 2u);
      const auto [low, high] = extent_of(simulation, frame, 1);
      EXPECT_EQ(simulation.info().scale_of_avatar[1], 1);
      EXPECT_NEAR(low, 0, 1.1e-3 * height_m);
      EXPECT_NEAR(high - low, height_m, 1.1e-3 * height_m);
    }
  }
}

TEST_F(Robots, ScaleToTheHeightOfTheScene) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    write("r.urdf", random_robot(seed));
    for (const double height_m : {0.3, 7.0}) {
      Simulation simulation(scene_with(fmt::format("model: r.urdf, height_m: {}", height_m)), {});
      const auto [low, high] = extent_of(simulation, simulation.step(), 0);
      EXPECT_NEAR(low, 0, 1.1e-3 * height_m) << "seed " << seed;
      EXPECT_NEAR(high - low, height_m, 1.1e-3 * height_m) << "seed " << seed;
    }
  }
}

TEST_F(Robots, FollowSetPose) {
  write("r.urdf", random_robot(3));
  Scene scene = scene_with("model: r.urdf");
  scene.groups[0].control_channel = "ROBOT";
  Simulation simulation(scene, {});
  EXPECT_NEAR(extent_of(simulation, simulation.step(), 0).first, 0, 5e-3);
  ExternalPose pose;
  pose.root.position_m = {1, 2, 0.25};
  EXPECT_EQ(simulation.set_pose(0, pose), 0);
  EXPECT_EQ(simulation.step().roots[0].position_m, pose.root.position_m);
}

TEST_F(Robots, DescribeSizeAndScale) {
  write(
      "r.urdf",
      "<robot name='cart'><link name='a'><collision><geometry><box size='1.2 0.6 0.5'/></geometry>"
      "</collision></link></robot>");
  const std::string own =
      "robot 'cart', 1.2 x 0.6 x 0.5 m at its own size, its root 0.25 m above the ground";
  EXPECT_EQ(describe_size(scene_with("model: r.urdf").groups[0]), own);
  EXPECT_EQ(describe_size(scene_with("model: r.urdf, height_m: 1").groups[0]),
            "robot 'cart', 2.4 x 1.2 x 1 m at scale 2, its root 0.5 m above the ground");
  EXPECT_EQ(describe_size(scene_with("desired_speed_mps: 1").groups[0]),
            "people of all heights after 'adult', which is 1.75 m tall");
  Simulation simulation(scene_with("model: r.urdf"), {});
  EXPECT_THAT(simulation.notes(), testing::Contains("group 'g': " + own));
}

TEST_F(Robots, FitIntoTheirSteeringDiscs) {
  const auto apart_m = [&](const std::string& keys, uint64_t seed) {
    Scene scene = scene_with(keys);
    scene.seed = seed;
    Simulation simulation(scene, {});
    const Frame& frame = simulation.step();
    EXPECT_EQ(frame.roots.size(), 2u);
    return (frame.roots[0].position_m - frame.roots[1].position_m).norm();
  };
  write("r.urdf",
        "<robot name='car'><link name='a'><collision><geometry><box size='3 1.6 1'/></geometry>"
        "</collision></link></robot>");
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_GE(apart_m("model: r.urdf", seed), 2 * 1.7) << "their own footprint, seed " << seed;
    EXPECT_GE(apart_m("model: r.urdf, radius_m: 2", seed), 4) << "seed " << seed;
    EXPECT_GE(apart_m("model: r.urdf, radius_m: 0.05", seed), 0.1) << "seed " << seed;
  }
  EXPECT_THAT(rejection_of("model: r.urdf, radius_m: 2.01"),
              HasSubstr("'radius_m' from 0.05 to 2"));
}

TEST_F(Robots, AndPeopleInWrongUnitsAreRejected) {
  write("r.urdf",
        "<robot name='r'><link name='a'><collision><geometry><box size='0.001 0.001 "
        "0.001'/></geometry></collision></link></robot>");
  EXPECT_EQ(rejection_of("model: r.urdf"), "accepted");
  EXPECT_EQ(rejection_of("model: r.urdf, height_m: 1"), "accepted");
  EXPECT_THAT(rejection_of("model: r.urdf, height_m: 1.01"),
              HasSubstr("s.yaml:3: expected a model at least 0.00101 m tall for avatars of 1.01 m, "
                        "found 'r' of 0.001 m; is it in other units?"));
  write(
      "r.urdf",
      "<robot name='r'><link name='a'><collision><origin xyz='0 0 9000'/><geometry><box size='9000 "
      "1 1'/></geometry></collision></link></robot>");
  EXPECT_THAT(rejection_of("model: r.urdf"),
              HasSubstr("expected a model with all parts within 10000 m of its root, found 'r'"));
  write("r.urdf",
        "<robot name='r'><link name='a'><collision><geometry><box size='1 1 "
        "9900'/></geometry></collision></link><link name='b'><collision><origin xyz='0 0 "
        "9900'/><geometry><box size='1 1 9900'/></geometry></collision></link><joint name='j' "
        "type='fixed'><parent link='a'/><child link='b'/></joint></robot>");
  EXPECT_THAT(rejection_of("model: r.urdf, height_m: 0.01"),
              HasSubstr("s.yaml:3: expected a model at most 10000 m tall for avatars of 0.01 m, "
                        "found 'r' of 19800 m; is it in other units?"));
}

}  // namespace
}  // namespace throng::robots_test
