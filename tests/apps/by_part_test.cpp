// Counts and volumes by part: `throng run --part-pairs`, `--part-volume` as a map, `throng render
// --volumes`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "tests/apps/cli.h"

namespace throng::by_part_test {
namespace {

using testing::HasSubstr;

struct Sums {
  uint64_t tests = 0, passed = 0, touching = 0;
};

/// Sums by stage of a part_pairs.csv.
std::map<std::string, Sums> sums_of(const std::string& csv) {
  std::map<std::string, Sums> sums;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "stage,volume,part_a,part_b,tests,passed,touching,false_positives");
  while (std::getline(lines, line)) {
    std::vector<std::string> fields{""};
    for (const char c : line)
      if (c == ',')
        fields.emplace_back();
      else
        fields.back() += c;
    EXPECT_EQ(fields.size(), 8u) << line;
    Sums& sum = sums[fields[0]];
    sum.tests += std::stoull(fields[4]);
    sum.passed += std::stoull(fields[5]);
    if (!fields[6].empty()) {
      sum.touching += std::stoull(fields[6]);
      EXPECT_EQ(std::stoull(fields[7]), std::stoull(fields[5]) - std::stoull(fields[6])) << line;
    }
  }
  return sums;
}

TEST(PartPairs, AddUpToTheCountersOfTheRun) {
  const ScratchFolder folder;
  for (const char* run : {"bottleneck --avatars 60 --seconds 9 --log b.lcmlog",
                          "b.lcmlog --log off", "paper_50 --seconds 1 --log off"})
    for (const char* exact : {"", " --exact"}) {
      const Outcome outcome = shell(
          std::string("throng run ") + run + exact + " --lcm off --json r.json --part-pairs parts",
          folder);
      ASSERT_EQ(outcome.exit_code, 0) << run << outcome.err;
      const auto stages = nlohmann::json::parse(read_file(folder / "r.json"))["stages"];
      std::map<std::string, Sums> sums = sums_of(read_file(folder / "parts/part_pairs.csv"));
      EXPECT_GE(sums.size(), *exact == 0 ? 4u : 5u);  // a log may ask for triangles itself
      for (const auto& [stage, sum] : sums) {
        EXPECT_EQ(sum.tests, stages[stage]["tests"].get<uint64_t>()) << run << ", " << stage;
        EXPECT_EQ(sum.passed, stages[stage]["passed"].get<uint64_t>()) << run << ", " << stage;
      }
      EXPECT_EQ(sums["part_volume"].touching, sums["part_box"].touching) << run;
      EXPECT_GT(sums["part_volume"].touching, 0u) << run;
    }
  for (const char* rejected : {"--budget-tests 5", "--budget-ms 5", "--strategy two-pass"}) {
    const Outcome outcome = shell(
        std::string("throng run corridor --log off --lcm off --part-pairs p ") + rejected, folder);
    EXPECT_EQ(outcome.exit_code, 2) << rejected;
    EXPECT_EQ(line_count(outcome.err), 1) << rejected << outcome.err;
  }
}

TEST(PartVolumeMap, IsStoredInTheLogAndReused) {
  const ScratchFolder folder;
  const auto hash_of = [&](const std::string& command) {
    const Outcome outcome = shell(command + " --lcm off --json r.json", folder);
    EXPECT_EQ(outcome.exit_code, 0) << command << ": " << outcome.err;
    return nlohmann::json::parse(read_file(folder / "r.json"))["hash"].get<std::string>();
  };
  const std::string map = "'hands: sphere, torso: ordop18, default: obb'";
  const std::string first =
      hash_of("throng run bottleneck --avatars 60 --seconds 9 --log m.lcmlog --part-volume " + map);
  EXPECT_THAT(shell("throng info m.lcmlog", folder).out,
              HasSubstr("hands: sphere, torso: ordop18, default: obb"));
  // Poses of a log are rounded, but alike each time. Its volumes are kept unless an option changes
  // them.
  const std::string again = hash_of("throng run m.lcmlog --log off");
  EXPECT_EQ(again, hash_of("throng run m.lcmlog --log off --part-volume " + map));
  EXPECT_NE(again, hash_of("throng run m.lcmlog --log off --part-volume obb"));
  EXPECT_EQ(shell("throng check m.lcmlog", folder).exit_code, 0);
  for (const auto& [text, said] : std::map<std::string, std::string>{
           {"hands: spere", "did you mean 'sphere'?"},
           {"hnads", "expected one of sphere, aabb"},
           {"hands sphere: ", "expected one of sphere, aabb"},
           {"antennas: sphere", "expected words of a part: pelvis, torso"},
           {"hands: sphere, hands: obb", "expected each part named once"}}) {
    const Outcome outcome =
        shell("throng run corridor --lcm off --log off --part-volume '" + text + "'", folder);
    EXPECT_EQ(outcome.exit_code, 2) << text;
    EXPECT_EQ(line_count(outcome.err), 1) << text << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(said)) << text;
  }
  const Outcome strategy = shell(
      "throng run corridor --lcm off --log off --strategy two-pass --part-volume " + map, folder);
  EXPECT_EQ(strategy.exit_code, 2);
  EXPECT_EQ(line_count(strategy.err), 1) << strategy.err;
}

TEST(RenderVolumes, DrawsTheRequestedVolumes) {
  const ScratchFolder folder;
  ASSERT_EQ(shell("throng run paper_50 --seconds 1 --lcm off --log p.lcmlog", folder).exit_code, 0);
  const std::string line = "throng render p.lcmlog --frame 30 --width 160 --height 120 ";
  std::map<std::string, std::string> pictures;
  for (const std::string volumes :
       {"", "--volumes sphere", "--volumes sphere,ordop26", "--volumes body-box --volumes-of 3,7",
        "--volumes body-sphere"}) {
    const Outcome outcome = shell(line + volumes + " --out a.png", folder);
    ASSERT_EQ(outcome.exit_code, 0) << volumes << ": " << outcome.err;
    EXPECT_TRUE(pictures.emplace(read_file(folder / "a.png"), volumes).second) << volumes;
  }
  for (const char* wrong :
       {"--volumes spher", "--volumes sphere,", "--volumes sphere --volumes-of x"}) {
    const Outcome outcome = shell(line + wrong + " --out b.png", folder);
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_EQ(line_count(outcome.err), 1) << wrong << ": " << outcome.err;
  }
}

}  // namespace
}  // namespace throng::by_part_test
