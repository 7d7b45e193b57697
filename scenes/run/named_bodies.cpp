#include "scenes/run/named_bodies.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "avatars/model/model.h"
#include "base/errors.h"
#include "scenes/file/pair_rules.h"
#include "scenes/file/part_words.h"

namespace throng {
namespace {

constexpr std::string_view kPeople = "people", kRobots = "robots", kObstacles = "obstacles";

bool needs_prefix(std::string_view name) {
  return NamedBodies::is_kind(name) || name.starts_with(kGroupPrefix) ||
         name.starts_with(kObstaclePrefix);
}

using Sides = PairFilter::Sides;

constexpr size_t kMaxNamesShown = 16;

/// Sets a side of every body or part that a rule's name means; of(name) returns one flag each.
/// Returns the first name that matches nothing, "" if there is none.
template <typename Of>
std::string assign_sides(const PairRules& rules, std::vector<Sides>& sides, const Of& of) {
  std::string unknown;
  const auto assign = [&](const std::string& name, Sides side) {
    const std::vector<uint8_t> meant = of(name);
    for (size_t i = 0; i < sides.size(); ++i)
      if (meant[i] != 0) sides[i] |= side;
    const bool matches_nothing =
        std::none_of(meant.begin(), meant.end(), [](uint8_t is_meant) { return is_meant != 0; });
    if (unknown.empty() && matches_nothing) unknown = name;
  };
  for (size_t i = 0; i < rules.size(); ++i) {
    assign(rules[i].left, PairFilter::left_of(static_cast<int>(i)));
    assign(rules[i].right, PairFilter::right_of(static_cast<int>(i)));
  }
  return unknown;
}

[[noreturn]] void reject_name(const char* key, std::string what, std::vector<std::string> names,
                              const std::string& name, const std::string& remark = "") {
  const std::string nearest = remark.empty() ? did_you_mean(name, names) : remark;
  if (names.size() > kMaxNamesShown) {
    names.resize(kMaxNamesShown);
    names.emplace_back("...");
  }
  throw InputError(key, fmt::format("{}: {}", what, fmt::join(names, ", ")),
                   fmt::format("'{}'{}", name, nearest));
}

std::vector<Sides> sides_of_bodies(const Scene& scene, const RunInfo& info) {
  std::vector<Sides> sides(info.model_of_avatar.size() + scene.obstacles.size());
  const NamedBodies named(info);
  const std::string unknown = assign_sides(scene.group_filter, sides,
                                           [&](const std::string& name) { return named.of(name); });
  if (unknown.empty()) return sides;
  const std::string namesake = NamedBodies::is_kind(unknown) ? named.namesake(unknown) : "";
  std::vector<std::string> names = named.names();
  if (unknown.starts_with(kGroupPrefix)) {
    names.clear();
    for (const std::string& group : info.groups)
      names.push_back(fmt::format("{}{}", kGroupPrefix, group));
  }
  for (std::string& name : names) name = rule_name(name);
  reject_name("group_filter", "groups of the run, or", names, unknown,
              namesake.empty() ? "" : ", which no body is; " + namesake);
}

std::vector<std::vector<Sides>> sides_of_parts(const Scene& scene, const RunInfo& info) {
  std::vector<std::string> names;
  std::vector<std::vector<Sides>> sides;
  for (const auto& model : info.models) {
    for (const Part& part : model->parts) names.push_back(part.name);
    sides.emplace_back(model->parts.size());
  }
  for (const Obstacle& obstacle : scene.obstacles) {
    names.push_back(obstacle.name);
    sides.emplace_back(1);
  }
  std::vector<Sides> flat(names.size());
  const std::string unknown = assign_sides(scene.part_filter, flat, [&](const std::string& name) {
    std::vector<uint8_t> has;
    for (const std::string& part : names) has.push_back(name == kAll || has_words(part, name));
    return has;
  });
  if (!unknown.empty()) reject_name("part_filter", "words of a part", names, unknown);
  size_t next = 0;
  for (std::vector<Sides>& of_type : sides)
    for (Sides& side : of_type) side = flat[next++];
  return sides;
}

/// Rejects filters that omit pairs of robots and people: these would seem far away.
void require_robots_and_people(const Scene& scene, const RunInfo& info, const PairFilter& filter) {
  if (!scene.separation) return;
  const std::string& where = scene.separation->where;
  if (!filter.sides_of_part.empty())
    throw InputError(where, "no 'part_filter' with 'separation', which needs whole bodies",
                     fmt::format("'{}'", to_text(scene.part_filter)));
  if (filter.sides_of_body.empty()) return;
  // Compares distinct sides, which are few.
  std::set<PairFilter::Sides> robots, people;
  for (size_t id = 0; id < info.model_of_avatar.size(); ++id)
    (info.models[info.model_of_avatar[id]]->is_person ? people : robots)
        .insert(filter.sides_of_body[id]);
  for (const PairFilter::Sides robot : robots)
    for (const PairFilter::Sides person : people)
      if (!PairFilter::match(robot, person))
        throw InputError(
            where, "a 'group_filter' (or --filter-groups) with 'robots: people' for 'separation'",
            fmt::format("'{}'", to_text(scene.group_filter)));
}

}  // namespace

bool NamedBodies::is_kind(std::string_view name) {
  return name == kPeople || name == kRobots || name == kObstacles || name == kAll;
}

std::vector<uint8_t> NamedBodies::of(std::string_view name) const {
  const size_t avatars = run_.model_of_avatar.size();
  const std::vector<Obstacle>& obstacles = run_.scene->obstacles;
  const bool names_kind = is_kind(name), is_group = name.starts_with(kGroupPrefix),
             is_obstacle = name.starts_with(kObstaclePrefix);
  std::string_view called = name;
  if (is_group) called.remove_prefix(kGroupPrefix.size());
  if (is_obstacle) called.remove_prefix(kObstaclePrefix.size());
  std::vector<uint8_t> out(avatars + obstacles.size(), name == kAll);
  for (size_t id = 0; id < avatars; ++id) {
    const bool is_person = run_.models[run_.model_of_avatar[id]]->is_person;
    out[id] |= names_kind ? (name == kPeople && is_person) || (name == kRobots && !is_person)
                          : !is_obstacle && run_.groups[run_.group_of_avatar[id]] == called;
  }
  for (size_t i = 0; i < obstacles.size(); ++i)
    out[avatars + i] |= names_kind ? name == kObstacles : !is_group && obstacles[i].name == called;
  return out;
}

std::vector<std::string> NamedBodies::names() const {
  std::vector<std::string> out;
  for (const std::string& group : run_.groups)
    out.push_back(needs_prefix(group) ? fmt::format("{}{}", kGroupPrefix, group) : group);
  for (const Obstacle& obstacle : run_.scene->obstacles)
    if (!obstacle.name.empty() && !is_kind(obstacle.name)) out.push_back(obstacle.name);
  for (const std::string_view kind : {kPeople, kRobots, kObstacles, kAll}) out.emplace_back(kind);
  return out;
}

std::string NamedBodies::namesake(std::string_view name) const {
  if (std::find(run_.groups.begin(), run_.groups.end(), name) != run_.groups.end())
    return fmt::format("the group of this name is '{}{}'", kGroupPrefix, name);
  const std::vector<Obstacle>& obstacles = run_.scene->obstacles;
  if (std::any_of(obstacles.begin(), obstacles.end(),
                  [&](const Obstacle& obstacle) { return obstacle.name == name; }))
    return fmt::format("the obstacle of this name is '{}{}'", kObstaclePrefix, name);
  return "";
}

PairFilter filter_of(const Scene& scene, const RunInfo& info) {
  PairFilter filter;
  if (!scene.group_filter.empty()) filter.sides_of_body = sides_of_bodies(scene, info);
  if (!scene.part_filter.empty()) filter.sides_of_part = sides_of_parts(scene, info);
  require_robots_and_people(scene, info, filter);
  return filter;
}

std::vector<std::string> filter_notes(const Scene& scene, const RunInfo& info) {
  std::set<std::string> names;
  for (const PairRule& rule : scene.group_filter)
    for (const std::string& name : {rule.left, rule.right})
      if (NamedBodies::is_kind(name)) names.insert(name);
  std::vector<std::string> notes;
  for (const std::string& name : names)
    if (const std::string namesake = NamedBodies(info).namesake(name); !namesake.empty())
      notes.push_back(
          fmt::format("group_filter: '{}' means all bodies of that kind; {}", name, namesake));
  return notes;
}

}  // namespace throng
