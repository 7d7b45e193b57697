#include "scenes/run/named_bodies.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/file/pair_rules.h"

namespace throng {
namespace {

constexpr std::string_view kPeople = "people", kRobots = "robots", kObstacles = "obstacles";

/// A name that means something else where it stands alone.
bool needs_prefix(std::string_view name) {
  return NamedBodies::is_kind(name) || name.starts_with(kGroupPrefix) ||
         name.starts_with(kObstaclePrefix);
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

}  // namespace throng
