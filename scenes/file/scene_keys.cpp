#include "scenes/file/scene_keys.h"

#include <fmt/format.h>

#include <iterator>

#include "base/errors.h"
#include "base/limits.h"
#include "base/text.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/density.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// Agents decide ten times per second; a decision must not last for less than a step.
constexpr Range kStepRange{1e-4, 0.1};
constexpr Range kDurationRange{0, 1e7, true};
constexpr double kMinGround_m = 2 * kMinRadius_m;

const std::vector<std::string> kKinds = {"crowd", "box", "recorded"};

bool is_kind(const Fields& fields, const std::string& kind) {
  return kKinds[fields.word("kind", kKinds).value_or(0)] == kind;
}
bool is_box(const Fields& fields) { return is_kind(fields, "box"); }
bool is_recorded(const Fields& fields) { return is_kind(fields, "recorded"); }

/// Rejects keys of the other kinds of scenes.
void read_kind(ReadContext&, Fields& fields, Scene&) {
  std::vector<std::string> absent = {"box", "recording"};
  if (is_box(fields))
    absent = {"ground", "groups", "obstacles", "recording", "doors", "separation"};
  if (is_recorded(fields)) absent = {"box", "step_s"};
  expect_keys_without(absent, scene_keys(), fields);
}

void read_part(const KeyTable<Scene>& table, ReadContext& context, const Fields& fields,
               Scene& scene) {
  const YamlNode* node = fields.find(table.text.name);
  if (node == nullptr) return;
  Fields inner(fields.file(), *node, table.title);
  read_keys(table, context, inner, scene);
}

void require_possible_ground(const Fields& fields, const Scene& scene) {
  const YamlNode* node = fields.find("ground");
  const std::string where = node != nullptr ? fields.where(*node) : fields.where();
  if (!(scene.ground.size_m().minCoeff() >= kMinGround_m))
    throw InputError(
        where, fmt::format("ground of at least {} m x {} m", kMinGround_m, kMinGround_m),
        fmt::format("{} m x {} m", scene.ground.size_m().x(), scene.ground.size_m().y()));
  if (!(scene.ground.area_m2() <= kMaxGround_m2))
    throw InputError(where, fmt::format("ground of at most {} m2", kMaxGround_m2),
                     fmt::format("{}", scene.ground.area_m2()));
  if (!scene.recorded) return;
  const Rectangle& bounds = scene.recorded->recording->facts().bounds;
  if (!scene.ground.contains(bounds.min_m) || !scene.ground.contains(bounds.max_m))
    throw InputError(where, fmt::format("a ground that holds the recording ({})", to_text(bounds)),
                     to_text(scene.ground));
}

/// Reads the recording before all keys whose areas have to lie on the ground, which may follow from
/// it.
void read_recorded(ReadContext& context, const Fields& fields, Scene& scene) {
  const YamlNode& node = fields.require("recording");
  scene.recorded.emplace();
  scene.groups.push_back(recorded_group());
  Fields inner(fields.file(), node, recording_keys().title);
  read_keys(recording_keys(), context, inner, scene);
  const double duration_s = scene.duration_s;
  apply_recording(scene, fields.find("ground") != nullptr, inner.where());
  if (fields.find("duration_s") != nullptr) scene.duration_s = duration_s;
  context.people += scene.groups.back().recorded;
}

void read_ground(ReadContext& context, Fields& fields, Scene& scene) {
  if (is_box(fields)) return;
  if (is_recorded(fields)) read_recorded(context, fields, scene);
  if (fields.find("ground") != nullptr || !is_recorded(fields))
    read_ground_value(context, fields.require("ground"), fields.file(), scene);
  for (const Obstacle& wall : scene.obstacles) context.obstacle_names.insert(wall.name);
  // Only navigation needs a ground of limited size.
  if (!is_recorded(fields) || fields.find("groups") != nullptr)
    require_possible_ground(fields, scene);
}

void expect_at_most(int64_t max, const std::string& key, const Fields& fields) {
  const YamlNode* node = fields.find(key);
  if (node != nullptr && static_cast<int64_t>(node->items.size()) > max)
    throw InputError(fields.where(*node), fmt::format("at most {} {}", max, key),
                     fmt::format("{}", node->items.size()));
}

