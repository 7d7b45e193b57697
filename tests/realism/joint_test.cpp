// Tests joint speeds and arm swing against known motion.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "bench/realism/joints.h"
#include "bench/realism/measured_run.h"
#include "scenes/motion/walk.h"

namespace throng::realism::joint_test {
namespace {

/// One adult whose joints and root are set by the test.
class Puppet {
 public:
  Puppet() {
    run_.models = {load_model(adult_urdf())};
    run_.model_of_avatar = {0};
    run_.scale_of_avatar = {1};
    run_.step_s = 0.02;
    row_.assign(static_cast<size_t>(run_.models[0]->kinematics.column_count()), 0);
    offsets_ = {0, row_.size()};
    speeds_.begin(run_);
  }
  float& joint(const std::string& name) {
    return row_[static_cast<size_t>(run_.models[0]->kinematics.column_of(name))];
  }
  void turn_to(double heading_rad) {
    const SinCos turn = sin_cos(heading_rad);
    root_.world_from_root = rotation_to({turn.cos, turn.sin});
  }
  void show(float speed_mps = 0) {
    Frame frame;
    frame.number = number_++;
    frame.roots = {&root_, 1};
    frame.postures = row_;
    frame.posture_offsets = offsets_;
    frame.speeds_mps = {&speed_mps, 1};
    frame.present = {&present, 1};
    speeds_.frame(run_, frame);
  }
  const JointMotion& motion(const std::string& name) const { return speeds_.joints().at(name); }
  const JointSpeeds& speeds() const { return speeds_; }
  double step_s() const { return run_.step_s; }
  RootPose& root() { return root_; }

  uint8_t present = 1;

 private:
  RunInfo run_;
  RootPose root_;
  std::vector<float> row_;
  std::vector<size_t> offsets_;
  JointSpeeds speeds_;
  int64_t number_ = 0;
};

TEST(JointSpeeds, MeasuresTheSpeedOfAJoint) {
  for (const double degps : {10.0, 123.0, 700.0}) {
    Puppet puppet;
    for (int i = 0; i < 20; ++i) {
      puppet.joint("left_elbow_flexion") =
          static_cast<float>(i * puppet.step_s() * degps * kDegree);
      puppet.show();
    }
    const JointMotion& elbow = puppet.motion("elbow_flexion");
    EXPECT_EQ(elbow.speeds.count(), 2 * 19u) << "left and right, from the second frame on";
    EXPECT_NEAR(elbow.speeds.max(), degps, 1e-2);
    EXPECT_NEAR(elbow.speeds.sum(), 19 * degps, 0.1) << "the right one rests";
    EXPECT_LT(elbow.accelerations.max(), 2) << "rounding of floats alone";
    EXPECT_EQ(elbow.over_speed, degps > limit_of("elbow_flexion")->speed_per_s ? 19u : 0u);
    EXPECT_EQ(puppet.speeds().frames_over_speed(BodyHalf::kUpper), elbow.over_speed);
    EXPECT_EQ(puppet.speeds().frames_over_speed(BodyHalf::kLegs), 0u);
    EXPECT_EQ(puppet.motion("knee_flexion").speeds.max(), 0);
  }
}

TEST(JointSpeeds, MeasuresTheAccelerationOfASwing) {
  Puppet puppet;
  const double amplitude_rad = 0.3, omega = 5;
  for (int i = 0; i < 200; ++i) {
    puppet.joint("thorax_yaw") =
        static_cast<float>(amplitude_rad * sin_cos(omega * i * puppet.step_s()).sin);
    puppet.show();
  }
  const JointMotion& thorax = puppet.motion("thorax_yaw");
  EXPECT_NEAR(thorax.speeds.max(), amplitude_rad * omega / kDegree, 1);
  EXPECT_NEAR(thorax.accelerations.max(), amplitude_rad * omega * omega / kDegree, 5);
}

TEST(JointSpeeds, IgnoresJumpsAndAbsences) {
  Puppet puppet;
  const auto stand = [&](double angle_rad) {
    puppet.joint("right_knee_flexion") = static_cast<float>(angle_rad);
    for (int i = 0; i < 5; ++i) puppet.show();
  };
  stand(0);
  puppet.root().position_m.x() += 1;  // 50 m/s
  stand(1);
  puppet.present = 0;
  stand(0.5);
  puppet.present = 1;
  stand(0.2);
  EXPECT_EQ(puppet.motion("knee_flexion").speeds.max(), 0);
  EXPECT_EQ(puppet.motion("knee_flexion").accelerations.max(), 0);
  EXPECT_EQ(puppet.speeds().frames(), 3 * 4u);
}

TEST(JointSpeeds, SeparatesTurnsOfStandingPeople) {
  Puppet puppet;
  double heading_rad = 3;  // over the turn of the circle
  for (int i = 0; i < 30; ++i) {
    puppet.turn_to(heading_rad);
    puppet.show(i < 10 ? 1.0f : 0.1f);
    heading_rad += (i < 10 ? 90 : -30) * kDegree * puppet.step_s();
  }
  EXPECT_EQ(puppet.speeds().turns().count(), 29u);
  EXPECT_EQ(puppet.speeds().standing_turns().count(), 20u);
  EXPECT_NEAR(puppet.speeds().turns().max(), 90, 0.01);
  EXPECT_NEAR(puppet.speeds().standing_turns().quantile(0.5), 30, 0.5);
}

TEST(JointLimits, CoverEachJointOfTheAdult) {
  const Puppet puppet;
  for (const auto& [name, motion] : puppet.speeds().joints())
    EXPECT_NE(limit_of(name), nullptr) << name;
  EXPECT_EQ(joint_limits().size(), puppet.speeds().joints().size());
}

/// Passes on the frames of a run with a reduced arm swing.
class Calmed final : public Sink {
 public:
  Calmed(const Simulation& simulation, float share) : swing(simulation), share_(share) {}
  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override { swing.begin(run); }
  void frame(const RunInfo& run, const Frame& frame) override {
    rows_.assign(frame.postures.begin(), frame.postures.end());
    for (size_t id = 0; id < run.model_of_avatar.size(); ++id)
      for (const char* joint : {"left_shoulder_flexion", "right_shoulder_flexion"}) {
        const int column = run.models[run.model_of_avatar[id]]->kinematics.column_of(joint);
        rows_[frame.posture_offsets[id] + static_cast<size_t>(column)] *= share_;
      }
    Frame calmed = frame;
    calmed.postures = rows_;
    swing.frame(run, calmed);
  }
  void end(const RunInfo&, const RunEnd&) override {}

