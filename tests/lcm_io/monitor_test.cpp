// Monitor reports the totals of a run, and no input stops it.
#include "lcm_io/wire/monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "base/errors.h"
#include "base/random.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/log/log_sink.h"
#include "synthetic_run.h"

namespace throng::monitor_test {
namespace {

using Messages = std::vector<MessageList::Message>;

void watch(Inbox& inbox, Monitor& monitor, const MessageList::Message& m) {
  const auto update = inbox.take(name_of(m.channel), m.bytes);
  monitor.take(update, static_cast<double>(m.utime_us) * 1e-6);
}

TEST(Monitor, CountsEventsFramesAndStages) {
  SyntheticRun run({.seed = 5, .pairs = 200});
  const Messages messages = messages_of(run, 120);
  Inbox inbox;
  Monitor monitor(inbox);
  for (const auto& m : messages) watch(inbox, monitor, m);
  const double end_s = static_cast<double>(messages.back().utime_us) * 1e-6;
  const Monitor::Totals all = monitor.overall(end_s);
  EXPECT_EQ(all.frames, 120);
  EXPECT_EQ(all.begins, run.begins());
  EXPECT_EQ(all.ends, run.ends());
  EXPECT_EQ(all.updates[0], 120 * 20);
  EXPECT_EQ(all.tests[0], 120 * 20 * 7 + 119 * 120 / 2);
  EXPECT_DOUBLE_EQ(all.test_ns[3], 12.5 * 120 * 121 / 2);
  EXPECT_DOUBLE_EQ(all.now_s, end_s);
  EXPECT_EQ(all.messages[static_cast<size_t>(Channel::kFrameStats)], 120);
  EXPECT_EQ(monitor.frame_time().last_ms, 1);
  int64_t sides = 0;
  for (const Monitor::PartTotal& part : monitor.parts()) {
    sides += part.begins;
    EXPECT_EQ(part.touching, 0) << "the run has ended: " << part.name;
  }
  EXPECT_GE(sides, run.begins());
  EXPECT_LE(sides, 2 * run.begins());
}

TEST(Monitor, LimitsRecentTotalsToTwoSeconds) {
  SyntheticRun run({.seed = 5});
  Inbox inbox;
  Monitor monitor(inbox);
  double now_s = 0;
  for (const auto& m : messages_of(run, 600)) {
    now_s = static_cast<double>(m.utime_us) * 1e-6;
    watch(inbox, monitor, m);
  }
  const Monitor::Totals recent = monitor.recent(now_s);
  EXPECT_GE(recent.now_s, Monitor::kRecent_s);
  EXPECT_LE(recent.now_s, Monitor::kRecent_s + 0.6);
  EXPECT_NEAR(static_cast<double>(recent.frames) / recent.now_s, 60, 2);
}

TEST(Monitor, ReportsTheDurationOfEndedPairs) {
  const SyntheticRun::Options options{.seed = 8, .pairs = 30};
  SyntheticRun run(options), oracle(options);
  std::map<PairKey, int64_t> began;
  std::map<std::pair<int64_t, PairKey>, double> lasted;
  for (int i = 0; i < 90; ++i) {
    const Frame& frame = oracle.step();
    for (const PairEvent& event : frame.events)
      if (event.kind == EventKind::kBegin)
        began[event.pair] = frame.utime_us;
      else
        lasted[{frame.utime_us, event.pair}] =
            static_cast<double>(frame.utime_us - began[event.pair]) * 1e-6;
  }
  Inbox inbox;
  Monitor monitor(inbox);
  int compared = 0;
  for (const auto& m : messages_of(run, 90)) {
    watch(inbox, monitor, m);
    if (m.channel != Channel::kEvents || monitor.notes().empty()) continue;
    const Monitor::Note& note = monitor.notes().back();
    if (note.kind != EventKind::kEnd || !lasted.contains({note.utime_us, note.pair})) continue;
    EXPECT_DOUBLE_EQ(note.lasted_s, (lasted[{note.utime_us, note.pair}]));
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

TEST(Monitor, StartsAgainWithAnotherRun) {
  SyntheticRun first({.seed = 1}), second({.seed = 2});
  Inbox inbox;
  Monitor monitor(inbox);
  for (const auto& m : messages_of(first, 30)) watch(inbox, monitor, m);
  for (const auto& m : messages_of(second, 12)) watch(inbox, monitor, m);
  EXPECT_EQ(monitor.overall(1).frames, 12);
  EXPECT_EQ(monitor.overall(1).begins, second.begins());
}

TEST(Monitor, SurvivesAHundredThousandDamagedMessages) {
  constexpr uint64_t kSeed = 12;
  SyntheticRun source(
      {.avatars = 6, .pairs = 10, .crowd = SyntheticRun::Crowd::kRovers, .has_budget = true});
  const Messages run = messages_of(source, 60);
  Inbox inbox;
  Monitor monitor(inbox);
  for (uint64_t i = 0; i < 100'000; ++i) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " message " << i);
    const RandomKey key{kSeed, i, 0, Purpose::kStyle};
    // After the header, where damage is not rejected at once.
    auto m = run[random_bits(key, 0) % run.size()];
    for (uint32_t hit = 0; hit < random_bits(key, 1) % 4; ++hit) {
      const size_t at = random_bits(key, 2 * hit + 2) % 3 == 0 ? 8 : 60;
      m.bytes[at + random_bits(key, 2 * hit + 3) % (m.bytes.size() - at)] =
          static_cast<uint8_t>(random_bits(key, 50 + hit));
    }
    watch(inbox, monitor, m);
    if (i % 100 == 0) {
      EXPECT_LE(monitor.parts().size(), 64u);
      EXPECT_FALSE(monitor.frame_time().median_ms < 0);
      (void)monitor.recent(static_cast<double>(i));
    }
  }
  EXPECT_GT(inbox.rejected(), 10'000);
  EXPECT_LE(monitor.notes().size(), Monitor::kNotes);
}

TEST(Monitor, ReadsDamagedLogsToTheirEnd) {
  constexpr uint64_t kSeed = 13;
  const ScratchFile sound, damaged;
  SyntheticRun run({.avatars = 3, .pairs = 6, .crowd = SyntheticRun::Crowd::kRovers});
  LogSink sink(sound.path());
  run.play(sink, 6);
  const auto bytes = bytes_of(sound.path());
  int64_t watched = 0;
  for (uint64_t round = 0; round < 1000; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " round " << round);
    const RandomKey key{kSeed, round, 0, Purpose::kStyle};
    auto hit = bytes;
    for (uint32_t k = 0; k < 1 + random_bits(key, 0) % 12; ++k)
      hit[4 + random_bits(key, 2 * k + 1) % (hit.size() - 4)] =
          static_cast<uint8_t>(random_bits(key, 2 * k + 2));
    write_bytes(damaged.path(), hit);
    LogReader log(damaged.path());
    Inbox inbox;
    Monitor monitor(inbox);
    LogEvent event;
    for (auto status = log.next(event); status != LogReader::Status::kEnd;
         status = log.next(event)) {
      if (status != LogReader::Status::kEvent) {
        if (!log.resync()) break;
        continue;
      }
      monitor.take(inbox.take(event.channel, event.data), 0);
      ++watched;
    }
    (void)monitor.parts();
  }
  EXPECT_GT(watched, 10'000);
}

TEST(Monitor, RemovesControlCharactersFromNames) {
  EXPECT_EQ(printable("walkers"), "walkers");
  EXPECT_EQ(printable("Fu\xc3\x9fg\xc3\xa4nger"), "Fu\xc3\x9fg\xc3\xa4nger");
  EXPECT_EQ(printable("\033[2J\a\r\n"), "?[2J???");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "??2J")
      << "a control character of two bytes";
  EXPECT_EQ(printable("\xff\xc3"), "??");
  EXPECT_EQ(printable(std::string(1000, 'x')).size(), 64u);
}

}  // namespace
}  // namespace throng::monitor_test
