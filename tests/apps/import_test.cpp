// `throng import`; tests/scenes covers the readers of floor plans.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/apps/cli.h"
#include "tests/apps/workplace.h"

namespace throng::import_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kPlan = "echo 'POLYGON ((0 0, 1000 0, 1000 600, 0 800))' > room.wkt; ";

TEST(ImportCommand, WritesASceneAndTellsWhatItDid) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell(std::string(kPlan) + "throng import room.wkt --out room.yaml --unit cm", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out,
            "room.wkt: WKT\n"
            "unit: cm, by --unit\n"
            "size: 10.00 m by 8.00 m, from [0.00, 0.00] to [10.00, 8.00]\n"
            "used: 1 geometry as walkable: 1 area\n"
            "scene: 1 walkable area, 0 obstacles, 0 walls, 0 starts, 0 goals\n"
            "The plan has no starts and goals; the largest walkable area stands for them.\n"
            "room.yaml written; next:\n"
            "  throng info room.yaml --plan plan.svg\n"
            "  throng run room.yaml\n");
  EXPECT_THAT(
      read_file(folder / "room.yaml"),
      HasSubstr("ground: {polygon: [[0, 0], [10, 0], [10, 6], [0, 8]], wall_height_m: 2.5}"));
}

TEST(ImportCommand, ReplacesASceneOnlyIfAsked) {
  const ScratchFolder folder;
  const Outcome refused = shell(std::string(kPlan) +
                                    "echo mine > room.yaml; throng import room.wkt --out room.yaml "
                                    "--unit cm",
                                folder);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(
      refused.err,
      "--out: expected a new file, or --overwrite with it, found room.yaml, which is there\n");
  EXPECT_EQ(read_file(folder / "room.yaml"), "mine\n");
  const Outcome asked =
      shell("throng import room.wkt --out room.yaml --unit cm --overwrite", folder);
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(read_file(folder / "room.yaml"), StartsWith("# Floor plan of room.wkt (WKT)"));
}

TEST(ImportCommand, RejectsUnitsLayersAndPlaces) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& options) {
    const Outcome outcome = shell(kPlan + ("throng import room.wkt " + options), folder);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  };
  EXPECT_THAT(refusal("--out a.yaml"), HasSubstr("expected a unit of length, as in --unit m"));
  EXPECT_THAT(refusal("--out a.yaml --unit league"), StartsWith("--unit: expected m, cm, mm"));
  EXPECT_THAT(refusal("--out a.yaml --unit 0"), StartsWith("--unit: expected"));
  EXPECT_THAT(refusal("--out a.yaml --unit m --layer walls"),
              StartsWith("--layer: expected USE=NAME"));
  EXPECT_THAT(refusal("--out room.wkt --unit m"), HasSubstr("the plan"));
  EXPECT_EQ(shell("ls", folder).out, "room.wkt\n");
}

}  // namespace
}  // namespace throng::import_test
