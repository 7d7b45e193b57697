// A signal ends a run after a frame, with a summary and a log of paired events.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::stop_test {
namespace {

struct Signal {
  const char* name;
  int exit_code;
};

class Stop : public testing::TestWithParam<Signal> {};

TEST_P(Stop, EndsTheRunCleanly) {
  const ScratchFolder folder;
  // Starts a run of an hour, waits until the log is longer than the description, and signals it.
  const Outcome outcome = shell(
      "throng run plaza --seconds 3600 --lcm off --log run.lcmlog --json run.json >table &\n"
      "run=$!\n"
      "for i in $(seq 600); do\n"
      "  [ \"$(wc -c <run.lcmlog 2>/dev/null || echo 0)\" -gt 3000000 ] && break; sleep 0.1\n"
      "done\n"
      "kill -" +
          std::string(GetParam().name) +
          " $run\n"
          "wait $run",
      folder);
  EXPECT_EQ(outcome.exit_code, GetParam().exit_code) << outcome.err;
  EXPECT_THAT(outcome.err, testing::ContainsRegex("stopped after [0-9]+ frames by SIG" +
                                                  std::string(GetParam().name)));
  EXPECT_THAT(read_file(folder / "table"), testing::HasSubstr("hash"));
  const auto json = nlohmann::json::parse(read_file(folder / "run.json"));
  EXPECT_EQ(json["stopped_early"], true);
  EXPECT_GT(json["frames"], 0);
  EXPECT_LT(json["frames"], 3600 * 60);
  EXPECT_EQ(json["events"]["begin"], json["events"]["end"]);
  const Outcome check = shell("throng check run.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
}

INSTANTIATE_TEST_SUITE_P(Signals, Stop,
                         testing::Values(Signal{"TERM", 143}, Signal{"INT", 130},
                                         Signal{"HUP", 129}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace throng::stop_test
