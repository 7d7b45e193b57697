// `throng compare`: table, JSON, figures and errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/workplace.h"

namespace throng::compare_test {
namespace {

using testing::HasSubstr;

TEST(Compare, ComparesTwoScenes) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng compare corridor crossing --seconds 4 --json c.json --out report", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("A  corridor: 120 people, 4.0 s"));
  EXPECT_THAT(outcome.out, HasSubstr("B  crossing: "));
  const auto json = nlohmann::json::parse(read_file(folder / "c.json"));
  for (const char* measure : {"speed_density", "spacing", "flow", "width_use", "sway",
                              "accelerations", "contacts", "depth"}) {
    ASSERT_TRUE(json[measure].is_array()) << measure;
    for (const auto& row : json[measure]) {
      EXPECT_TRUE(row.contains("density") || row.contains("width") || row.contains("part") ||
                  row.contains("speed"))
          << measure << ": " << row;
      EXPECT_TRUE(row.contains("a") && row.contains("b") && row.contains("unit")) << row;
      EXPECT_FALSE(row["a"].is_null() && row["b"].is_null()) << measure << ": " << row;
    }
  }
  EXPECT_GT(json["speed_density"].size(), 10u);
  EXPECT_EQ(json["a"]["name"], "corridor");
  const std::string report = read_file(folder / "report/report.md");
  EXPECT_THAT(report, HasSubstr("speed_density.svg"));
  EXPECT_THAT(report, HasSubstr("A: corridor, 120 people; B: crossing"));
  EXPECT_THAT(read_file(folder / "report/speed_density.svg"), HasSubstr("</svg>"));
}

TEST(Compare, FindsNoDifferenceBetweenALogAndItsScene) {
  const ScratchFolder folder;
  ASSERT_EQ(
      shell("throng run corridor --seconds 3 --exact --lcm off --log a.lcmlog", folder).exit_code,
      0);
  const Outcome outcome = shell("throng compare a.lcmlog corridor --seconds 3 --json -", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);  // only JSON on stdout
  int compared = 0, one_sided = 0;
  for (const char* measure :
       {"speed_density", "spacing", "flow", "width_use", "accelerations", "contacts", "depth"})
    for (const auto& row : json[measure]) {
      // A bin may have enough values on one side only.
      const bool is_one_sided = row["a"].is_null() || row["b"].is_null();
      ++(is_one_sided ? one_sided : compared);
      if (is_one_sided) continue;
      // A log rounds positions to a fraction of a millimetre.
      EXPECT_NEAR(row["a"].get<double>(), row["b"].get<double>(),
                  0.02 + 0.02 * std::abs(row["a"].get<double>()))
          << measure << ": " << row;
    }
  EXPECT_GT(compared, 10 * one_sided);
}

TEST(Compare, MeasuresFlowAtTheGivenLine) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("throng compare corridor corridor --seconds 2 --line 0,-3,0,3 --json -", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(json["flow"][0]["width"].get<double>(), 6, 0.01);
  EXPECT_EQ(json["flow"][1]["a"], json["flow"][1]["b"]);
}

TEST(Compare, RejectsBadInputBeforeAnyOutput) {
  Workplace place;
  expect_rejected(place, "throng compare my.yaml nowhere.yaml --json out.json", "nowhere");
  expect_rejected(place, "throng compare my.yaml body.tri --json out.json", "body.tri");
  expect_rejected(place, "throng compare my.yaml my.yaml --json my.yaml", "my.yaml");
  expect_rejected(place, "throng compare my.yaml", "B");
  expect_rejected(place, "throng compare my.yaml my.yaml --line 1,2,3", "--line");
  expect_rejected(place, "throng compare my.yaml my.yaml --line 1,2,1,2", "--line");
}

}  // namespace
}  // namespace throng::compare_test
