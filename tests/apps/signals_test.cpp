// Signals at any moment: while loading, opening outputs, between frames, twice in quick succession.
// Outputs stay complete, and the exit code names the signal.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "tests/apps/cli.h"

namespace throng::signals_test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

/// Sanitizers make the time until the first frame 23 times as long.
constexpr double kSlowness = THRONG_SLOWNESS > 1 ? 30 : 1;
constexpr int kRounds = THRONG_SLOWNESS > 1 ? 8 : 24;

/// Waits for a condition, two minutes at most.
std::string until(const std::string& condition) {
  return "tries=0; until " + condition +
         " || [ $tries = 1200 ]; do sleep 0.1; tries=$((tries+1)); done; ";
}

/// Starts `command` in the background. Once it catches SIGINT, which a shell makes its background
/// processes ignore, waits and runs `then` with the process in $run.
std::string signalled(const std::string& command, double after_s, const std::string& then) {
  return command + " & run=$!\n" + until("grep -q 'SigCgt:.*[2367abef]$' /proc/$run/status") +
         "sleep " + std::to_string(kSlowness * after_s) + "\n" + then + "\nwait $run";
}

const std::string kUntilItWrites = until("[ -s run.lcmlog ]");

TEST(Signals, LeaveACompleteLogOrNone) {
  const unsigned seed = 20261122;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const struct {
    const char* name;
    int exit_code;
  } signals[] = {{"INT", 130}, {"TERM", 143}, {"HUP", 129}};
  int logs = 0;
  for (int round = 0; round < kRounds; ++round) {
    const ScratchFolder folder;
    // Half of them while it loads, half while it writes. The loading time depends on the load of
    // the machine.
    const bool has_begun = round % 2 == 1;
    const double after_s = 0.5 * static_cast<double>(random() % 1000) / 1000;
    const auto& signal = signals[round % 3];
    SCOPED_TRACE("SIG" + std::string(signal.name) + " after " + std::to_string(after_s) + " s");
    const Outcome outcome = shell(
        signalled(
            "throng run plaza --avatars 300 --seconds 3600 --lcm off --log run.lcmlog", after_s,
            (has_begun ? kUntilItWrites : "") + std::string("kill -") + signal.name + " $run"),
        folder);
    EXPECT_EQ(outcome.exit_code, signal.exit_code) << outcome.err;
    if (!std::filesystem::exists(folder / "run.lcmlog")) continue;
    ++logs;
    const Outcome check = shell("throng check run.lcmlog", folder);
    EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
    EXPECT_THAT(check.out, HasSubstr("run.lcmlog: sound\n"));
  }
  EXPECT_GE(logs, kRounds / 2) << "runs were not stopped while they ran";
}

TEST(Signals, InQuickSuccessionCountAsOne) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell(signalled("throng run plaza --avatars 300 --seconds 3600 --lcm off --log run.lcmlog", 0,
                      kUntilItWrites + "kill -TERM $run; kill -HUP $run; kill -TERM $run"),
            folder);
  EXPECT_THAT(outcome.exit_code, AnyOf(143, 129)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("stopped after"));
  EXPECT_EQ(shell("throng check run.lcmlog", folder).exit_code, 0);
}

TEST(Signals, ForceTheEndIfRepeatedLater) {
  const ScratchFolder folder;
  // The reader of this pipe never reads, so the run blocks after 64 kB and cannot end normally.
  write_file(folder / "until_full.py",
             "import fcntl, os, struct, termios, time\n"
             "pipe = os.open('pipe', os.O_RDONLY | os.O_NONBLOCK)\n"
             "held = -1\n"
             "for _ in range(600):\n"
             "    before, held = held, struct.unpack('i', fcntl.ioctl(pipe, termios.FIONREAD, "
             "b'0000'))[0]\n"
             "    if held > 32768 and held == before: break\n"
             "    time.sleep(0.2)\n");
  const Outcome outcome =
      shell("mkfifo pipe\nsleep 3600 <>pipe & reader=$!\n" +
                signalled("throng run plaza --seconds 3600 --lcm off --log pipe", 0,
                          "python3 until_full.py; kill -TERM $run; sleep 1; kill -INT $run; "
                          "(sleep 20; kill -KILL $run) &") +
                "\ncode=$?; kill $reader; exit $code",
            folder);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("throng: stopped by SIGINT"));
}

TEST(Signals, LeaveHangupIgnoredUnderNohup) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "trap '' HUP\n" +
          signalled("throng run plaza --avatars 20 --seconds 3 --pace 2 --lcm off --log run.lcmlog",
                    0.7 / kSlowness, "kill -HUP $run"),
      folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("180 frames"));
}

TEST(Signals, LetPaperPrintFinishedTables) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      signalled("throng paper --frames 10000 --seeds 10000 --json paper.json", 1, "kill -INT $run"),
      folder);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("stopped by SIGINT: finished tables follow"));
  EXPECT_THAT(outcome.out, HasSubstr("The formula on the paper's own numbers"));
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "paper.json"))["stopped_early"], true);
}

TEST(Signals, LetValidatePrintFinishedVerdicts) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell(signalled("throng validate --threads 1 --json v.json", 0.5, "kill -TERM $run"), folder);
  EXPECT_EQ(outcome.exit_code, 143) << outcome.err;
  EXPECT_THAT(outcome.err, testing::ContainsRegex(
                               "stopped by SIGTERM: [0-9]+ of [0-9]+ experiments were finished"));
  EXPECT_THAT(outcome.out, HasSubstr("passed, "));
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "v.json"))["stopped_early"], true);
}

TEST(Signals, LetBenchPrintMeasuredFrames) {
  const ScratchFolder folder;
  // After four seconds of processor time the scene is built, on a busy machine as well.
  const Outcome outcome = shell(
      signalled("throng bench --avatars 2000 --engines none --frames 100000 --json b.json", 0,
                fmt::format("until [ \"$(cut -d' ' -f14 /proc/$run/stat)\" -gt {} ]; do sleep 0.1; "
                            "done; kill -INT $run",
                            400 * THRONG_SLOWNESS)),
      folder);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("finished measurements follow"));
  const auto json = nlohmann::json::parse(read_file(folder / "b.json"));
  EXPECT_GT(json["frames"], 0);
  EXPECT_LT(json["frames"], 100000);
}

TEST(Signals, EndMonitorAndView) {
  for (const char* command :
       {"throng monitor --lcm memq://", "throng view --lcm memq:// --port 0"}) {
    const ScratchFolder folder;
    const Outcome outcome = shell(signalled(command, 1, "kill -INT $run"), folder);
    const bool is_monitor = std::string(command).find("monitor") != std::string::npos;
    EXPECT_EQ(outcome.exit_code, is_monitor ? 1 : 0)
        << command << outcome.err;  // no run was received
  }
}

}  // namespace
}  // namespace throng::signals_test
