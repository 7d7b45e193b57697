// Messages: fingerprints, sizes, and equality of sent and received values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "base/random.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/run_reader.h"
#include "synthetic_run.h"
#include "throng/stamp_t.hpp"
#include "throng/step_request_t.hpp"

namespace throng::messages_test {
namespace {

// Listeners are built against these numbers. A change breaks them: state it in the changelog.
TEST(Messages, HaveTheKnownFingerprints) {
  const std::map<std::string, std::pair<int64_t, uint64_t>> golden = {
      {"run_chunk_t", {run_chunk_t::getHash(), 0xc40bb11c8af3eb40}},
      {"run_description_t", {run_description_t::getHash(), 0x28edc9c3bc372cf4}},
      {"obstacle_t", {obstacle_t::getHash(), 0xdc90ba3330d0e3c8}},
      {"polygon_t", {polygon_t::getHash(), 0x22727c9e08e1f6d8}},
      {"mesh_t", {mesh_t::getHash(), 0x3a66596cb107c4a8}},
      {"model_t", {model_t::getHash(), 0x8459d7f47a107a2a}},
      {"joint_t", {joint_t::getHash(), 0x9ba21b10d8364e58}},
      {"part_t", {part_t::getHash(), 0xe2123e5fdfbf1b33}},
      {"states_t", {states_t::getHash(), 0x8f6d31ab79743a73}},
      {"events_t", {events_t::getHash(), 0xc3c4687c6fb789ed}},
      {"touching_t", {touching_t::getHash(), 0x9eff8eb7aaa41e9d}},
      {"frame_stats_t", {frame_stats_t::getHash(), 0x50b2de6ad1c65e10}},
      {"end_t", {end_t::getHash(), 0xe798eab369bd5e12}},
      {"part_poses_t", {part_poses_t::getHash(), 0x15259622cf3c970a}},
      {"pose_command_t", {pose_command_t::getHash(), 0x0656f1a8d73bf8d0}},
      {"checksums_t", {checksums_t::getHash(), 0x1a136b47d00f1cc8}},
      {"proximity_t", {proximity_t::getHash(), 0x26092931f225daf6}},
      {"separation_t", {separation_t::getHash(), 0x6cc58951e48f1d18}},
      {"contact_points_t", {contact_points_t::getHash(), 0x8e016add1273ecf8}},
      {"step_request_t", {step_request_t::getHash(), 0x5d42ef3a2e13dfcc}},
      {"crowd_change_t", {crowd_change_t::getHash(), 0x6b0c3c312a94a0c4}},
      {"stamp_t", {stamp_t::getHash(), 0x3778b8925480d7b6}},
      {"step_reply_t", {step_reply_t::getHash(), 0xaab0b1f72bfd7db9}},
  };
  for (const auto& [name, hashes] : golden)
    EXPECT_EQ(static_cast<uint64_t>(hashes.first), hashes.second)
        << name << std::hex << ": expected " << hashes.second << ", found " << hashes.first;
}

class OptionalMessages : public testing::TestWithParam<Channel> {};

TEST_P(OptionalMessages, AreNeitherSentNorNamedWithoutRequest) {
  SyntheticRun run({.avatars = 5});
  MessageList list;
  RunEncoder encoder({}, list);
  run.play(encoder, 3);
  for (const auto& m : list.messages) {
    EXPECT_NE(m.channel, GetParam());
    const std::string bytes(m.bytes.begin(), m.bytes.end());
    EXPECT_EQ(bytes.find(name_of(GetParam())), std::string::npos) << name_of(m.channel);
  }
}

INSTANTIATE_TEST_SUITE_P(Channels, OptionalMessages,
                         testing::Values(Channel::kProximity, Channel::kSeparation,
                                         Channel::kContactPoints, Channel::kChanges),
                         [](const auto& channel) { return std::string(name_of(channel.param)); });

struct Crowd {
  int avatars;
  int pairs;
  int frames;
};
class MessageSizes : public testing::TestWithParam<Crowd> {};

TEST_P(MessageSizes, FitIntoOneDatagram) {
  const Crowd crowd = GetParam();
  SyntheticRun run({.avatars = crowd.avatars,
                    .seed = 7,
                    .pairs = crowd.pairs,
                    .comings = true,
                    .has_budget = true});
  const auto messages = messages_of(run, crowd.frames, {.part_poses = true});
  size_t largest = 0;
  std::map<Channel, int64_t> seq;
  for (const auto& m : messages) {
    largest = std::max(largest, m.bytes.size());
    MessageHeader header;
    ASSERT_EQ(read_header(m.channel, m.bytes, header), "");
    EXPECT_EQ(header.seq, seq[m.channel]++) << name_of(m.channel);
    EXPECT_EQ(header.run_id, static_cast<int64_t>(run.info().run_id));
    EXPECT_EQ(header.instance, static_cast<int64_t>(run.info().instance));
  }
  EXPECT_LE(largest, kMaxMessageBytes);
  if (crowd.avatars >= 500) {
    EXPECT_GT(largest, kMaxMessageBytes * 9 / 10) << "chunks are filled";
  }
}

INSTANTIATE_TEST_SUITE_P(Crowds, MessageSizes,
                         testing::Values(Crowd{0, 0, 2}, Crowd{1, 3, 70}, Crowd{500, 20'000, 3},
                                         Crowd{100'000, 30'000, 1}));

TEST(Messages, CarryStatesWithinHalfAQuantisationStep) {
  constexpr uint64_t kSeed = 3;
  SyntheticRun run({.avatars = 900, .seed = kSeed, .spread_m = 10'000});
  MessageList list;
  RunEncoder encoder({}, list);
  encoder.begin(run.info());
  for (int chunk = 0; chunk < encoder.target_state().description_chunks(); ++chunk)
    encoder.target_state().send_description_chunk(chunk);
  const Frame& sent = run.step();
  encoder.frame(run.info(), sent);
  RunReader reader;
  for (const auto& m : list.messages)
    ASSERT_NE(reader.take(name_of(m.channel), m.bytes), RunReader::Update::kRejected)
        << reader.rejection();
  ASSERT_EQ(reader.state().frame, 0) << "seed " << kSeed;

  double position = 0, angle = 0, speed = 0, joint = 0, allowed = 0;
  for (size_t i = 0; i < sent.roots.size(); ++i) {
    const RootPose& found = reader.state().roots[i];
    const RootPose& root = sent.roots[i];
    position = std::max(position, (found.position_m - root.position_m).cwiseAbs().maxCoeff());
    angle = std::max(
        angle, static_cast<double>(found.world_from_root.angularDistance(root.world_from_root)));
    speed = std::max(
        speed, std::abs(static_cast<double>(reader.state().speeds_mps[i] - sent.speeds_mps[i])));
    const auto ranges = column_ranges(*run.info().models[run.info().model_of_avatar[i]]);
    for (size_t c = 0; c < ranges.size(); ++c) {
      const size_t at = sent.posture_offsets[i] + c;
      const double step =
          0.5 * ranges[c].half / 32767 + 2e-7;  // and the rounding of a float near pi
      const double off =
          std::abs(static_cast<double>(reader.state().postures[at] - sent.postures[at]));
      EXPECT_LE(off, step) << "avatar " << i << " column " << c << ", seed " << kSeed;
      joint = std::max(joint, off);
      allowed = std::max(allowed, step);
    }
  }
  EXPECT_LE(position, 0.5e-4 + 1e-9);
  EXPECT_LE(angle, 6.2e-5 + 1e-3) << "angularDistance() itself loses 1e-3 near zero in float";
  EXPECT_EQ(speed, 0);
  EXPECT_GT(joint, allowed / 2) << "the largest error is near the stated bound";
  EXPECT_EQ(encoder.target_state().clamped(), 0);
}

TEST(Messages, CarryRotationsWithinTheStatedAngle) {
  constexpr uint64_t kSeed = 11;
  double worst = 0;
  for (uint64_t i = 0; i < 20'000; ++i) {
    SCOPED_TRACE(i);
    Eigen::Vector4d v;
    for (uint32_t k = 0; k < 4; ++k)
      v[k] = random_normal({kSeed, i, 0, Purpose::kStyle}, 0, 1, 2 * k);
    const Eigen::Quaternionf q(v.normalized().cast<float>());
    int32_t clamped = 0;
    const Eigen::Quaternionf back =
        rotation_of(quantised_unit(q.w(), clamped), quantised_unit(q.x(), clamped),
                    quantised_unit(q.y(), clamped), quantised_unit(q.z(), clamped));
    ASSERT_EQ(clamped, 0);
    const Eigen::Quaterniond off = q.cast<double>().conjugate() * back.cast<double>();
    worst = std::max(worst, 2 * std::asin(std::min(1.0, off.vec().norm())));
  }
  EXPECT_LT(worst, 6.2e-5) << "radians, seed " << kSeed;
  EXPECT_GT(worst, 3e-5) << "the bound is not too large";
}

TEST(Messages, ClampAndCountValuesOutOfRange) {
  int32_t clamped = 0;
  EXPECT_EQ(quantised_position(300'000, clamped), 2147483646);
  EXPECT_EQ(quantised_position(-1e300, clamped), -2147483646);
  EXPECT_EQ(quantised_position(std::nan(""), clamped), 0);
  EXPECT_EQ(clamped, 3);
  const ColumnRange knee{1, 1, false};
  EXPECT_EQ(knee.quantised_value(2.5f, clamped), 32767);
  EXPECT_EQ(clamped, 4);
  EXPECT_EQ(knee.quantised_value(2.0f, clamped), 32767);
  EXPECT_EQ(knee.quantised_value(0.0f, clamped), -32767);
  EXPECT_EQ(quantised_unit(1.0000001f, clamped), 32767);
  EXPECT_EQ(clamped, 4) << "a rounding error beyond a limit does not count";
}

TEST(Messages, WrapContinuousJoints) {
  const ColumnRange wheel{0, std::numbers::pi, true};
  int32_t clamped = 0;
  const float turned = wheel.value_of(wheel.quantised_value(100.0f, clamped));
  EXPECT_NEAR(static_cast<double>(turned), std::remainder(100.0, 2 * std::numbers::pi), 5e-5);
  EXPECT_EQ(clamped, 0);
}

TEST(Messages, CarryEventsInOrderOverAllChunks) {
  SyntheticRun run({.avatars = 500, .seed = 5, .pairs = 20'000});
  const auto messages = messages_of(run, 2);
  std::map<int64_t, std::vector<PairEvent>> found;
  for (const auto& m : messages) {
    if (m.channel != Channel::kEvents) continue;
    events_t events;
    ASSERT_EQ(decode(m.bytes, events), "");
    for (size_t i = 0; i < events.a.size(); ++i)
      found[events.frame].push_back(
          {PairKey(static_cast<uint32_t>(events.a[i]), static_cast<uint32_t>(events.b[i]),
                   events.part_a[i], events.part_b[i]),
           static_cast<EventKind>(events.kind[i]), static_cast<PairLevel>(events.level[i])});
  }
  SyntheticRun again({.avatars = 500, .seed = 5, .pairs = 20'000});
  for (int frame = 0; frame < 2; ++frame) {
    const Frame& sent = again.step();
    EXPECT_GT(sent.events.size(), 10'000u) << "more than one chunk";
    EXPECT_TRUE(std::equal(sent.events.begin(), sent.events.end(), found[frame].begin(),
                           found[frame].end()))
        << "frame " << frame;
  }
  const RunEnd end = again.finish();
  EXPECT_TRUE(std::equal(end.events.begin(), end.events.end(), found[2].begin(), found[2].end()));
}

TEST(Messages, CarryTheLevelOfEveryPair) {
  const SyntheticRun::Options options{
      .avatars = 500, .seed = 5, .pairs = 20'000, .has_budget = true};
  SyntheticRun run(options), again(options);
  std::vector<uint8_t> event_levels, levels;
  for (const auto& m : messages_of(run, 1)) {
    events_t events;
    touching_t touching;
    if (m.channel == Channel::kEvents && decode(m.bytes, events).empty() && events.frame == 0)
      event_levels.insert(event_levels.end(), events.level.begin(), events.level.end());
    if (m.channel == Channel::kTouching && decode(m.bytes, touching).empty())
      levels.insert(levels.end(), touching.level.begin(), touching.level.end());
  }
  const Frame& sent = again.step();
  ASSERT_GT(sent.pairs.size(), 10'000u) << "more than one chunk";
  EXPECT_TRUE(std::equal(sent.levels.begin(), sent.levels.end(), levels.begin(), levels.end()));
  EXPECT_TRUE(std::equal(sent.events.begin(), sent.events.end(), event_levels.begin(),
                         event_levels.end(), [](const PairEvent& event, uint8_t level) {
                           return event.level == static_cast<PairLevel>(level);
                         }));
  for (int level = 0; level < 4; ++level)
    EXPECT_GT(std::count(levels.begin(), levels.end(), level), 1000) << "level " << level;
}

TEST(Messages, HaveTheLastLevelWithoutABudget) {
  for (const bool exact : {false, true}) {
    SyntheticRun run({.pairs = 100});
    run.set_exact(exact);
    for (const auto& m : messages_of(run, 2)) {
      touching_t touching;
      if (m.channel != Channel::kTouching) continue;
      ASSERT_EQ(decode(m.bytes, touching), "");
      EXPECT_GT(touching.count, 20);
      EXPECT_THAT(touching.level, testing::Each(exact ? 3 : 2));
    }
  }
}

TEST(Messages, ContainPresenceOnlyIfAnAvatarIsAbsent) {
  SyntheticRun whole({.avatars = 50}), run({.avatars = 50, .comings = true});
  const auto presence_in = [](SyntheticRun& from) {
    for (const auto& m : messages_of(from, 1)) {
      states_t states;
      if (m.channel == Channel::kStates && decode(m.bytes, states).empty()) return states.present;
    }
    return std::vector<uint8_t>();
  };
  EXPECT_THAT(presence_in(whole), testing::IsEmpty());
  const std::vector<uint8_t> present = presence_in(run);
  ASSERT_EQ(present.size(), 50u);
  EXPECT_THAT(present, testing::Contains(0));
  EXPECT_THAT(present, testing::Contains(1));
}

TEST(Messages, KeepEveryEventWithFewerStates) {
  SyntheticRun every({.seed = 2}), fifth({.seed = 2});
  std::map<Channel, int> full, thin;
  for (const auto& m : messages_of(every, 30)) ++full[m.channel];
  for (const auto& m : messages_of(fifth, 30, {.state_every = 5})) ++thin[m.channel];
  EXPECT_EQ(full[Channel::kStates], 30);
  EXPECT_EQ(thin[Channel::kStates], 6);
  for (const Channel channel :
       {Channel::kEvents, Channel::kFrameStats, Channel::kTouching, Channel::kEnd})
    EXPECT_EQ(thin[channel], full[channel]) << name_of(channel);
}

/// Returns the frames with states in a run of `frames`, at 60 frames per second.
std::vector<int64_t> frames_with_states(double states_hz, int frames) {
  SyntheticRun run({.avatars = 3, .seed = 2});
  std::vector<int64_t> found;
  for (const auto& m : messages_of(run, frames, {.state_every = 60 / states_hz})) {
    MessageHeader header;
    if (m.channel == Channel::kStates && read_header(m.channel, m.bytes, header).empty())
      found.push_back(header.frame);
  }
  return found;
}

TEST(Messages, CarryStatesAtTheFirstFrameAfterEachMultiple) {
  EXPECT_THAT(frames_with_states(10, 20), testing::ElementsAre(0, 6, 12, 18));
  EXPECT_THAT(frames_with_states(25, 15), testing::ElementsAre(0, 3, 5, 8, 10, 12));
  EXPECT_THAT(frames_with_states(7, 28), testing::ElementsAre(0, 9, 18, 26));
  EXPECT_THAT(frames_with_states(0.1, 601), testing::ElementsAre(0, 600));
}

TEST(Messages, CarryStatesAtTheRequestedRate) {
  for (int states_hz = 1; states_hz <= 60; ++states_hz) {
    const std::vector<int64_t> found = frames_with_states(states_hz, 600);
    ASSERT_EQ(found.size(), static_cast<size_t>(10 * states_hz)) << states_hz << " per second";
    for (size_t k = 0; k < found.size(); ++k)
      EXPECT_EQ(found[k], (static_cast<int64_t>(k) * 60 + states_hz - 1) / states_hz)
          << "states " << k << " at " << states_hz << " per second";
  }
}

TEST(Messages, CarryAllTouchingPairsOncePerSecond) {
  SyntheticRun run({.seed = 2});
  std::vector<int64_t> stamps;
  for (const auto& m : messages_of(run, 200))
    if (m.channel == Channel::kTouching) stamps.push_back(m.utime_us);
  EXPECT_THAT(stamps, testing::ElementsAre(0, 1'000'000, 2'000'000, 3'000'000));
}

TEST(Messages, CarryPartPosesOfForwardKinematics) {
  SyntheticRun run({.avatars = 9, .seed = 4});
  MessageList list;
  RunEncoder encoder({.part_poses = true}, list);
  encoder.begin(run.info());
  const Frame& frame = run.step();
  encoder.frame(run.info(), frame);
  part_poses_t parts;
  for (const auto& m : list.messages)
    if (m.channel == Channel::kPartPoses) {
      ASSERT_EQ(decode(m.bytes, parts), "");
    }
  ASSERT_EQ(parts.avatar_count, 9);
  size_t at = 0;
  for (size_t i = 0; i < 9; ++i) {
    const Model& model = *run.info().models[run.info().model_of_avatar[i]];
    std::vector<PartPose> poses(model.parts.size());
    const RootFrame root{frame.roots[i].world_from_root, run.info().scale_of_avatar[i]};
    forward_kinematics(
        model.kinematics,
        frame.postures.subspan(frame.posture_offsets[i],
                               frame.posture_offsets[i + 1] - frame.posture_offsets[i]),
        {&root, 1}, poses);
    for (const PartPose& pose : poses) {
      const Eigen::Isometry3d expected = to_isometry(pose);
      const Eigen::Vector3d position(position_of(parts.x_100um[at]), position_of(parts.y_100um[at]),
                                     position_of(parts.z_100um[at]));
      EXPECT_LT((position - frame.roots[i].position_m - expected.translation()).norm(), 1e-4)
          << "part " << at;
      const Eigen::Matrix3d rotation =
          rotation_of(parts.qw[at], parts.qx[at], parts.qy[at], parts.qz[at])
              .cast<double>()
              .toRotationMatrix();
      EXPECT_LT((rotation - expected.linear()).cwiseAbs().maxCoeff(), 1e-4) << "part " << at;
      ++at;
    }
  }
  EXPECT_EQ(at, parts.qw.size());
}

}  // namespace
}  // namespace throng::messages_test
