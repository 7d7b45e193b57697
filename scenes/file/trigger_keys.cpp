// Keys of triggers and doors.
#include <algorithm>
#include <limits>
#include <utility>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

constexpr int64_t kMaxGoals = 1'000'000;
/// Narrower than any body.
constexpr double kMinDoorWidth_m = 0.2;

KeyTable<TriggerRule> make_trigger_keys() {
  return {
      .text = {.name = "trigger",
               .meaning = "Number of seconds after the start, or after all agents of a group have "
                          "reached a goal",
               .or_number = true},
      .title = "a trigger",
      .keys = {number("delay_s", "delay after that, in seconds", &TriggerRule::delay_s, kTimeRange),
               custom_key<TriggerRule>(
                   "group",
                   "group whose agents have to reach the goal; agents without a path to it do not "
                   "count",
                   "the start of the run", {})
                   .with_reader([](ReadContext&, Fields& fields, TriggerRule& trigger) {
                     trigger.group = fields.name_or("group", "");
                   })
                   .with_hash(&TriggerRule::group),
               whole("goal", "number of the goal on the group's route, counted from 1",
                     &TriggerRule::goal, 1, kMaxGoals)
                   .with_fallback("the last goal")
                   .with_reader([](ReadContext&, Fields& fields, TriggerRule& trigger) {
                     if (fields.find("goal") == nullptr) return;
                     fields.require("group");
                     trigger.goal = static_cast<int>(fields.integer_or("goal", 1, kMaxGoals, 1));
                   })}};
}

void read_door_name(ReadContext& context, Fields& fields, Door& door) {
  door.name = fields.name_or("name", fmt::format("door {}", context.scene.doors.size() + 1));
  require_new(fields, door.name, context.door_names);
}

Key<Door> end_key(const std::string& name, const std::string& meaning, Eigen::Vector2d Door::*end) {
  return custom_key<Door>(
             name, meaning, "required, or `area`",
             {.kind = Rule::Kind::kNumbers, .range = kPositionRange, .min = 2, .max = 2})
      .with_reader([name, end](ReadContext&, Fields& fields, Door& door) {
        if (fields.find("area") != nullptr) return;
        const std::vector<double> place = fields.numbers(name, 2, kPositionRange);
        door.*end = {place[0], place[1]};
      })
      .with_hash([end](Hasher& hash, const Door& door) {
        hash.add((door.*end).x()).add((door.*end).y());
      });
}

Key<Door> triggers_key(const std::string& name, const std::string& meaning,
                       const std::string& fallback, std::vector<TriggerRule> Door::*triggers) {
  return custom_key<Door>(name, meaning, fallback, list_rule("trigger"))
      .with_reader([name, triggers](ReadContext& context, Fields& fields, Door& door) {
        for (const YamlNode* item : fields.items(name, false))
          (door.*triggers).push_back(read_trigger(context, fields.file(), *item));
      })
      .with_hash([triggers](Hasher& hash, const Door& door) {
        hash.add(uint64_t{(door.*triggers).size()});
        for (const TriggerRule& trigger : door.*triggers) add_trigger(hash, trigger);
      });
}

/// The leaf lies along the longer side of the narrowest rectangle around an area.
void put_into(const Area& area, Door& door) {
  Polygon::Ring corners;
  for (const Polygon& polygon : area.polygons())
    corners.insert(corners.end(), polygon.outline.begin(), polygon.outline.end());
  const std::vector<Eigen::Vector2d> hull = convex_hull(std::move(corners));
  double min_m2 = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); ++i) {
    Eigen::Vector2d along = (hull[(i + 1) % hull.size()] - hull[i]).normalized();
    Eigen::Vector2d aside(-along.y(), along.x());
    Rectangle span{{along.dot(hull[0]), aside.dot(hull[0])},
                   {along.dot(hull[0]), aside.dot(hull[0])}};
    for (const Eigen::Vector2d& corner : hull) {
      const Eigen::Vector2d local(along.dot(corner), aside.dot(corner));
      span.min_m = span.min_m.cwiseMin(local);
      span.max_m = span.max_m.cwiseMax(local);
    }
    if (span.area_m2() >= min_m2 - 1e-9) continue;
    min_m2 = span.area_m2();
    const Eigen::Vector2d size = span.size_m(), middle = span.middle_m();
    const Eigen::Vector2d centre = middle.x() * along + middle.y() * aside;
    if (size.y() > size.x()) along = aside;
    door.from_m = centre - 0.5 * size.maxCoeff() * along;
    door.to_m = centre + 0.5 * size.maxCoeff() * along;
    door.thickness_m = size.minCoeff();
  }
}

