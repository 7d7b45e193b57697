// RunReader reconstructs a run from its messages and knows which are missing.
#include "lcm_io/codec/run_reader.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "synthetic_run.h"

namespace throng::run_reader_test {
namespace {

using Update = RunReader::Update;
using Messages = std::vector<MessageList::Message>;

Update take(RunReader& reader, const MessageList::Message& m) {
  return reader.take(name_of(m.channel), m.bytes);
}

Messages run_of(uint64_t seed, int frames, int avatars = 20, uint64_t instance = 1) {
  SyntheticRun run({.avatars = avatars, .seed = seed});
  run.set_instance(instance);
  return messages_of(run, frames);
}

TEST(RunReader, ReconstructsARun) {
  SyntheticRun oracle({.seed = 4});
  RunReader reader;
  const Frame* frame = nullptr;
  for (const auto& m : run_of(4, 50)) {
    const Update update = take(reader, m);
    ASSERT_NE(update, Update::kRejected) << reader.rejection();
    if (update == Update::kState) {
      frame = &oracle.step();
      ASSERT_EQ(reader.state().frame, frame->number);
      ASSERT_NEAR(reader.state().roots[3].position_m.x(), frame->roots[3].position_m.x(), 1e-4);
    }
    if (update == Update::kFrameStats) {
      const auto& touching = reader.touching();
      ASSERT_TRUE(std::equal(touching.begin(), touching.end(), frame->pairs.begin(),
                             frame->pairs.end(),
                             [](const auto& found, PairKey pair) { return found.first == pair; }));
    }
  }
  EXPECT_EQ(frame->number, 49);
  ASSERT_TRUE(reader.end().has_value());
  EXPECT_EQ(reader.end()->frames, 50);
  EXPECT_TRUE(reader.touching().empty()) << "the end of the run ends every pair";
  for (const Channel channel : kAllChannels) EXPECT_EQ(reader.tally(channel).missing, 0);
}

TEST(RunReader, KnowsPresenceAndLevels) {
  const SyntheticRun::Options options{.seed = 4, .comings = true, .has_budget = true};
  SyntheticRun run(options), oracle(options);
  RunReader reader;
  const Frame* frame = nullptr;
  int64_t absent = 0, whole = 0;
  for (const auto& m : messages_of(run, 50)) {
    const Update update = take(reader, m);
    ASSERT_NE(update, Update::kRejected) << reader.rejection();
    if (update == Update::kState) {
      frame = &oracle.step();
      ASSERT_TRUE(std::equal(frame->present.begin(), frame->present.end(),
                             reader.state().present.begin(), reader.state().present.end()))
          << "frame " << frame->number;
      absent += std::count(frame->present.begin(), frame->present.end(), 0);
    }
    if (update == Update::kFrameStats) {
      ASSERT_EQ(reader.touching().size(), frame->pairs.size());
      for (size_t i = 0; i < frame->pairs.size(); ++i) {
        const auto found = reader.touching().find(frame->pairs[i]);
        ASSERT_NE(found, reader.touching().end());
        ASSERT_EQ(static_cast<int>(found->second), frame->levels[i]);
        whole += frame->pairs[i].part_a() == kWholeBody ? 1 : 0;
      }
    }
  }
  EXPECT_GT(absent, 100);
  EXPECT_GT(whole, 100);
}

TEST(RunReader, RejectsPairsOutsideTheRun) {
  RunReader reader;
  for (const auto& m : run_of(4, 1, 5)) {
    if (m.channel == Channel::kRun) take(reader, m);
    if (m.channel != Channel::kEvents) continue;
    events_t events;
    ASSERT_EQ(decode(m.bytes, events), "");
    events.b[0] = 6;  // five avatars and an obstacle have ids 0 to 5
    std::vector<uint8_t> bytes(static_cast<size_t>(events.getEncodedSize()));
    events.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    EXPECT_EQ(reader.take("THRONG_EVENTS", bytes), Update::kRejected);
    EXPECT_NE(reader.rejection().find("that the run does not have"), std::string::npos);
    EXPECT_TRUE(reader.touching().empty());
  }
}

TEST(RunReader, PosesPartsLikeTheSimulation) {
  SyntheticRun oracle({.seed = 4});
  const Frame& frame = oracle.step();
  RunReader reader;
  for (const auto& m : run_of(4, 1)) take(reader, m);
  std::vector<PartPose> poses, expected;
  for (int avatar = 0; avatar < 6; ++avatar) {
    const auto i = static_cast<size_t>(avatar);
    reader.part_poses(avatar, poses);
    const Model& model = *oracle.info().models[oracle.info().model_of_avatar[i]];
    const RootFrame root{frame.roots[i].world_from_root, oracle.info().scale_of_avatar[i]};
    expected.resize(model.parts.size());
    forward_kinematics(
        model.kinematics,
        frame.postures.subspan(frame.posture_offsets[i],
                               frame.posture_offsets[i + 1] - frame.posture_offsets[i]),
        {&root, 1}, expected);
    ASSERT_EQ(poses.size(), expected.size());
    for (size_t p = 0; p < poses.size(); ++p) {
      const double off =
          (to_isometry(poses[p]).translation() - to_isometry(expected[p]).translation()).norm();
      EXPECT_LT(off, 5e-4) << "metres; errors of angles add up along the arm; avatar " << avatar;
    }
  }
}

TEST(RunReader, CountsMissingMessagesExactly) {
  const Messages all = run_of(5, 100);
  RunReader reader;
  int64_t dropped = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    const bool is_hole = all[i].channel == Channel::kFrameStats && i % 7 == 3;
    dropped += is_hole ? 1 : 0;
    if (!is_hole) take(reader, all[i]);
  }
  EXPECT_GT(dropped, 5);
  EXPECT_EQ(reader.tally(Channel::kFrameStats).missing, dropped);
  EXPECT_EQ(reader.tally(Channel::kFrameStats).messages + dropped, 100);
  EXPECT_EQ(reader.tally(Channel::kStates).missing, 0);
}

TEST(RunReader, AcceptsLateMessages) {
  Messages all = run_of(5, 30);
  std::vector<size_t> counters;
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i].channel == Channel::kFrameStats) counters.push_back(i);
  std::swap(all[counters[10]], all[counters[12]]);
  RunReader reader;
  for (const auto& m : all) take(reader, m);
  EXPECT_EQ(reader.tally(Channel::kFrameStats).missing, 0);
}

