// Faults of the environment: full disks, closed pipes, deleted folders, kill -9. A run reports them
// with exit code 3, and what it has written stays readable to the last complete event.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "base/random.h"
#include "tests/apps/cli.h"

namespace throng::faults_test {
namespace {

using testing::HasSubstr;

constexpr const char* kRun = "throng run corridor --seconds 3600 --lcm off --threads 1";

/// THRONG_KILLS sets the number of kills, THRONG_KILL_SEED the seed.
uint64_t from_environment(const char* name, uint64_t fallback) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::strtoull(value, nullptr, 10) : fallback;
}

/// Prints counts for scripts/reliability.sh.
void print_survived(const char* what, uint64_t times) {
  std::printf("[ faults ] %s: %d survived\n", what, static_cast<int>(times));
}

/// The number after a word in the output of `throng check`.
int64_t figure(const std::string& text, const std::string& word) {
  const size_t at = text.find(word);
  return at == text.npos ? -1 : std::atoll(text.c_str() + at + word.size());
}

/// Checks a log with any kind of end, copies its sound part, and checks that the copy is sound.
void expect_readable(const std::string& log, const ScratchFolder& folder) {
  const Outcome check = shell("throng check " + log + " --repair mended.lcmlog", folder);
  EXPECT_LE(check.exit_code, 1) << check.err;
  const Outcome mended = shell("throng check mended.lcmlog", folder);
  // The fault removed the end of the run, so the copy is cut off.
  const bool is_cut = mended.out.starts_with("mended.lcmlog: sound, but cut off\n");
  EXPECT_TRUE(is_cut || mended.out.starts_with("mended.lcmlog: sound\n")) << mended.out;
  EXPECT_EQ(mended.exit_code, is_cut ? 1 : 0) << mended.out << mended.err;
  EXPECT_EQ(figure(mended.out, "messages "), figure(check.out, "messages "))
      << "a sound message was lost\n"
      << check.out << mended.out;
}

TEST(Faults, LeaveAReadableLogOnAFullDisk) {
  const ScratchFolder folder;
  // Limits files to 3 MB, in blocks of 512 bytes.
  const Outcome run = shell(fmt::format("ulimit -f 6000\n{} --log run.lcmlog", kRun), folder);
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("run.lcmlog: cannot write the log"));
  EXPECT_THAT(run.out, HasSubstr("hash")) << "the summary is missing";
  expect_readable("run.lcmlog", folder);
  EXPECT_GT(figure(shell("throng check mended.lcmlog", folder).out, "frames "), 10);
  print_survived("full disk", 1);
}

TEST(Faults, ReportAReadOnlyFolder) {
  const ScratchFolder folder;
  const Outcome run = shell(fmt::format("{} --log /sys/throng.lcmlog", kRun), folder);
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_EQ(line_count(run.err), 1) << run.err;
  print_survived("read-only folder", 1);
}

TEST(Faults, ReportAClosedPipe) {
  const ScratchFolder folder;
  const Outcome run = shell(
      fmt::format("mkfifo pipe\nhead -c 3000000 <pipe >run.lcmlog &\n{} --log pipe", kRun), folder);
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("Broken pipe"));
  expect_readable("run.lcmlog", folder);
  print_survived("closed pipe", 1);
}

TEST(Faults, ReportADeletedFolder) {
  const ScratchFolder folder;
  const Outcome run =
      shell(fmt::format("mkdir logs\n"
                        "( while [ ! -s logs/run.lcmlog ]; do sleep 0.05; done; rm -r logs ) &\n"
                        "{} --log logs/run.lcmlog",
                        kRun),
            folder);
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the file was deleted"));
  print_survived("vanished folder", 1);
}

TEST(Faults, LeaveAReadableLogWhenKilled) {
  const uint64_t kills = from_environment("THRONG_KILLS", 5);
  const uint64_t seed = from_environment("THRONG_KILL_SEED", 1);
  int64_t frames = 0, torn = 0;
  for (uint64_t i = 0; i < kills; ++i) {
    SCOPED_TRACE(testing::Message() << "THRONG_KILL_SEED=" << seed << ", kill " << i);
    const ScratchFolder folder;
    const RandomKey key{seed, i, 0, Purpose::kStyle};
    const double flush_s = i % 2 == 0 ? 0.02 : 0.25;
    const Outcome run = shell(fmt::format("{} --log run.lcmlog --flush-s {} &\nrun=$!\n"
                                          "while [ ! -s run.lcmlog ]; do sleep 0.01; done\n"
                                          "sleep {:.3f}\nkill -9 $run\nwait $run || true",
                                          kRun, flush_s, random_uniform(key, 0, 0.6)),
                              folder);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    expect_readable("run.lcmlog", folder);
    const std::string report = shell("throng check run.lcmlog", folder).out;
    frames += std::max<int64_t>(0, figure(report, "frames "));
    torn += report.find("not sound") != report.npos ? 1 : 0;
  }
  EXPECT_GT(frames, static_cast<int64_t>(kills)) << "killed before the first frames";
  print_survived("kill -9", kills);
  std::printf("[ figures ] %d kills, %d frames read back, %d torn tails mended\n",
              static_cast<int>(kills), static_cast<int>(frames), static_cast<int>(torn));
}

