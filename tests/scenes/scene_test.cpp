// Scene files: values are read, errors name file and line.
#include "scenes/file/scene.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/errors.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/yaml_tree.h"
#include "tests/scenes/scene_file.h"

namespace throng::scene_test {
namespace {

namespace fs = std::filesystem;

const std::string kGroup =
    "groups:\n"
    "  - name: a\n"
    "    count: 3\n"
    "    spawn: {min_m: [1, 1], max_m: [4, 9]}\n"
    "    goals: [{min_m: [15, 1], max_m: [19, 9]}]\n";

const std::string kTwoGroups = kGround +
                               "groups:\n"
                               "  - name: a\n"
                               "    density_per_m2: 3\n"
                               "    spawn: {min_m: [1, 1], max_m: [4, 9]}\n"
                               "    goals:\n"
                               "      - {min_m: [15, 1], max_m: [19, 9], waypoint: true}\n"
                               "      - {min_m: [10, 1], max_m: [12, 9]}\n"
                               "  - name: b\n"
                               "    count: 2\n"
                               "    spawn: {min_m: [5, 1], max_m: [8, 9]}\n"
                               "    goals: [{min_m: [15, 1], max_m: [19, 9]}]\n";

TEST_F(SceneFile, ReadsTriggersAndDoors) {
  const Scene scene = load(kTwoGroups +
                           "    after: {group: a, goal: 1, delay_s: 2}\n"
                           "doors:\n"
                           "  - {from_m: [9, 2], to_m: [9, 4], opens: [3, {group: a}]}\n"
                           "  - {name: gate, from_m: [9, 5], to_m: [9, 7], closes: [7/2]}\n");
  EXPECT_EQ(scene.groups[0].count, 72);
  EXPECT_FALSE(scene.groups[0].after);
  EXPECT_EQ(scene.groups[1].after, (TriggerRule{2, "a", 1}));
  ASSERT_EQ(scene.doors.size(), 2u);
  EXPECT_EQ(scene.doors[0].name, "door 1");
  EXPECT_EQ(scene.doors[0].opens, (std::vector<TriggerRule>{{3, "", 0}, {0, "a", 0}}));
  EXPECT_TRUE(scene.doors[0].closes.empty());
  EXPECT_EQ(scene.doors[1].name, "gate");
  EXPECT_EQ(scene.doors[1].to_m, Eigen::Vector2d(9, 7));
  EXPECT_EQ(scene.doors[1].closes, (std::vector<TriggerRule>{{3.5, "", 0}}));
  const uint64_t hash = scene.content_hash;
  EXPECT_NE(load(kTwoGroups + "    after: {group: a, goal: 2, delay_s: 2}\n").content_hash,
            load(kTwoGroups + "    after: {group: a, goal: 1, delay_s: 2}\n").content_hash);
  EXPECT_NE(load(kTwoGroups).content_hash, hash);
  EXPECT_EQ(load(kTwoGroups + "doors: []\n").content_hash, load(kTwoGroups).content_hash);
}

TEST_F(SceneFile, RejectsInvalidTriggersDoorsAndDensities) {
  const auto group = [](const std::string& lines) { return kTwoGroups + lines; };
  const auto door = [](const std::string& keys) {
    return kTwoGroups + "doors: [{from_m: [9, 2], " + keys + "}]\n";
  };
  EXPECT_EQ(complaint(group("    after: {group: aa}\n")),
            "s.yaml:13: expected the name of a group of the scene, found 'aa' (did you mean 'a'?)");
  EXPECT_EQ(complaint(group("    after: {group: a, goal: 3}\n")),
            "s.yaml:13: expected one of the 2 goals of 'a', found 3");
  EXPECT_EQ(complaint(group("    after: {goal: 1}\n")),
            "s.yaml:13: expected the key 'group' in a trigger, found none");
  EXPECT_EQ(complaint(group("    after: soon\n")),
            "s.yaml:13: expected a number for 'a trigger', found 'soon'");
  EXPECT_EQ(
      complaint(group("    after: {group: b}\n")),
      "s.yaml: expected groups that do not wait for each other, found 'b', which waits for itself "
      "through 'after'");
  EXPECT_EQ(complaint(group("    density_per_m2: 3\n")),
            "s.yaml:10: expected either 'count' or 'density_per_m2', found both");
  EXPECT_EQ(complaint(door("to_m: [9, 2.1], opens: [1]")),
            "s.yaml:13: expected a door at least 0.2 m wide, found 0.1 m");
  EXPECT_EQ(complaint(door("to_m: [9, 4]")),
            "s.yaml:13: expected the key 'opens' or 'closes' in a door, found neither");
  EXPECT_EQ(
      complaint(door("to_m: [9, 40], opens: [1]")),
      "s.yaml:13: expected door 'door 1' within the ground ([0, 0] to [20, 10]), found an end "
      "at [9, 40]");
  EXPECT_EQ(complaint(door("to_m: [9, 4], closes: [{group: c}]")),
            "s.yaml:13: expected the name of a group of the scene, found 'c' (did you mean 'a'?)");
}

TEST_F(SceneFile, ReadsSocialGroups) {
  const Scene alone = load(kTwoGroups);
  EXPECT_FALSE(alone.groups[1].social_groups);
  const Scene usual = load(kTwoGroups + "    social_groups: {}\n");
  EXPECT_EQ(usual.groups[1].social_groups->share, 0.6);
  EXPECT_NE(usual.content_hash, alone.content_hash);
  EXPECT_EQ(load(kTwoGroups + "    social_groups: 0.6\n").content_hash, usual.content_hash);
  const Scene some = load(kTwoGroups + "    social_groups: {share: 1/4, pairs: 0, fours: 3}\n");
  EXPECT_EQ(some.groups[1].social_groups->share, 0.25);
  EXPECT_EQ(some.groups[1].social_groups->sizes, (std::array<double, 3>{0, 0.21, 3}));
  EXPECT_NE(some.content_hash, usual.content_hash);
  const auto group = [](const std::string& lines) { return kTwoGroups + lines; };
  EXPECT_EQ(complaint(group("    social_groups: 2\n")),
            "s.yaml:13: expected 'social_groups' from 0 to 1, found 2");
  EXPECT_EQ(complaint(group("    social_groups: [2]\n")),
            "s.yaml:13: expected social_groups (a map of keys), found a list of 1");
  EXPECT_EQ(complaint(group("    social_groups: {pairs: 0, threes: 0, fours: 0}\n")),
            "s.yaml:13: expected one of 'pairs', 'threes' and 'fours' above 0, found none");
  EXPECT_EQ(complaint(group("    social_groups: {pair: 1}\n")).substr(0, 43),
            "s.yaml:13: expected a key of social_groups,");
  EXPECT_EQ(complaint(kGround + "groups:\n"
                                "  - density_per_m2: 3\n"
                                "    social_groups: 0.5\n"
                                "    spawn: {min_m: [1, 1], max_m: [4, 9]}\n"
                                "    goals: [{min_m: [15, 1], max_m: [19, 9]}]\n"),
            "s.yaml:4: expected either 'social_groups' or 'density_per_m2', found both");
}

TEST_F(SceneFile, ReadsAllValues) {
  const Scene scene =
      load("name: test\ndescription: a test\nseed: 7\nstep_s: 1/50\nduration_s: 2.5\n" + kGround +
           "culling: {part_volume: ordop14, exact: true}\nplanted_feet: false\n" + kGroup +
           "    desired_speed_mps: {mean: 1.2, std_dev: 0.1, min: 1, max: 1.5}\n"
           "    height_m: 1.8\n"
           "    look_at: [10, -3]\n"
           "obstacles:\n"
           "  - {name: wall, kind: box, position_m: [10, 5], size_m: [0.5, 2, 3], yaw_deg: 90}\n"
           "  - {kind: cylinder, position_m: [12, 5], diameter_m: 1, height_m: 2, bottom_m: 1}\n");
  EXPECT_EQ(scene.name, "test");
  EXPECT_EQ(scene.seed, 7u);
  EXPECT_EQ(scene.step_s, 1.0 / 50);
  EXPECT_EQ(scene.duration_s, 2.5);
  EXPECT_EQ(scene.part_volume, VolumeKind::kOrdop14);
  EXPECT_TRUE(scene.exact);
  EXPECT_FALSE(scene.planted_feet);
  EXPECT_TRUE(scene.body_avoidance);
  ASSERT_EQ(scene.groups.size(), 1u);
  EXPECT_EQ(scene.groups[0].count, 3);
  EXPECT_EQ(scene.groups[0].speed_mps->mean, 1.2);
  EXPECT_EQ(scene.groups[0].height_m->min, 1.8);
  EXPECT_EQ(scene.groups[0].height_m->max, 1.8);
  EXPECT_EQ(scene.groups[0].look_at_m, Eigen::Vector2d(10, -3));
  ASSERT_NE(scene.groups[0].body, nullptr);
  EXPECT_EQ(scene.groups[0].body->part_count(), 15);
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_NEAR(scene.obstacles[0].heading_rad, 1.5707963267948966, 1e-15);
  EXPECT_EQ(scene.obstacles[0].centre_m.z(), 1.5);
  EXPECT_EQ(scene.obstacles[1].centre_m.z(), 2);
  EXPECT_EQ(scene.obstacles[1].name, "obstacle 2");
}

struct Wrong {
  std::string what;
  std::string text;
  std::string complaint;  ///< how it begins
};

TEST_F(SceneFile, ReportsErrorsWithFileAndLine) {
  const std::string box = "obstacles:\n  - {kind: box, position_m: [5, 5], size_m: [1, 1, 1]";
  const Wrong cases[] = {
      {"unknown key", kGround + kGroup + "durations: 3\n",
       "s.yaml:7: expected a key of a scene, found 'durations' (did you mean 'duration_s'?)"},
      {"misspelt required key", "grund: {min_m: [0, 0], max_m: [20, 10]}\n" + kGroup,
       "s.yaml:1: expected a key of a scene, found 'grund' (did you mean 'ground'?)"},
      {"no ground", kGroup, "s.yaml:1: expected the key 'ground' in a scene, found none"},
      {"no groups", kGround, "s.yaml:1: expected the key 'groups' in a scene, found none"},
      {"empty groups", kGround + "groups: []\n",
       "s.yaml:2: expected a list for 'groups', found a list of 0"},
      {"wrong type", kGround + "seed: many\n" + kGroup,
       "s.yaml:2: expected a whole number from 0 to 9223372036854775807 for 'seed', found 'many'"},
      {"a quoted number", kGround + "duration_s: \"3\"\n" + kGroup,
       "s.yaml:2: expected a number for 'duration_s', found '3'"},
      {"not a number", kGround + "duration_s: .nan\n" + kGroup,
       "s.yaml:2: expected a number for 'duration_s', found '.nan'"},
      {"infinite", kGround + "duration_s: inf\n" + kGroup,
       "s.yaml:2: expected a number for 'duration_s', found 'inf'"},
      {"out of range", kGround + "step_s: 2\n" + kGroup,
       "s.yaml:2: expected 'step_s' from 0.0001 to 0.1, found 2"},
      {"division by zero", kGround + "step_s: 1/0\n" + kGroup,
       "s.yaml:2: expected a number for 'step_s', found '1/0'"},
      {"key twice", kGround + kGround + kGroup,
       "s.yaml:2: expected every key once, found 'ground' again (first on line 1)"},
      {"name twice", kGround + kGroup + kGroup.substr(8),
       "s.yaml:7: expected every name once, found 'a' again"},
      {"corners swapped", "ground: {min_m: [0, 10], max_m: [20, 0]}\n" + kGroup,
       "s.yaml:1: expected min_m below max_m in ground, found [0, 10] and [20, 0]"},
      {"three coordinates", "ground: {min_m: [0, 0, 0], max_m: [20, 10]}\n" + kGroup,
       "s.yaml:1: expected a list of 2 numbers for 'min_m', found a list of 3"},
      {"a face without a place", kGround + kGroup + "    look_at: north\n",
       "s.yaml:7: expected a list of 2 numbers for 'look_at', found 'north'"},
      {"huge ground", "ground: {min_m: [-90000, -90000], max_m: [90000, 90000]}\n" + kGroup,
       "s.yaml:1: expected ground of at most 1"},
      {"spawn off the ground",
       kGround + "groups:\n  - count: 1\n    spawn: {min_m: [-1, 1], max_m: [4, 9]}\n",
       "s.yaml:4: expected spawn within the ground ([0, 0] to [20, 10]), found [-1, 1] to [4, 9]"},
      {"too many people", kGround + "groups:\n  - {count: 99999999}\n",
       "s.yaml:3: expected a whole number from 0 to 16777215 for 'count', found '99999999'"},
      {"negative count", kGround + "groups:\n  - {count: -1}\n",
       "s.yaml:3: expected a whole number from 0 to 16777215 for 'count', found '-1'"},
      {"no goals", kGround + kGroup.substr(0, kGroup.find("    goals")) + "    goals: []\n",
       "s.yaml:6: expected a list for 'goals', found a list of 0"},
      {"mean outside", kGround + kGroup + "    desired_speed_mps: {mean: 3, max: 2}\n",
       "s.yaml:7: expected min <= mean <= max in desired_speed_mps, found min 0.5, mean 3, max 2"},
      {"unknown age", kGround + kGroup + "    ages: elderlies\n",
       "s.yaml:7: expected ages (adults, children, young, middle_aged, elderly, impaired, mixed), "
       "or a map of shares, found 'elderlies' (did you mean 'elderly'?)"},
      {"a list of ages", kGround + kGroup + "    ages: [elderly]\n",
       "s.yaml:7: expected ages (adults, children, young, middle_aged, elderly, impaired, mixed), "
       "or a map of shares, found a list of 1"},
      {"unknown age among others", kGround + kGroup + "    ages: {young: 1, old: 1}\n",
       "s.yaml:7: expected a key of ages, found 'old'"},
      {"a mix among ages", kGround + kGroup + "    ages: {mixed: 1}\n",
       "s.yaml:7: expected a key of ages, found 'mixed'"},
      {"no ages", kGround + kGroup + "    ages: {young: 0}\n",
       "s.yaml:7: expected a share above 0 in ages, found none"},
      {"negative share", kGround + kGroup + "    ages: {young: -1}\n",
       "s.yaml:7: expected 'young' from 0 to 1000000, found -1"},
      {"unknown style", kGround + kGroup + "    gait_styles: stif\n",
       "s.yaml:7: expected gait_styles (plain, relaxed, brisk, stiff, pockets, short_steps), or a "
       "map "
       "of shares, found 'stif' (did you mean 'stiff'?)"},
      {"unknown style among others", kGround + kGroup + "    gait_styles: {plain: 1, brisque: 1}\n",
       "s.yaml:7: expected a key of gait_styles, found 'brisque' (did you mean 'brisk'?)"},
      {"no gait styles", kGround + kGroup + "    gait_styles: {plain: 0}\n",
       "s.yaml:7: expected a share above 0 in gait_styles, found none"},
      {"no such model", kGround + kGroup + "    model: missing.urdf\n",
       "s.yaml:7: expected 'adult' or a URDF file, found 'missing.urdf', and no such file at "},
      {"obstacle off the ground",
       kGround + kGroup +
           "obstacles:\n  - {name: x, kind: box, position_m: [20.5, 5], size_m: [1, 1, 1]}\n",
       "s.yaml:8: expected obstacle 'x' on the ground ([0, 0] to [20, 10]), found all of it "
       "outside, [20, 4.5] to [21, 5.5]"},
      {"obstacle off the ground, in millimetres",
       kGround + kGroup +
           "obstacles:\n  - {name: x, kind: box, position_m: [20.7, 4.3], size_m: [0.2466, 0.6014, "
           "1]}\n",
       "s.yaml:8: expected obstacle 'x' on the ground ([0, 0] to [20, 10]), found all of it "
       "outside, [20.5767, 3.9993] to [20.8233, 4.6007]"},
      {"flat obstacle",
       kGround + kGroup + "obstacles:\n  - {kind: box, position_m: [5, 5], size_m: [1, 0, 1]}\n",
       "s.yaml:8: expected 'size_m' from 0.001 to 10000, found 0"},
      {"unknown shape", kGround + kGroup + "obstacles:\n  - {kind: bix, position_m: [5, 5]}\n",
       "s.yaml:8: expected kind: box, cylinder, mesh, polygon or wall, found 'bix' (did you mean "
       "'box'?)"},
      {"a key of another shape", kGround + kGroup + box + ", diameter_m: 2}\n",
       "s.yaml:8: expected a key of an obstacle, found 'diameter_m'"},
      {"no such mesh",
       kGround + kGroup + "obstacles:\n  - {kind: mesh, position_m: [5, 5], file: no.tri}\n",
       "s.yaml:8: expected a mesh file, found 'no.tri', and no such file at "},
      {"unknown volume", kGround + "culling: {part_volume: ordop27}\n" + kGroup,
       "s.yaml:2: expected part_volume: sphere, aabb, obb, kdop14, kdop18, kdop26, ordop14, "
       "ordop18"},
      {"not YAML", kGround + "groups: [\n", "s.yaml:"},
      {"a list", "- 1\n- 2\n", "s.yaml:1: expected a scene (a map of keys), found a list of 2"},
      {"empty", "", "s.yaml: expected a scene, found an empty file"},
      {"only a comment", "# nothing\n", "s.yaml"},
      {"two documents", kGround + "---\n" + kGround, "s.yaml:3: expected one document in the file"},
      {"an anchor", "ground: &g {min_m: [0, 0], max_m: [20, 10]}\n",
       "s.yaml:1: expected a value, found a YAML anchor ('&'), which scene files do not use"},
      {"a tag", "ground: !!python/object {min_m: [0, 0]}\n",
       "s.yaml:1: expected a value without a tag, found the tag "},
      {"deep nesting", "ground: " + std::string(40, '[') + std::string(40, ']') + "\n",
       "s.yaml:1: expected at most 16 levels of nesting, found a deeper level"},
      {"binary", std::string("a: \0b", 5), "s.yaml: expected text, found a binary file"},
  };
  for (const Wrong& wrong : cases)
    EXPECT_THAT(complaint(wrong.text), testing::StartsWith(wrong.complaint)) << wrong.what;
}

TEST_F(SceneFile, RejectsHugeFilesUnread) {
  const fs::path file = write("big.yaml", "");
  fs::resize_file(file, uint64_t{3} << 30);  // sparse file
  EXPECT_THAT(
      [&] { load_scene(file.string()); },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("expected at most 4194304 bytes")));
  fs::create_directories(folder_ / "folder.yaml");
  EXPECT_THAT(
      [&] { load_scene((folder_ / "folder.yaml").string()); },
      testing::ThrowsMessage<InputError>(testing::HasSubstr("expected a file, found a directory")));
}

TEST_F(SceneFile, RejectsManyKeysQuickly) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += fmt::format("k{}: 1\n", i);
  EXPECT_EQ(complaint(text), "s.yaml:65: expected at most 64 keys in a map, found more");
}