Key<Door> door_area() {
  Key<Door> key =
      custom_key<Door>("area",
                       "area of the leaf instead of its ends; the leaf is the narrowest rectangle "
                       "around it",
                       "none", map_rule("area"))
          .with_reader([](ReadContext& context, Fields& fields, Door& door) {
            const YamlNode* node = fields.find("area");
            if (node == nullptr) return;
            expect_keys_without({"from_m", "to_m"}, door_keys(), fields);
            put_into(read_area(context, fields.file(), *node, "the area of a door"), door);
          })
          .with_hash(&Door::thickness_m);
  key.is_default = [](const Door& door) { return door.thickness_m == Door::kThickness_m; };
  return key;
}

void complete_door(ReadContext& context, const Fields& fields, Door& door) {
  const Rectangle& ground = context.scene.ground;
  for (const Eigen::Vector2d& end : {door.from_m, door.to_m})
    if (!ground.contains(end))
      throw InputError(fields.where(),
                       fmt::format("door '{}' within the ground ({})", door.name, to_text(ground)),
                       fmt::format("an end at [{}, {}]", end.x(), end.y()));
  const double width_m = (door.to_m - door.from_m).norm();
  if (!(width_m >= kMinDoorWidth_m))
    throw InputError(fields.where(), fmt::format("a door at least {} m wide", kMinDoorWidth_m),
                     fmt::format("{:.3g} m", width_m));
  if (door.opens.empty() && door.closes.empty())
    throw InputError(fields.where(), "the key 'opens' or 'closes' in a door", "neither");
}

/// Groups that wait for each other would wait for ever.
void require_no_cycle(const ReadContext& context) {
  std::map<std::string, std::string> waits_for;
  for (const Group& group : context.scene.groups)
    if (group.after && !group.after->group.empty()) waits_for[group.name] = group.after->group;
  for (const auto& [name, first] : waits_for) {
    std::string other = first;
    for (size_t i = 0; i < waits_for.size() && other != name && waits_for.contains(other); ++i)
      other = waits_for[other];
    if (other == name)
      throw InputError(context.scene.file.string(), "groups that do not wait for each other",
                       fmt::format("'{}', which waits for itself through 'after'", name));
  }
}

}  // namespace

const KeyTable<TriggerRule>& trigger_keys() {
  static const KeyTable<TriggerRule> table = make_trigger_keys();
  return table;
}

const KeyTable<Door>& door_keys() {
  static const KeyTable<Door> table = {
      .text = {.name = "door",
               .meaning = "A line segment that stops agents while it is closed",
               .choices = {{"from_m", "to_m"}, {"area"}}},
      .title = "a door",
      .keys = {custom_key<Door>("name", "unique among the doors", "`door 1`, ...", {})
                   .with_reader(read_door_name)
                   .with_hash(&Door::name),
               end_key("from_m", "`[x, y]` of one end", &Door::from_m),
               end_key("to_m", "`[x, y]` of the other end", &Door::to_m),
               triggers_key("opens", "list of triggers that open the door", "open from the start",
                            &Door::opens),
               triggers_key("closes", "list of triggers that close the door", "never",
                            &Door::closes)},
      .later = {door_area()},
      .complete = complete_door};
  return table;
}

TriggerRule read_trigger(ReadContext& context, const std::string& file, const YamlNode& node) {
  TriggerRule trigger;
  if (node.kind == YamlNode::Kind::kScalar) {
    const YamlNode wrapper{
        YamlNode::Kind::kMap, node.line, "", false, {}, {{"a trigger", node.line, node}}};
    trigger.delay_s = Fields(file, wrapper, "a trigger").number("a trigger", kTimeRange);
    return trigger;
  }
  Fields fields(file, node, trigger_keys().title);
  read_keys(trigger_keys(), context, fields, trigger);
  context.triggers.emplace_back(fields.where(), trigger);
  return trigger;
}

void require_triggers(const ReadContext& context) {
  const std::vector<Group>& groups = context.scene.groups;
  for (const auto& [where, trigger] : context.triggers) {
    if (trigger.group.empty()) continue;
    const auto group =
        std::find_if(groups.begin(), groups.end(),
                     [&name = trigger.group](const Group& each) { return each.name == name; });
    if (group == groups.end()) {
      const std::vector<std::string> names(context.group_names.begin(), context.group_names.end());
      throw InputError(where, "the name of a group of the scene",
                       fmt::format("'{}'", trigger.group) + did_you_mean(trigger.group, names));
    }
    if (group->is_external() || group->recorded > 0)
      throw InputError(
          where, "a group that walks to goals",
          fmt::format("'{}', which is recorded or externally controlled", trigger.group));
    if (trigger.goal > static_cast<int>(group->goals.size()))
      throw InputError(where,
                       fmt::format("one of the {} goals of '{}'", group->goals.size(), group->name),
                       fmt::format("{}", trigger.goal));
  }
  require_no_cycle(context);
}

void add_trigger(Hasher& hash, const TriggerRule& trigger) {
  add_keys(trigger_keys(), hash, trigger);
}

}  // namespace throng
