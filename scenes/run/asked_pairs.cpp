#include "scenes/run/asked_pairs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "avatars/model/model.h"
#include "base/errors.h"
#include "scenes/file/part_words.h"

namespace throng {
namespace {

using Sides = PairFilter::Sides;

constexpr std::string_view kPeople = "people", kRobots = "robots", kObstacles = "obstacles";
constexpr size_t kMostNamesShown = 16;

/// Gives every name of the rules' sides to what it means; is_of(name, i) for each of `count`.
/// Returns the first name that means nothing, "" if there is none.
template <typename IsOf>
std::string give_sides(const PairRules& rules, size_t count, std::vector<Sides>& sides,
                       const IsOf& is_of) {
  std::string nobody;
  const auto give = [&](const std::string& name, Sides side) {
    bool is_somebody = false;
    for (size_t i = 0; i < count; ++i) {
      if (name != kAll && !is_of(name, i)) continue;
      sides[i] |= side;
      is_somebody = true;
    }
    if (!is_somebody && nobody.empty()) nobody = name;
  };
  for (size_t i = 0; i < rules.size(); ++i) {
    give(rules[i].left, PairFilter::left_of(static_cast<int>(i)));
    give(rules[i].right, PairFilter::right_of(static_cast<int>(i)));
  }
  return nobody;
}

[[noreturn]] void refuse(const char* key, std::string what, std::vector<std::string> names,
                         const std::string& name) {
  const std::string nearest = did_you_mean(name, names);
  if (names.size() > kMostNamesShown) {
    names.resize(kMostNamesShown);
    names.emplace_back("...");
  }
  throw InputError(key, fmt::format("{}: {}", what, fmt::join(names, ", ")),
                   fmt::format("'{}'{}", name, nearest));
}

std::vector<Sides> sides_of_bodies(const Scene& scene, const RunInfo& info) {
  const size_t avatars = info.model_of_avatar.size(), count = avatars + scene.obstacles.size();
  std::vector<Sides> sides(count);
  const auto has_group = [&](const std::string& name) {
    return std::find(info.groups.begin(), info.groups.end(), name) != info.groups.end();
  };
  const auto is_of = [&](const std::string& name, size_t id) {
    if (id >= avatars) return name == kObstacles || scene.obstacles[id - avatars].name == name;
    if (has_group(name)) return info.groups[info.group_of_avatar[id]] == name;
    const bool is_person = info.models[info.model_of_avatar[id]]->is_person;
    return (name == kPeople && is_person) || (name == kRobots && !is_person);
  };
  if (const std::string nobody = give_sides(scene.between, count, sides, is_of); !nobody.empty()) {
    std::vector<std::string> names(info.groups);
    names.insert(names.end(), {std::string(kPeople), std::string(kRobots), std::string(kObstacles),
                               std::string(kAll)});
    refuse("between", "groups of the run, or", names, nobody);
  }
  return sides;
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
  const std::string nobody = give_sides(
      scene.parts, names.size(), flat,
      [&](const std::string& name, size_t part) { return has_words(names[part], name); });
  if (!nobody.empty()) refuse("parts", "words of a part", names, nobody);
  size_t next = 0;
  for (std::vector<Sides>& of_type : sides)
    for (Sides& side : of_type) side = flat[next++];
  return sides;
}

/// What is left out would seem far away.
void require_robots_and_people(const Scene& scene, const RunInfo& info, const PairFilter& filter) {
  if (!scene.separation) return;
  const std::string& where = scene.separation->where;
  if (!filter.of_part.empty())
    throw InputError(where, "all parts beside 'separation', which is of whole bodies",
                     fmt::format("'parts' (or --parts) of '{}'", to_text(scene.parts)));
  if (filter.of_body.empty()) return;
  // By the sides that they stand on, which are few.
  std::set<PairFilter::Sides> robots, people;
  for (size_t id = 0; id < info.model_of_avatar.size(); ++id)
    (info.models[info.model_of_avatar[id]]->is_person ? people : robots).insert(filter.of_body[id]);
  for (const PairFilter::Sides robot : robots)
    for (const PairFilter::Sides person : people)
      if (!PairFilter::meet(robot, person))
        throw InputError(where,
                         "'between' (or --between) to hold 'robots: people' beside 'separation'",
                         fmt::format("'{}'", to_text(scene.between)));
}

}  // namespace

PairFilter filter_of(const Scene& scene, const RunInfo& info) {
  PairFilter filter;
  if (!scene.between.empty()) filter.of_body = sides_of_bodies(scene, info);
  if (!scene.parts.empty()) filter.of_part = sides_of_parts(scene, info);
  require_robots_and_people(scene, info, filter);
  return filter;
}

}  // namespace throng
