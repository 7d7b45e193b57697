// Messages about the ground of a scene: too narrow grounds, gaps, and unreachable goals.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"
#include "tests/apps/run_json.h"

namespace throng::plan_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// 20 people, a wall with a gap in its middle, a goal behind it.
std::string gap_scene(double gap_m) {
  const double wall_m = 6 - 0.5 * gap_m;
  return fmt::format(
      "ground: {{min_m: [-8, -6], max_m: [8, 6]}}\n"
      "groups: [{{name: visitors, count: 20, spawn: {{min_m: [-7, -5], max_m: [-2, 5]}}, goals: "
      "[{{min_m: [3, -4], max_m: [7, 4]}}], on_arrival: leave}}]\n"
      "obstacles:\n"
      "  - {{name: south, kind: box, position_m: [0, {}], size_m: [0.2, {}, 3]}}\n"
      "  - {{name: north, kind: box, position_m: [0, {}], size_m: [0.2, {}, 3]}}\n",
      -6 + 0.5 * wall_m, wall_m, 6 - 0.5 * wall_m, wall_m);
}

TEST(Ground, IsRejectedIfNarrowerThanAVoxel) {
  const ScratchFolder folder;
  write_file(
      folder / "narrow.yaml",
      "ground: {min_m: [0, 0], max_m: [0.04, 5]}\n"
      "groups: [{count: 1, spawn: {min_m: [0, 0], max_m: [0.04, 1]}, goals: [{min_m: [0, 4], "
      "max_m: [0.04, 5]}]}]\n");
  write_file(folder / "box.yaml", "kind: box\nbox: {count: 3, edge_m: 1e-3}\n");
  for (const char* command : {"run narrow.yaml --lcm off --log off", "info narrow.yaml",
                              "run box.yaml --lcm off --log off", "info box.yaml"}) {
    const Outcome outcome = shell(std::string("throng ") + command, folder);
    EXPECT_EQ(outcome.exit_code, 2) << command << ": " << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(".yaml:")) << command;
  }
}

TEST(Gap, IsPassableAtHalfAMetreAndNotAt40Centimetres) {
  const ScratchFolder folder;
  write_file(folder / "half.yaml", gap_scene(0.5));
  const Json half = run_json("half.yaml --seconds 60 --log off", folder);
  EXPECT_EQ(half["stranded"]["people"], 0);
  EXPECT_EQ(half["stranded"]["groups"], Json::array());
  EXPECT_EQ(half["people"]["left"], 20);
  write_file(folder / "narrow.yaml", gap_scene(0.4));
  const Json narrow = run_json("narrow.yaml --seconds 1 --log off", folder);
  EXPECT_EQ(narrow["stranded"]["people"], 20);
  EXPECT_EQ(narrow["stranded"]["groups"],
            Json::parse(R"([{"group": "visitors", "goal": 1, "people": 20}])"));
}

TEST(Summary, CountsPeopleThatCannotReachAGoal) {
  const ScratchFolder folder;
  write_file(folder / "narrow.yaml", gap_scene(0.3));
  EXPECT_THAT(shell("throng run narrow.yaml --seconds 0.1 --lcm off --log off", folder).out,
              HasSubstr("stranded  20 people cannot reach a goal: 20 of group 'visitors' goal 1"));
  for (const char* scene : {"corridor", "paper_15"})
    EXPECT_THAT(
        shell(fmt::format("throng run {} --seconds 0.1 --lcm off --log off", scene), folder).out,
        HasSubstr("stranded  0 people cannot reach a goal\n"));
}

TEST(Scaling, IsInTheJson) {
  const ScratchFolder folder;
  const Json own = run_json("corridor --seconds 0.05 --log off", folder);
  EXPECT_EQ(own["scaling"]["factor"], 1);
  EXPECT_EQ(own["notes"], Json::array());
  const Json grown = run_json("corridor --seconds 0.05 --log off --avatars 1000", folder);
  EXPECT_GT(grown["scaling"]["factor"], 1);
  for (const int axis : {0, 1})
    EXPECT_NEAR(
        grown["scaling"]["ground_m"][axis].get<double>(),
        grown["scaling"]["factor"].get<double>() * own["scaling"]["ground_m"][axis].get<double>(),
        1e-9);
  EXPECT_THAT(grown["notes"].dump(), HasSubstr("the plan of 'corridor' grew"));
}

}  // namespace
}  // namespace throng::plan_test
