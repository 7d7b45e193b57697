// THRONG_CHECKSUMS: every flipped bit of a log is detected, damage is located, repaired logs are
// sound, and the origin of a run is stated.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "base/errors.h"
#include "base/random.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/codec/running_checksums.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "scenes/run/runner.h"
#include "synthetic_run.h"

namespace throng::checks_test {
namespace {

using testing::HasSubstr;

class BitFlipper {
 public:
  explicit BitFlipper(const std::vector<uint8_t>& bytes) : bytes_(bytes) {
    write_bytes(file_.path(), bytes);
    descriptor_ = ::open(file_.path().c_str(), O_WRONLY | O_CLOEXEC);
  }
  ~BitFlipper() { ::close(descriptor_); }
  BitFlipper(const BitFlipper&) = delete;
  BitFlipper& operator=(const BitFlipper&) = delete;

  /// Returns whether the log with this bit flipped is reported as sound.
  bool is_called_sound(size_t bit) {
    put(bit / 8, static_cast<uint8_t>(bytes_[bit / 8] ^ 1u << bit % 8));
    bool is_sound = false;
    try {
      is_sound = check_log(file_.path()).is_sound();
    } catch (const InputError&) {
      EXPECT_LT(bit / 8, 4u) << "only damage of the first magic number makes the file no log";
    }
    put(bit / 8, bytes_[bit / 8]);
    return is_sound;
  }
  std::string place_of(size_t bit) const {
    LogReader log(file_.path());
    for (LogEvent event; log.next(event) == LogReader::Status::kEvent;)
      if (event.offset + event.bytes > bit / 8)
        return "byte " + std::to_string(bit / 8 - event.offset) + " of event " +
               std::to_string(event.number) + " on " + std::string(event.channel);
    return "after the end";
  }
  const std::filesystem::path& path() const { return file_.path(); }

 private:
  void put(size_t at, uint8_t byte) const {
    ASSERT_EQ(::pwrite(descriptor_, &byte, 1, static_cast<off_t>(at)), 1);
  }
  ScratchFile file_;
  const std::vector<uint8_t>& bytes_;
  int descriptor_ = -1;
};

/// A log without adults, to keep it small.
std::vector<uint8_t> small_log(int frames, int avatars = 2) {
  const ScratchFile file;
  SyntheticRun run(
      {.avatars = avatars, .seed = 6, .pairs = 5, .crowd = SyntheticRun::Crowd::kRovers});
  LogSink sink(file.path());
  run.play(sink, frames);
  return bytes_of(file.path());
}

TEST(Checksums, DetectEveryFlippedBitOfASmallLog) {
  const std::vector<uint8_t> bytes = small_log(2);
  BitFlipper log(bytes);
  ASSERT_TRUE(check_log(log.path()).is_sound());
  // Every bit is significant. Sanitizer builds test a part only, because all bits take a quarter of
  // an hour.
  constexpr size_t kEvery = THRONG_SLOWNESS > 1 ? 9 : 1;
  int unnoticed = 0;
  for (size_t bit = 0; bit < 8 * bytes.size(); bit += kEvery)
    if (log.is_called_sound(bit) && ++unnoticed < 10) ADD_FAILURE() << log.place_of(bit);
  EXPECT_EQ(unnoticed, 0) << "of " << 8 * bytes.size() << " bits, every " << kEvery;
}

/// People who enter and leave, an obstacle, an externally controlled group, and levels of a budget.
std::vector<uint8_t> log_of_a_real_run() {
  const ScratchFile scene(".yaml"), file;
  std::ofstream(scene.path()) << R"(name: checks
seed: 4
duration_s: 2
step_s: 1/30
ground: {min_m: [0, 0], max_m: [12, 6]}
obstacles:
  - {name: kiosk, kind: box, position_m: [6, 3], size_m: [0.6, 0.6, 2]}
groups:
  - name: visitors
    count: 30
    spawn: {min_m: [3, 1], max_m: [9, 5]}
    sources:
      - {area: {min_m: [0, 1], max_m: [2, 5]}, count: 6, rate_per_s: 4, arrivals: poisson}
    goals:
      - {min_m: [11, 2], max_m: [12, 4]}
    on_arrival: leave
  - name: guide
    count: 1
    control_channel: GUIDE
    radius_m: 0.3
    spawn: {min_m: [7, 1], max_m: [8, 2]}
)";
  Simulation simulation(load_scene(scene.path().string()), {.culler = {.budget_tests = 400}});
  {
    LogSink sink(file.path());
    sink.begin(simulation.info());
    for (int i = 0; i < 60; ++i) sink.frame(simulation.info(), simulation.step());
    sink.end(simulation.info(), simulation.finish());
  }
  return bytes_of(file.path());
}

TEST(Checksums, DetectAThousandFlippedBitsOfARealRun) {
  constexpr uint64_t kSeed = 14;
  const std::vector<uint8_t> bytes = log_of_a_real_run();
  BitFlipper log(bytes);
  const LogReport report = check_log(log.path());
  ASSERT_TRUE(report.is_sound()) << report.problems.front();
  EXPECT_GT(report.begins, 10);
  EXPECT_GT(report.begins_by_level[0] + report.begins_by_level[1], 0) << "levels";
  for (uint64_t round = 0; round < 1000; ++round) {
    const size_t bit = random_bits({kSeed, round, 0, Purpose::kStyle}) % (8 * bytes.size());
    EXPECT_FALSE(log.is_called_sound(bit))
        << log.place_of(bit) << ", seed " << kSeed << " round " << round;
  }
}

/// A log of a few frames, its events, and the results of damage and repair.
class LogRepair : public testing::Test {
 protected:
  LogRepair() : bytes_(small_log(6)) {
    write_bytes(file_.path(), bytes_);
    LogReader log(file_.path());
    for (LogEvent event; log.next(event) == LogReader::Status::kEvent;)
      events_.push_back({std::string(event.channel), event.offset, event.bytes, event.data.size()});
  }
  struct Event {
    std::string channel;
    uint64_t offset, bytes, data_bytes;
  };
  const Event& event(std::string_view channel, int n) const {
    for (const Event& event : events_)
      if (event.channel == channel && n-- == 0) return event;
    throw std::out_of_range("no such event");
  }
  void damage(const Event& event, int64_t byte) {
    const auto data = event.offset + event.bytes - event.data_bytes;
    bytes_[static_cast<size_t>(byte >= 0 ? data + static_cast<uint64_t>(byte)
                                         : event.offset + event.bytes -
                                               static_cast<uint64_t>(-byte))] ^= 4;
  }
  void erase(const Event& event) {
    const auto first = bytes_.begin() + static_cast<ptrdiff_t>(event.offset);
    bytes_.erase(first, first + static_cast<ptrdiff_t>(event.bytes));
  }
  LogReport check() {
    write_bytes(file_.path(), bytes_);
    return check_log(file_.path());
  }
  LogReport check_repaired() {
    write_bytes(file_.path(), bytes_);
    repair_log(file_.path(), repaired_.path());
    return check_log(repaired_.path());
  }