TEST_F(SceneFile, SuggestsBundledNames) {
  EXPECT_THAT([] { load_scene("plazza"); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("(did you mean 'plaza'?)")));
}

TEST_F(SceneFile, LoadsBundledScenes) {
  const std::vector<SceneEntry> entries = bundled_scenes();
  std::vector<std::string> names;
  for (const SceneEntry& entry : entries) {
    names.push_back(entry.name);
    EXPECT_FALSE(entry.description.empty()) << entry.name;
    EXPECT_EQ(load_scene(entry.name).name, entry.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"bottleneck",
                                             "city_square",
                                             "concert",
                                             "corridor",
                                             "crossing",
                                             "evacuation",
                                             "metro",
                                             "museum",
                                             "paper_15",
                                             "paper_350",
                                             "paper_50",
                                             "paper_500",
                                             "plaza",
                                             "ring",
                                             "robot_in_crowd",
                                             "rush_hour",
                                             "stadium_exit",
                                             "station_hall",
                                             "station_platform",
                                             "ticket_office"}));
  const Scene plaza = load_scene("plaza");
  int people = 0;
  for (const Group& group : plaza.groups) people += group.count;
  EXPECT_EQ(people, 500);
  for (const Obstacle& obstacle : plaza.obstacles) {
    EXPECT_TRUE(is_closed(obstacle.mesh)) << obstacle.name;
    EXPECT_GT(signed_volume_m3(obstacle.mesh), 0) << obstacle.name;
  }
}

