// Runs with a custom motion source.
#include <gtest/gtest.h>

#include "scenes/run/posing.h"
#include "scenes/run/simulation.h"

namespace throng::custom_motion_test {
namespace {

/// Two adults who face each other and approach, with arms at their sides or lifted forwards.
class TwoWhoMeet final : public MotionSource {
 public:
  TwoWhoMeet(float arms_rad, uint64_t hash) : hash_(hash), models_{load_model(adult_urdf())} {
    const FlatModel& kinematics = models_.front()->kinematics;
    row_.resize(static_cast<size_t>(kinematics.column_count()));
    for (const char* joint : {"right_shoulder_flexion", "left_shoulder_flexion"})
      row_[static_cast<size_t>(kinematics.column_of(joint))] = arms_rad;
  }
  const std::vector<std::shared_ptr<const Model>>& models() const override { return models_; }
  void place(BodyStates& bodies) override {
    bodies.types = {0, 0};
    bodies.scales = {1, 1};
    bodies.phases = {0, 0};
    bodies.external_rows = {row_.data(), row_.data()};
  }
  void describe(RunInfo& info) const override {
    info.groups = {"external"};
    info.control_channels = {""};
    info.group_of_avatar = {0, 0};
  }
  void step() override { apart_m_ -= 0.1; }
  void update(const Posing&, BodyStates& bodies, std::span<float>) override {
    bodies.roots[0].position_m.x() = -0.5 * apart_m_;
    bodies.roots[1] = {{0.5 * apart_m_, 0, 0}, Eigen::Quaternionf(0, 0, 0, 1)};
  }
  void archive(Archive& a) override { a(apart_m_); }
  uint64_t content_hash() const override { return hash_; }

 private:
  uint64_t hash_;
  std::vector<std::shared_ptr<const Model>> models_;
  std::vector<float> row_;
  double apart_m_ = 2;
};

Simulation external_run(float arms_rad, uint64_t hash) {
  Scene scene;
  scene.name = "external";
  scene.exact = true;
  SimulationOptions options;
  options.motion = [=](const Scene&, SimdTarget, Workers&) {
    return std::make_unique<TwoWhoMeet>(arms_rad, hash);
  };
  return {std::move(scene), options};
}

int frame_of_contact(Simulation simulation) {
  for (int frame = 0; frame < 20; ++frame)
    if (!simulation.step().pairs.empty()) return frame;
  return -1;
}

TEST(CustomMotion, AppliesExternalPostures) {
  const int still = frame_of_contact(external_run(0, 0));
  const int reaching = frame_of_contact(external_run(1.5f, 0));
  EXPECT_GT(still, 14) << "bodies touch at about 0.4 m";
  EXPECT_GT(reaching, 1) << "arms are shorter than 1 m";
  EXPECT_LT(reaching, 12) << "hands meet at more than 0.8 m";
}

TEST(CustomMotion, ContributesToTheRunId) {
  EXPECT_EQ(external_run(0, 1).info().run_id, external_run(0, 1).info().run_id);
  EXPECT_NE(external_run(0, 1).info().run_id, external_run(0, 2).info().run_id);
  EXPECT_NE(external_run(0, 1).info().run_id, external_run(0, 0).info().run_id);
}

TEST(CustomMotion, ResumesFromACheckpoint) {
  Simulation whole = external_run(1.5f, 3);
  for (int i = 0; i < 5; ++i) whole.step();
  Simulation rest = external_run(1.5f, 3);
  rest.resume(whole.saved(), "test");
  for (int i = 0; i < 12; ++i) {
    const Frame& found = rest.step();
    const Frame& expected = whole.step();
    ASSERT_EQ(found.hash, expected.hash);
    ASSERT_EQ(found.roots[0].position_m, expected.roots[0].position_m);
  }
}

}  // namespace
}  // namespace throng::custom_motion_test