void read_groups(ReadContext& context, Fields& fields, Scene& scene) {
  if (is_box(fields)) return;
  expect_at_most(kMaxGroups, "groups", fields);
  std::vector<Group> recorded = std::move(scene.groups);
  scene.groups.clear();
  read_items(group_keys(), "groups", !is_recorded(fields), context, fields, scene.groups);
  std::move(recorded.begin(), recorded.end(), std::back_inserter(scene.groups));
}

void note_cut_obstacles(Scene& scene, size_t first) {
  const Obstacle* first_cut = nullptr;
  size_t count = 0;
  for (size_t i = first; i < scene.obstacles.size(); ++i) {
    const std::vector<Eigen::Vector2d> footprint = footprint_of(scene.obstacles[i]);
    if (clipped(footprint, scene.ground) == footprint) continue;
    if (count++ == 0) first_cut = &scene.obstacles[i];
  }
  if (count == 1)
    scene.notes.push_back(
        fmt::format("obstacle '{}' extends beyond the ground: its footprint is cut off there; its "
                    "whole mesh is tested for contacts",
                    first_cut->name));
  if (count > 1)
    scene.notes.push_back(
        fmt::format("{} obstacles extend beyond the ground, first '{}': their footprints are cut "
                    "off there; their whole meshes are tested for contacts",
                    count, first_cut->name));
}

void read_obstacles(ReadContext& context, Fields& fields, Scene& scene) {
  expect_at_most(kMaxObstacles, "obstacles", fields);
  const size_t first = scene.obstacles.size();
  read_items(obstacle_keys(), "obstacles", false, context, fields, scene.obstacles);
  std::move(context.more_obstacles.begin(), context.more_obstacles.end(),
            std::back_inserter(scene.obstacles));
  if (static_cast<int64_t>(scene.obstacles.size()) > kMaxObstacles)
    throw InputError(
        fields.where(),
        fmt::format("at most {} obstacles, counting pieces of polygons and walls", kMaxObstacles),
        fmt::format("{}", scene.obstacles.size()));
  note_cut_obstacles(scene, first);
  require_few(fields.where(), context.people + static_cast<int64_t>(scene.obstacles.size()));
}

void read_doors(ReadContext& context, Fields& fields, Scene& scene) {
  expect_at_most(kMaxDoors, "doors", fields);
  read_items(door_keys(), "doors", false, context, fields, scene.doors);
}

void count_by_densities(ReadContext& context, const std::string& where) {
  for (Group& group : context.scene.groups) {
    if (group.density_per_m2 == 0) continue;
    const int64_t count = count_by_density(context.scene, group);
    require_few(where,
                context.people + count + static_cast<int64_t>(context.scene.obstacles.size()));
    context.people += count;
    group.count = static_cast<int>(count);
  }
}

void read_box(ReadContext& context, Fields& fields, Scene& scene) {
  if (!is_box(fields)) return;
  Fields inner(fields.file(), fields.require("box"), box_keys().title);
  read_keys(box_keys(), context, inner, scene.box.emplace());
  scene.ground.max_m = Eigen::Vector2d::Constant(0.5 * scene.box->edge_m);
  scene.ground.min_m = -scene.ground.max_m;
}

void read_separation(ReadContext& context, Fields& fields, Scene& scene) {
  const YamlNode* node = fields.find("separation");
  if (node == nullptr) return;
  Fields inner(fields.file(), *node, separation_keys().title);
  read_keys(separation_keys(), context, inner, scene.separation.emplace());
}

void read_part_volume(ReadContext&, Fields& fields, Scene& scene) {
  const YamlNode* node = fields.find("part_volume");
  if (node == nullptr) return;
  if (node->kind != YamlNode::Kind::kMap) {
    scene.part_volume =
        volume_of(volume_names()[*fields.word("part_volume", volume_names())]).value();
    return;
  }
  scene.part_volume = {};
  for (const YamlEntry& entry : node->entries) {
    const std::string where = at_line(fields.file(), entry.line);
    if (entry.value.kind != YamlNode::Kind::kScalar)
      throw InputError(where, fmt::format("a volume for '{}'", entry.key), describe(entry.value));
    add_part_volume(entry.key, entry.value.scalar, where, scene.part_volume);
  }
}

