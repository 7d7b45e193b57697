// Logs are reproducible bytewise, readable by LCM's code, and report a full disk.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <thread>

#include "base/errors.h"
#include "lcm_io/codec/log_format.h"
#include "lcm_io/codec/message_validation.h"
#include "lcm_io/export/exported_log.h"
#include "lcm_io/log/file_writer.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "synthetic_run.h"

namespace throng::log_test {
namespace {

std::vector<uint8_t> log_of(uint64_t seed, uint64_t instance, const LogOptions& options = {}) {
  const ScratchFile file;
  SyntheticRun run({.seed = seed});
  run.set_instance(instance);
  LogSink sink(file.path(), options);
  run.play(sink, 90);
  return bytes_of(file.path());
}

TEST(Log, IsReproducible) {
  const auto first = log_of(1, 111);
  EXPECT_GT(first.size(), 100'000u);
  EXPECT_EQ(first, log_of(1, 222)) << "instance and clock are not in the log";
  EXPECT_NE(first, log_of(2, 111));
  EXPECT_NE(first, log_of(1, 111, {.with_clock_times = true})) << "clock times were requested";
}

/// Tens of thousands of avatars take more messages per frame than are encoded at a time.
TEST(Log, IsIndependentOfTheNumberOfThreads) {
  std::vector<uint8_t> expected;
  for (const int threads : {1, 2, 3}) {
    const ScratchFile file;
    SyntheticRun run({.avatars = 30'000, .seed = 5});
    LogSink sink(file.path(), {.threads = threads});
    run.play(sink, 3);
    const auto found = bytes_of(file.path());
    if (threads == 1) expected = found;
    EXPECT_GT(found.size(), 3'000'000u);
    EXPECT_TRUE(found == expected) << threads << " threads";
    EXPECT_TRUE(check_log(file.path()).is_sound()) << threads << " threads";
  }
}

TEST(Log, ContainsNoPathOfThisMachine) {
  const auto bytes = log_of(1, 1);
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_EQ(text.find("/a/folder"), std::string::npos);
  EXPECT_EQ(text.find(data_directory().string()), std::string::npos);
}

TEST(Log, IsReadableByLcm) {
  const ScratchFile file;
  SyntheticRun run({.seed = 9, .pairs = 500});
  LogSink sink(file.path());
  run.play(sink, 150);

  lcm::LogFile log(file.path().string(), "r");
  ASSERT_TRUE(log.good());
  int64_t events = 0, begins = 0, ends = 0, last_stamp = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    EXPECT_EQ(event->eventnum, events++);
    EXPECT_GE(event->timestamp, last_stamp);
    last_stamp = event->timestamp;
    if (event->channel != "THRONG_EVENTS") continue;
    events_t message;
    ASSERT_EQ(message.decode(event->data, 0, event->datalen), event->datalen);
    for (const uint8_t kind : message.kind) ++(kind == 0 ? begins : ends);
  }
  EXPECT_EQ(events, sink.messages());
  EXPECT_EQ(begins, run.begins());
  EXPECT_EQ(ends, run.ends());
  EXPECT_EQ(last_stamp, 149 * 1'000'000 / 60) << "stamps are simulation time";
}

TEST(Log, IsReadAsByLcm) {
  const ScratchFile file;
  SyntheticRun run({.seed = 9});
  LogSink sink(file.path());
  run.play(sink, 70);
  lcm::LogFile lcm_reader(file.path().string(), "r");
  LogReader reader(file.path());
  LogEvent event;
  uint64_t offset = 0;
  while (reader.next(event) == LogReader::Status::kEvent) {
    const lcm::LogEvent* expected = lcm_reader.readNextEvent();
    ASSERT_NE(expected, nullptr);
    EXPECT_EQ(event.number, expected->eventnum);
    EXPECT_EQ(event.stamp_us, expected->timestamp);
    EXPECT_EQ(event.channel, expected->channel);
    const auto* data = static_cast<const uint8_t*>(expected->data);
    EXPECT_TRUE(std::equal(event.data.begin(), event.data.end(), data, data + expected->datalen));
    EXPECT_EQ(event.offset, offset);
    offset += event.bytes;
  }
  EXPECT_EQ(lcm_reader.readNextEvent(), nullptr);
  EXPECT_EQ(offset, reader.size());
}

TEST(Log, IsSoundAfterAFinishedRun) {
  const ScratchFile file;
  SyntheticRun run({.seed = 3, .pairs = 300});
  LogSink sink(file.path());
  run.play(sink, 130);
  const LogReport report = check_log(file.path());
  EXPECT_THAT(report.problems, testing::IsEmpty());
  EXPECT_TRUE(report.finished && report.is_sound() && !report.torn && !report.damaged);
  EXPECT_EQ(report.begins, run.begins());
  EXPECT_EQ(report.ends, run.ends());
  EXPECT_EQ(report.begins, report.ends);
  EXPECT_EQ(report.open_pairs, 0);
  EXPECT_EQ(report.log_events, sink.messages());
  EXPECT_EQ(report.bytes, sink.bytes());
  EXPECT_EQ(report.sound_bytes, report.bytes);
  EXPECT_EQ(report.channels[static_cast<size_t>(Channel::kStates)].messages, 130);
}

TEST(Log, IsSoundWithABudgetAndChangingPeople) {
  const ScratchFile file;
  SyntheticRun run({.seed = 3, .pairs = 300, .comings = true, .has_budget = true});
  LogSink sink(file.path());
  run.play(sink, 130);
  const LogReport report = check_log(file.path());
  EXPECT_THAT(report.problems, testing::IsEmpty());
  EXPECT_TRUE(report.finished);
  EXPECT_EQ(report.begins, run.begins());
}

TEST(Log, IsUnsoundWithAPairOfAnAbsentAvatar) {
  struct AbsentAvatar : Sink {  // reports avatar 0 as absent, and keeps its pairs
    explicit AbsentAvatar(LogSink& to) : log(to) {}
    void begin(const RunInfo& run) override { log.begin(run); }
    void frame(const RunInfo& run, const Frame& frame) override {
      std::vector<uint8_t> present(frame.roots.size(), 1);
      present[0] = 0;
      Frame changed = frame;
      changed.present = present;
      log.frame(run, changed);
    }
    void end(const RunInfo& run, const RunEnd& end) override { log.end(run, end); }
    LogSink& log;
  };
  const ScratchFile file;
  SyntheticRun run({.avatars = 5, .seed = 3, .pairs = 60});
  LogSink sink(file.path());
  AbsentAvatar absent_avatar(sink);
  run.play(absent_avatar, 3);
  const LogReport report = check_log(file.path());
  EXPECT_FALSE(report.is_sound());
  EXPECT_THAT(report.problems, testing::Each(testing::HasSubstr("of an avatar that is absent")));
}

TEST(Log, IsDescribedAsText) {
  const ScratchFile file;
  SyntheticRun run({.seed = 3});
  LogSink sink(file.path());
  run.play(sink, 61);
  const std::string text = describe_log(file.path());
  for (const char* expected :
       {"scene synthetic, seed 3, 20 avatars", "model adult", "model rover", "1 obstacle",
        "group walkers: 14 avatars", "group robots: 6 avatars, controlled by ROBOT_DRIVE",
        "THRONG_STATES", "finished"})
    EXPECT_THAT(text, testing::HasSubstr(expected));
  EXPECT_THAT(text, testing::HasSubstr(std::to_string(run.begins()) + " begins"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("problem")));
}

TEST(Log, ReportsAFullDiskWithTheFileName) {
  SyntheticRun run({.avatars = 500});
  LogSink sink("/dev/full");
  try {
    run.play(sink, 300);
    FAIL() << "no error";
  } catch (const EnvironmentError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/dev/full"));
    EXPECT_THAT(error.what(), testing::HasSubstr("No space left"));
  }
}

TEST(Log, ReportsAMissingFolder) {
  EXPECT_THROW(LogSink("/no/such/folder/run.lcmlog"), EnvironmentError);
}

TEST(Log, IsWrittenWithinTheFlushInterval) {
  const ScratchFile file;
  SyntheticRun run({.avatars = 3, .pairs = 2, .crowd = SyntheticRun::Crowd::kAdults});
  LogSink sink(file.path(), {.flush_s = 0.05});
  sink.begin(run.info());
  EXPECT_EQ(std::filesystem::file_size(file.path()), sink.bytes())
      << "the description is written at once";
  using Clock = std::chrono::steady_clock;
  // At the end of each frame, bytes not yet in the file are at most flush_s old, less a frame.
  std::vector<std::pair<Clock::time_point, uint64_t>> history;
  for (int i = 0; i < 40; ++i) {
    const auto started = Clock::now();
    sink.frame(run.info(), run.step());
    const auto now = Clock::now();
    history.emplace_back(started, sink.bytes());
    const uint64_t handed_over = sink.bytes() - sink.buffered();
    const auto waits = std::find_if(history.begin(), history.end(),
                                    [&](const auto& one) { return one.second > handed_over; });
    if (waits != history.end() && waits + 1 != history.end()) {
      EXPECT_LT(std::chrono::duration<double>(now - waits->first).count(), 0.06) << "frame " << i;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
}

TEST(Log, HoldsEveryFrameBeforeTheNextWithoutAFlushInterval) {
  const ScratchFile file;
  SyntheticRun run({.avatars = 3, .pairs = 2, .crowd = SyntheticRun::Crowd::kAdults});
  LogSink sink(file.path(), {.flush_s = 0});
  sink.begin(run.info());
  for (int i = 0; i < 10; ++i) {
    sink.frame(run.info(), run.step());
    EXPECT_EQ(std::filesystem::file_size(file.path()), sink.bytes()) << "frame " << i;
  }
}

/// Reads a pipe after a while, in small pieces.
class SlowReader {
 public:
  explicit SlowReader(const std::filesystem::path& pipe)
      : thread_([this, pipe] {
          std::ifstream in(pipe, std::ios::binary);
          std::this_thread::sleep_for(std::chrono::milliseconds(300));
          std::vector<char> piece(100'000);
          while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())), in.gcount() > 0)
            read_.insert(read_.end(), piece.begin(), piece.begin() + in.gcount());
        }) {}
  const std::vector<uint8_t>& all() {
    thread_.join();
    return read_;
  }

 private:
  std::vector<uint8_t> read_;
  std::thread thread_;
};

std::vector<uint8_t> counted(size_t bytes) {
  std::vector<uint8_t> out(bytes);
  for (size_t i = 0; i < bytes; ++i) out[i] = static_cast<uint8_t>(i * 2654435761u >> 24);
  return out;
}

TEST(FileWriter, LosesNothingWithASlowFile) {
  const ScratchFile pipe;
  std::filesystem::remove(pipe.path());
  ASSERT_EQ(::mkfifo(pipe.path().c_str(), 0600), 0);
  SlowReader reader(pipe.path());
  const std::vector<uint8_t> bytes = counted(40'000'000);  // more than all buffers hold
  FileWriter writer(pipe.path());
  for (size_t at = 0; at < bytes.size(); at += 1'000'000) writer.put(&bytes[at], 1'000'000);
  writer.close();
  EXPECT_TRUE(reader.all() == bytes);
}

TEST(FileWriter, LeavesAPrefixAfterAnError) {
  const ScratchFile file;
  const rlimit limit = {6'500'000, 6'500'000};
  const std::vector<uint8_t> bytes = counted(12'000'000);
  // In a child process whose files may not grow beyond the limit.
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    int errors = 0;
    FileWriter writer(file.path());
    for (size_t at = 0; at < bytes.size(); at += 500'000) {
      try {
        writer.put(&bytes[at], 500'000);
        writer.start_writing();
        writer.check();
      } catch (const EnvironmentError&) {
        ++errors;
        const rlimit free = {RLIM_INFINITY, RLIM_INFINITY};
        ::setrlimit(RLIMIT_FSIZE, &free);  // as if space were available again
      }
    }
    try {
      writer.close();
    } catch (const EnvironmentError&) {
      ++errors;
    }
    std::_Exit(errors);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1) << "reported once";
  std::ifstream in(file.path(), std::ios::binary);
  const std::vector<uint8_t> content{std::istreambuf_iterator<char>(in), {}};
  ASSERT_EQ(content.size(), 6'500'000u);
  EXPECT_TRUE(std::equal(content.begin(), content.end(), bytes.begin()));
}

TEST(Log, IsReadableAfterAnAbandonedRun) {
  const ScratchFile file;
  SyntheticRun run({.seed = 3});
  {
    LogSink sink(file.path());
    sink.begin(run.info());
    for (int i = 0; i < 20; ++i) sink.frame(run.info(), run.step());
  }
  const LogReport report = check_log(file.path());
  EXPECT_TRUE(report.is_sound()) << report.problems.front();
  EXPECT_FALSE(report.finished);
  EXPECT_EQ(report.last_frame, 19);
  EXPECT_EQ(report.open_pairs, run.begins() - run.ends());
}

TEST(Log, IsRejectedIfItIsNotALog) {
  const ScratchFile file;
  write_bytes(file.path(), std::vector<uint8_t>{'h', 'e', 'l', 'l', 'o'});
  EXPECT_THROW(check_log(file.path()), InputError);
  write_bytes(file.path(), {});
  EXPECT_THROW(check_log(file.path()), InputError);
  EXPECT_THROW(check_log("/no/such/file.lcmlog"), InputError);
  EXPECT_THROW(check_log("/tmp"), InputError);
}

TEST(Log, IsRejectedInOneLineIfOfAnotherVersion) {
  const ScratchFile file;
  SyntheticRun run({.avatars = 2, .seed = 6, .crowd = SyntheticRun::Crowd::kRovers});
  LogSink sink(file.path());
  run.play(sink, 3);
  std::vector<uint8_t> bytes = bytes_of(file.path());
  LogReader log(file.path());
  for (LogEvent event; log.next(event) == LogReader::Status::kEvent;)
    put_big_endian(bytes.data() + event.offset + kLogHeadBytes + event.channel.size() + 56,
                   kSchema - 1);
  write_bytes(file.path(), bytes);
  const auto rejection = [&file](auto read) -> std::string {
    try {
      read(file.path());
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  const std::string why =
      fmt::format("THRONG_RUN: schema {}, this program reads {}", kSchema - 1, kSchema);
  EXPECT_THAT(rejection([](auto path) { check_log(path); }),
              testing::HasSubstr("expected messages of this version of Throng, found " + why +
                                 "; record the run again with this version"));
  EXPECT_THAT(rejection([](auto path) { ExportedLog(path, [] { return true; }); }),
              testing::HasSubstr("expected a run's description, found none (" + why +
                                 "); record the run again with this version"));
}

TEST(Log, NamesAnEndWithoutChecksums) {
  SyntheticRun run({.avatars = 2, .seed = 6, .crowd = SyntheticRun::Crowd::kRovers});
  const ScratchFile file;
  LogFile log(file.path());
  for (const auto& m : messages_of(run, 3))
    if (m.channel != Channel::kChecksums) log.write(name_of(m.channel), m.utime_us, m.bytes);
  log.close();
  const LogReport report = check_log(file.path());
  EXPECT_FALSE(report.finished);
  EXPECT_THAT(report.problems, testing::Contains(testing::HasSubstr(
                                   "expected THRONG_CHECKSUMS before THRONG_END, found none")));
}

}  // namespace
}  // namespace throng::log_test
