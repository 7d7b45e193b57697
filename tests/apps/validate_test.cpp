// `throng validate`: verdicts, JSON, report and exit code.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::validate_test {
namespace {

using testing::HasSubstr;

TEST(Validate, GivesAVerdictForEveryStandardOfATest) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng validate --only rimea_1 --only 'IMO 6' --json v.json --out report", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(read_file(folder / "v.json"));
  std::string ids;
  for (const auto& test : json["tests"]) {
    ids += test["id"].get<std::string>() + " ";
    EXPECT_EQ(test["verdict"], "pass");
    for (const char* key : {"title", "measured", "criterion"})
      EXPECT_FALSE(test[key].get<std::string>().empty()) << key;
  }
  EXPECT_EQ(ids, "rimea_1 rimea_6 imo_6 iso_4 walls ");
  EXPECT_THAT(outcome.out, HasSubstr("5 passed, 0 failed"));
  EXPECT_THAT(outcome.err, HasSubstr("rimea_6")) << "progress";
  EXPECT_THAT(read_file(folder / "report/report.md"), HasSubstr("RiMEA 6: round a corner"));
  EXPECT_THAT(read_file(folder / "report/rimea_6.svg"), HasSubstr("</svg>"));
}

TEST(Validate, ReportsEveryReadingOfEmpiricalTests) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng validate --empirical --only corner --json v.json --out report", folder);
  const auto json = nlohmann::json::parse(read_file(folder / "v.json"));
  ASSERT_EQ(json["tests"].size(), 2u) << "the test and the walls";
  const auto& test = json["tests"][0];
  EXPECT_EQ(outcome.exit_code, test["verdict"] == "pass" ? 0 : 1) << outcome.err;
  ASSERT_EQ(test["readings"].size(), 9u) << "eight lanes, and the number of used ones";
  for (const char* key : {"at", "what", "unit", "simulated", "recorded", "from", "to", "met"})
    EXPECT_TRUE(test["readings"][0].contains(key)) << key;
  EXPECT_THAT(read_file(folder / "report/report.md"), HasSubstr("| 0.0 to 0.5 m |"));
  EXPECT_THAT(read_file(folder / "report/corner.svg"), HasSubstr("</svg>"));
}

TEST(Validate, CombinesSeedsIntoOneVerdict) {
  const ScratchFolder folder;
  const Outcome outcome = shell(
      "throng validate --only overtaking --seed 3 --seeds 2 --json v.json --out report", folder);
  const auto json = nlohmann::json::parse(read_file(folder / "v.json"));
  const auto& test = json["tests"][0];
  EXPECT_EQ(outcome.exit_code, test["verdict"] == "pass" ? 0 : 1) << outcome.err;
  ASSERT_EQ(test["seeds"].size(), 2u);
  bool all_pass = true;
  double sum = 0;
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(test["seeds"][i]["seed"], 3 + i);
    all_pass = all_pass && test["seeds"][i]["verdict"] == "pass";
    sum += test["readings"][0]["by_seed"][i].get<double>();
  }
  EXPECT_EQ(test["verdict"], all_pass ? "pass" : "fail");
  EXPECT_NEAR(test["readings"][0]["simulated"].get<double>(), sum / 2, 1e-12);
  EXPECT_TRUE(test["readings"][0].contains("worst"));
  EXPECT_THAT(outcome.out, HasSubstr("of 2 seeds pass"));
  EXPECT_THAT(read_file(folder / "report/report.md"), HasSubstr("Measured with seeds 3 to 4."));
}

TEST(Validate, NamesTestsThatDiffer) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng validate --only imo_4 --only rimea_1 --json v.json --out report", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("2 passed, 0 failed, 2 differ (imo_4, iso_11), which is "
                                     "measured and neither passed nor failed\n"));
  EXPECT_THAT(
      read_file(folder / "report/report.md"),
      HasSubstr("2 of 4 tests pass; 0 fail; 2 differ (imo_4, iso_11), which is measured and "
                "neither passed nor failed. Measured with seed 1."));
}

std::string failed_of(const nlohmann::json& json) {
  std::string ids;
  for (const auto& test : json["tests"])
    if (test["verdict"] == "fail") ids += (ids.empty() ? "" : ", ") + test["id"].get<std::string>();
  return ids;
}

TEST(Validate, NamesFailedTests) {
  const ScratchFolder folder;
  // With ORCA 117 of 200 overtake; the criterion is 190.
  const Outcome outcome = shell(
      "throng validate --only overtaking --only rimea_1 --steering orca --json v.json --out report",
      folder);
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  const auto json = nlohmann::json::parse(read_file(folder / "v.json"));
  EXPECT_EQ(failed_of(json), "overtaking");
  EXPECT_THAT(outcome.out, HasSubstr("1 failed (overtaking)\n"));
  EXPECT_THAT(read_file(folder / "report/report.md"),
              HasSubstr("1 fail (overtaking). Measured with seed 1."));
}

TEST(Validate, SkipsTestsWithoutRecordings) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng validate --only spacing_door --json v.json", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(read_file(folder / "v.json"));
  EXPECT_EQ(json["tests"][0]["verdict"], "skipped");
  EXPECT_EQ(json["skipped"], 1);
  EXPECT_THAT(outcome.out, HasSubstr("1 skipped"));
}

TEST(Validate, RejectsAFolderWithoutTheRecordings) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng validate --only spacing_door --recordings . --json v.json", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--recordings: expected a folder with uo-180-180-120.txt"));
}

TEST(Validate, RejectsUnknownTests) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng validate --only rimea_13", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("rimea_1"));
}

TEST(Validate, ReportsAnUnusableFolderBeforeRunning) {
  const ScratchFolder folder;
  const Outcome outcome = shell("echo >f; throng validate --out f/report", folder);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("f/report"));
}

}  // namespace
}  // namespace throng::validate_test
