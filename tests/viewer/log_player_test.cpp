// Tests LogPlayer: any frame, in any order, equals the frame of the run.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>
#include <tuple>

#include "base/errors.h"
#include "base/random.h"
#include "lcm_io/codec/log_format.h"
#include "tests/lcm_io/synthetic_run.h"
#include "tests/viewer/contacts_message.h"
#include "tests/viewer/web_socket.h"
#include "viewer/server/log_view.h"

namespace throng::log_player_test {
namespace {

constexpr int kFrames = 200;

class RecordedCrowd : public testing::Test {
 protected:
  void record(const SyntheticRun::Options& options, double state_every = 1) {
    SyntheticRun run(options);
    LogSink sink(log_.path(), {.state_every = state_every});
    run.play(sink, kFrames);
  }
  std::shared_ptr<const Bytes> fresh(const LogIndex& index, const RunGeometry& geometry,
                                     int64_t frame) {
    return LogPlayer(index, geometry).frame(frame);
  }
  static RunReader described(const LogIndex& index) {
    RunReader run;
    index.describe(run);
    return run;
  }
  ScratchFile log_;
};

FrameHead head_of(const Bytes& message) {
  FrameHead head;
  std::memcpy(&head, message.data(), sizeof head);
  return head;
}

/// Returns the message without the head, whose numbers differ between players.
std::vector<uint8_t> picture_of(const Bytes& message) {
  return {message.begin() + sizeof(FrameHead), message.end()};
}

TEST_F(RecordedCrowd, JumpsAndPlaysEqually) {
  for (const double state_every : {1.0, 2.4, 7.0, 150.0}) {
    record({.avatars = 30, .seed = 3, .pairs = 60, .comings = true, .has_budget = true},
           state_every);
    LogIndex index(log_.path());
    index.wait();
    RunReader run = described(index);
    const RunGeometry geometry(run);
    LogPlayer playing(index, geometry), jumping(index, geometry);
    std::vector<std::vector<uint8_t>> played;
    for (int64_t frame = 0; frame < kFrames; ++frame) {
      const auto message = playing.frame(frame);
      ASSERT_NE(message, nullptr);
      ASSERT_EQ(head_of(*message).frame, static_cast<double>(frame));
      played.push_back(picture_of(*message));
    }
    for (uint64_t i = 0; i < 60; ++i) {
      const auto frame = static_cast<int64_t>(random_bits({.seed = 4, .id = i}) % kFrames);
      const auto message = jumping.frame(frame);
      ASSERT_NE(message, nullptr);
      ASSERT_EQ(picture_of(*message), played[static_cast<size_t>(frame)])
          << "frame " << frame << ", jump " << i << ", states every " << state_every;
    }
  }
}

TEST_F(RecordedCrowd, FramesEqualTheRun) {
  const SyntheticRun::Options options{.avatars = 12, .seed = 8, .pairs = 20, .comings = true};
  record(options);
  LogIndex index(log_.path());
  index.wait();
  RunReader run = described(index);
  const RunGeometry geometry(run);
  LogPlayer player(index, geometry);
  SyntheticRun again(options);
  for (int64_t number = 0; number < kFrames; ++number) {
    const Frame& frame = again.step();
    const auto message = player.frame(number);
    const FrameHead head = head_of(*message);
    ASSERT_EQ(head.pairs, frame.pairs.size()) << "frame " << number;
    ASSERT_EQ(head.avatars, frame.roots.size());
    uint32_t present = 0;
    for (size_t i = 0; i < frame.roots.size(); ++i) {
      present += frame.present.empty() || frame.present[i] != 0 ? 1 : 0;
      float xyz[3];
      std::memcpy(xyz, message->data() + sizeof head + 16 * i, sizeof xyz);
      for (int axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(xyz[axis], frame.roots[i].position_m[axis], 1e-4);
    }
    ASSERT_EQ(head.present, present) << "frame " << number;
  }
}

TEST_F(RecordedCrowd, SamplesThePositionsOfTheRun) {
  const SyntheticRun::Options options{.avatars = 12, .seed = 8, .comings = true};
  record(options);
  LogIndex index(log_.path());
  index.wait();
  LogSampler sampler(index);
  SyntheticRun again(options);
  int64_t stepped = -1;
  const Frame* frame = nullptr;
  int64_t next = 30;
  for (int samples = 0; next <= 99; ++samples) {
    const Bytes message = sampler.positions(next, 99, 7, std::chrono::milliseconds(0));
    PositionsHead head;
    std::memcpy(&head, message.data(), sizeof head);
    ASSERT_EQ(head.kind, kPositionsMessage);
    ASSERT_EQ(head.samples, 1u) << "one sample per answer within no time";
    ASSERT_EQ(head.from, next);
    ASSERT_EQ(message.size(), sizeof head + 2 * sizeof(float) * head.avatars);
    for (; stepped < next; ++stepped) frame = &again.step();
    for (size_t i = 0; i < head.avatars; ++i) {
      float xy[2];
      std::memcpy(xy, message.data() + sizeof head + i * sizeof xy, sizeof xy);
      const bool is_there = frame->present.empty() || frame->present[i] != 0;
      ASSERT_EQ(std::isnan(xy[0]), !is_there) << "avatar " << i << " in frame " << next;
      if (!is_there) continue;
      EXPECT_NEAR(xy[1], frame->roots[i].position_m.y(), 1e-4);
    }
    next = static_cast<int64_t>(head.to);
    EXPECT_EQ(next, std::min<int64_t>(100, 30 + 7 * (samples + 1)));
  }
  const Bytes rest = sampler.positions(kFrames, 10 * kFrames, 1, std::chrono::hours(1));
  EXPECT_EQ(rest.size(), sizeof(PositionsHead));
}

TEST_F(RecordedCrowd, IndexesTheWholeLog) {
  record({.avatars = 10});
  LogIndex index(log_.path());
  index.wait();
  EXPECT_EQ(index.last_frame(), kFrames - 1);
  EXPECT_EQ(index.problem(), "");
  const auto json = nlohmann::json::parse(index.to_json(50))["index"];
  EXPECT_EQ(json["frames"], kFrames);
  EXPECT_LE(json["pairs"].size(), 50u);
}

TEST_F(RecordedCrowd, CountsAFrameFarAheadOnce) {
  // The largest number that a message may have: there is no memory for all frames before it.
  const int64_t far = int64_t{1} << 53;
  {
    SyntheticRun run({.avatars = 10});
    LogSink sink(log_.path());
    sink.begin(run.info());
    for (int i = 0; i < 20; ++i) sink.frame(run.info(), run.step());
    Frame last = run.step();
    last.number = far;
    sink.frame(run.info(), last);
    sink.end(run.info(), run.finish());
  }
  LogIndex index(log_.path());
  index.wait();
  EXPECT_EQ(index.last_frame(), far);
  const auto json = nlohmann::json::parse(index.to_json(50))["index"];
  EXPECT_EQ(json["frames"], far + 1);
  EXPECT_LE(json["pairs"].size(), 50u);
}

TEST_F(RecordedCrowd, PlaysTheSoundPartOfATornLog) {
  record({.avatars = 10});
  std::vector<uint8_t> bytes = bytes_of(log_.path());
  bytes.resize(bytes.size() * 2 / 3);
  write_bytes(log_.path(), bytes);
  LogIndex index(log_.path());
  index.wait();
  EXPECT_NE(index.problem(), "");
  EXPECT_GT(index.last_frame(), 50);
  RunReader run = described(index);
  const RunGeometry geometry(run);
  EXPECT_NE(fresh(index, geometry, kFrames), nullptr);
}

TEST_F(RecordedCrowd, SurvivesDamage) {
  record({.avatars = 10, .pairs = 30});
  const std::vector<uint8_t> sound = bytes_of(log_.path());
  for (uint64_t seed = 0; seed < 60; ++seed) {
    std::vector<uint8_t> bytes = sound;
    for (uint64_t i = 0; i < 40; ++i) {
      const RandomKey key{.seed = seed, .id = i};
      bytes[random_bits(key, 0) % bytes.size()] = static_cast<uint8_t>(random_bits(key, 1));
    }
    write_bytes(log_.path(), bytes);
    try {
      LogIndex index(log_.path());
      index.wait();
      RunReader run = described(index);
      const RunGeometry geometry(run);
      LogPlayer player(index, geometry);
      for (const int64_t frame : {150, 3, 199, 80}) player.frame(frame);
    } catch (const InputError&) {
      // A damaged description is rejected with an error.
    }
  }
}

std::map<PairKey, int64_t> begins_of(const Bytes& message) {
  struct Pair {
    uint32_t a, b;
    uint8_t part_a, part_b, level, zero;
    int32_t began;
  };
  const FrameHead head = head_of(message);
  std::map<PairKey, int64_t> begins;
  const uint8_t* at = message.data() + sizeof head + 16 * (head.avatars + head.parts);
  for (uint32_t i = 0; i < head.pairs; ++i, at += sizeof(Pair)) {
    Pair pair;
    std::memcpy(&pair, at, sizeof pair);
    begins[PairKey(pair.a, pair.b, pair.part_a, pair.part_b)] = pair.began;
  }
  return begins;
}

/// Returns the begin frames of each frame's pairs, derived from the run's events.
std::vector<std::map<PairKey, int64_t>> begins_by_hand(const SyntheticRun::Options& options) {
  SyntheticRun run(options);
  std::map<PairKey, int64_t> open;
  std::vector<std::map<PairKey, int64_t>> frames;
  for (int64_t number = 0; number < kFrames; ++number) {
    for (const PairEvent& event : run.step().events) {
      if (event.kind == EventKind::kBegin)
        open[event.pair] = number;
      else
        open.erase(event.pair);
    }
    frames.push_back(open);
  }
  return frames;
}

TEST_F(RecordedCrowd, KnowsBeginFramesAfterJumps) {
  const SyntheticRun::Options options{.avatars = 30, .seed = 5, .pairs = 60, .comings = true};
  record(options, 3);
  LogIndex index(log_.path());
  index.wait();
  RunReader run = described(index);
  const RunGeometry geometry(run);
  const auto expected = begins_by_hand(options);
  LogPlayer playing(index, geometry), jumping(index, geometry);
  for (int64_t frame = 0; frame < kFrames; ++frame)
    ASSERT_EQ(begins_of(*playing.frame(frame)), expected[static_cast<size_t>(frame)]) << frame;
  for (uint64_t i = 0; i < 60; ++i) {
    // Backwards, forwards, and one frame on.
    const auto frame = static_cast<int64_t>(random_bits({.seed = 6, .id = i}) % (kFrames - 1));
    for (const int64_t number : {frame, frame + 1})
      ASSERT_EQ(begins_of(*jumping.frame(number)), expected[static_cast<size_t>(number)])
          << "frame " << number << ", jump " << i;
  }
}

TEST_F(RecordedCrowd, BoundsUnrecordedBeginFrames) {
  // The log starts within a run: the first pairs began before it.
  const SyntheticRun::Options options{.avatars = 30, .seed = 7, .pairs = 60};
  constexpr int kBefore = 70;
  const auto expected = begins_by_hand(options);
  Resumed resumed;
  resumed.frame = kBefore - 1;
  for (const auto& [pair, begin] : expected[kBefore - 1]) resumed.touching.push_back(pair);
  {
    SyntheticRun run(options);
    for (int i = 0; i < kBefore; ++i) run.step();
    RunInfo info = run.info();
    info.resumed = resumed;
    LogSink sink(log_.path());
    sink.begin(info);
    for (int i = kBefore; i < kFrames; ++i) sink.frame(info, run.step());
    sink.end(info, run.finish());
  }
  LogIndex index(log_.path());
  index.wait();
  RunReader run = described(index);
  const RunGeometry geometry(run);
  LogPlayer player(index, geometry);
  int64_t from_before = 0;
  for (const int64_t frame : {kBefore + 40, kBefore, kFrames - 1, kBefore + 3}) {
    for (const auto& [pair, began] : begins_of(*player.frame(frame))) {
      const int64_t begin = expected[static_cast<size_t>(frame)].at(pair);
      ASSERT_EQ(began, begin < kBefore ? began_before(kBefore) : begin) << "frame " << frame;
      from_before += began < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(from_before, 0);
}

TEST(PairBegins, BoundsBeginsAfterLostEvents) {
  const SyntheticRun::Options options{.avatars = 20, .seed = 9, .pairs = 50};
  SyntheticRun sender(options);
  const std::vector<MessageList::Message> messages = messages_of(sender, kFrames);
  const auto expected = begins_by_hand(options);
  RunReader run;
  PairBegins begins;
  int64_t frame = -1, lost_until = 0, doubted = 0;
  for (const MessageList::Message& message : messages) {
    MessageHeader header;
    ASSERT_EQ(read_header(message.channel, message.bytes, header), "");
    const bool is_lost = message.channel == Channel::kEvents && header.frame % 40 == 20;
    if (is_lost) lost_until = header.frame;
    if (is_lost) continue;
    const auto update = run.take(name_of(message.channel), message.bytes);
    begins.take(run, update);
    if (update == RunReader::Update::kFrameStats) frame = header.frame;
    if (update != RunReader::Update::kFrameStats || frame >= kFrames) continue;
    // A stated frame number must be right; before the gap is detected, no number can be checked.
    for (const auto& [pair, began] : begins.all()) {
      const auto& now = expected[static_cast<size_t>(frame)];
      if (!now.contains(pair) || frame - lost_until < 2) continue;
      if (began >= 0)
        ASSERT_EQ(began, now.at(pair)) << "frame " << frame;
      else
        ASSERT_LT(now.at(pair), ~began) << "frame " << frame;
      doubted += began < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(doubted, 0);
}

TEST(PairBegins, EndsAContactBeforeItBeginsAgain) {
  SyntheticRun sender({.avatars = 20, .seed = 9, .pairs = 50});
  RunReader run;
  PairBegins begins;
  std::map<PairKey, int64_t> open;
  int64_t lost = 0;
  for (const MessageList::Message& message : messages_of(sender, kFrames)) {
    MessageHeader header;
    ASSERT_EQ(read_header(message.channel, message.bytes, header), "");
    if (message.channel == Channel::kEvents && header.frame % 40 == 20) continue;
    begins.take(run, run.take(name_of(message.channel), message.bytes));
    for (const PairBegins::Change& change : begins.changes()) {
      if (change.kind == PairBegins::ChangeKind::kBegan) {
        ASSERT_TRUE(open.emplace(change.pair, change.began).second) << "frame " << header.frame;
        continue;
      }
      lost += change.kind == PairBegins::ChangeKind::kLost ? 1 : 0;
      ASSERT_TRUE(open.contains(change.pair)) << "frame " << header.frame;
      ASSERT_EQ(open[change.pair], change.began) << "frame " << header.frame;
      open.erase(change.pair);
    }
    ASSERT_EQ(open, begins.all()) << "frame " << header.frame;
  }
  EXPECT_GT(lost, 0);
}

TEST_F(RecordedCrowd, ContinuesAfterATornLength) {
  record({.avatars = 10, .pairs = 30});
  std::vector<uint8_t> bytes = bytes_of(log_.path());
  // Makes the length of a message in the middle larger than the file.
  LogReader reader(log_.path());
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent && event.offset < bytes.size() / 2)
    continue;
  bytes[event.offset + kLogHeadBytes - 4] = 0;
  bytes[event.offset + kLogHeadBytes - 3] = 0xf0;
  write_bytes(log_.path(), bytes);
  LogIndex index(log_.path());
  index.wait();
  EXPECT_EQ(index.last_frame(), kFrames - 1);
  EXPECT_NE(index.problem().find("damaged"), std::string::npos) << index.problem();
  RunReader run = described(index);
  const RunGeometry geometry(run);
  EXPECT_EQ(head_of(*LogPlayer(index, geometry).frame(kFrames - 1)).frame, kFrames - 1);
}

TEST_F(RecordedCrowd, ReportsAlteredMessages) {
  record({.avatars = 10, .pairs = 30});
  std::vector<uint8_t> bytes = bytes_of(log_.path());
  LogReader reader(log_.path());
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent &&
         (event.offset < bytes.size() / 2 || event.channel != name_of(Channel::kStates)))
    continue;
  bytes[event.offset + event.bytes - 9] ^= 1;  // one byte of a number: the message still decodes
  write_bytes(log_.path(), bytes);
  LogIndex index(log_.path());
  index.wait();
  EXPECT_NE(index.problem().find("1 stretch of messages is altered"), std::string::npos)
      << index.problem();
}

TEST_F(RecordedCrowd, ReportsTheMissingEnd) {
  record({.avatars = 10, .pairs = 30});
  const std::vector<uint8_t> sound = bytes_of(log_.path());
  LogReader reader(log_.path());
  std::vector<uint64_t> boundaries;
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent) boundaries.push_back(event.offset);
  const auto problem_of = [&](size_t size) {
    write_bytes(log_.path(), std::span(sound).first(size));
    LogIndex index(log_.path());
    index.wait();
    return index.problem();
  };
  EXPECT_EQ(problem_of(sound.size()), "");
  EXPECT_NE(problem_of(sound.size() - 1).find("torn"), std::string::npos);
  for (size_t i = boundaries.size() / 3; i < boundaries.size() - 2; i += 97) {
    EXPECT_NE(problem_of(boundaries[i]).find("cut off"), std::string::npos) << i;
    EXPECT_NE(problem_of(boundaries[i] + 9).find("torn"), std::string::npos) << i;
  }
}

TEST_F(RecordedCrowd, ListsThePairsOfAPerson) {
  const SyntheticRun::Options options{.avatars = 8, .seed = 5, .pairs = 12};
  record(options);
  LogIndex index(log_.path());
  index.wait();
  // Expected values: begins and ends of all pairs, frame by frame.
  SyntheticRun again(options);
  std::map<PairKey, int64_t> open;
  std::vector<std::array<int64_t, 2>> expected;  // begin, end of person 3's pairs up to frame 150
  for (int64_t number = 0; number <= 150; ++number)
    for (const PairEvent& event : again.step().events) {
      if (event.pair.a() != 3 && event.pair.b() != 3) continue;
      if (event.kind == EventKind::kBegin) {
        open[event.pair] = number;
      } else {
        expected.push_back({open[event.pair], number});
        open.erase(event.pair);
      }
    }
  for (const auto& [pair, begin] : open) expected.push_back({begin, -1});
  std::vector<std::array<int64_t, 2>> found;
  const auto answer = nlohmann::json::parse(index.history().of(3, 150, 10000));
  for (const auto& row : answer["pairs"]) found.push_back({row[0], row[1]});
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
}

/// Frame, begin frame, pair and kind of a change.
using ChangeRow = std::tuple<int64_t, int64_t, PairKey, int>;

ChangeRow row_of(const ContactRecord& record) {
  EXPECT_EQ(record.zero, 0);
  return {record.frame, record.began, PairKey(record.a, record.b, record.part_a, record.part_b),
          record.kind};
}

std::vector<ChangeRow> rows_of(const ContactsMessage& message) {
  std::vector<ChangeRow> rows;
  for (const ContactRecord& record : message.records) rows.push_back(row_of(record));
  return rows;
}

/// Returns the changes of a run, derived from its events. All contacts end after the last frame.
std::vector<ChangeRow> changes_by_hand(const SyntheticRun::Options& options) {
  SyntheticRun run(options);
  std::map<PairKey, int64_t> open;
  std::vector<ChangeRow> rows;
  for (int64_t number = 0; number < kFrames; ++number)
    for (const PairEvent& event : run.step().events) {
      const bool begins = event.kind == EventKind::kBegin;
      if (begins) open[event.pair] = number;
      rows.emplace_back(number, open[event.pair], event.pair, begins ? 0 : 1);
      if (!begins) open.erase(event.pair);
    }
  for (const auto& [pair, begin] : open) rows.emplace_back(kFrames, begin, pair, 1);
  return rows;
}

/// Returns the next binary message of a kind.
std::string next(TestSocket& browser, uint32_t kind) {
  for (;;) {
    const auto message = browser.read_message();
    if (!message) return "";
    uint32_t found = 0;
    if (message->opcode == Opcode::kBinary && message->payload.size() >= sizeof found)
      std::memcpy(&found, message->payload.data(), sizeof found);
    if (found == kind) return message->payload;
  }
}

ContactsMessage ask(TestSocket& browser, const std::string& query) {
  browser.send_frame(Opcode::kText, query);
  return contacts_of(next(browser, kContactsMessage));
}

TEST_F(RecordedCrowd, ServesTheContactsOfAllPairs) {
  const SyntheticRun::Options options{.avatars = 30, .seed = 5, .pairs = 60, .comings = true};
  record(options, 3);
  LogView view(log_.path(), {}, "<!doctype html>");
  view.index().wait();
  TestSocket browser(view.server().port());
  browser.open();
  const ContactsMessage all = ask(browser, R"({"contacts": 0})");
  const std::vector<ChangeRow> expected = changes_by_hand(options);
  ASSERT_GT(expected.size(), 1000u);
  EXPECT_EQ(rows_of(all), expected);
  EXPECT_EQ(all.head.first, 0);
  EXPECT_EQ(all.head.known, static_cast<double>(expected.size()));
  EXPECT_EQ(all.head.frame, static_cast<double>(view.index().last_frame()));

  const ContactsMessage rest = ask(browser, R"({"contacts": 500})");
  EXPECT_EQ(rest.head.first, 500);
  EXPECT_EQ(rows_of(rest), std::vector(expected.begin() + 500, expected.end()));
  const auto late = std::find_if(expected.begin(), expected.end(),
                                 [](const ChangeRow& row) { return std::get<0>(row) >= 150; });
  const ContactsMessage since = ask(browser, R"({"contacts": 3, "since": 150})");
  EXPECT_EQ(since.head.first, static_cast<double>(late - expected.begin()));
  EXPECT_EQ(rows_of(since), std::vector(late, expected.end()));
  const ContactsMessage none = ask(browser, R"({"contacts": 100000})");
  EXPECT_EQ(none.head.count, 0u);
  EXPECT_EQ(none.head.first, none.head.known);
}

TEST_F(RecordedCrowd, MarksContactsOfLostEvents) {
  const SyntheticRun::Options options{.avatars = 30, .seed = 5, .pairs = 60};
  record(options);
  std::vector<uint8_t> bytes = bytes_of(log_.path());
  LogReader reader(log_.path());
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent &&
         (event.offset < bytes.size() / 2 || event.channel != name_of(Channel::kEvents)))
    continue;
  MessageHeader header;
  ASSERT_EQ(read_header(Channel::kEvents, event.data, header), "");
  bytes[event.offset] ^= 1;  // the reader skips a message that begins like none
  write_bytes(log_.path(), bytes);
  LogView view(log_.path(), {}, "<!doctype html>");
  view.index().wait();
  TestSocket browser(view.server().port());
  browser.open();
  const std::vector<ChangeRow> found = rows_of(ask(browser, R"({"contacts": 0})"));
  const std::vector<ChangeRow> expected = changes_by_hand(options);
  const auto before = std::count_if(expected.begin(), expected.end(), [&](const ChangeRow& row) {
    return std::get<0>(row) < header.frame;
  });
  ASSERT_GT(before, 0);
  ASSERT_TRUE(std::equal(expected.begin(), expected.begin() + before, found.begin()));
  // Each touching pair is lost, and begins again at an unknown frame if it still touches.
  std::map<PairKey, int64_t> open;
  int lost = 0;
  for (const auto& [frame, began, pair, kind] : found) {
    if (kind == 0) {
      EXPECT_FALSE(open.contains(pair)) << "frame " << frame;
      open[pair] = began;
      continue;
    }
    ASSERT_TRUE(open.contains(pair)) << "frame " << frame;
    EXPECT_EQ(began, open[pair]) << "frame " << frame;
    open.erase(pair);
    if (kind != 2) continue;
    ++lost;
    EXPECT_GT(frame, header.frame);
  }
  EXPECT_GT(lost, 10);
  EXPECT_TRUE(open.empty()) << "the run's end ends all pairs";
}

// Contacts are never dropped like frames: the number of waiting messages is bounded.
TEST_F(RecordedCrowd, DisconnectsAPageThatReadsNoContacts) {
  record({.avatars = 30, .pairs = 60});
  LogView view(log_.path(), {.send_buffer_bytes = 4096}, "<!doctype html>");
  view.index().wait();
  TestSocket stalled(view.server().port(), 4096);
  stalled.open();
  for (int i = 0; i < 80; ++i) stalled.send_frame(Opcode::kText, R"({"contacts": 0})");
  for (int i = 0; i < 1000 && view.server().client_count() > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(view.server().client_count(), 0u);
}

TEST_F(RecordedCrowd, TellsPeopleFromRobots) {
  record({.avatars = 9});
  LogIndex index(log_.path());
  RunReader run = described(index);
  const Bytes message = run_message(run, RunGeometry(run), ViewMode::kLog);
  uint32_t size;
  std::memcpy(&size, message.data() + 4, sizeof size);
  const auto text = nlohmann::json::parse(message.begin() + 8, message.begin() + 8 + size);
  std::map<std::string, bool> is_person;
  for (const auto& model : text["models"]) is_person[model["name"]] = model["is_person"];
  EXPECT_EQ(is_person,
            (std::map<std::string, bool>{{adult()->name, true}, {rover()->name, false}}));
}

}  // namespace
}  // namespace throng::log_player_test