nlohmann::json result(const std::string& options, const ScratchFolder& folder) {
  const Outcome run = shell("throng run " + options + " --lcm off --json run.json", folder);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return nlohmann::json::parse(read_file(folder / "run.json"));
}

TEST(Faults, AllowResumingAKilledRun) {
  for (const std::string scene : {"plaza --avatars 150", "paper_50"}) {
    SCOPED_TRACE(scene);
    const ScratchFolder folder;
    const std::string run = scene + " --seconds 8";
    const auto whole = result(run + " --log off", folder);
    shell("throng run " + run +
              " --pace 4 --lcm off --log first.lcmlog --checkpoint c --checkpoint-every 0.5 >table "
              "&\nrun=$!\n"
              "while [ ! -s c ]; do sleep 0.01; done\nsleep 0.2\nkill -9 $run\nwait $run || true",
          folder);
    const auto rest = result(run + " --resume c --log rest.lcmlog --threads 3", folder);
    EXPECT_EQ(rest["hash"], whole["hash"]);
    EXPECT_EQ(rest["events"]["begin"], whole["events"]["begin"]);
    EXPECT_EQ(rest["events"]["end"], whole["events"]["end"]);
    EXPECT_LT(rest["frames"], whole["frames"]);
    const Outcome check = shell("throng check rest.lcmlog", folder);
    EXPECT_EQ(check.exit_code, 0) << check.out;
    EXPECT_THAT(check.out, HasSubstr("rest.lcmlog: sound\n"));
    expect_readable("first.lcmlog", folder);
  }
  print_survived("kill -9 and resume", 2);
}

TEST(Faults, LeaveACheckpointWhenStopped) {
  const ScratchFolder folder;
  const std::string run = "plaza --avatars 150 --seconds 20";
  const Outcome stopped =
      shell("throng run " + run +
                " --pace 4 --lcm off --log first.lcmlog --checkpoint c >table &\nrun=$!\n"
                "while [ ! -s first.lcmlog ]; do sleep 0.01; done\nsleep 0.1\n"
                "kill -TERM $run\nwait $run",
            folder);
  EXPECT_EQ(stopped.exit_code, 143) << stopped.err;
  EXPECT_EQ(result(run + " --resume c --log off", folder)["hash"],
            result(run + " --log off", folder)["hash"]);
}

TEST(Faults, RejectAnInvalidCheckpointInOneLine) {
  const ScratchFolder folder;
  write_file(folder / "c", "THRONGCP and then nothing");
  const Outcome damaged = shell("throng run plaza --resume c --log off --lcm off", folder);
  EXPECT_EQ(damaged.exit_code, 2);
  EXPECT_EQ(line_count(damaged.err), 1) << damaged.err;
  const Outcome nowhere =
      shell("throng run plaza --seconds 1 --checkpoint no/c --log off --lcm off", folder);
  EXPECT_EQ(nowhere.exit_code, 3);
  EXPECT_THAT(nowhere.err, HasSubstr("--checkpoint no/c: cannot create it"));
}

TEST(Trace, ShowsTheFirstStageAndFrameThatDiffer) {
  const ScratchFolder folder;
  const std::string run = "throng run corridor --seconds 0.5 --log off --lcm off --trace-hash ";
  ASSERT_EQ(shell(run + "a --threads 1", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "b --threads 3 --simd scalar --pair-search sweep", folder).exit_code, 0);
  ASSERT_EQ(shell(run + "c --part-volume sphere", folder).exit_code, 0);
  const std::string a = read_file(folder / "a");
  EXPECT_EQ(a, read_file(folder / "b"));
  EXPECT_EQ(line_count(a), 1 + 30 * 5 + 1) << "a line for the run, each stage and frame, the end";
  // Other volumes change run_id and pairs; the stages before are equal.
  const Outcome diff = shell("diff a c | grep '^<' | sed -n 2p", folder);
  EXPECT_THAT(diff.out, testing::ContainsRegex("^< [0-9]+ pairs [0-9a-f]{16}\n$"));
  EXPECT_EQ(shell(run + "/dev/full", folder).exit_code, 3);
}

}  // namespace
}  // namespace throng::faults_test