TEST_F(SceneFile, HashesContentNotLocation) {
  const std::string tri = "4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n4\n0 2 1\n0 1 3\n1 2 3\n2 0 3\n";
  const std::string text =
      kGround + kGroup + "obstacles:\n  - {kind: mesh, file: a.tri, position_m: [9, 5]}\n";
  write("a.tri", tri);
  const uint64_t hash = load("name: n\n" + text).content_hash;
  fs::create_directories(folder_ / "elsewhere");
  write("elsewhere/a.tri", tri);
  write("elsewhere/t.yaml", "# moved\nname: n\n\n" + text);
  EXPECT_EQ(load_scene((folder_ / "elsewhere" / "t.yaml").string()).content_hash, hash);
  EXPECT_EQ(load("name: n\nduration_s: 99\ndescription: other\n" + text).content_hash, hash);
  EXPECT_NE(load("name: n\nseed: 2\n" + text).content_hash, hash);
  EXPECT_NE(load("name: n\nstep_s: 1/30\n" + text).content_hash, hash);
  write("a.tri", "4\n0 0 0\n1 0 0\n0 1 0\n0 0 2\n4\n0 2 1\n0 1 3\n1 2 3\n2 0 3\n");
  EXPECT_NE(load("name: n\n" + text).content_hash, hash);
}