MapText part_volumes_text() {
  return {.name = "part_volumes",
          .meaning =
              "One bounding volume for all parts, or a map from words of part names to volumes; "
              "`default` for the rest",
          .or_words = volume_names(),
          .any_key = volume_names()};
}

const KeyTable<Scene>& culling_keys() {
  static const KeyTable<Scene> table = [] {
    std::vector<std::string> names;
    for (const std::string& name : volume_names()) names.push_back("`" + name + "`");
    return KeyTable<Scene>{
        .text = {.name = "culling", .meaning = "Settings of contact detection"},
        .title = "culling",
        .keys = {
            custom_key<Scene>("part_volume",
                              "bounding volume of body parts: " + list_of(names, " or ") +
                                  ", or a map by part, see docs/culling.md",
                              fmt::format("`{}`", to_text(PartVolumes())), map_rule("part_volumes"))
                .with_reader(read_part_volume)
                .with_hash(
                    [](Hasher& hash, const Scene& scene) { hash.add(to_text(scene.part_volume)); }),
            flag("exact", "decide contacts by triangle tests", &Scene::exact)}};
  }();
  return table;
}

const KeyTable<Scene>& steering_keys() {
  static const KeyTable<Scene> table = [] {
    Rule models{.kind = Rule::Kind::kWord, .words = steering_names()};
    return KeyTable<Scene>{
        .text = {.name = "steering", .meaning = "Settings of the steering model"},
        .title = "steering",
        .keys = {custom_key<Scene>("model",
                                   "steering model: " + steering_choices() + ", see docs/motion.md",
                                   fmt::format("`{}`", name_of(SteeringRule{}.model)), models)
                     .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
                       if (const auto found = fields.word("model", steering_names()))
                         scene.steering.model = all_steering_kinds()[*found];
                     })
                     .with_hash([](Hasher& hash, const Scene& scene) {
                       hash.add(name_of(scene.steering.model));
                     }),
                 custom_key<Scene>("density_dependent_speed",
                                   "limit speeds by the density ahead (Weidmann 1993)", "false",
                                   {.kind = Rule::Kind::kFlag})
                     .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
                       scene.steering.density_dependent_speed =
                           fields.boolean_or("density_dependent_speed", false);
                     })
                     .with_hash([](Hasher& hash, const Scene& scene) {
                       add_value(hash, scene.steering.density_dependent_speed);
                     })}};
  }();
  return table;
}

Key<Scene> part_key(const std::string& meaning, const KeyTable<Scene>& table) {
  return custom_key<Scene>(table.text.name, meaning, "see its keys", map_rule(table.text.name))
      .with_reader([&table](ReadContext& context, Fields& fields, Scene& scene) {
        read_part(table, context, fields, scene);
      })
      .with_hash([&table](Hasher& hash, const Scene& scene) { add_keys(table, hash, scene); });
}