  ScratchFile file_, repaired_;
  std::vector<uint8_t> bytes_;
  std::vector<Event> events_;
};

TEST_F(LogRepair, NamesDamageByChannelAndFrame) {
  // The last bytes of a states message are joint positions, which may have any value.
  damage(event("THRONG_STATES", 3), -10);
  const LogReport report = check();
  ASSERT_EQ(report.problem_count, 1) << testing::PrintToString(report.problems);
  EXPECT_THAT(report.problems[0],
              HasSubstr("THRONG_STATES: damaged, 1 message, between the checksums "
                        "of frame 2 and those of frame 3"));
  ASSERT_EQ(report.damage.size(), 1u);
  EXPECT_TRUE(report.damage[0].contains(Channel::kStates, event("THRONG_STATES", 3).offset));
  EXPECT_FALSE(report.damage[0].contains(Channel::kStates, event("THRONG_STATES", 2).offset));
  EXPECT_FALSE(report.damage[0].contains(Channel::kStates, event("THRONG_STATES", 4).offset));
}

TEST_F(LogRepair, ReportsTwoDamagesSeparately) {
  damage(event("THRONG_STATES", 1), -10);
  damage(event("THRONG_FRAME_STATS", 4), 80);
  const LogReport report = check();
  ASSERT_EQ(report.damage.size(), 2u) << testing::PrintToString(report.problems);
  EXPECT_EQ(report.damage[0].channel, Channel::kStates);
  EXPECT_EQ(report.damage[0].to_frame, 1);
  EXPECT_EQ(report.damage[1].channel, Channel::kFrameStats);
  EXPECT_EQ(report.damage[1].to_frame, 4);
}

TEST_F(LogRepair, CountsAMissingMessage) {
  erase(event("THRONG_FRAME_STATS", 2));
  EXPECT_THAT(check().problems, testing::Contains(HasSubstr(
                                    "THRONG_FRAME_STATS: 0 messages instead of 1, between the "
                                    "checksums of frame 1 and those of frame 2")));
}

TEST_F(LogRepair, RemovesAllDamage) {
  damage(event("THRONG_STATES", 3), -10);
  const LogReport report = check_repaired();
  EXPECT_TRUE(report.damage.empty()) << testing::PrintToString(report.problems);
  EXPECT_TRUE(report.repaired);
  EXPECT_EQ(report.log_events, static_cast<int64_t>(events_.size()) - 1);
  // The log is not sound, because it reports the missing messages.
  EXPECT_FALSE(report.is_sound() || report.finished);
  EXPECT_EQ(report.channels[static_cast<size_t>(Channel::kStates)].missing, 1);
  EXPECT_TRUE(report.hash_agrees) << "no event is missing";
}

TEST_F(LogRepair, RemovesDamagedEventsAndReportsTheHash) {
  damage(event("THRONG_EVENTS", 2), 66);
  const LogReport report = check_repaired();
  EXPECT_TRUE(report.damage.empty()) << testing::PrintToString(report.problems);
  EXPECT_TRUE(report.repaired);
  EXPECT_FALSE(report.hash_agrees);
  EXPECT_THAT(report.problems, testing::Contains(HasSubstr("the events in the log have another")));
}

TEST_F(LogRepair, IsIdempotent) {
  damage(event("THRONG_STATES", 3), -10);
  damage(event("THRONG_CHECKSUMS", 4), 70);
  check_repaired();
  const auto once = bytes_of(repaired_.path());
  bytes_ = once;
  check_repaired();
  EXPECT_EQ(bytes_of(repaired_.path()), once);
}

TEST_F(LogRepair, LeavesALogWhoseFlippedBitsAreDetected) {
  damage(event("THRONG_STATES", 3), -10);
  check_repaired();
  const auto repaired = bytes_of(repaired_.path());
  write_bytes(file_.path(), repaired);
  LogReader log(file_.path());
  for (LogEvent event; log.next(event) == LogReader::Status::kEvent;) {
    if (event.channel != "THRONG_STATES") continue;
    bytes_ = repaired;
    bytes_[event.offset + event.bytes - 9] ^= 1;
    const LogReport report = check();
    ASSERT_EQ(report.damage.size(), 1u) << testing::PrintToString(report.problems);
    EXPECT_EQ(report.damage[0].channel, Channel::kStates);
  }
}

TEST_F(LogRepair, ReportsMessagesAfterTheLastChecksums) {
  const Event& last = event("THRONG_CHECKSUMS", 3);
  bytes_.resize(last.offset + last.bytes);
  LogReport report = check();
  EXPECT_TRUE(report.is_sound() && !report.finished) << "killed after frame 3";
  EXPECT_EQ(report.checked_frame, 3);
  EXPECT_EQ(report.uncovered, 0);

  bytes_ = small_log(6);
  const Event& states = event("THRONG_STATES", 4);
  bytes_.resize(states.offset + states.bytes);
  report = check();
  EXPECT_TRUE(report.is_sound() && !report.finished);
  EXPECT_GT(report.uncovered, 0);
  EXPECT_THAT(describe_coverage(report), testing::Contains(HasSubstr("not covered: ")));
}

TEST_F(LogRepair, ReportsALogWithoutLastChecksumsAsCutOff) {
  erase(events_.back());
  ASSERT_EQ(events_.back().channel, "THRONG_CHECKSUMS");
  const LogReport report = check();
  EXPECT_TRUE(report.is_sound());
  EXPECT_FALSE(report.finished);
  EXPECT_EQ(report.uncovered, 2) << "the last ends and THRONG_END have no checksums";
}

TEST_F(LogRepair, ReportsMessagesAfterTheEnd) {
  const Event& states = event("THRONG_STATES", 5);
  const std::vector<uint8_t> copy(
      bytes_.begin() + static_cast<ptrdiff_t>(states.offset),
      bytes_.begin() + static_cast<ptrdiff_t>(states.offset + states.bytes));
  bytes_.insert(bytes_.end(), copy.begin(), copy.end());
  EXPECT_THAT(check().problems, testing::Contains(HasSubstr("after the last one of the run")));
}

TEST_F(LogRepair, NamesAnUnknownChannel) {
  const Event& counters = event("THRONG_FRAME_STATS", 2);
  bytes_[counters.offset + kLogHeadBytes + 3] ^= 1;
  const LogReport report = check();
  EXPECT_THAT(report.problems,
              testing::Contains(HasSubstr("'THRNNG_FRAME_STATS' is not a channel of a run")));
  EXPECT_THAT(report.problems,
              testing::Contains(HasSubstr("THRONG_FRAME_STATS: 0 messages instead of 1")));
  EXPECT_TRUE(check_repaired().damage.empty());
}

TEST(Checksums, AreTheOnlyMessageAfterTheTotalsOfTheEnd) {
  SyntheticRun run({.avatars = 5, .seed = 3});
  const auto messages = messages_of(run, 4);
  std::map<std::string, int64_t> before_end;
  end_t end;
  for (const auto& m : messages) {
    if (m.channel == Channel::kEnd) {
      ASSERT_EQ(decode(m.bytes, end), "");
      break;
    }
    ++before_end[std::string(name_of(m.channel))];
  }
  for (size_t i = 0; i < end.channels.size(); ++i)
    EXPECT_EQ(end.messages[i], before_end[end.channels[i]]) << end.channels[i];
  checksums_t last;
  ASSERT_EQ(messages.back().channel, Channel::kChecksums);
  ASSERT_EQ(decode(messages.back().bytes, last), "");
  EXPECT_TRUE(last.is_last);
  EXPECT_EQ(last.seq, before_end["THRONG_CHECKSUMS"])
      << "it follows the end and is not counted there";
  EXPECT_EQ(last.message_index, static_cast<int64_t>(messages.size()) - 1);
  EXPECT_EQ(last.hash, end.hash);
  EXPECT_EQ(sum_of(Channel::kEnd, last).messages, 1);
  EXPECT_EQ(sum_of(Channel::kChecksums, last).messages, last.seq) << "all before it";
}

TEST(Checksums, FollowTheStatisticsOfEveryFrame) {
  SyntheticRun run({.seed = 3});
  const auto messages = messages_of(run, 30);
  int64_t frames = 0;
  for (size_t i = 0; i + 1 < messages.size(); ++i) {
    if (messages[i].channel != Channel::kFrameStats) continue;
    EXPECT_EQ(messages[i + 1].channel, Channel::kChecksums);
    ++frames;
  }
  EXPECT_EQ(frames, 30);
}

TEST(Checksums, AreRejectedWhenDamaged) {
  SyntheticRun run({.avatars = 3, .seed = 3});
  auto bytes = messages_of(run, 1).back().bytes;
  ASSERT_EQ(check_message(Channel::kChecksums, bytes), "");
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    ASSERT_NE(check_message(Channel::kChecksums, bytes), "") << "bit " << bit;
    bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
  }
}