TEST_F(SceneFile, RejectsTooSmallGroundsAndBoxes) {
  for (const char* ground :
       {"{min_m: [0, 0], max_m: [0.04, 5]}", "{min_m: [0, 0], max_m: [5, 1e-3]}",
        "{min_m: [0, 0], max_m: [1e-300, 1e-300]}"})
    EXPECT_THAT(complaint(fmt::format("ground: {}\n{}", ground, kGroup)),
                testing::HasSubstr("s.yaml:1: expected ground of at least 0.1 m x 0.1 m"))
        << ground;
  EXPECT_THAT(complaint("kind: box\nbox: {count: 3, edge_m: 1e-3}\n"),
              testing::HasSubstr("s.yaml:2: expected 'edge_m' from 0.1 to 1000, found 1e-3"));
  EXPECT_THAT(complaint(kGround + kGroup +
                        "obstacles: [{kind: box, position_m: [9, 9], size_m: [1e-300, 1, 1]}]\n"),
              testing::HasSubstr("'size_m' from 0.001 to 10000"));
}

/// A wedge, 1 x 2 x 3 units, as the text of mesh files. No axis or side can be confused with
/// another.
struct Wedge {
  static constexpr float kCorners[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0},
                                           {1, 2, 0}, {0, 0, 3}, {0, 2, 3}};
  static constexpr int kTriangles[8][3] = {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {2, 5, 3},
                                           {0, 4, 2}, {2, 4, 5}, {1, 3, 4}, {3, 5, 4}};

  static std::string text(const std::string& format, float factor, const std::string& up = "Z_UP") {
    std::string v, f, soup;
    for (const auto& c : kCorners)
      v += fmt::format("{}{} {} {}\n", format == "obj" ? "v " : "", factor * c[0], factor * c[1],
                       factor * c[2]);
    const int first = format == "obj" ? 1 : 0;
    for (const auto& t : kTriangles) {
      f += fmt::format("{}{} {} {}\n",
                       format == "obj"   ? "f "
                       : format == "ply" ? "3 "
                                         : "",
                       t[0] + first, t[1] + first, t[2] + first);
      soup += "facet normal 0 0 0\nouter loop\n";
      for (const int i : t)
        soup += fmt::format("vertex {} {} {}\n", factor * kCorners[i][0], factor * kCorners[i][1],
                            factor * kCorners[i][2]);
      soup += "endloop\nendfacet\n";
    }
    if (format == "tri") return "6\n" + v + "8\n" + f;
    if (format == "obj") return v + f;
    if (format == "stl") return "solid wedge\n" + soup + "endsolid wedge\n";
    if (format == "ply")
      return "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
             "property float z\nelement face 8\nproperty list uchar int vertex_indices\n"
             "end_header\n" +
             v + f;
    return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
           "version=\"1.4.1\"><asset><unit meter=\"1\" name=\"meter\"/><up_axis>" +
           up +
           "</up_axis></asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\">"
           "<float_array id=\"a\" count=\"18\">" +
           v +
           "</float_array><technique_common><accessor source=\"#a\" count=\"6\" stride=\"3\">"
           "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
           "type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input "
           "semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"8\"><input "
           "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
           f +
           "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
           "<visual_scene id=\"s\"><node id=\"n\"><instance_geometry url=\"#g\"/></node>"
           "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/>"
           "</scene></COLLADA>\n";
  }
};

