// Tests LiveView with runs over LCM and damaged messages from the network.
#include "viewer/server/live_view.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

#include "base/random.h"
#include "lcm_io/wire/lcm_sink.h"
#include "tests/lcm_io/memory_bus.h"
#include "tests/lcm_io/synthetic_run.h"
#include "tests/viewer/contacts_message.h"
#include "tests/viewer/web_socket.h"

namespace throng::live_view_test {
namespace {

using namespace std::chrono_literals;

/// A sender and a viewer in one process, connected by LCM's memory queue.
class LiveCrowd : public testing::Test {
 protected:
  LiveCrowd()
      : lcm_(memory_bus()),
        view_(std::make_unique<Receiver>(lcm_), {.max_stall = 10min, .send_buffer_bytes = 4096},
              "<!doctype html>", "udpm://239.255.0.1:7799?ttl=0") {}

  /// Returns the next binary message of a kind.
  static std::string next(TestSocket& browser, uint32_t kind) {
    for (;;) {
      const auto message = browser.read_message();
      if (!message) return "";
      uint32_t found = 0;
      if (message->opcode == Opcode::kBinary && message->payload.size() >= 4)
        std::memcpy(&found, message->payload.data(), 4);
      if (found == kind) return message->payload;
    }
  }
  static FrameHead head_of(const std::string& message) {
    FrameHead head;
    if (message.size() >= sizeof head) std::memcpy(&head, message.data(), sizeof head);
    return head;
  }

  static ContactsMessage ask(TestSocket& browser, const std::string& query) {
    browser.send_frame(Opcode::kText, query);
    return contacts_of(next(browser, kContactsMessage));
  }

