// `throng monitor`: the figures of a run, live and from its log.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::monitor_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

TEST(Monitor, ShowsALogAsTheRunReportedIt) {
  const ScratchFolder folder;
  ASSERT_EQ(
      shell("throng run corridor --exact --seconds 1 --lcm off --log a.lcmlog --json run.json",
            folder)
          .exit_code,
      0);
  const Outcome outcome = shell("throng monitor a.lcmlog --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json seen = Json::parse(outcome.out);
  const Json run = Json::parse(read_file(folder / "run.json"));
  EXPECT_EQ(seen["run"]["scene"], "corridor");
  EXPECT_EQ(seen["run"]["run_id"], run["run_id"]);
  EXPECT_EQ(seen["run"]["ended"], true);
  EXPECT_EQ(seen["frames"], run["frames"]);
  EXPECT_EQ(seen["events"]["begin"], run["events"]["begin"]);
  EXPECT_EQ(seen["events"]["end"], run["events"]["end"]);
  EXPECT_EQ(seen["lost"], 0);
  const auto frames = run["frames"].get<double>();
  EXPECT_DOUBLE_EQ(seen["stages"][0]["N_v"].get<double>() * frames,
                   run["stages"]["body_sphere"]["tests"].get<double>());
  EXPECT_EQ(seen["stages"][1]["volume"], "body box");
  EXPECT_DOUBLE_EQ(seen["stages"][1]["N_v"].get<double>() * frames,
                   run["stages"]["body_box"]["tests"].get<double>());
  EXPECT_DOUBLE_EQ(seen["stages"][2]["passed"].get<double>() * frames,
                   run["stages"]["part_box"]["passed"].get<double>());
  EXPECT_DOUBLE_EQ(seen["N_p"].get<double>() * frames,
                   run["stages"]["triangles"]["tests"].get<double>());
  for (const auto& [name, channel] : seen["channels"].items()) {
    if (name == "THRONG_END") continue;
    EXPECT_EQ(channel["messages"], channel["sent"]) << name;
  }
}

TEST(Monitor, NamesPartsAndPeople) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run plaza --seconds 1 --lcm off --log a.lcmlog", folder).exit_code, 0);
  const Outcome outcome = shell("throng monitor a.lcmlog", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* word :
       {"plaza, seed 1, 500 avatars", "THRONG_STATES", "N_u", "C_u", "N_v", "C_v", "N_p", "C_p",
        "C_o", "T ", "lost 0", "newest contacts", " foot ", "east ", "ordop26"})
    EXPECT_THAT(outcome.out, HasSubstr(word));
}

TEST(Monitor, ReportsThatNothingWasReceived) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng monitor --lcm memq:// --once --seconds 0.2", folder);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("memq://: expected a run, found none"));
  EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
}

TEST(Monitor, RejectsALogOfAnotherVersion) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run corridor --seconds 0.2 --lcm off --log a.lcmlog", folder).exit_code,
            0);
  std::string bytes = read_file(folder / "a.lcmlog");
  const auto size_at = [&bytes](size_t at) {
    size_t size = 0;
    for (size_t i = at; i < at + 4; ++i) size = size << 8 | static_cast<unsigned char>(bytes[i]);
    return size;
  };
  constexpr size_t kHead = 28, kSchemaEnd = 59;  // bytes of an event and of a message
  for (size_t at = 0; at < bytes.size();) {
    const size_t channel = size_at(at + 20), message = size_at(at + 24);
    bytes[at + kHead + channel + kSchemaEnd] = 2;
    at += kHead + channel + message;
  }
  for (const size_t size : {bytes.size(), bytes.size() - 10}) {
    write_file(folder / "old.lcmlog", bytes.substr(0, size));
    const Outcome outcome = shell("throng monitor old.lcmlog --json", folder);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(
        outcome.err,
        "old.lcmlog: expected messages of this version of Throng, found THRONG_RUN: schema 2, "
        "this program reads 1; record the run again with this version\n");
  }
}