std::string wedge_scene(const std::string& keys) {
  return kGround + kGroup + "obstacles:\n  - {name: w, kind: mesh, position_m: [9, 5], " + keys +
         "}\n";
}

std::vector<std::array<float, 3>> sorted_corners(const Mesh& mesh) {
  std::vector<std::array<float, 3>> out;
  for (const Eigen::Vector3f& v : mesh.vertices) out.push_back({v.x(), v.y(), v.z()});
  for (auto& corner : out)
    for (float& value : corner) value = std::round(1e4f * value) / 1e4f + 0.0f;
  std::sort(out.begin(), out.end());
  return out;
}

TEST_F(SceneFile, ReadsTheSameObstacleFromEveryMeshFormat) {
  write("w.tri", Wedge::text("tri", 1));
  const Scene expected = load(wedge_scene("file: w.tri"));
  EXPECT_NEAR(signed_volume_m3(expected.obstacles[0].mesh), 3, 1e-5);
  for (const std::string format : {"tri", "stl", "obj", "ply", "dae"})
    for (const bool in_millimetres : {false, true}) {
      SCOPED_TRACE(format);
      write("w." + format, Wedge::text(format, in_millimetres ? 1000.0f : 1.0f));
      const Scene read =
          load(wedge_scene("file: w." + format + (in_millimetres ? ", scale: 0.001" : "")));
      const Obstacle& obstacle = read.obstacles[0];
      EXPECT_EQ(sorted_corners(obstacle.mesh), sorted_corners(expected.obstacles[0].mesh));
      EXPECT_NEAR(signed_volume_m3(obstacle.mesh), 3, 1e-4);
      EXPECT_TRUE(is_closed(obstacle.mesh));
      EXPECT_TRUE(obstacle.size_m.isApprox(Eigen::Vector3d(1, 2, 3), 1e-6));
      EXPECT_NEAR(obstacle.centre_m.z(), 0, 1e-6);
      EXPECT_TRUE(read.notes.empty());
    }
}

