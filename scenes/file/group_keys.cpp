// Keys of groups and social groups.
#include <algorithm>
#include <cctype>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "scenes/file/density.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

constexpr Range kShareRange{0, 1};
constexpr Range kGroupSizeShareRange{0, 1e6};

Key<SocialGroupRule> group_size_key(const std::string& name, const std::string& meaning,
                                    size_t index) {
  return custom_key<SocialGroupRule>(name, meaning,
                                     fmt::format("{}", SocialGroupRule{}.sizes[index]),
                                     {.kind = Rule::Kind::kNumber, .range = kGroupSizeShareRange})
      .with_reader([name, index](ReadContext&, Fields& fields, SocialGroupRule& social_groups) {
        double& share = social_groups.sizes[index];
        share = fields.number_or(name, kGroupSizeShareRange, share);
      })
      .with_hash([index](Hasher& hash, const SocialGroupRule& social_groups) {
        hash.add(social_groups.sizes[index]);
      });
}

void complete_social_groups(ReadContext&, const Fields& fields, SocialGroupRule& social_groups) {
  const auto& sizes = social_groups.sizes;
  if (std::all_of(sizes.begin(), sizes.end(), [](double share) { return share == 0; }))
    throw InputError(fields.where(), "one of 'pairs', 'threes' and 'fours' above 0", "none");
}

}  // namespace

const KeyTable<SocialGroupRule>& social_group_keys() {
  static const KeyTable<SocialGroupRule> table = {
      .text = {.name = "social_groups",
               .meaning = "Social groups: the share of agents in them, or a map",
               .or_number = true},
      .title = "social_groups",
      .keys = {number("share", "share of agents that walk in social groups of two to four, 0 to 1",
                      &SocialGroupRule::share, kShareRange),
               group_size_key("pairs", "relative number of social groups of two", 0),
               group_size_key("threes", "relative number of social groups of three", 1),
               group_size_key("fours", "relative number of social groups of four", 2)},
      .complete = complete_social_groups};
  return table;
}

SocialGroupRule read_social_groups(ReadContext& context, const std::string& file,
                                   const YamlNode& node) {
  SocialGroupRule social_groups;
  if (node.kind == YamlNode::Kind::kScalar) {
    const YamlNode wrapper{
        YamlNode::Kind::kMap, node.line, "", false, {}, {{"social_groups", node.line, node}}};
    social_groups.share =
        Fields(file, wrapper, "social_groups").number("social_groups", kShareRange);
    return social_groups;
  }
  Fields fields(file, node, social_group_keys().title);
  read_keys(social_group_keys(), context, fields, social_groups);
  return social_groups;
}

