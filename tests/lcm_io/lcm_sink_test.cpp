// LcmSink delivers all messages in order over a lossless transport and reports a dead network once.
#include "lcm_io/wire/lcm_sink.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <thread>

#include "lcm_io/codec/run_reader.h"
#include "synthetic_run.h"

namespace throng::lcm_sink_test {
namespace {

/// LCM within one process, with a reader as the receiver.
struct Loop {
  Loop() : lcm(std::make_shared<lcm::LCM>("memq://")) {
    // Functions, because the sanitizer of g++ 12 mistakes LCM's call through a member pointer.
    lcm->subscribeFunction("THRONG_.*", &Loop::on_message, this);
  }
  static void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel, Loop* loop) {
    loop->take(buffer, channel);
  }
  void take(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    const std::span bytes(static_cast<const uint8_t*>(buffer->data), buffer->data_size);
    EXPECT_LE(bytes.size(), kMaxMessageBytes);
    ++messages;
    received += static_cast<int64_t>(bytes.size());
    EXPECT_NE(reader.take(channel, bytes), RunReader::Update::kRejected) << reader.rejection();
    for (const PairEvent& event : reader.new_events())
      if (channel == "THRONG_EVENTS") ++(event.kind == EventKind::kBegin ? begins : ends);
  }
  void drain() {
    while (lcm->handleTimeout(0) > 0) {
    }
  }
  std::shared_ptr<lcm::LCM> lcm;
  RunReader reader;
  int64_t messages = 0, received = 0, begins = 0, ends = 0;
};

TEST(LcmSink, DeliversAllMessagesInOrder) {
  Loop loop;
  LcmSink sink({.part_poses = true}, loop.lcm);
  ASSERT_TRUE(sink.good());
  SyntheticRun run({.avatars = 600, .pairs = 300});
  run.play(sink, 40);
  loop.drain();
  EXPECT_EQ(loop.messages, sink.messages());
  EXPECT_EQ(loop.received, sink.bytes());
  EXPECT_EQ(sink.dropped(), 0);
  EXPECT_EQ(loop.begins, run.begins());
  EXPECT_EQ(loop.ends, run.ends());
  EXPECT_EQ(loop.reader.state().frame, 39);
  EXPECT_EQ(loop.reader.instance(), static_cast<int64_t>(run.info().instance));
  for (const Channel channel : kAllChannels) {
    EXPECT_EQ(loop.reader.tally(channel).missing, 0) << name_of(channel);
    EXPECT_EQ(loop.reader.tally(channel).messages, sink.target_state().totals(channel).messages);
  }
  EXPECT_EQ(loop.reader.tally(Channel::kEnd).messages, 5);
  const end_t& end = *loop.reader.end();
  for (size_t i = 0; i < end.channels.size(); ++i) {
    const int64_t behind = end.channels[i] == "THRONG_CHECKSUMS" ? 1 : 0;
    EXPECT_EQ(end.messages[i] + behind, loop.reader.tally(*channel_of(end.channels[i])).messages)
        << end.channels[i];
  }
  EXPECT_TRUE(loop.reader.checks()->is_last);
  EXPECT_EQ(loop.reader.checks()->message_index, sink.messages() - 1);
}

TEST(LcmSink, RepeatsTheDescriptionEverySecond) {
  Loop loop;
  LcmSink sink({}, loop.lcm);
  SyntheticRun run({.avatars = 50});
  sink.begin(run.info());
  const int chunks = sink.target_state().description_chunks();
  ASSERT_GT(chunks, 1);
  const auto started = std::chrono::steady_clock::now();
  std::chrono::duration<double> elapsed{};
  while (elapsed.count() < 2.5) {
    sink.frame(run.info(), run.step());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    elapsed = std::chrono::steady_clock::now() - started;
  }
  loop.drain();
  const auto rounds = loop.reader.tally(Channel::kRun).messages / chunks;
  EXPECT_GE(rounds, 3) << "at the start, after 1 s, after 2 s";
  EXPECT_LE(rounds, 1 + static_cast<int64_t>(elapsed.count()));
}

TEST(LcmSink, ReportsAMissingNetworkOnce) {
  std::vector<std::string> warnings;
  LcmSink sink(
      {.url = "nosuchtransport://", .warn = [&](const std::string& w) { warnings.push_back(w); }});
  EXPECT_FALSE(sink.good());
  SyntheticRun run({});
  EXPECT_NO_THROW(run.play(sink, 20));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings.front(), testing::HasSubstr("ip route add 224.0.0.0/4 dev lo"));
  EXPECT_EQ(sink.messages(), 0);
}

TEST(LcmSink, HasALocalDefaultUrlWithAReceiveBuffer) {
  EXPECT_THAT(std::string(kDefaultLcmUrl), testing::HasSubstr("ttl=0"));
  EXPECT_THAT(std::string(kDefaultLcmUrl), testing::HasSubstr("recv_buf_size="));
  const auto doc = bytes_of(std::filesystem::path(THRONG_SOURCE_DIR) / "docs/reference/lcm.md");
  EXPECT_THAT(std::string(doc.begin(), doc.end()), testing::HasSubstr(std::string(kDefaultLcmUrl)))
      << "the documentation names the default URL";
}

}  // namespace
}  // namespace throng::lcm_sink_test
