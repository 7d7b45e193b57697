// Tests a short run of the whole experiment: its JSON, tables and figures.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/paper/experiment.h"
#include "bench/paper/report.h"
#include "bench/paper/tables.h"

namespace throng::paper::result_test {
namespace {

const PaperResult& result() {
  static const PaperResult run = [] {
    PaperOptions options;
    options.frames = 20;
    options.seeds = 2;
    options.constructions = 3;
    options.max_objects = 500;
    options.attitudes = 10;
    return run_experiments(load_objects(), options, [](const std::string&) {});
  }();
  return run;
}

TEST(PaperJson, HasEveryKeyForEveryVolume) {
  const auto json = nlohmann::json::parse(to_json(result(), "a \"cpu\""));
  for (const std::string name : {"sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "ordop14",
                                 "ordop18", "ordop26", "exact", "aabb_turned", "kdop26_refit"}) {
    ASSERT_TRUE(json["volumes"].contains(name)) << name;
    const auto& volume = json["volumes"][name];
    EXPECT_EQ(volume["collisions"].size(), 5u) << name;
    EXPECT_EQ(volume["n_v"], 105 * 19) << name;
    EXPECT_EQ(volume["n_u"], 15 * 19) << name;
    for (const char* key : {"c_v_ns", "c_u_ns", "c_o_ns", "total_ms"})
      EXPECT_GT(volume[key].get<double>(), 0) << name << "." << key;
    EXPECT_GE(volume["false_positive_rate"].get<double>(), 0) << name;
    EXPECT_LE(volume["false_positive_rate"].get<double>(), 1) << name;
  }
  EXPECT_EQ(json["volumes"]["exact"]["false_positive_rate"], 0);
  for (const char* name : {"control", "sphere", "ordop", "hybrid_one", "hybrid_all", "two_pass"})
    for (const char* key : {"fps", "tests", "updates", "total_ms"})
      EXPECT_TRUE(json["strategies"][name].contains(key)) << name << "." << key;
  ASSERT_EQ(json["paper_totals"].size(), 5u);
  for (const auto& row : json["paper_totals"]) {
    EXPECT_LT(row["error"].get<double>(), 0.002) << row["volume"];
    EXPECT_TRUE(row.contains("printed") && row.contains("computed"));
  }
}

TEST(PaperResult, TotalsFollowTheFormula) {
  for (const VolumeResult& volume : result().volumes) {
    const MethodCosts& costs = volume.costs;
    const double construction_ms = costs.construction_all.median_ns * 1e-6;
    const double expected = 15 * 19 * costs.update.median_ns * 1e-6 +
                            105 * 19 * costs.test.median_ns * 1e-6 + construction_ms;
    EXPECT_NEAR(volume.total_ms(), expected, 1e-9 * expected) << volume.name;
    // Twice the frames are 39 tested frames, because frame 0 is never tested.
    EXPECT_NEAR((volume.total_ms(2) - construction_ms) / (expected - construction_ms), 39.0 / 19,
                1e-6)
        << volume.name;
  }
}

/// A volume that encloses another one overlaps in more places.
TEST(PaperResult, OrdersNestedOverlapVolumes) {
  const auto litres = [](const std::string& name) {
    for (const VolumeResult& volume : result().volumes)
      if (volume.name == name) return volume.overlap.litres;
    return 0.0;
  };
  for (const char* volume : {"sphere", "aabb", "aabb_turned", "obb", "kdop14", "kdop26", "ordop26"})
    EXPECT_GT(litres(volume), litres("exact")) << volume;
  EXPECT_GT(litres("aabb_turned"), litres("aabb"));
  EXPECT_GT(litres("aabb"), litres("kdop26_refit"));
  EXPECT_GT(litres("kdop14"), litres("kdop26"));
  EXPECT_GT(litres("ordop14"), litres("ordop26"));
  EXPECT_GE(result().noise(), 1);
}

/// Two spheres overlap in a sphere of the sum of their radii, at any attitude.
TEST(OverlapVolume, MatchesTheFormulaForSpheres) {
  const std::vector<Object> objects = load_objects();
  const OverlapTable table = measure_overlap(objects, 20, 5);
  double expected_l = 0;
  int pairs = 0;
  for (size_t a = 0; a < objects.size(); ++a)
    for (size_t b = a + 1; b < objects.size(); ++b, ++pairs)
      expected_l +=
          4e3 / 3 * 3.14159265358979 * std::pow(objects[a].radius_m + objects[b].radius_m, 3);
  expected_l /= pairs;
  const OverlapVolume& sphere = table[kSphereMethod];
  EXPECT_NEAR(sphere.litres, expected_l, 5 * sphere.error_l);
  EXPECT_LT(sphere.error_l, 0.02 * expected_l);
}

/// The headline of Part I is tested with and without construction, in short and long runs.
TEST(PaperResult, JudgesTheCheapestVolumes) {
  const auto total_ms = [](const std::string& name, int length, bool is_built) {
    for (const VolumeResult& volume : result().volumes)
      if (volume.name == name)
        return volume.total_ms(length) -
               (is_built ? 0 : volume.costs.construction_all.median_ns * 1e-6);
    return -1.0;
  };
  size_t judged = 0;
  for (const int length : {1, 10})
    for (const bool is_built : {true, false}) {
      const std::string about = std::string("Table 3, T in ms ") + (is_built ? "with" : "without") +
                                " C_o, " + std::to_string(20 * length) + " frames";
      for (const Claim& claim : result().claims) {
        if (claim.about != about) continue;
        ++judged;
        EXPECT_TRUE(claim.right == "sphere" || claim.right == "ordop26") << claim.right;
        EXPECT_EQ(claim.left_value, total_ms(claim.left, length, is_built)) << claim.left;
        EXPECT_EQ(claim.right_value, total_ms(claim.right, length, is_built)) << claim.right;
        EXPECT_EQ(claim.holds, claim.left_value > claim.right_value);
      }
    }
  EXPECT_EQ(judged, 4u * 11);
}

TEST(PaperPictures, CoverEveryFigureOfThePaper) {
  std::set<std::string> ids;
  for (const Picture& picture : pictures_of(load_objects(), 1)) {
    EXPECT_TRUE(ids.insert(picture.id).second) << picture.id;
    EXPECT_FALSE(picture.caption.empty()) << picture.id;
    EXPECT_GT(picture.image.rgb.size(), 1'000'000u) << picture.id;
  }
  for (const Figure& figure : figures_of(result())) ids.insert(figure.id);
  const std::set<std::string> expected = {"crossings", "figure_01",  "figure_02",  "figure_03",
                                          "figure_04", "figure_05a", "figure_05b", "figure_06",
                                          "figure_07", "figure_08",  "figure_09",  "figure_10",
                                          "figure_11", "figure_12",  "figure_13"};
  EXPECT_EQ(ids, expected);
}

TEST(PaperResult, HasTablesAsWideAsTheirHeads) {
  const std::vector<Table> tables = tables_of(result());
  EXPECT_GT(tables.size(), 8u);
  for (const Table& table : tables) {
    EXPECT_FALSE(table.rows.empty()) << table.title;
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.head.size()) << table.title;
  }
}

TEST(PaperResult, EscapesMarkdownAndHtml) {
  const Table table{"a < b", "note", {"x", "y"}, {{"1 | 2", "<b>"}}};
  EXPECT_NE(to_markdown(table).find("| 1 \\| 2 | <b> |"), std::string::npos) << to_markdown(table);
  EXPECT_NE(to_html(table).find("<td>&lt;b&gt;</td>"), std::string::npos) << to_html(table);
}

TEST(Winners, ListEachChange) {
  std::vector<Scale> scales;
  for (const size_t size : {size_t{10}, size_t{20}, size_t{30}}) {
    Scale scale{size, {}};
    for (size_t s = 0; s < kStrategies.size(); ++s) {
      StrategyCost cost;
      cost.strategy = static_cast<Strategy>(s);
      cost.result.frames = 1;
      cost.result.frame_ms = 100;
      cost.culling_ms = 100;
      scale.strategies.push_back(cost);
    }
    // Control and the one object of interest do not look at all pairs: never winners.
    scale.strategies[0].culling_ms = 1;
    scale.strategies[3].culling_ms = 1;
    scale.strategies[size < 30 ? 1 : 5].culling_ms = 50;
    scales.push_back(scale);
  }
  std::vector<std::pair<size_t, std::string>> counted;
  for (const Winner& winner : find_winners(scales))
    if (winner.measure == "culling, counted") counted.emplace_back(winner.objects, winner.strategy);
  const std::vector<std::pair<size_t, std::string>> expected = {{10, "sphere"}, {30, "two_pass"}};
  EXPECT_EQ(counted, expected);
}

}  // namespace
}  // namespace throng::paper::result_test
