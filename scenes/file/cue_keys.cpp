// Cues that groups and doors wait for, and doors.
#include <algorithm>

#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// More goals than any route has.
constexpr int64_t kMaxGoals = 1'000'000;
/// Narrower than any body.
constexpr double kNarrowest_m = 0.2;

KeyTable<Cue> make_cue_keys() {
  return {
      .text = {.name = "cue",
               .meaning = "So many seconds after the start, or after everybody of a group has been "
                          "at a goal",
               .or_number = true},
      .title = "a cue",
      .keys = {number("later_s", "how long after that", &Cue::later_s, kTimeRange),
               own_key<Cue>("group",
                            "the name of a group: after everybody of it has been at a goal; who "
                            "cannot get there is not waited for",
                            "after the start", {})
                   .reading([](Reading&, Fields& fields, Cue& cue) {
                     cue.group = fields.name_or("group", "");
                   })
                   .hashing(&Cue::group),
               whole("goal", "which of its goals, counted from 1", &Cue::goal, 1, kMaxGoals)
                   .stating("its last")
                   .reading([](Reading&, Fields& fields, Cue& cue) {
                     if (fields.find("goal") == nullptr) return;
                     fields.require("group");
                     cue.goal = static_cast<int>(fields.integer_or("goal", 1, kMaxGoals, 1));
                   })}};
}

void read_door_name(Reading& reading, Fields& fields, Door& door) {
  door.name = fields.name_or("name", fmt::format("door {}", reading.scene.doors.size() + 1));
  require_new(fields, door.name, reading.door_names);
}

Key<Door> end_key(const std::string& name, const std::string& meaning, Eigen::Vector2d Door::*end) {
  return own_key<Door>(name, meaning, "",
                       {.kind = Rule::Kind::kNumbers, .range = kPlaceRange, .least = 2, .most = 2})
      .required()
      .reading([name, end](Reading&, Fields& fields, Door& door) {
        const std::vector<double> place = fields.numbers(name, 2, kPlaceRange);
        door.*end = {place[0], place[1]};
      })
      .hashing([end](Hasher& hash, const Door& door) {
        hash.add((door.*end).x()).add((door.*end).y());
      });
}

Key<Door> cues_key(const std::string& name, const std::string& meaning, const std::string& fallback,
                   std::vector<Cue> Door::*cues) {
  return own_key<Door>(name, meaning, fallback, list_rule("cue"))
      .reading([name, cues](Reading& reading, Fields& fields, Door& door) {
        for (const YamlNode* item : fields.items(name, false))
          (door.*cues).push_back(read_cue(reading, fields.file(), *item));
      })
      .hashing([cues](Hasher& hash, const Door& door) {
        hash.add(uint64_t{(door.*cues).size()});
        for (const Cue& cue : door.*cues) add_cue(hash, cue);
      });
}

void complete_door(Reading& reading, const Fields& fields, Door& door) {
  const Rectangle& ground = reading.scene.ground;
  for (const Eigen::Vector2d& end : {door.from_m, door.to_m})
    if (!ground.contains(end))
      throw InputError(fields.where(),
                       fmt::format("door '{}' within the ground ({})", door.name, show(ground)),
                       fmt::format("an end at [{}, {}]", end.x(), end.y()));
  const double width_m = (door.to_m - door.from_m).norm();
  if (!(width_m >= kNarrowest_m))
    throw InputError(fields.where(), fmt::format("a door at least {} m wide", kNarrowest_m),
                     fmt::format("{:.3g} m", width_m));
  if (door.opens.empty() && door.closes.empty())
    throw InputError(fields.where(), "'opens' or 'closes' of a door", "neither");
}

/// Groups that wait for each other would wait for ever.
void require_no_circle(const Reading& reading) {
  std::map<std::string, std::string> waits_for;
  for (const Group& group : reading.scene.groups)
    if (group.after && !group.after->group.empty()) waits_for[group.name] = group.after->group;
  for (const auto& [name, first] : waits_for) {
    std::string other = first;
    for (size_t i = 0; i < waits_for.size() && other != name && waits_for.contains(other); ++i)
      other = waits_for[other];
    if (other == name)
      throw InputError(reading.scene.file.string(), "groups of which one sets out first",
                       fmt::format("'{}', which waits for itself by way of 'after'", name));
  }
}

}  // namespace

const KeyTable<Cue>& cue_keys() {
  static const KeyTable<Cue> table = make_cue_keys();
  return table;
}

const KeyTable<Door>& door_keys() {
  static const KeyTable<Door> table = {
      .text = {.name = "door", .meaning = "A leaf across a way that opens and closes"},
      .title = "a door",
      .keys = {own_key<Door>("name", "unique among the doors", "`door 1`, ...", {})
                   .reading(read_door_name)
                   .hashing(&Door::name),
               end_key("from_m", "`[x, y]` of one end", &Door::from_m),
               end_key("to_m", "`[x, y]` of the other", &Door::to_m),
               cues_key("opens", "when it opens, a list of [cues](#cues)", "open from the start",
                        &Door::opens),
               cues_key("closes", "when it closes", "never", &Door::closes)},
      .complete = complete_door};
  return table;
}

Cue read_cue(Reading& reading, const std::string& file, const YamlNode& node) {
  Cue cue;
  if (node.kind == YamlNode::Kind::kScalar) {
    const YamlNode wrapper{YamlNode::Kind::kMap,        node.line, "", false, {},
                           {{"a cue", node.line, node}}};
    cue.later_s = Fields(file, wrapper, "a cue").number("a cue", kTimeRange);
    return cue;
  }
  Fields fields(file, node, cue_keys().title);
  read_keys(cue_keys(), reading, fields, cue);
  reading.cues.emplace_back(fields.where(), cue);
  return cue;
}

void require_cues(const Reading& reading) {
  const std::vector<Group>& groups = reading.scene.groups;
  for (const auto& [where, cue] : reading.cues) {
    if (cue.group.empty()) continue;
    const auto group =
        std::find_if(groups.begin(), groups.end(),
                     [&name = cue.group](const Group& each) { return each.name == name; });
    if (group == groups.end()) {
      const std::vector<std::string> names(reading.group_names.begin(), reading.group_names.end());
      throw InputError(where, "the name of a group of the scene",
                       fmt::format("'{}'", cue.group) + did_you_mean(cue.group, names));
    }
    if (!group->driven.empty() || group->recorded > 0)
      throw InputError(where, "a group that walks to goals",
                       fmt::format("'{}', which something else moves", cue.group));
    if (cue.goal > static_cast<int>(group->goals.size()))
      throw InputError(where,
                       fmt::format("one of the {} goals of '{}'", group->goals.size(), group->name),
                       fmt::format("{}", cue.goal));
  }
  require_no_circle(reading);
}

void add_cue(Hasher& hash, const Cue& cue) { add_keys(cue_keys(), hash, cue); }

}  // namespace throng