TEST(Checksums, RejectImpossibleTotalsWithAValidChecksum) {
  SyntheticRun run({.avatars = 3, .seed = 3});
  checksums_t sound;
  ASSERT_EQ(decode(messages_of(run, 1).back().bytes, sound), "");
  const auto defect = [&](auto change) {
    checksums_t changed = sound;
    change(changed);
    std::vector<uint8_t> bytes(static_cast<size_t>(changed.getEncodedSize()));
    changed.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    seal(bytes);
    return check_message(Channel::kChecksums, bytes);
  };
  EXPECT_EQ(defect([](checksums_t&) {}), "");
  EXPECT_THAT(defect([](checksums_t& c) { c.message_index = -1; }),
              HasSubstr("found message_index -1"));
  EXPECT_THAT(defect([](checksums_t& c) { c.messages[2] = -5; }), HasSubstr("found messages -5"));
  EXPECT_THAT(defect([](checksums_t& c) { c.bytes[2] = INT64_MAX; }),
              HasSubstr("found bytes 922337"));
}

/// Records a run as an independent recorder does: with clock times as stamps and its own numbers.
void record(const std::vector<MessageList::Message>& messages, const std::filesystem::path& file,
            size_t first = 0, size_t left_out = SIZE_MAX) {
  LogFile log(file);
  log.write("SOMEBODY_ELSE", 1'700'000'000'000'000, std::vector<uint8_t>(5));
  for (size_t i = first; i < messages.size(); ++i)
    if (i != left_out)
      log.write(name_of(messages[i].channel), 1'700'000'000'000'001 + static_cast<int64_t>(i) * 100,
                messages[i].bytes);
  log.close();
}

TEST(Checksums, CoverARecordingByTheSendersNumbers) {
  SyntheticRun run({.avatars = 4, .seed = 3, .crowd = SyntheticRun::Crowd::kRovers});
  auto messages = messages_of(run, 20);
  const ScratchFile file;
  record(messages, file.path());
  LogReport report = check_log(file.path());
  EXPECT_TRUE(report.is_sound() && report.finished) << testing::PrintToString(report.problems);
  EXPECT_TRUE(report.has_checks);
  EXPECT_EQ(report.foreign_messages, 1);

  for (auto& message : messages)
    if (message.channel == Channel::kStates && &message > &messages[messages.size() / 2]) {
      message.bytes[message.bytes.size() - 9] ^= 1;
      break;
    }
  record(messages, file.path());
  report = check_log(file.path());
  ASSERT_EQ(report.damage.size(), 1u) << testing::PrintToString(report.problems);
  EXPECT_EQ(report.damage[0].channel, Channel::kStates);
}

TEST(Checksums, ReportOnlyTheMessagesThatARecorderMissed) {
  SyntheticRun run({.avatars = 4, .seed = 3, .crowd = SyntheticRun::Crowd::kRovers});
  const auto messages = messages_of(run, 20);
  const ScratchFile file;
  for (const auto& [first, left_out] : {std::pair<size_t, size_t>{25, SIZE_MAX}, {0, 40}}) {
    record(messages, file.path(), first, left_out);
    const LogReport report = check_log(file.path());
    EXPECT_TRUE(report.damage.empty()) << testing::PrintToString(report.problems);
    EXPECT_FALSE(report.is_sound());
  }
}

TEST(Checksums, ContinueFromTheHashOfAResumedRun) {
  const ScratchFile file;
  SyntheticRun whole({.seed = 3, .pairs = 100});
  Resumed resumed;
  for (int i = 0; i < 20; ++i) {
    const Frame& frame = whole.step();
    resumed = {
        frame.number, frame.utime_us, {frame.pairs.begin(), frame.pairs.end()}, {}, frame.hash};
  }
  RunInfo info = whole.info();
  info.resumed = resumed;
  {
    LogSink sink(file.path());
    sink.begin(info);
    for (int i = 0; i < 20; ++i) sink.frame(info, whole.step());
    sink.end(info, whole.finish());
  }
  const LogReport report = check_log(file.path());
  EXPECT_TRUE(report.is_sound() && report.finished) << testing::PrintToString(report.problems);
  EXPECT_TRUE(report.hash_agrees);
}

TEST(Checksums, ReportAHashThatDiffersFromTheEvents) {
  struct Liar : Sink {
    explicit Liar(LogSink& to) : log(to) {}
    void begin(const RunInfo& run) override { log.begin(run); }
    void frame(const RunInfo& run, const Frame& frame) override {
      Frame changed = frame;
      changed.hash ^= frame.number == 3 ? 1 : 0;
      log.frame(run, changed);
    }
    void end(const RunInfo& run, const RunEnd& end) override { log.end(run, end); }
    LogSink& log;
  };
  const ScratchFile file;
  SyntheticRun run({.seed = 3});
  LogSink sink(file.path());
  Liar liar(sink);
  run.play(liar, 6);
  const LogReport report = check_log(file.path());
  EXPECT_FALSE(report.is_sound());
  EXPECT_THAT(report.problems[0], HasSubstr("of its events up to frame 3, those in the log have"));
}

/// Returns the description of a run after `change`.
checksums_t checksums_of(const std::function<void(RunInfo&)>& change) {
  SyntheticRun run({.avatars = 3});
  RunInfo info = run.info();
  change(info);
  checksums_t out;
  describe_checksums(info, out);
  return out;
}

TEST(Checksums, StateTheContactsThatARunOmits) {
  EXPECT_EQ(checksums_of([](RunInfo&) {}).omits, "");
  const std::pair<Strategy, const char*> cases[] = {
      {Strategy::kNone, "every contact: nothing was tested"},
      {Strategy::kSphere, "body parts: a pair is two whole bodies whose spheres meet"},
      {Strategy::kHybridOne, "every contact but those of the first body"},
      {Strategy::kVolume, ""},
      {Strategy::kHybridAll, ""},
      {Strategy::kTwoPass, ""},
  };
  for (const auto& [strategy, words] : cases) {
    const checksums_t found = checksums_of([s = strategy](RunInfo& info) { info.strategy = s; });
    EXPECT_EQ(found.omits, words);
    EXPECT_EQ(found.strategy, name_of(strategy));
  }
  EXPECT_THAT(checksums_of([](RunInfo& info) { info.culling = false; }).omits,
              HasSubstr("all contacts"));
  const checksums_t with_budget =
      checksums_of([](RunInfo& info) { info.culler.budget_tests = 500; });
  EXPECT_THAT(with_budget.omits, HasSubstr("their level names the last test passed"));
  EXPECT_EQ(with_budget.budget_tests, 500);
  EXPECT_EQ(with_budget.budget_ms, -1);
  EXPECT_EQ(with_budget.hash_kind, static_cast<int32_t>(EventHashKind::kEventsAndLevels));
}

}  // namespace
}  // namespace throng::checks_test
