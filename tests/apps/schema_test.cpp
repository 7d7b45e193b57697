// scenes/scene.schema.json, which editors read, agrees with the reader of scene files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "base/errors.h"
#include "scenes/file/scene.h"
#include "scenes/file/scene_keys.h"
#include "scenes/file/yaml_tree.h"
#include "tests/apps/json_schema.h"

namespace throng::schema_test {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

const Json& schema() {
  static const Json parsed =
      Json::parse(text_of(fs::path(THRONG_SOURCE_DIR) / "scenes" / "scene.schema.json"));
  return parsed;
}

/// The YAML as an editor reads it: plain numbers and Booleans have their type.
Json json_of(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return nullptr;
    case YamlNode::Kind::kList: {
      Json list = Json::array();
      for (const YamlNode& item : node.items) list.push_back(json_of(item));
      return list;
    }
    case YamlNode::Kind::kMap: {
      Json map = Json::object();
      for (const YamlEntry& entry : node.entries) map[entry.key] = json_of(entry.value);
      return map;
    }
    case YamlNode::Kind::kScalar:
      break;
  }
  const std::string& text = node.scalar;
  if (node.quoted || text.empty()) return text;
  if (text == "true" || text == "false") return text == "true";
  const char* end = text.data() + text.size();
  int64_t integer = 0;
  if (std::from_chars(text.data(), end, integer).ptr == end) return integer;
  double number = 0;
  if (std::from_chars(text.data(), end, number).ptr == end) return number;
  return text;
}

Json json_of(const std::string& text) { return json_of(parse_yaml(text, "scene")); }

/// Section of a page: from "## NAME" to the next one.
std::string section(const std::string& page, const std::string& name) {
  const size_t begin = page.find(fmt::format("\n## {}\n", name));
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find("\n## ", begin + 1) - begin);
}

TEST(SceneKeys, AreDocumented) {
  const std::string page =
      text_of(fs::path(THRONG_SOURCE_DIR) / "docs" / "reference" / "scene-keys.md");
  for (const MapText& map : scene_maps()) {
    const std::string keys = section(page, map.name);
    ASSERT_FALSE(keys.empty()) << "docs/reference/scene-keys.md has no section " << map.name;
    for (const KeyText& key : map.keys) {
      // The page shows the name of a document as a link.
      const std::string meaning = key.meaning.substr(0, key.meaning.find("docs/"));
      EXPECT_NE(keys.find(fmt::format("\n| `{}` | {}", key.name, meaning)), std::string::npos)
          << "docs/reference/scene-keys.md lacks " << key.name << " of " << map.name;
      EXPECT_TRUE(key.fallback.find('[') != std::string::npos ||
                  keys.find(fmt::format(" | {} |\n", key.fallback)) != std::string::npos)
          << key.name << " of " << map.name;
    }
  }
}

TEST(SceneKeys, ReferToExistingMaps) {
  std::set<std::string> names;
  for (const MapText& map : scene_maps()) EXPECT_TRUE(names.insert(map.name).second) << map.name;
  for (const MapText& map : scene_maps()) {
    std::set<std::string> keys;
    for (const KeyText& key : map.keys) {
      EXPECT_TRUE(keys.insert(key.name).second) << key.name << " twice in " << map.name;
      EXPECT_FALSE(key.meaning.empty()) << key.name;
      EXPECT_FALSE(key.fallback.empty()) << key.name;
      EXPECT_TRUE(key.rule.map.empty() || names.contains(key.rule.map)) << key.rule.map;
    }
    for (const auto& choice : map.choices)
      for (const std::string& key : choice) EXPECT_TRUE(keys.contains(key)) << key;
  }
}

TEST(SceneSchema, AcceptsTheBundledScenes) {
  int files = 0;
  for (const auto& item :
       fs::directory_iterator(fs::path(THRONG_SOURCE_DIR) / "scenes" / "bundled")) {
    if (item.path().extension() != ".yaml") continue;
    ++files;
    EXPECT_THAT(faults_of(json_of(text_of(item.path())), schema()), testing::IsEmpty())
        << item.path().filename();
  }
  EXPECT_GE(files, 15);
}

const std::string kGround = "ground: {min_m: [0, 0], max_m: [20, 10]}\n";
const std::string kGroup =
    "groups:\n"
    "  - {count: 1, spawn: {min_m: [1, 1], max_m: [4, 9]}, goals: [{min_m: [15, 1], max_m: [19, "
    "9]}]}\n";

struct Case {
  std::string what;
  std::string text;
};