TEST(Monitor, SurvivesTornAndDamagedLogs) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run corridor --seconds 0.2 --lcm off --log a.lcmlog", folder).exit_code,
            0);
  const std::string whole = read_file(folder / "a.lcmlog");
  for (size_t cut = 1; cut <= 8; ++cut) {
    std::string bytes = whole.substr(0, whole.size() * cut / 8 - cut);
    for (size_t k = 1; k < 30; ++k) bytes[4 + (bytes.size() - 5) * k / 30 + cut] = '\x7f';
    write_file(folder / "b.lcmlog", bytes);
    const Outcome outcome = shell("throng monitor b.lcmlog --json", folder);
    EXPECT_LE(outcome.exit_code, 1) << outcome.err;
    EXPECT_TRUE(Json::accept(outcome.out)) << outcome.out;
  }
}

/// Wraps a line of sh to make multicast work on any machine; "" if that is not allowed.
std::string network() {
  const ScratchFolder folder;
  for (const char* flags : {"-n", "-rn"})
    if (shell(std::string("unshare ") + flags + " true", folder).exit_code == 0)
      return std::string("unshare ") + flags + " sh -c 'ip link set lo up; " +
             "ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo; . ./script'";
  return shell("ip route get 239.255.76.67", folder).exit_code == 0 ? ". ./script" : "";
}

/// Waits half a minute at most.
const std::string kUntilItListens =
    "tries=0; until ss -lun | grep -q ':7684 ' || [ $tries = 300 ]; do "
    "sleep 0.1; tries=$((tries+1)); done\nsleep 0.3\n";

/// JSON of a monitor that receives a short live run with this receive buffer.
Json watched(const std::string& buffer, const std::string& run) {
  const std::string in_network = network();
  if (in_network.empty()) return nullptr;
  const ScratchFolder folder;
  const std::string url = "udpm://239.255.76.67:7684?ttl=0&recv_buf_size=" + buffer;
  write_file(
      folder / "script",
      fmt::format("throng monitor --json --until-end --seconds {} --lcm \"{}\" >seen.json &\n"
                  "monitor=$!\n{}throng run {} --log off --json run.json >/dev/null\n"
                  "wait $monitor\n",
                  60 * THRONG_SLOWNESS, url, kUntilItListens, run));
  const Outcome outcome = shell(in_network, folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  Json seen = Json::parse(read_file(folder / "seen.json"));
  seen["run_json"] = Json::parse(read_file(folder / "run.json"));
  return seen;
}

TEST(Monitor, LosesNothingOfALiveRunWithTheDefaultUrl) {
  const Json seen = watched("2097152", "plaza --seconds 3 --pace 1");
  if (seen.is_null()) GTEST_SKIP() << "neither network namespaces nor a multicast route";
  EXPECT_EQ(seen["run"]["ended"], true);
  EXPECT_EQ(seen["run"]["from_start"], true);
  EXPECT_EQ(seen["lost"], 0) << seen.dump(1);
  EXPECT_EQ(seen["frames"], 180);
  EXPECT_EQ(seen["events"]["begin"], seen["run_json"]["events"]["begin"]);
}

TEST(Monitor, ReportsSentMinusReceivedAsLost) {
  // The buffer holds one datagram, so most of a burst is lost.
  const Json seen = watched("4096", "plaza --avatars 2000 --seconds 3 --pace 1");
  if (seen.is_null()) GTEST_SKIP() << "neither network namespaces nor a multicast route";
  ASSERT_EQ(seen["run"]["ended"], true);
  int64_t lost = 0;
  for (const auto& [name, channel] : seen["channels"].items()) {
    if (name == "THRONG_END") continue;
    const int64_t missing = channel["sent"].get<int64_t>() - channel["messages"].get<int64_t>();
    EXPECT_EQ(channel["missing"].get<int64_t>() + channel["before"].get<int64_t>(), missing)
        << name;
    lost += missing;
  }
  EXPECT_GT(lost, 0) << "the test needs losses";
}

}  // namespace
}  // namespace throng::monitor_test