std::vector<Key<Scene>> rows_of_scenes() {
  return {
      custom_key<Scene>("name",
                        "name in results; this and all names below: 1 to 120 bytes of printable "
                        "UTF-8",
                        "the file's name", {})
          .with_reader([](ReadContext& context, Fields& fields, Scene& scene) {
            scene.name = fields.name_or("name", name_after(context.scene.file.stem().string()));
          })
          .with_hash(&Scene::name),
      custom_key<Scene>("description", "description in the list of `throng scenes`, one line",
                        "none", {})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            scene.description = fields.line_or("description", "");
          }),
      whole<Scene, uint64_t>("seed", "seed of all random numbers", &Scene::seed, 0, INT64_MAX),
      number("step_s", "time between frames in seconds, at most 0.1", &Scene::step_s, kStepRange)
          .with_fallback("1/60"),
      number("duration_s", "duration of a run in seconds; `--seconds` overrides it",
             &Scene::duration_s, kDurationRange)
          .without_hash(),
      custom_key<Scene>(
          "kind",
          "`crowd`; `box`: loose parts, `box` replaces ground, groups and obstacles; `recorded`: "
          "`recording` replaces groups, and the ground follows from it unless it is given",
          "`crowd`", {.kind = Rule::Kind::kWord, .words = kKinds})
          .with_reader(read_kind),
      part_key("contact detection: `part_volume` and `exact`", culling_keys()),
      flag("planted_feet",
           "feet stay in place on curves and while turning; false: they glide, which saves about "
           "80 ns per person and frame (docs/motion.md)",
           &Scene::planted_feet),
      part_key("steering: `model` and `density_dependent_speed`", steering_keys()),
      custom_key<Scene>(
          "ground",
          "where agents can walk: a rectangle `{min_m: [x, y], max_m: [x, y]}`, at least 0.1 m "
          "wide, or polygons, see docs/scenes.md",
          "required of a crowd", map_rule("ground"))
          .with_reader(read_ground)
          .with_hash([](Hasher& hash, const Scene& scene) {
            add_value(hash, scene.ground);
            // A recording adds its own.
            if (!scene.floor.empty() && !scene.recorded) add_value(hash.add("floor"), scene.floor);
          }),
      custom_key<Scene>("groups", "groups of agents", "required of a crowd",
                        list_rule("group", 1, kMaxGroups))
          .with_reader(read_groups)
          .with_hash([](Hasher& hash, const Scene& scene) {
            add_items(group_keys(), hash, scene.groups);
          }),
      custom_key<Scene>("box", "loose parts of `kind: box`", "required of a box", map_rule("box"))
          .with_reader(read_box)
          .with_hash([](Hasher& hash, const Scene& scene) {
            if (scene.box) add_keys(box_keys(), hash.add("box"), *scene.box);
          }),
      custom_key<Scene>("obstacles", "solid bodies that agents avoid", "none",
                        list_rule("obstacle", 0, kMaxObstacles))
          .with_reader(read_obstacles)
          .with_hash([](Hasher& hash, const Scene& scene) {
            add_items(obstacle_keys(), hash, scene.obstacles);
          })};
}