TEST_F(SceneFile, TurnsMeshesUpright) {
  const auto corners = [&](const std::string& keys) {
    const Obstacle obstacle = load(wedge_scene(keys)).obstacles[0];
    EXPECT_NEAR(signed_volume_m3(obstacle.mesh), 3, 1e-5) << "turned, not mirrored";
    return sorted_corners(obstacle.mesh);
  };
  // The wedge stands on its long edge: y up puts (0, 2, 3) at (0, -3, 2).
  Mesh y_up, x_up;
  for (const auto& c : Wedge::kCorners) {
    y_up.vertices.emplace_back(c[0], -c[2], c[1]);
    x_up.vertices.emplace_back(-c[1], -c[2], c[0]);
  }
  for (const std::string format : {"tri", "stl", "obj", "dae"}) {
    SCOPED_TRACE(format);
    write("w." + format, Wedge::text(format, 1));
    EXPECT_EQ(corners("up: y, file: w." + format), sorted_corners(y_up));
    EXPECT_EQ(corners("up: x, file: w." + format), sorted_corners(x_up));
    EXPECT_EQ(corners("up: z, file: w." + format), corners("file: w." + format));
  }
  // A statement of the file is honoured; the key decides against it.
  write("y.dae", Wedge::text("dae", 1, "Y_UP"));
  write("x.DAE", Wedge::text("dae", 1, "X_UP"));
  EXPECT_EQ(corners("file: y.dae"), sorted_corners(y_up));
  EXPECT_EQ(corners("file: x.DAE"), sorted_corners(x_up));
  EXPECT_EQ(corners("up: z, file: y.dae"), corners("file: w.dae"));
}