namespace {

constexpr Range kPersonRange{kMinPerson_m, kMaxPerson_m};
constexpr Range kRobotRange{kMinRobot_m, kMaxRobot_m};
constexpr Range kRadiusRange{kMinRadius_m, kMaxRadius_m};

void read_group_name(ReadContext& context, Fields& fields, Group& group) {
  group.name = fields.name_or("name", fmt::format("group {}", context.scene.groups.size() + 1));
  require_new(fields, group.name, context.group_names);
}

bool may_be_empty(const Fields& fields) {
  return fields.find("sources") != nullptr || fields.find("spare") != nullptr;
}
bool has_density(const Fields& fields) { return fields.find("density_per_m2") != nullptr; }

bool has_positions(const Fields& fields) { return fields.find("positions_m") != nullptr; }

void read_count(ReadContext& context, Fields& fields, Group& group) {
  if (has_positions(fields)) return read_positions(context, fields, group);
  if (has_density(fields)) {
    if (const YamlNode* count = fields.find("count"))
      throw InputError(fields.where(*count), "either 'count' or 'density_per_m2'", "both");
    return;
  }
  if (!may_be_empty(fields)) fields.require("count");
  group.count = static_cast<int>(fields.integer_or("count", 0, kMaxBodies, 0));
}

void read_spawn(ReadContext& context, Fields& fields, Group& group) {
  const bool has_no_start =
      has_positions(fields) || (group.count == 0 && may_be_empty(fields) && !has_density(fields));
  if (fields.find("spawn") == nullptr && has_no_start)
    group.spawn = context.scene.ground;
  else
    group.spawn = read_area(context, fields.file(), fields.require("spawn"), "spawn");
}

void read_group_model(ReadContext& context, Fields& fields, Group& group) {
  group.model = read_model_file(context, fields);
  std::shared_ptr<const Model>& body = context.bodies[group.model.string()];
  if (body == nullptr) body = load_model(group.model);
  group.body = body;
  if (!(body->height_m > 0))
    throw InputError(
        fields.where(), "a model that stands above its ground",
        fmt::format("'{}' with height {} m", body->name, static_cast<double>(body->height_m)));
}

bool is_external(const Fields& fields) {
  return fields.find("control_channel") != nullptr ||
         fields.boolean_or("externally_controlled", false);
}

void read_goals(ReadContext& context, Fields& fields, Group& group) {
  if (is_external(fields)) return;
  read_items(goal_keys(), "goals", true, context, fields, group.goals);
}

void read_external(ReadContext&, Fields& fields, Group& group) {
  group.externally_controlled = fields.boolean_or("externally_controlled", false);
  if (!is_external(fields)) return;
  for (const char* key : {"goals", "on_arrival", "sources", "premovement_s", "look_at", "after",
                          "density_per_m2", "social_groups"})
    if (const YamlNode* other = fields.find(key))
      throw InputError(fields.where(*other),
                       "no goals and no sources for an externally controlled group",
                       fmt::format("'{}'", key));
  group.goals.emplace_back().areas.push_back(group.spawn);
}

void read_look_at(ReadContext&, Fields& fields, Group& group) {
  if (fields.find("look_at") == nullptr) return;
  const std::vector<double> point =
      fields.numbers("look_at", 2, {-kMaxCoordinate_m, kMaxCoordinate_m});
  group.look_at_m = {point[0], point[1]};
}

void read_social_group_key(ReadContext& context, Fields& fields, Group& group) {
  const YamlNode* node = fields.find("social_groups");
  if (node == nullptr) return;
  if (has_density(fields))
    throw InputError(fields.where(*node), "either 'social_groups' or 'density_per_m2'", "both");
  group.social_groups = read_social_groups(context, fields.file(), *node);
}

void read_premovement(ReadContext&, Fields& fields, Group& group) {
  if (const YamlNode* node = fields.find("premovement_s"))
    group.premovement_s = read_distribution(fields.file(), *node, "premovement_s",
                                            {0, 0, 0, kTimeRange.max}, kTimeRange);
}

/// Defaults of speed and height: those of the group's only age, or of adults.
const AgeGroup& base_of(const Fields& fields) {
  return age_group(only_age(read_ages(fields)).value_or(Age::kAdult));
}

void read_speed(ReadContext&, Fields& fields, Group& group) {
  if (const YamlNode* node = fields.find("desired_speed_mps"))
    group.speed_mps = read_distribution(fields.file(), *node, "desired_speed_mps",
                                        base_of(fields).speed_mps, kDesiredSpeedRange);
}

/// Defaults of a robot: its model's height, without limits.
void read_height(ReadContext&, Fields& fields, Group& group) {
  const YamlNode* node = fields.find("height_m");
  if (node == nullptr) return;
  const auto height_m = static_cast<double>(group.body->height_m);
  const bool is_person = group.body->is_person;
  const Distribution fallback =
      is_person ? base_of(fields).height_m : Distribution{height_m, 0, kMinRobot_m, kMaxRobot_m};
  group.height_m = read_distribution(fields.file(), *node, "height_m", fallback,
                                     is_person ? kPersonRange : kRobotRange);
}

/// Checks that scales fit into log messages and that parts stay within reach of the root.
void require_scale(const Fields& fields, const Group& group) {
  const Model& body = *group.body;
  double tallest_m = 0;
  for (size_t age = 0; age < kAgeCount; ++age)
    tallest_m =
        std::max(tallest_m, group.height_m.value_or(age_group(static_cast<Age>(age)).height_m).max);
  const auto own_m = static_cast<double>(body.height_m);
  const auto scale = static_cast<float>(tallest_m / own_m);
  if (!(scale <= kMaxScale))
    throw InputError(fields.where(),
                     fmt::format("a model at least {:g} m tall for avatars of {:g} m",
                                 tallest_m / static_cast<double>(kMaxScale), tallest_m),
                     fmt::format("'{}' of {:g} m; is it in other units?", body.name, own_m));
  const double min_height_m = group.height_m ? group.height_m->min : kMinPerson_m;
  if (!(min_height_m / own_m >= 1 / kMaxDescribed))
    throw InputError(fields.where(),
                     fmt::format("a model at most {:g} m tall for avatars of {:g} m",
                                 min_height_m * kMaxDescribed, min_height_m),
                     fmt::format("'{}' of {:g} m; is it in other units?", body.name, own_m));
  const double reach_m = static_cast<double>(scale) * static_cast<double>(reach_of(body));
  if (!(reach_m <= kMaxReach_m))
    throw InputError(fields.where(),
                     fmt::format("a model with all parts within {:g} m of its root", kMaxReach_m),
                     fmt::format("'{}', whose joints let them be at {:g} m; is it in other units?",
                                 body.name, reach_m));
}

void complete_group(ReadContext& context, const Fields& fields, Group& group) {
  if (group.density_per_m2 > 0 && !has_people(group))
    throw InputError(fields.where(), "a model with human legs for 'density_per_m2'",
                     fmt::format("'{}'", group.body->name));
  keep_own_size(group);
  require_scale(fields, group);
  context.people += group.total();
  require_few(fields.where(), context.people);
}

template <typename Shares>
void add_shares(Hasher& hash, const Shares& shares) {
  for (const double share : shares) hash.add(share);
}

void add_ages(Hasher& hash, const Group& group) {
  if (group.ages == kAdultsOnly) return;
  hash.add("ages").add(uint64_t{!group.speed_mps}).add(uint64_t{!group.height_m});
  add_shares(hash, group.ages);
}

const Distribution& speed_of(const Group& group) {
  return group.speed_mps ? *group.speed_mps : age_group(Age::kAdult).speed_mps;
}
const Distribution& height_of(const Group& group) {
  return group.height_m ? *group.height_m : age_group(Age::kAdult).height_m;
}

std::vector<Key<Group>> rows_of_groups() {
  return {
      custom_key<Group>("name", "unique in the scene", "`group 1`, `group 2`, ...", {})
          .with_reader(read_group_name)
          .with_hash(&Group::name),
      whole("count", "number of agents at the start", &Group::count, 0, kMaxBodies)
          .with_fallback("required, unless there are sources, spare agents, a density or positions")
          .with_reader(read_count),
      custom_key<Group>(
          "model",
          "`adult`, or a URDF file relative to the scene file; its meshes may be `.tri`, `.stl`, "
          "`.obj`, `.dae` and many others, see docs/reliability.md",
          "`adult`", {})
          .with_reader(read_group_model)
          .with_hash([](Hasher& hash, const Group& group) {
            hash.add(group.body == nullptr ? 0 : group.body->content_hash);
          }),
      custom_key<Group>("spawn", "rectangle in which agents start",
                        "required, if there is a count without positions", map_rule("area"))
          .with_reader(read_spawn)
          .with_hash(&Group::spawn),
      custom_key<Group>("goals", "goals of the route, in order",
                        "required, unless externally controlled", list_rule("goal", 1))
          .with_reader(read_goals)
          .with_hash(
              [](Hasher& hash, const Group& group) { add_items(goal_keys(), hash, group.goals); }),
      word<Group, OnArrival>(
          "on_arrival",
          "action after the last goal: `loop` (start again), `stay` there, or `leave` the scene",
          &Group::on_arrival,
          {{"loop", OnArrival::kLoop}, {"stay", OnArrival::kStay}, {"leave", OnArrival::kLeave}}),
      custom_key<Group>("sources", "areas where agents enter during the run", "none",
                        list_rule("source"))
          .with_reader([](ReadContext& context, Fields& fields, Group& group) {
            read_items(source_keys(), "sources", false, context, fields, group.sources);
          })
          .with_hash([](Hasher& hash, const Group& group) {
            add_items(source_keys(), hash, group.sources);
          }),
      custom_key<Group>("premovement_s",
                        "time before an agent sets out, in seconds: `{mean, std_dev, min, max}`, "
                        "or one number",
                        "0", map_rule("distribution"))
          .with_reader(read_premovement)
          .with_hash(&Group::premovement_s),
      custom_key<Group>("desired_speed_mps",
                        "desired speed in m/s, 0.1 to 4, regardless of age: `{mean, std_dev, min, "
                        "max}`, or one number for all agents",
                        "by age", map_rule("distribution"))
          .with_reader(read_speed)
          .with_hash([](Hasher& hash, const Group& group) { add_value(hash, speed_of(group)); }),
      custom_key<Group>("height_m",
                        "body height in metres, as a distribution or a number; scales the model; "
                        "people 0.5 to 2.5, robots 0.01 to 100",
                        "people: by age; robots: height of the model", map_rule("distribution"))
          .with_reader(read_height)
          .with_hash([](Hasher& hash, const Group& group) { add_value(hash, height_of(group)); }),
      custom_key<Group>("ages", "ages, which determine desired speed and height", "`adults`",
                        map_rule("ages"))
          .with_reader(
              [](ReadContext&, Fields& fields, Group& group) { group.ages = read_ages(fields); })
          .with_hash(add_ages),
      custom_key<Group>("gait_styles", "gait styles", "by age", map_rule("gait_styles"))
          .with_reader([](ReadContext&, Fields& fields, Group& group) {
            if (const YamlNode* node = fields.find("gait_styles"))
              group.gait_styles = read_styles(fields, *node);
          })
          .with_hash([](Hasher& hash, const Group& group) {
            if (group.gait_styles) add_shares(hash.add("gait_styles"), *group.gait_styles);
          }),
      number("radius_m", "radius of the disc that steering keeps clear of others, in metres",
             &Group::radius_m, kRadiusRange)
          .with_fallback(
              "people: 0.22 at 1.70 m, proportional to height; robots: circle that encloses them "
              "at the start, within 0.05 to 2"),
      custom_key<Group>(
          "control_channel",
          "LCM channel of an externally controlled group, see docs/control.md; the group then has "
          "neither goals nor sources, and the model's own height",
          "none", {.pattern = kChannelPattern})
          .with_reader([](ReadContext&, Fields& fields, Group& group) {
            if (fields.find("control_channel") != nullptr)
              group.control_channel = read_channel(fields, "control_channel");
          })
          .with_hash([](Hasher& hash, const Group& group) {
            if (!group.control_channel.empty())
              hash.add("control_channel").add(group.control_channel);
          })};
}

std::vector<Key<Group>> later_rows_of_groups() {
  Key<Group> look_at =
      custom_key<Group>("look_at",
                        "`[x, y]` of the point that agents face while they stand: before setting "
                        "out, while waiting, and where they stay",
                        "the next goal",
                        {.kind = Rule::Kind::kNumbers,
                         .range = {-kMaxCoordinate_m, kMaxCoordinate_m},
                         .min = 2,
                         .max = 2})
          .with_reader(read_look_at)
          .with_hash([](Hasher& hash, const Group& group) {
            hash.add(group.look_at_m->x()).add(group.look_at_m->y());
          });
  look_at.is_default = [](const Group& group) { return !group.look_at_m; };
  Key<Group> after =
      custom_key<Group>("after",
                        "trigger that lets the group start; `premovement_s` begins with it",
                        "the start, or entering", map_rule("trigger"))
          .with_reader([](ReadContext& context, Fields& fields, Group& group) {
            if (const YamlNode* node = fields.find("after"))
              group.after = read_trigger(context, fields.file(), *node);
          })
          .with_hash([](Hasher& hash, const Group& group) { add_trigger(hash, *group.after); });
  after.is_default = [](const Group& group) { return !group.after; };
  Key<Group> social_groups =
      custom_key<Group>("social_groups",
                        "agents that walk together, see docs/scenes.md#social-groups",
                        "all agents walk alone", map_rule("social_groups"))
          .with_reader(read_social_group_key)
          .with_hash([](Hasher& hash, const Group& group) {
            add_keys(social_group_keys(), hash, *group.social_groups);
          });
  social_groups.is_default = [](const Group& group) { return !group.social_groups; };
  Key<Group> external =
      flag("externally_controlled",
           "whether the program that steps the run moves the group, see docs/control.md; "
           "`control_channel` implies it",
           &Group::externally_controlled)
          .with_reader(read_external);
  external.is_default = [](const Group& group) {
    return !group.externally_controlled || !group.control_channel.empty();
  };
  std::vector<Key<Group>> rows = {
      look_at,
      number("density_per_m2",
             "people per m2 of free ground in `spawn` at the start, at most 6; replaces "
             "`count`; placed by body outline instead of disc",
             &Group::density_per_m2, {0, kMaxDensity_per_m2, true})
          .with_fallback("`count`"),
      after, social_groups};
  rows.push_back(whole("spare", "number of agents that the run can add later, see docs/control.md",
                       &Group::spare, 0, kMaxBodies));
  rows.push_back(std::move(external));
  for (Key<Group>& row : rows_of_starts()) rows.push_back(std::move(row));
  return rows;
}

}  // namespace

const KeyTable<Group>& group_keys() {
  static const KeyTable<Group> table = {
      .text = {.name = "group",
               .meaning = "Agents with one body model",
               .choices = {{"goals"}, {"control_channel"}, {"externally_controlled"}}},
      .title = "a group",
      .keys = rows_of_groups(),
      .later = later_rows_of_groups(),
      .complete = complete_group};
  return table;
}

}  // namespace throng