  std::shared_ptr<lcm::LCM> lcm_;
  LiveView view_;
};

TEST_F(LiveCrowd, ReportsThatItWaits) {
  TestSocket browser(view_.server().port());
  browser.open();
  const auto message = browser.read_message();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->opcode, Opcode::kText);
  EXPECT_NE(message->payload.find("waiting"), std::string::npos) << message->payload;
  EXPECT_NE(message->payload.find("udpm://239.255.0.1:7799?ttl=0"), std::string::npos)
      << "names no URL: " << message->payload;
  EXPECT_NE(message->payload.find("--lcm 'udpm://239.255.0.1:7799?ttl=0'"), std::string::npos)
      << message->payload;
}

TEST_F(LiveCrowd, ShowsAFinishedRunToALatePage) {
  SyntheticRun run({.avatars = 30, .pairs = 50});
  LcmSink sink({.url = "memq://"}, lcm_);
  sink.begin(run.info());
  size_t pairs = 0;
  for (int i = 0; i < 10; ++i) {
    const Frame& frame = run.step();
    pairs = frame.pairs.size();
    sink.frame(run.info(), frame);
  }
  sink.end(run.info(), run.finish());
  for (int i = 0; i < 1000 && view_.frames_received() < 10; ++i) std::this_thread::sleep_for(5ms);
  TestSocket late(view_.server().port());
  late.open();
  EXPECT_NE(next(late, kRunMessage), "");
  bool has_end = false;
  for (;;) {
    const auto message = late.read_message();
    ASSERT_TRUE(message) << "no frame";
    has_end = has_end || message->payload == R"({"end":true})";
    if (message->opcode != Opcode::kBinary) continue;
    EXPECT_EQ(head_of(message->payload).pairs, pairs) << "the ends behind the last frame";
    EXPECT_EQ(head_of(message->payload).frame, 9);
    break;
  }
  for (int i = 0; i < 5 && !has_end; ++i) {
    const auto message = late.read_message();
    has_end = message && message->payload == R"({"end":true})";
  }
  EXPECT_TRUE(has_end);
  EXPECT_GT(pairs, 0u);
}

TEST_F(LiveCrowd, ShowsRunsStartedBeforeAndAfterThePage) {
  TestSocket early(view_.server().port());
  early.open();
  SyntheticRun run({.avatars = 30});
  LcmSink sink({.url = "memq://"}, lcm_);
  sink.begin(run.info());
  sink.frame(run.info(), run.step());
  EXPECT_NE(next(early, kRunMessage), "");
  TestSocket late(view_.server().port());
  late.open();
  EXPECT_NE(next(late, kRunMessage), "");
  for (int i = 0; i < 5; ++i) {
    sink.frame(run.info(), run.step());
    std::this_thread::sleep_for(5ms);
  }
  for (TestSocket* browser : {&early, &late}) {
    const FrameHead head = head_of(next(*browser, kFrameMessage));
    EXPECT_EQ(head.avatars, 30u);
    EXPECT_GE(head.frame, 0);
  }
}

TEST_F(LiveCrowd, ServesTheDistancesOfABody) {
  SyntheticRun run({.avatars = 12, .pairs = 60, .proximity = true});
  LcmSink sink({.url = "memq://"}, lcm_);
  TestSocket browser(view_.server().port());
  browser.open();
  sink.begin(run.info());
  double to = 0;
  for (int frame = 0; frame < 5; ++frame) {
    sink.frame(run.info(), run.step());
    while (view_.frames_received() <= static_cast<uint64_t>(frame)) std::this_thread::yield();
    browser.send_frame(Opcode::kText,
                       R"({"proximity": 3, "since": )" + std::to_string(frame) + "}");
    const std::string message = next(browser, kProximityMessage);
    ProximityHead head;
    ASSERT_GE(message.size(), sizeof head);
    std::memcpy(&head, message.data(), sizeof head);
    EXPECT_EQ(head.body, 3u);
    EXPECT_EQ(head.from, to);
    EXPECT_EQ(head.to, frame + 1);
    EXPECT_GT(head.count, 0u);
    to = head.to;
  }
}

TEST_F(LiveCrowd, ServesTheContactsOfAllPairs) {
  SyntheticRun run({.avatars = 30, .pairs = 50});
  LcmSink sink({.url = "memq://"}, lcm_);
  TestSocket browser(view_.server().port());
  browser.open();
  EXPECT_EQ(ask(browser, R"({"contacts": 0})").head.frame, -1);
  sink.begin(run.info());
  std::vector<PairEvent> expected;
  std::vector<int64_t> frames;
  const auto step = [&](uint64_t received) {
    const Frame& frame = run.step();
    expected.insert(expected.end(), frame.events.begin(), frame.events.end());
    frames.resize(expected.size(), frame.number);
    sink.frame(run.info(), frame);
    for (int i = 0; i < 1000 && view_.frames_received() < received; ++i)
      std::this_thread::sleep_for(5ms);
  };
  // A page asks from the last known change on.
  uint64_t known = 0;
  for (uint64_t number = 1; number <= 20; ++number) {
    step(number);
    if (number % 4 != 0) continue;
    const ContactsMessage piece =
        ask(browser, R"({"contacts": )" + std::to_string(known) + R"(, "since": 0})");
    EXPECT_EQ(piece.head.first, static_cast<double>(known));
    EXPECT_EQ(piece.head.frame, static_cast<double>(number - 1));
    ASSERT_EQ(piece.head.known, static_cast<double>(expected.size()));
    ASSERT_EQ(piece.records.size(), expected.size() - known);
    for (const ContactRecord& record : piece.records) {
      const PairEvent& event = expected[known];
      EXPECT_EQ(record.frame, frames[known]);
      EXPECT_EQ(PairKey(record.a, record.b, record.part_a, record.part_b), event.pair);
      EXPECT_EQ(record.kind, event.kind == EventKind::kBegin ? 0 : 1);
      EXPECT_EQ(record.began == record.frame, event.kind == EventKind::kBegin);
      ++known;
    }
  }
  EXPECT_GT(known, 50u);
  // Another run counts from 0.
  SyntheticRun other({.avatars = 10, .seed = 2, .pairs = 5});
  other.set_instance(77);
  LcmSink other_sink({.url = "memq://"}, lcm_);
  sink.end(run.info(), run.finish());
  other_sink.begin(other.info());
  other_sink.frame(other.info(), other.step());
  ASSERT_NE(next(browser, kRunMessage), "");
  for (int i = 0; i < 1000 && view_.frames_received() < 21; ++i) std::this_thread::sleep_for(5ms);
  const ContactsMessage fresh = ask(browser, R"({"contacts": )" + std::to_string(known) + "}");
  EXPECT_LT(fresh.head.known, static_cast<double>(known));
  EXPECT_EQ(fresh.head.count, 0u);
  EXPECT_EQ(fresh.head.frame, 0);
  const ContactsMessage start = ask(browser, R"({"contacts": 0})");
  EXPECT_EQ(start.head.first, 0);
  EXPECT_GT(start.head.count, 0u);
  EXPECT_EQ(start.head.known, start.head.count);
}

// The run's process only sends. A browser that stops reading must not delay the viewer's reception:
// every frame of the run is received.
TEST_F(LiveCrowd, ReceivesAllFramesDespiteAStalledClient) {
  TestSocket stalled(view_.server().port(), 4096);
  stalled.open();
  SyntheticRun run({.avatars = 200});
  LcmSink sink({.url = "memq://"}, lcm_);
  sink.begin(run.info());
  uint64_t sent = 0;
  for (; sent == 0 || (view_.frames_built() == 0 && sent < 600); ++sent) {
    sink.frame(run.info(), run.step());  // the first picture takes long
    std::this_thread::sleep_for(100ms);
  }
  // Sends until 30 frames were built: a busy machine builds one frame from several.
  for (; view_.frames_built() < 30 && sent < 3000; ++sent) {
    sink.frame(run.info(), run.step());
    std::this_thread::sleep_for(2ms);
  }
  for (int i = 0; i < 1000 && view_.frames_received() < sent; ++i) std::this_thread::sleep_for(5ms);
  EXPECT_EQ(view_.frames_received(), sent);
  const uint64_t built = view_.frames_built();
  EXPECT_GE(built, 30u);
  EXPECT_GE(view_.server().frames_dropped() + 10, built)
      << "a few frames fit into the socket, the rest is dropped and counted";
}

TEST_F(LiveCrowd, SurvivesDamagedMessages) {
  TestSocket browser(view_.server().port());
  browser.open();
  SyntheticRun run({.avatars = 10, .has_budget = true});
  std::vector<MessageList::Message> messages = messages_of(run, 20);
  constexpr uint64_t kSeed = 11;
  constexpr int kPackets = 100'000;
  int sent = 0;
  for (uint64_t i = 0; sent < kPackets; ++i) {
    const RandomKey key{.seed = kSeed, .id = i};
    const MessageList::Message& message = messages[random_bits(key, 0) % messages.size()];
    // Damaged descriptions are large and sent rarely, which keeps the test short.
    if (message.bytes.size() > 8000 && i % 50 != 0) continue;
    std::vector<uint8_t> bytes = message.bytes;
    for (uint32_t change = 0; change < 1 + random_bits(key, 1) % 4; ++change)
      bytes[random_bits(key, 10 + change) % bytes.size()] =
          static_cast<uint8_t>(random_bits(key, 20 + change));
    if (random_bits(key, 2) % 3 == 0) bytes.resize(random_bits(key, 3) % (bytes.size() + 1));
    publish(*lcm_, message.channel, bytes);
    ++sent;
    if (i % 500 == 0) std::this_thread::sleep_for(1ms);
  }
  // Afterwards it still shows an intact run.
  SyntheticRun sound({.avatars = 17, .seed = 99});
  sound.set_instance(12345);
  LcmSink sink({.url = "memq://"}, lcm_);
  TestSocket late(view_.server().port());
  late.open();
  sink.begin(sound.info());
  FrameHead head;
  for (int i = 0; i < 200 && head.avatars != 17; ++i) {
    sink.frame(sound.info(), sound.step());
    head = head_of(next(late, kFrameMessage));
  }
  EXPECT_EQ(head.avatars, 17u);
}

}  // namespace
}  // namespace throng::live_view_test