TEST_F(SceneFile, DoubtsTheUnitOfAMesh) {
  write("mm.stl", Wedge::text("stl", 1000));
  EXPECT_THAT(complaint(wedge_scene("file: mm.stl")),
              testing::AllOf(testing::HasSubstr("s.yaml:8: expected a mesh at most 1000 m high"),
                             testing::HasSubstr("found one of 1000 x 2000 x 3000 m; set 'scale: "
                                                "0.001' if the file is in millimetres")));
  write("house.stl", Wedge::text("stl", 9000));
  EXPECT_THAT(complaint(wedge_scene("file: house.stl")),
              testing::HasSubstr("house.stl: expected coordinates within 10000 m, found"));
  EXPECT_THAT(complaint(wedge_scene("file: house.stl")), testing::HasSubstr("set 'scale'"));
  EXPECT_EQ(load(wedge_scene("file: house.stl, scale: 0.0001")).obstacles.size(), 1u);
  write("km.stl", Wedge::text("stl", 0.001f));
  const Scene tiny = load(wedge_scene("file: km.stl"));
  ASSERT_EQ(tiny.notes.size(), 1u);
  EXPECT_THAT(tiny.notes[0], testing::HasSubstr("if the unit of 'km.stl' is not the metre, set"));
  EXPECT_TRUE(load(wedge_scene("file: km.stl, scale: 1000")).notes.empty());
  for (const char* scale : {"0", "-1", "1e9"})
    EXPECT_THAT(complaint(wedge_scene(fmt::format("file: km.stl, scale: {}", scale))),
                testing::HasSubstr("s.yaml:8: expected 'scale' from 1e-07 to 10000, found"))
        << scale;
  EXPECT_THAT(complaint(wedge_scene("file: km.stl, up: w")),
              testing::HasSubstr("s.yaml:8: expected up: x, y or z, found 'w'"));
  for (const char* key : {"scale: 2", "up: y"})
    EXPECT_THAT(complaint(kGround + kGroup +
                          "obstacles:\n  - {kind: box, position_m: [9, 5], size_m: [1, 1, 1], " +
                          key + "}\n"),
                testing::HasSubstr("expected a key of an obstacle, found"));
}