  ArmSwing swing;

 private:
  float share_;
  std::vector<float> rows_;
};

TEST(ArmSwing, EqualsTheGaitStyleOfUndisturbedWalkers) {
  for (const float share : {1.0f, 0.5f}) {
    std::unique_ptr<Calmed> calmed;
    run_measured(plain_walking(5), 2, false, [&](const Simulation& simulation) {
      calmed = std::make_unique<Calmed>(simulation, share);
      return std::vector<Sink*>{calmed.get()};
    });
    const SwingSums& alone = calmed->swing.levels()[0];
    EXPECT_GT(alone.time_s, 500);
    EXPECT_NEAR(alone.share(), static_cast<double>(share), 1e-3);
    for (size_t level = 1; level < ArmSwing::kLevels; ++level)
      EXPECT_EQ(calmed->swing.levels()[level].time_s, 0);
  }
}

/// Expects 99.9 % of the frames within the limits.
void expect_within_limits(const JointSpeeds& speeds) {
  const auto share = [&](uint64_t over) {
    return static_cast<double>(over) / static_cast<double>(speeds.frames());
  };
  for (const BodyHalf half : {BodyHalf::kLegs, BodyHalf::kUpper}) {
    EXPECT_LE(share(speeds.frames_over_speed(half)), 0.001);
    EXPECT_LE(share(speeds.frames_over_acceleration(half)), 0.001);
  }
}

TEST(PlainWalking, KeepsTheLimits) {
  JointSpeeds speeds;
  std::unique_ptr<ArmSwing> swing;
  run_measured(plain_walking(5), 2, false, [&](const Simulation& simulation) {
    swing = std::make_unique<ArmSwing>(simulation);
    return std::vector<Sink*>{&speeds, swing.get()};
  });
  expect_within_limits(speeds);
  const std::string report = joint_report("plain walking", speeds, *swing);
  EXPECT_NE(report.find("knee_flexion"), std::string::npos) << report;
}

// Crowds demand most of the legs: feet land behind bodies that are pushed back, and bodies turn
// over them.
TEST(CrowdedWalking, KeepsTheLimits) {
  for (const char* scene : {"bottleneck", "crossing"}) {
    JointSpeeds speeds;
    run_measured(open_measured_run(scene, 12), 2, false,
                 [&](const Simulation&) { return std::vector<Sink*>{&speeds}; });
    EXPECT_GT(speeds.frames(), 50000u);
    SCOPED_TRACE(scene);
    expect_within_limits(speeds);
  }
}

// An audience that stands in various postures and departs.
TEST(Departure, KeepsTheLimits) {
  JointSpeeds speeds;
  run_measured(open_measured_run("concert", 14), 2, false,
               [&](const Simulation&) { return std::vector<Sink*>{&speeds}; });
  EXPECT_GT(speeds.frames(), 50000u);
  expect_within_limits(speeds);
}

}  // namespace
}  // namespace throng::realism::joint_test
