#include "scenes/separation/separation_rule.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

#include "base/errors.h"
#include "scenes/file/scene.h"
#include "scenes/separation/body_region.h"

namespace throng {
namespace {

/// Maximum of 0 and a speed; NaN stays NaN.
double at_least_zero(double speed_mps) { return speed_mps < 0 ? 0 : speed_mps; }

}  // namespace

ProtectiveDistance protective_distance(const SeparationRule& rule, double human_speed_mps,
                                       double robot_speed_mps) {
  const double human = at_least_zero(human_speed_mps), robot = at_least_zero(robot_speed_mps);
  const double stopping_s =
      rule.stopping_s ? *rule.stopping_s : robot / rule.deceleration_mps2.value_or(1);
  return {human * (rule.reaction_s + stopping_s), robot * rule.reaction_s, 0.5 * robot * stopping_s,
          rule.intrusion_m + rule.human_uncertainty_m + rule.robot_uncertainty_m};
}

namespace {

/// Required distance at the fixed speeds of the rule, with measured speeds of 0.
double min_required_m(const SeparationRule& rule) {
  return protective_distance(rule, rule.human_speed_mps.value_or(0),
                             rule.robot_speed_mps.value_or(0))
      .total_m();
}

std::string reach_note(const Scene& scene) {
  const SeparationRule& rule = *scene.separation;
  const std::string text = fmt::format(
      "separation: distances are known up to proximity_m = {:.6g} m", scene.proximity_m);
  // Increase of the required distance per speed of the person, in seconds.
  const double seconds = protective_distance(rule, 1, rule.robot_speed_mps.value_or(0)).human_m;
  if (!rule.robot_speed_mps || !(seconds > 0))
    return text +
           "; if measured speeds require more, shortfalls may begin undetected; such cases are "
           "counted";
  return text + fmt::format(
                    ", enough for people who approach at up to {:.3g} m/s; at higher speeds "
                    "shortfalls may begin undetected; such cases are counted",
                    (scene.proximity_m - min_required_m(rule)) / seconds);
}

}  // namespace

void require_valid_separation(const Scene& scene) {
  if (!scene.separation) return;
  const SeparationRule& rule = *scene.separation;
  if (!(scene.proximity_m > 0))
    throw InputError(rule.where,
                     "'proximity_m' (or --proximity) with 'separation', which needs distances",
                     "none");
  if (rule.is_measured() && !scene.exact)
    throw InputError(rule.where,
                     "'exact: true' under 'culling' (or --exact) to measure speeds, or "
                     "'human_speed_mps' and 'robot_speed_mps'",
                     "neither");
  const double min_required = min_required_m(rule);
  if (!(min_required <= scene.proximity_m))
    throw InputError(
        rule.where,
        fmt::format("'proximity_m' (or --proximity) of at least {:.6g}, the distance that "
                    "'separation' requires{}",
                    min_required, rule.is_measured() ? " at least" : ""),
        fmt::format("{:.6g}", scene.proximity_m));
}

void require_separation(const Scene& scene, const std::string& where) {
  if (!scene.separation)
    throw InputError(where, "a scene with a 'separation' (see docs/contacts.md)",
                     fmt::format("none in {}", scene.name));
}

std::vector<std::string> separation_notes(const Scene& scene) {
  std::vector<std::string> notes;
  if (!scene.separation) return notes;
  if (scene.separation->is_measured()) notes.push_back(reach_note(scene));
  std::set<const Model*> seen;
  for (const Group& group : scene.groups) {
    if (group.body == nullptr || !group.body->is_person || !seen.insert(group.body.get()).second)
      continue;
    std::vector<std::string> names;
    for (const Part& part : group.body->parts)
      if (body_region(part.name) == BodyRegion::kOther) names.push_back(part.name);
    if (!names.empty())
      notes.push_back(
          fmt::format("separation: model '{}' has {} without a body region: {}", group.body->name,
                      names.size() == 1 ? "1 part" : fmt::format("{} parts", names.size()),
                      fmt::join(names, ", ")));
  }
  return notes;
}

}  // namespace throng
