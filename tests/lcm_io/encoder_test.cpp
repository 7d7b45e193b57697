// RunEncoder gives each target the bytes of a separate encoder.
#include <gtest/gtest.h>

#include "base/errors.h"
#include "lcm_io/codec/message_validation.h"
#include "scenes/run/stages.h"
#include "synthetic_run.h"

namespace throng::encoder_test {
namespace {

struct WholeRun : MessageList {
  void after_begin(TargetState& target_state) override {
    for (int chunk = 0; chunk < target_state.description_chunks(); ++chunk)
      target_state.send_description_chunk(chunk);
  }
  void after_end(TargetState& target_state) override {
    target_state.repeat_end();
    target_state.send_last_checksums();
  }
};

const SyntheticRun::Options kCrowd{.avatars = 900, .seed = 5, .pairs = 300, .comings = true};

void expect_same(const MessageList& found, const MessageList& expected, const std::string& what) {
  ASSERT_EQ(found.messages.size(), expected.messages.size()) << what;
  for (size_t i = 0; i < found.messages.size(); ++i) {
    const auto &f = found.messages[i], &e = expected.messages[i];
    ASSERT_EQ(name_of(f.channel), name_of(e.channel)) << what << ", message " << i;
    ASSERT_EQ(f.utime_us, e.utime_us) << what << ", message " << i;
    ASSERT_EQ(f.bytes, e.bytes) << what << ", message " << i << " on " << name_of(f.channel);
  }
}

TEST(RunEncoder, GivesEachTargetTheMessagesOfASeparateEncoder) {
  const EncoderOptions all[] = {{.with_instance = false, .with_clock_times = false, .threads = 2},
                                {.state_every = 4},
                                {.state_every = 1.5, .part_poses = true}};
  WholeRun together[3];
  RunEncoder encoder;
  for (size_t i = 0; i < 3; ++i) encoder.add(all[i], together[i]);
  SyntheticRun(kCrowd).play(encoder, 70);
  for (size_t i = 0; i < 3; ++i) {
    WholeRun alone;
    RunEncoder own(all[i], alone);
    SyntheticRun(kCrowd).play(own, 70);
    expect_same(together[i], alone, "target " + std::to_string(i));
  }
  EXPECT_LT(together[1].messages.size(), together[0].messages.size());
}

TEST(RunEncoder, NumbersTheMessagesOfEachTargetWithoutGaps) {
  struct Repeating : WholeRun {
    void after_frame(TargetState& target_state) override { target_state.send_description_chunk(0); }
  } often;
  WholeRun once, alone;
  RunEncoder encoder;
  encoder.add({}, often);
  encoder.add({}, once);
  SyntheticRun(kCrowd).play(encoder, 5);
  RunEncoder own({}, alone);
  SyntheticRun(kCrowd).play(own, 5);
  EXPECT_EQ(often.messages.size(), once.messages.size() + 5);
  expect_same(once, alone, "with a target that repeats the description");
}

TEST(RunEncoder, SkipsATargetThatWantsNoMessages) {
  struct Deaf : WholeRun {
    bool wants_messages() const override { return messages.size() < 20; }
  } deaf;
  WholeRun other, alone;
  RunEncoder encoder;
  encoder.add({}, deaf);
  encoder.add({}, other);
  SyntheticRun(kCrowd).play(encoder, 20);
  RunEncoder own({}, alone);
  SyntheticRun(kCrowd).play(own, 20);
  EXPECT_LT(deaf.messages.size(), other.messages.size());
  expect_same(other, alone, "with a target that wants no messages");
}

TEST(RunEncoder, SendsTheStagesInTheirOrder) {
  SyntheticRun run({.avatars = 3});
  CullingCounters counters;
  uint64_t number = 0;
  for (StageCounters* stage : culling_stages(counters)) {
    ++number;
    *stage = {"",
              number,
              10 * number,
              100 * number,
              0.5 * static_cast<double>(number),
              0.25 * static_cast<double>(number)};
  }
  FrameTimes times;
  for (size_t i = 0; i < kStageCount; ++i) times.stage_ns[i] = 7.5 * static_cast<double>(i + 1);
  Frame frame = run.step();
  frame.counters = &counters;
  frame.times = &times;
  for (const bool clock : {true, false}) {
    MessageList list;
    RunEncoder encoder({.with_clock_times = clock}, list);
    encoder.begin(run.info());
    encoder.frame(run.info(), frame);
    frame_stats_t stats;
    for (const auto& m : list.messages) {
      if (m.channel != Channel::kFrameStats) continue;
      ASSERT_EQ(decode(m.bytes, stats), "");
    }
    for (size_t i = 0; i < kCullingStageCount; ++i) {
      const auto n = static_cast<int64_t>(i + 1);
      EXPECT_EQ(stats.updates[i], n);
      EXPECT_EQ(stats.tests[i], 10 * n);
      EXPECT_EQ(stats.passed[i], 100 * n);
      EXPECT_EQ(stats.update_ns[i], clock ? 0.5 * static_cast<double>(n) : 0);
      EXPECT_EQ(stats.test_ns[i], clock ? 0.25 * static_cast<double>(n) : 0);
    }
    for (size_t i = 0; i < kStageCount; ++i)
      EXPECT_EQ(stats.stage_ns[i], clock ? times.stage_ns[i] : 0) << kStageNames[i];
  }
}

}  // namespace
}  // namespace throng::encoder_test