/// An editor must report the mistakes that the reader reports.
TEST(SceneSchema, RejectsWhatTheReaderRejects) {
  const auto with_group = [](const std::string& keys) {
    return kGround + "groups:\n  - {count: 1, spawn: {min_m: [1, 1], max_m: [4, 9]}, " + keys +
           "}\n";
  };
  const std::string goals = "goals: [{min_m: [15, 1], max_m: [19, 9]}]";
  const Case cases[] = {
      {"a misspelt key", kGround + kGroup + "duration: 3\n"},
      {"a quoted number", kGround + kGroup + "duration_s: \"3\"\n"},
      {"a step out of range", kGround + kGroup + "step_s: 2\n"},
      {"no goals", with_group("desired_speed_mps: 1")},
      {"no goals at all", with_group("goals: []")},
      {"an invalid arrival", with_group(goals + ", on_arrival: go")},
      {"a goal without a corner", with_group("goals: [{min_m: [15, 1]}]")},
      {"a wait without an area", with_group("goals: [{wait_s: 3}]")},
      {"a negative wait", with_group("goals: [{min_m: [15, 1], max_m: [19, 9], wait_s: -1}]")},
      {"a goal without capacity",
       with_group("goals: [{min_m: [15, 1], max_m: [19, 9], capacity: 0}]")},
      {"a queue along one corner",
       with_group("goals: [{min_m: [15, 1], max_m: [19, 9], queue: {line: [[9, 5]]}}]")},
      {"an invalid corner",
       with_group("goals: [{min_m: [15, 1], max_m: [19, 9], queue: {line: [[9, 5], [8]]}}]")},
      {"people on top of each other",
       with_group("goals: [{min_m: [15, 1], max_m: [19, 9], queue: {spacing_m: 0.1}}]")},
      {"a source without a rate",
       with_group(goals + ", sources: [{area: {min_m: [1, 1], max_m: [4, 9]}, count: 3}]")},
      {"a source at rate 0",
       with_group(goals +
                  ", sources: [{area: {min_m: [1, 1], max_m: [4, 9]}, count: 3, rate_per_s: 0}]")},
      {"an unknown age", with_group(goals + ", ages: old")},
      {"a share of an unknown age", with_group(goals + ", ages: {old: 1}")},
      {"a negative share", with_group(goals + ", ages: {young: -1}")},
      {"no ages", with_group(goals + ", ages: {}")},
      {"an unknown style", with_group(goals + ", gait_styles: silly")},
      {"a share of an unknown style", with_group(goals + ", gait_styles: {silly: 1}")},
      {"a radius too wide", with_group(goals + ", radius_m: 2.5")},
      {"a corner of one number", with_group("goals: [{min_m: [15], max_m: [19, 9]}]")},
      {"an obstacle without a kind", kGround + kGroup + "obstacles: [{position_m: [5, 5]}]\n"},
      {"an unknown volume", kGround + kGroup + "culling: {part_volume: blob}\n"},
  };
  const fs::path folder = fs::temp_directory_path() / fmt::format("throng_schema_{}", ::getpid());
  fs::create_directories(folder);
  for (const Case& each : cases) {
    SCOPED_TRACE(each.what);
    std::ofstream(folder / "s.yaml") << each.text;
    EXPECT_THROW(load_scene((folder / "s.yaml").string()), InputError);
    EXPECT_THAT(faults_of(json_of(each.text), schema()), testing::Not(testing::IsEmpty()));
  }
  fs::remove_all(folder);
}

TEST(SceneSchema, AcceptsASceneWithEveryKey) {
  const std::string text =
      "name: all\ndescription: every key\nseed: 3\nstep_s: 1/50\nduration_s: 2\nkind: crowd\n" +
      kGround +
      "culling: {part_volume: obb, exact: true}\n"
      "groups:\n"
      "  - name: g\n    model: adult\n    count: 2\n"
      "    spawn: {min_m: [1, 1], max_m: [4, 9]}\n"
      "    sources:\n"
      "      - {area: {min_m: [1, 1], max_m: [4, 9]}, count: 2, rate_per_s: 1/2, start_s: 1, "
      "arrivals: poisson}\n"
      "    goals:\n"
      "      - {min_m: [9, 1], max_m: [10, 9], waypoint: true}\n"
      "      - {any_of: [{min_m: [15, 1], max_m: [19, 4]}, {min_m: [15, 6], max_m: [19, 9]}], "
      "wait_s: 2, capacity: 3, queue: {spacing_m: 1/2, line: [[14, 5], [14, 7], [11, 8]]}}\n"
      "    on_arrival: leave\n"
      "    premovement_s: {mean: 2, std_dev: 1, min: 0, max: 5}\n"
      "    ages: {young: 1/2, elderly: 1}\n"
      "    gait_styles: {plain: 3, brisk: 1}\n"
      "    desired_speed_mps: {mean: 1.2, std_dev: 0.1, min: 1, max: 1.5}\n"
      "    height_m: 1.8\n    radius_m: 0.2\n"
      "obstacles:\n"
      "  - {name: a, kind: box, position_m: [6, 5], size_m: [0.5, 2, 3], yaw_deg: 90, "
      "bottom_m: "
      "0}\n"
      "  - {kind: cylinder, position_m: [12, 5], diameter_m: 1, height_m: 2}\n";
  EXPECT_THAT(faults_of(json_of(text), schema()), testing::IsEmpty());
  const fs::path file = fs::temp_directory_path() / fmt::format("throng_all_{}.yaml", ::getpid());
  std::ofstream(file) << text;
  const Scene scene = load_scene(file.string());
  fs::remove(file);
  ASSERT_EQ(scene.groups.size(), 1u);
  const Group& group = scene.groups[0];
  EXPECT_EQ(group.total(), 4);
  ASSERT_EQ(group.sources.size(), 1u);
  EXPECT_EQ(group.sources[0].rate_per_s, 0.5);
  EXPECT_EQ(group.sources[0].start_s, 1);
  EXPECT_TRUE(group.sources[0].is_poisson);
  ASSERT_EQ(group.goals.size(), 2u);
  EXPECT_TRUE(group.goals[0].waypoint);
  EXPECT_EQ(group.goals[1].areas.size(), 2u);
  EXPECT_EQ(group.goals[1].wait_s.mean, 2);
  EXPECT_EQ(group.goals[1].capacity, 3);
  EXPECT_EQ(group.goals[1].queue.spacing_m, 0.5);
  EXPECT_EQ(group.goals[1].queue.line_m.size(), 3u);
  EXPECT_EQ(group.on_arrival, OnArrival::kLeave);
  EXPECT_EQ(group.premovement_s.max, 5);
  EXPECT_EQ(group.ages, (AgeShares{0, 0, 0.5, 0, 1, 0}));
  EXPECT_EQ(group.gait_styles, (StyleShares{3, 0, 1, 0, 0, 0}));
}

}  // namespace
}  // namespace throng::schema_test