TEST(RunReader, SkipsAFrameWithALostChunk) {
  const Messages all = run_of(5, 3, 2000);
  RunReader reader;
  bool is_dropped = false;
  for (const auto& m : all) {
    MessageHeader header;
    ASSERT_EQ(read_header(m.channel, m.bytes, header), "");
    const bool drop = m.channel == Channel::kStates && header.frame == 1 && header.chunk == 1;
    is_dropped = is_dropped || drop;
    if (drop) continue;
    if (take(reader, m) == Update::kState) {
      EXPECT_NE(reader.state().frame, 1);
    }
  }
  EXPECT_TRUE(is_dropped);
  EXPECT_EQ(reader.state().frame, 2);
  EXPECT_EQ(reader.tally(Channel::kStates).incomplete, 1);
  EXPECT_EQ(reader.tally(Channel::kStates).missing, 1);
}

TEST(RunReader, CatchesUpAfterALateStart) {
  SyntheticRun run({.seed = 6});
  MessageList list;
  RunEncoder encoder({}, list);
  encoder.begin(run.info());
  std::vector<PairKey> pairs;
  for (int i = 0; i < 61; ++i) {
    if (i == 40)
      for (int chunk = encoder.target_state().description_chunks(); chunk-- > 0;)
        encoder.target_state().send_description_chunk(chunk);
    const Frame& frame = run.step();
    encoder.frame(run.info(), frame);
    pairs.assign(frame.pairs.begin(), frame.pairs.end());
  }
  RunReader reader;
  bool is_late = true;
  for (const auto& m : list.messages) {
    MessageHeader header;
    ASSERT_EQ(read_header(m.channel, m.bytes, header), "");
    is_late = is_late && header.frame < 30;
    if (is_late) continue;
    take(reader, m);
    if (header.frame < 39) {
      EXPECT_EQ(reader.run(), nullptr);
    }
  }
  ASSERT_NE(reader.run(), nullptr) << "chunks may arrive in any order";
  EXPECT_EQ(reader.state().frame, 60);
  EXPECT_TRUE(std::equal(reader.touching().begin(), reader.touching().end(), pairs.begin(),
                         pairs.end(),
                         [](const auto& found, PairKey pair) { return found.first == pair; }));
}