TEST_F(SceneFile, RejectsBrokenMeshesInOneLine) {
  for (const std::string file : {"a.stl", "a.obj", "a.dae", "a.ply", "a.tri", "a.mesh", "a"}) {
    write(file, "ply\nformat ascii 1.0\nelement vertex 99999999\n");
    const std::string message = complaint(wedge_scene("file: " + file));
    EXPECT_THAT(message, testing::HasSubstr(file)) << message;
    EXPECT_THAT(message, testing::HasSubstr(": expected ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST_F(SceneFile, PlacesMeshesByTheirLowestVertex) {
  // A pyramid whose origin lies at its tip.
  write("hanging.tri",
        "5\n-1 -1 -3\n1 -1 -3\n1 1 -3\n-1 1 -3\n0 0 0\n6\n0 2 1\n0 3 2\n0 1 4\n1 2 4\n2 3 4\n3 0 "
        "4\n");
  const std::string scene =
      kGround + kGroup + "obstacles: [{kind: mesh, position_m: [3, 5], file: hanging.tri";
  for (const double bottom_m : {0.0, 0.5, 2.5, 4.0}) {
    const Scene read = load(scene + fmt::format(", bottom_m: {}}}]\n", bottom_m));
    EXPECT_EQ(read.obstacles[0].centre_m, Eigen::Vector3d(3, 5, bottom_m + 3));
    EXPECT_EQ(blocks_people(read.obstacles[0], headroom_m(read)), bottom_m < 2.1) << bottom_m;
  }
  EXPECT_EQ(load(scene + "}]\n").obstacles[0].centre_m.z(), 3) << "on the ground by default";
}

TEST_F(SceneFile, ClipsFootprintsAtTheEdgeOfTheGround) {
  const auto with = [&](const std::string& keys) {
    return load(kGround + kGroup + "obstacles: [{name: x, kind: box, " + keys + "}]\n");
  };
  const Scene inside = with("position_m: [10, 5], size_m: [20, 1, 1]");
  EXPECT_TRUE(inside.notes.empty()) << "its ends lie in the edge";
  const Scene over = with("position_m: [20, 5], yaw_deg: 30, size_m: [4, 1, 1]");
  ASSERT_EQ(over.notes.size(), 1u);
  EXPECT_EQ(
      over.notes[0],
      "obstacle 'x' extends beyond the ground: its footprint is cut off there; its whole mesh "
      "is tested for contacts");
  EXPECT_GT(bounds_of(footprint_of(over.obstacles[0])).max_m.x(), 21.5);
  const std::vector<Footprint> footprints = footprints_of(over);
  ASSERT_EQ(footprints.size(), 1u);
  EXPECT_EQ(bounds_of(footprints[0].corners).max_m.x(), 20);
  double doubled_m2 = 0;
  for (size_t i = 0; i < footprints[0].corners.size(); ++i) {
    const Eigen::Vector2d& p = footprints[0].corners[i];
    const Eigen::Vector2d& q = footprints[0].corners[(i + 1) % footprints[0].corners.size()];
    doubled_m2 += p.x() * q.y() - q.x() * p.y();
  }
  EXPECT_NEAR(doubled_m2, 4, 1e-6) << "counter-clockwise, half of 4 m by 1 m";
  for (const char* keys : {"position_m: [22, 5], size_m: [4, 1, 1]",
                           "position_m: [22.7, 12.5], yaw_deg: 45, size_m: [4, 4, 1]",
                           "position_m: [-500, 5], size_m: [4, 1, 1]"})
    EXPECT_THAT(complaint(kGround + kGroup + "obstacles: [{name: x, kind: box, " + keys + "}]\n"),
                testing::HasSubstr("s.yaml:7: expected obstacle 'x' on the ground ([0, 0] to [20, "
                                   "10]), found all of it outside, "));
  EXPECT_EQ(with("position_m: [5000, 5], size_m: [10000, 1, 1]").notes.size(), 1u);
  EXPECT_EQ(with("position_m: [0, 5], size_m: [1, 1, 1]}, {name: y, kind: cylinder, position_m: "
                 "[9, 10], diameter_m: 1, height_m: 1")
                .notes,
            std::vector<std::string>{
                "2 obstacles extend beyond the ground, first 'x': their footprints are cut off "
                "there; their whole meshes are tested for contacts"});
}

TEST_F(SceneFile, LetsAgentsPassBelowHighObstacles) {
  const auto headroom = [&](const std::string& keys) {
    return headroom_m(load(kGround + kGroup + keys));
  };
  EXPECT_DOUBLE_EQ(headroom(""), 2.1) << "adults";
  EXPECT_DOUBLE_EQ(headroom("    ages: children\n"), 1.7);
  EXPECT_DOUBLE_EQ(headroom("    ages: {children: 1, elderly: 1}\n"), 2.06);
  EXPECT_DOUBLE_EQ(headroom("    height_m: 1.5\n"), 1.6);
  EXPECT_DOUBLE_EQ(headroom("    height_m: {mean: 1.7, std_dev: 0.1, min: 1.5, max: 2.5}\n"), 2.6);
  const std::string second =
      "  - {name: b, count: 1, height_m: 2.2, spawn: {min_m: [5, 1], max_m: [8, 9]}, goals: "
      "[{min_m: [15, 1], max_m: [19, 9]}]}\n";
  EXPECT_DOUBLE_EQ(headroom(second), 2.3) << "the tallest group";
  Scene scene = load(kGround + kGroup + second);
  scene.groups[1].count = 0;
  EXPECT_DOUBLE_EQ(headroom_m(scene), 2.1) << "an empty group";
  const auto blocks = [&](const std::string& keys) {
    const Scene read =
        load(kGround + kGroup + "obstacles: [{kind: box, position_m: [10, 5], " + keys + "}]\n");
    return footprints_of(read).size();
  };
  EXPECT_EQ(blocks("size_m: [0.3, 10, 0.3], bottom_m: 2.1"), 0u);
  EXPECT_EQ(blocks("size_m: [0.3, 10, 0.3], bottom_m: 2.099"), 1u);
  EXPECT_EQ(blocks("size_m: [0.3, 10, 1], bottom_m: -1"), 0u) << "in the ground";
}

TEST(ScaleTo, KeepsProportions) {
  for (const int total : {1, 3, 7, 101, 999, 5000}) {
    Scene scene;
    scene.ground = {{0, 0}, {1000, 1000}};
    for (const int count : {10, 20, 70, 0, 33}) {
      Group group;
      group.count = count;
      group.spawn = scene.ground;
      scene.groups.push_back(group);
    }
    const Scene before = scene;
    std::vector<std::string> notes;
    scale_to(scene, total, notes);
    int sum = 0;
    for (size_t i = 0; i < scene.groups.size(); ++i) {
      const double share = before.groups[i].count * total / 133.0;
      EXPECT_LT(std::abs(scene.groups[i].count - share), 1) << "group " << i << " of " << total;
      sum += scene.groups[i].count;
    }
    EXPECT_EQ(sum, total);
    EXPECT_TRUE(notes.empty()) << "enough space for " << total;
  }
}

TEST(ScaleTo, GrowsCrowdedPlans) {
  Scene scene = load_scene("corridor");
  const Scene before = scene;
  std::vector<std::string> notes;
  scale_to(scene, 4000, notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], testing::HasSubstr("4000 people need more space"));
  const double factor = scene.ground.size_m().x() / before.ground.size_m().x();
  EXPECT_GT(factor, 1.5);
  EXPECT_LE(4000 / scene.ground.area_m2(), 1.0 + 1e-9) << "more than one person per m2";
  // The walls still bound the whole corridor and keep their thickness and height.
  EXPECT_NEAR(scene.obstacles[0].size_m.x(), factor * before.obstacles[0].size_m.x(), 1e-9);
  EXPECT_EQ(scene.obstacles[0].size_m.y(), before.obstacles[0].size_m.y());
  EXPECT_EQ(scene.obstacles[0].size_m.z(), before.obstacles[0].size_m.z());
  EXPECT_EQ(scene.obstacles[2].size_m, before.obstacles[2].size_m) << "a column grew";
  EXPECT_NE(scene.content_hash, before.content_hash);
}

TEST(ScaleTo, RejectsInvalidTotals) {
  Scene scene = load_scene("corridor");
  std::vector<std::string> notes;
  EXPECT_THROW(scale_to(scene, 0, notes), InputError);
  EXPECT_THROW(scale_to(scene, static_cast<int>(kMaxBodies), notes), InputError);
}

}  // namespace
}  // namespace throng::scene_test