std::vector<Key<Scene>> later_rows_of_scenes() {
  Key<Scene> recording = custom_key<Scene>("recording", "recorded people of `kind: recorded`",
                                           "required of a recorded scene", map_rule("recording"))
                             .with_hash([](Hasher& hash, const Scene& scene) {
                               hash.add(scene.recorded->recording->content_hash());
                               add_value(hash, scene.recorded->recorded_frames);
                             });
  recording.is_default = [](const Scene& scene) { return !scene.recorded; };
  Key<Scene> doors = custom_key<Scene>("doors", "doors that open and close", "none",
                                       list_rule("door", 0, kMaxDoors))
                         .with_reader(read_doors)
                         .with_hash([](Hasher& hash, const Scene& scene) {
                           add_items(door_keys(), hash, scene.doors);
                         });
  doors.is_default = [](const Scene& scene) { return scene.doors.empty(); };
  Key<Scene> separation =
      custom_key<Scene>("separation",
                        "required separation of robots from people, see docs/contacts.md", "none",
                        map_rule("separation"))
          .with_reader(read_separation)
          .with_hash([](Hasher& hash, const Scene& scene) {
            add_keys(separation_keys(), hash, *scene.separation);
          });
  separation.is_default = [](const Scene& scene) { return !scene.separation; };
  const auto pairs = [](const char* name, std::string meaning, PairRules Scene::*rules,
                        PairRules (*rules_of)(std::string_view, std::string_view)) {
    Key<Scene> key =
        custom_key<Scene>(name, std::move(meaning), "all", {.kind = Rule::Kind::kText})
            .with_reader([name, rules, rules_of](ReadContext&, Fields& fields, Scene& scene) {
              if (const YamlNode* node = fields.find(name))
                scene.*rules = rules_of(fields.text(name), fields.where(*node));
            })
            .with_hash(
                [rules](Hasher& hash, const Scene& scene) { hash.add(to_text(scene.*rules)); });
    key.is_default = [rules](const Scene& scene) { return (scene.*rules).empty(); };
    return key;
  };
  Key<Scene> changes =
      custom_key<Scene>("change_channel",
                        "LCM channel with messages that add, remove and redirect agents, see "
                        "docs/control.md",
                        "none", {.pattern = kChannelPattern})
          .with_reader([](ReadContext&, Fields& fields, Scene& scene) {
            if (fields.find("change_channel") != nullptr)
              scene.change_channel = read_channel(fields, "change_channel");
          })
          .with_hash([](Hasher& hash, const Scene& scene) { hash.add(scene.change_channel); });
  changes.is_default = [](const Scene& scene) { return scene.change_channel.empty(); };
  return {
      recording,
      pairs(
          "group_filter",
          "pairs of groups whose contacts and distances are found, such as `robots: people, "
          "people: doors`; a single name pairs with all; `people`, `robots`, `obstacles` and `all` "
          "name bodies of a kind, `group:people` the group of that name; see docs/contacts.md",
          &Scene::group_filter, pair_rules_of),
      pairs("part_filter",
            "pairs of parts whose contacts and distances are found, by words of their names, such "
            "as `hands: head`; single words pair with all parts",
            &Scene::part_filter, part_rules_of),
      number("proximity_m",
             "margin in metres: pairs of parts within it are reported with bounds of their "
             "distance, see docs/contacts.md; at most 100, 0: off",
             &Scene::proximity_m, kProximityRange),
      number("closest_parts_m",
             "margin in metres: the closest parts of each two avatars within it are reported; at "
             "most 100, 0: off",
             &Scene::closest_parts_m, kProximityRange),
      flag("contact_points",
           "report contact point, normal and penetration depth of every touching pair of parts; "
           "requires `culling: {exact: true}`, see docs/contacts.md",
           &Scene::contact_points),
      flag("body_avoidance",
           "bodies adapt their posture to neighbours and walls; standing people breathe, sway and "
           "hold their arms in several ways; requires `planted_feet` (docs/motion.md)",
           &Scene::body_avoidance),
      doors,
      separation,
      changes};
}

}  // namespace

const KeyTable<Scene>& scene_keys() {
  static const KeyTable<Scene> table = {
      .text = {.name = "scene",
               .meaning = "A scene: a ground, agents that walk to goals, and obstacles"},
      .title = "a scene",
      .keys = rows_of_scenes(),
      .later = later_rows_of_scenes()};
  return table;
}

std::vector<MapText> scene_maps() {
  return {text_of(scene_keys()),
          text_of(culling_keys()),
          part_volumes_text(),
          text_of(steering_keys()),
          text_of(group_keys()),
          ages_text(),
          styles_text(),
          text_of(goal_keys()),
          text_of(queue_keys()),
          text_of(source_keys()),
          text_of(trigger_keys()),
          text_of(social_group_keys()),
          text_of(obstacle_keys()),
          text_of(door_keys()),
          text_of(box_keys()),
          text_of(separation_keys()),
          text_of(recording_keys()),
          area_text(),
          ground_text(),
          starts_text(),
          distribution_text()};
}

Scene read_scene(const std::filesystem::path& file, const YamlNode& root) {
  LoadedModels models;
  return read_scene(file, root, models);
}

Scene read_scene(const std::filesystem::path& file, const YamlNode& root, LoadedModels& models) {
  ReadContext context;
  context.bodies = models;
  context.folder = file.parent_path();
  context.scene.file = file;
  const std::string name = file.string();
  Fields fields(name, root, scene_keys().title);
  read_keys(scene_keys(), context, fields, context.scene);
  require_triggers(context);
  require_lines(context);
  count_by_densities(context, fields.where());
  context.scene.content_hash = content_hash_of(context.scene);
  models.merge(context.bodies);
  return std::move(context.scene);
}

uint64_t content_hash_of(const Scene& scene) {
  Hasher hash;
  add_keys(scene_keys(), hash, scene);
  return hash.value();
}

}  // namespace throng