TEST(RunReader, DistinguishesTwoRuns) {
  const Messages first = run_of(1, 40, 20, 100), second = run_of(1, 40, 20, 200);
  RunReader reader;
  size_t at = 0;
  for (; at < first.size() / 2; ++at) take(reader, first[at]);
  ASSERT_EQ(reader.instance(), 100);
  const auto middle = static_cast<std::ptrdiff_t>(second.size() / 2);
  for (auto m = second.begin() + middle; m != second.begin() + middle + 10; ++m) take(reader, *m);
  EXPECT_EQ(reader.instance(), 100) << "another running run does not take over";
  EXPECT_EQ(reader.foreign(), 10);
  take(reader, second.front());
  EXPECT_EQ(reader.instance(), 200) << "a starting run takes over";
  reader.forget();
  take(reader, first[at]);
  EXPECT_EQ(reader.instance(), 100) << "after forget() any run takes over";
}

TEST(RunReader, FollowsTheChosenRun) {
  const Messages first = run_of(1, 40, 20, 100), second = run_of(1, 40, 20, 200),
                 third = run_of(1, 40, 20, 300);
  RunReader reader;
  take(reader, first.front());
  reader.follow(reader.run_id(), 200);
  take(reader, first[1]);
  EXPECT_EQ(reader.instance(), 100) << "until the chosen run sends";
  take(reader, second[second.size() / 2]);
  ASSERT_EQ(reader.instance(), 200);
  take(reader, third.front());
  EXPECT_EQ(reader.instance(), 200) << "a starting run does not replace the chosen one";
  for (const auto& m : second)
    if (m.channel == Channel::kEnd) take(reader, m);
  ASSERT_TRUE(reader.end());
  take(reader, third.front());
  EXPECT_EQ(reader.instance(), 300) << "after the end of the chosen run";
  take(reader, first.front());
  EXPECT_EQ(reader.instance(), 100) << "a choice holds for one run";
}

TEST(RunReader, IgnoresMaliciousMessages) {
  RunReader reader;
  const Messages all = run_of(4, 10);
  for (const auto& m : all) {
    if (m.channel == Channel::kEnd) break;
    take(reader, m);
    auto bytes = m.bytes;
    bytes.resize(bytes.size() / 2);
    EXPECT_EQ(reader.take(name_of(m.channel), bytes), Update::kRejected);
    EXPECT_EQ(reader.take("SOMEBODY_ELSE", m.bytes), Update::kNothing);
  }
  EXPECT_EQ(reader.state().frame, 9);
  EXPECT_GT(reader.rejected(), 20);
}

TEST(RunReader, RejectsStatesThatDoNotFitTheModels) {
  Messages all = run_of(4, 1);
  RunReader reader;
  for (const auto& m : all) {
    if (m.channel != Channel::kStates) {
      if (m.channel == Channel::kRun) take(reader, m);
      continue;
    }
    states_t states;
    ASSERT_EQ(decode(m.bytes, states), "");
    states.first_avatar = 1;
    std::vector<uint8_t> bytes(static_cast<size_t>(states.getEncodedSize()));
    states.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    EXPECT_EQ(reader.take("THRONG_STATES", bytes), Update::kRejected);
    states.first_avatar = INT32_MAX;
    states.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    EXPECT_EQ(reader.take("THRONG_STATES", bytes), Update::kRejected);
  }
}

}  // namespace
}  // namespace throng::run_reader_test
