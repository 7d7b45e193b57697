// Externally controlled avatars take commanded poses, within their bounds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <thread>

#include "base/checksum.h"
#include "base/errors.h"
#include "base/random.h"
#include "external_scene.h"
#include "lcm_io/wire/lcm_sink.h"
#include "lcm_io/wire/pose_command_receiver.h"
#include "scenes/motion/external_avatars.h"
#include "synthetic_run.h"

namespace throng::external_control_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
std::span<const float> row_of(const Frame& frame, uint32_t avatar) {
  const size_t first = frame.posture_offsets[avatar];
  return frame.postures.subspan(first, frame.posture_offsets[avatar + 1] - first);
}

ExternalPose standing_at(double x, double y) {
  ExternalPose pose;
  pose.root.position_m = {x, y, 0};
  return pose;
}

TEST(ExternalControl, IsSetByTheScene) {
  const ScratchFile file(".yaml");
  const auto load = [&file](const std::string& keys) {
    const std::string text =
        "ground: {min_m: [0, 0], max_m: [20, 10]}\n"
        "groups:\n  - {count: 1, spawn: {min_m: [1, 1], max_m: [4, 9]}, model: " +
        std::string(THRONG_SOURCE_DIR) + "/tests/lcm_io/fixtures/rover.urdf, " + keys + "}\n";
    write_bytes(file.path(), {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
    return load_scene(file.path().string());
  };
  const Scene scene = load("control_channel: ROBOT_1");
  EXPECT_EQ(scene.groups[0].control_channel, "ROBOT_1");
  EXPECT_EQ(scene.groups[0].height_m->mean, static_cast<double>(rover()->height_m));
  EXPECT_NE(load("control_channel: ROBOT_2").content_hash, scene.content_hash);
  const std::string goals = ", goals: [{min_m: [9, 1], max_m: [10, 9]}]";
  for (const std::string& wrong :
       {std::string("control_channel: THRONG_EVENTS"),
        std::string("control_channel: \"a channel\""), "control_channel: " + std::string(64, 'x'),
        "control_channel: ROBOT" + goals, std::string("control_channel: ROBOT, on_arrival: leave")})
    EXPECT_THROW(load(wrong), InputError) << wrong;
}

TEST(ExternalControl, HasAReachThatBoundsEveryPosture) {
  constexpr uint64_t kSeed = 3;
  for (const auto& model : {rover(), adult()}) {
    const auto& columns = model->kinematics.columns();
    const auto reach_m = static_cast<double>(reach_of(*model));
    std::vector<float> row(columns.size());
    std::vector<PartPose> poses(model->parts.size());
    double farthest_m = 0;
    for (uint64_t trial = 0; trial < 1000; ++trial) {
      const RandomKey key{kSeed, trial, 0, Purpose::kStyle};
      for (size_t c = 0; c < row.size(); ++c) {
        // A third each at the lower limit, at the upper limit, and in between.
        const auto where = random_bits(key, static_cast<uint32_t>(2 * c)) % 3;
        row[c] = where == 0 ? columns[c].lower
                 : where == 1
                     ? columns[c].upper
                     : static_cast<float>(random_uniform(key, static_cast<double>(columns[c].lower),
                                                         static_cast<double>(columns[c].upper),
                                                         static_cast<uint32_t>(2 * c + 1)));
      }
      const RootFrame root;
      forward_kinematics(model->kinematics, row, {&root, 1}, poses);
      for (size_t p = 0; p < poses.size(); ++p)
        for (const Eigen::Vector3f& vertex : model->parts[p].mesh.vertices)
          farthest_m = std::max(farthest_m, (to_isometry(poses[p]) * vertex.cast<double>()).norm());
    }
    EXPECT_LE(farthest_m, reach_m) << model->name << ", seed " << kSeed;
    EXPECT_GT(farthest_m, 0.4 * reach_m) << model->name << ": the bound is not too large";
  }
}

TEST(ExternalControl, HoldsEachPoseUntilTheNext) {
  Simulation simulation(rover_in_crowd(), {});
  const uint32_t id = rover_of(simulation);
  EXPECT_THAT(simulation.notes(), testing::Contains(testing::HasSubstr("controlled through "
                                                                       "LCM channel ROBOT_DRIVE")));
  EXPECT_EQ(simulation.info().control_channels.back(), kChannel);
  simulation.step();
  ExternalPose pose = standing_at(3, -2);
  pose.root.position_m.z() = 0.5;
  pose.root.world_from_root = Eigen::AngleAxisf(0.3f, Eigen::Vector3f::UnitY());
  pose.velocity_mps = {0.6, 0.8};
  const std::vector<double> joints = {0.5, 0.25, -0.75};
  pose.joints = joints;
  EXPECT_EQ(simulation.set_pose(id, pose), 0);
  for (int i = 0; i < 20; ++i) {
    const Frame& frame = simulation.step();
    EXPECT_EQ(frame.roots[id].position_m, pose.root.position_m) << "frame " << frame.number;
    EXPECT_TRUE(frame.roots[id].world_from_root.isApprox(pose.root.world_from_root, 1e-6f));
    EXPECT_FLOAT_EQ(frame.speeds_mps[id], 1);
    for (size_t c = 0; c < joints.size(); ++c)
      EXPECT_FLOAT_EQ(row_of(frame, id)[c], static_cast<float>(joints[c]));
  }
}

TEST(ExternalControl, ClampsAndCountsValuesOutOfRange) {
  Simulation simulation(rover_in_crowd(), {});
  const uint32_t id = rover_of(simulation);
  simulation.step();
  const Rectangle ground = simulation.scene().ground;
  const std::vector<double> far_joints = {7.0, 9.0, -9.0};
  ExternalPose far = standing_at(1e9, -1e9);
  far.joints = far_joints;
  EXPECT_EQ(simulation.set_pose(id, far), 4)
      << "x, y, the mast and the shoulder; the wheel is continuous";
  const Frame& frame = simulation.step();
  EXPECT_EQ(frame.roots[id].position_m.x(), ground.max_m.x());
  EXPECT_EQ(frame.roots[id].position_m.y(), ground.min_m.y());
  EXPECT_FLOAT_EQ(row_of(frame, id)[0], static_cast<float>(std::remainder(7.0, 2 * M_PI)));
  EXPECT_FLOAT_EQ(row_of(frame, id)[1], 0.8f);
  EXPECT_FLOAT_EQ(row_of(frame, id)[2], -1.2f);

  const std::vector<double> no_numbers(3, kNan);
  ExternalPose wild = standing_at(kNan, kNan);
  wild.root.position_m.z() = HUGE_VAL;
  wild.root.world_from_root.coeffs().setConstant(static_cast<float>(kNan));
  wild.velocity_mps = {kNan, 1e300};
  wild.joints = no_numbers;
  EXPECT_EQ(simulation.set_pose(id, wild), 8);
  const Frame& unchanged = simulation.step();
  EXPECT_EQ(unchanged.roots[id].position_m.x(), ground.max_m.x()) << "NaN changes nothing";
  EXPECT_FLOAT_EQ(row_of(unchanged, id)[1], 0.8f);
  EXPECT_TRUE(unchanged.roots[id].world_from_root.coeffs().allFinite());
  EXPECT_TRUE(std::isfinite(unchanged.speeds_mps[id]));

  const std::vector<double> two(2);
  ExternalPose wrong = standing_at(0, 0);
  wrong.joints = two;
  EXPECT_EQ(simulation.set_pose(id, wrong), -1) << "a rover has three columns";
  EXPECT_EQ(simulation.set_pose(0, standing_at(0, 0)), -1) << "people walk by themselves";
  EXPECT_EQ(simulation.set_pose(99'999, standing_at(0, 0)), -1);
}

/// Moves the rover in a circle among the people, with random arm positions.
void drive_in_a_circle(Simulation& simulation, int64_t frame) {
  const double t = static_cast<double>(frame) / 60;
  const RandomKey key{1, static_cast<uint64_t>(frame), 0, Purpose::kStyle};
  const std::vector<double> joints = {t, random_uniform(key, 0, 0.8, 0),
                                      random_uniform(key, -1.2, 2.1, 1)};
  ExternalPose pose = standing_at(6 * std::cos(t / 6), 6 * std::sin(t / 6));
  pose.root.world_from_root =
      Eigen::AngleAxisf(static_cast<float>(t / 6 + M_PI / 2), Eigen::Vector3f::UnitZ());
  pose.velocity_mps = {-std::sin(t / 6), std::cos(t / 6)};
  pose.joints = joints;
  ASSERT_GE(simulation.set_pose(rover_of(simulation), pose), 0);
}

TEST(ExternalControl, IsIndependentOfThreadsAndPairSearch) {
  std::vector<uint64_t> hashes;
  for (const auto& [threads, search] :
       {std::pair(1, PairSearch::kGrid), std::pair(3, PairSearch::kGrid),
        std::pair(2, PairSearch::kBrute)}) {
    SimulationOptions options;
    options.threads = threads;
    options.culler.pair_search = search;
    Simulation simulation(rover_in_crowd(), options);
    int64_t touched = 0;
    for (int64_t i = 0; i < 1500; ++i) {
      const Frame& frame = simulation.step();
      for (const PairKey& pair : frame.pairs) touched += pair.b() == rover_of(simulation) ? 1 : 0;
      drive_in_a_circle(simulation, i);
    }
    EXPECT_GT(touched, 0) << "a person touches the rover";
    hashes.push_back(simulation.finish().hash);
  }
  EXPECT_EQ(hashes[1], hashes[0]);
  EXPECT_EQ(hashes[2], hashes[0]);
}

TEST(ExternalControl, MovesAvatarsThatPeopleAvoid) {
  Simulation simulation(rover_in_crowd(), {});
  const uint32_t id = rover_of(simulation);
  int64_t deep = 0, frames = 0;
  double nearest_m = 1e9;
  for (int64_t i = 0; i < 1200; ++i) {
    const Frame& frame = simulation.step();
    double nearest_now_m = 1e9;
    for (uint32_t other = 0; other < id; ++other)
      nearest_now_m =
          std::min(nearest_now_m,
                   (frame.roots[other].position_m - frame.roots[id].position_m).head<2>().norm());
    nearest_m = std::min(nearest_m, nearest_now_m);
    deep += nearest_now_m < 0.4 ? 1 : 0;  // discs of 0.35 m and about 0.22 m
    ++frames;
    drive_in_a_circle(simulation, i);
  }
  EXPECT_LT(nearest_m, 1.5) << "they do meet";
  EXPECT_LT(deep, frames / 100)
      << "frames in which a person stands inside the rover's disc; nearest " << nearest_m << " m";
}

/// A run whose rover is controlled over LCM within one process.
struct ControlledRun {
  ControlledRun()
      : lcm(std::make_shared<lcm::LCM>("memq://")),
        simulation(rover_in_crowd(), {}),
        receiver(simulation.info(), lcm),
        id(static_cast<int32_t>(rover_of(simulation))) {}

  pose_command_t message(double x) {
    pose_command_t m{};
    m.seq = next_seq++;
    m.schema = kSchema;
    m.count = 1;
    m.avatar = {id};
    m.x_m = {x};
    m.y_m = m.z_m = {0};
    m.qw = {1};
    m.qx = m.qy = m.qz = {0};
    m.vx_mps = m.vy_mps = {0};
    m.joint_positions = {0, 0.25, 0};
    m.joint_position_count = 3;
    return m;
  }
  void send(const pose_command_t& m) { lcm->publish(kChannel, &m); }
  double x_after_a_step() {
    receiver.apply(simulation);
    return simulation.step().roots[static_cast<size_t>(id)].position_m.x();
  }
  const PoseCommandReceiver::Counts& counts() const { return receiver.counts().front(); }

  std::shared_ptr<lcm::LCM> lcm;
  Simulation simulation;
  PoseCommandReceiver receiver;
  int32_t id;
  int64_t next_seq = 0;
};

TEST(PoseCommandReceiver, AppliesTheNewestMessageAndHoldsItsPose) {
  ControlledRun run;
  const double start = run.x_after_a_step();
  EXPECT_LE(std::abs(start), 0.5) << "in its spawn area";
  run.send(run.message(1));
  run.send(run.message(2));
  EXPECT_EQ(run.x_after_a_step(), 2);
  EXPECT_EQ(run.x_after_a_step(), 2);
  EXPECT_EQ(run.counts().messages, 2);
  EXPECT_EQ(run.counts().frames, 3);
  EXPECT_EQ(run.counts().frames_without_command, 2) << "the first and the last";
}

TEST(PoseCommandReceiver, CountsMissingLateAndRejectedMessages) {
  ControlledRun run;
  run.send(run.message(1));
  const pose_command_t late = run.message(9);
  run.next_seq += 3;
  run.send(run.message(2));
  EXPECT_EQ(run.x_after_a_step(), 2);
  run.send(late);
  EXPECT_EQ(run.x_after_a_step(), 2) << "a newer one arrived before";
  pose_command_t other = run.message(5);
  other.avatar = {0};
  run.send(other);
  EXPECT_EQ(run.x_after_a_step(), 2);
  EXPECT_EQ(run.counts().rejection, "avatar 0 is not of group 'rovers'");
  pose_command_t joints = run.message(5);
  joints.joint_positions = {1};
  joints.joint_position_count = 1;
  run.send(joints);
  EXPECT_EQ(run.x_after_a_step(), 2);
  EXPECT_EQ(run.counts().rejection, "1 joint positions, expected 3");
  pose_command_t old = run.message(5);
  old.schema = 2;
  run.send(old);
  EXPECT_EQ(run.x_after_a_step(), 2);
  EXPECT_EQ(run.counts().missing, 3) << "one of the four gaps was filled late";
  EXPECT_EQ(run.counts().late, 1);
  EXPECT_EQ(run.counts().rejected, 3);
  run.next_seq = 0;  // a restarted controller
  run.send(run.message(7));
  EXPECT_EQ(run.x_after_a_step(), 7);
}

TEST(PoseCommandReceiver, RestartsTheNumberingAfterASecond) {
  ControlledRun run;
  pose_command_t wild = run.message(1);
  wild.seq = 1'000'000'000'000;
  run.send(run.message(2));
  EXPECT_EQ(run.x_after_a_step(), 2);
  run.send(wild);
  EXPECT_EQ(run.x_after_a_step(), 1);
  // It continues to send.
  testing::internal::CaptureStderr();
  const auto start = std::chrono::steady_clock::now();
  double x = 1;
  while (x != 5 && std::chrono::steady_clock::now() - start < std::chrono::seconds(20)) {
    run.send(run.message(5));
    x = run.x_after_a_step();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_GT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("note: control channel ROBOT_DRIVE: no message after number "
                                 "1000000000000 for 1."));
  EXPECT_EQ(x, 5);
  run.send(run.message(6));
  EXPECT_EQ(run.x_after_a_step(), 6);
  EXPECT_EQ(run.counts().restarts, 1);
  EXPECT_LT(run.counts().missing, 3) << "the numbers in between were never sent";
}

TEST(PoseCommandReceiver, SurvivesDamagedMessages) {
  constexpr uint64_t kSeed = 21;
  ControlledRun run;
  const pose_command_t sound = run.message(1);
  std::vector<uint8_t> bytes(static_cast<size_t>(sound.getEncodedSize()));
  sound.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  for (uint64_t round = 0; round < 20'000; ++round) {
    const RandomKey key{kSeed, round, 0, Purpose::kStyle};
    auto hit = bytes;
    for (uint32_t k = 0; k < 1 + random_bits(key, 0) % 4; ++k) {
      const size_t from = random_bits(key, 3 * k + 1) % 4 == 0 ? 0 : 28;
      hit[from + random_bits(key, 3 * k + 2) % (hit.size() - from)] =
          static_cast<uint8_t>(random_bits(key, 3 * k + 3));
    }
    if (random_bits(key, 90) % 8 == 0) hit.resize(random_bits(key, 91) % hit.size());
    run.lcm->publish(kChannel, hit.data(), static_cast<unsigned>(hit.size()));
    run.receiver.apply(run.simulation);
    if (round % 200 != 0) continue;
    const Frame& frame = run.simulation.step();
    const auto id = static_cast<size_t>(run.id);
    ASSERT_TRUE(run.simulation.scene().ground.contains(frame.roots[id].position_m.head<2>()))
        << "seed " << kSeed << " round " << round;
    ASSERT_NEAR(frame.roots[id].world_from_root.norm(), 1, 1e-5f);
    for (const float value : row_of(frame, static_cast<uint32_t>(run.id)))
      ASSERT_LE(std::abs(value), 3.2f);
  }
  EXPECT_GT(run.counts().rejected, 1000);
  EXPECT_GT(run.counts().messages, 1000);
}

TEST(PoseCommandReceiver, LeadsToContactsThatAreReceivedOverLcm) {
  ControlledRun run;
  LcmSink sink({}, run.lcm);
  int64_t contacts = 0;
  struct Context {
    int64_t* contacts;
    int32_t id;
  } context{&contacts, run.id};
  run.lcm->subscribeFunction(
      "THRONG_EVENTS",
      +[](const lcm::ReceiveBuffer*, const std::string&, const events_t* m, Context* c) {
        for (size_t i = 0; i < m->a.size(); ++i)
          *c->contacts += m->a[i] == c->id || m->b[i] == c->id ? 1 : 0;
      },
      &context);
  sink.begin(run.simulation.info());
  // Onto the position of the nearest person.
  for (int i = 0; i < 30; ++i) {
    const Frame& frame = run.simulation.step();
    sink.frame(run.simulation.info(), frame);
    pose_command_t m = run.message(frame.roots[0].position_m.x());
    m.y_m = {frame.roots[0].position_m.y()};
    run.send(m);
    run.receiver.apply(run.simulation);
  }
  while (run.lcm->handleTimeout(0) > 0) {
  }
  EXPECT_GT(contacts, 0);
}

}  // namespace
}  // namespace throng::external_control_test
