#include "scenes/run/crowd_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/errors.h"
#include "base/text.h"
#include "scenes/motion/external_avatars.h"
#include "scenes/motion/walk.h"

namespace throng {
namespace {

std::string at(const Eigen::Vector2d& point) {
  return fmt::format("({:g}, {:g})", point.x(), point.y());
}

void check_entry(const AgentEntry& entry, size_t index, const Scene& scene, const Crowd& crowd,
                 uint32_t id, bool is_external) {
  const auto where = [&] { return fmt::format("positions_m[{}]", index); };
  const Eigen::Vector2d& point = entry.position_m;
  if (!point.allFinite() || !scene.ground.contains(point))
    throw InputError(where(),
                     fmt::format("a point on the ground, from {} to {} m", at(scene.ground.min_m),
                                 at(scene.ground.max_m)),
                     at(point));
  // Externally controlled agents may be anywhere.
  if (const double gap_m = min_clearance_m(crowd.radius_m(id)),
      clearance_m = crowd.clearance_m(point);
      !is_external && !(clearance_m >= gap_m))
    throw InputError(where(), fmt::format("a point at least {:.2f} m from walls", gap_m),
                     clearance_m > 0
                         ? fmt::format("{}, {:.2f} m from a wall", at(point), clearance_m)
                         : fmt::format("{}, in a wall or outside the floor", at(point)));
  if (const std::optional<uint32_t> other = crowd.find_overlapping(point, crowd.radius_m(id));
      other && !is_external)
    throw InputError(where(),
                     fmt::format("a point at least {:.2f} m from other agents",
                                 min_apart_m(crowd.radius_m(id), crowd.radius_m(*other))),
                     fmt::format("{}, {:.2f} m from agent {}", at(point),
                                 (crowd.positions_m()[*other] - point).norm(), *other));
  if (std::abs(entry.heading_rad) > kMaxHeading_rad)
    throw InputError(fmt::format("headings_rad[{}]", index),
                     fmt::format("an angle from -{0:g} to {0:g} rad", kMaxHeading_rad),
                     fmt::format("{:g}", entry.heading_rad));
  if (!(entry.speed_mps >= 0 && entry.speed_mps <= kMaxEntrySpeed_mps))
    throw InputError(fmt::format("speeds_mps[{}]", index),
                     fmt::format("a speed from 0 to {:g} m/s", kMaxEntrySpeed_mps),
                     fmt::format("{:g}", entry.speed_mps));
}

size_t group_index(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (const Group& group : scene.groups) {
    if (group.name == name) return names.size();
    names.push_back(group.name);
  }
  throw InputError("group", fmt::format("a group of scene '{}'", scene.name),
                   fmt::format("'{}'{}", name, did_you_mean(name, names)));
}

/// Throws InputError if two of the discs overlap by more than half. Sweeps along x.
void require_apart(std::span<const AgentEntry> entries, uint32_t first, const Crowd& crowd) {
  std::vector<uint32_t> by_x(entries.size());
  std::iota(by_x.begin(), by_x.end(), 0u);
  const auto x = [&](uint32_t i) { return entries[i].position_m.x(); };
  std::sort(by_x.begin(), by_x.end(), [&](uint32_t a, uint32_t b) { return x(a) < x(b); });
  for (size_t i = 0; i < by_x.size(); ++i)
    for (size_t k = i + 1; k < by_x.size(); ++k) {
      const uint32_t a = std::min(by_x[i], by_x[k]), b = std::max(by_x[i], by_x[k]);
      if (std::abs(x(b) - x(a)) > crowd.max_radius_m()) break;
      const double min_m = min_apart_m(crowd.radius_m(first + a), crowd.radius_m(first + b));
      const double apart_m = (entries[a].position_m - entries[b].position_m).norm();
      if (apart_m < min_m)
        throw InputError(fmt::format("positions_m[{}]", b),
                         fmt::format("a point at least {:.2f} m from the others", min_m),
                         fmt::format("{}, {:.2f} m from positions_m[{}]", at(entries[b].position_m),
                                     apart_m, a));
    }
}

void add(CrowdChange& change, const Scene& scene, Crowd& crowd, ExternalAvatars& external) {
  const size_t index = group_index(scene, change.group);
  const Group& group = scene.groups[index];
  const uint32_t spares = crowd.spares(index);
  if (change.entries.size() > spares)
    throw InputError(
        fmt::format("group '{}'", group.name),
        fmt::format("spare agents for all positions; its key `spare` reserves them, now {}",
                    group.spare),
        fmt::format("{} left for {} positions", spares, change.entries.size()));
  const uint32_t first = crowd.first_spare(index);
  for (size_t i = 0; i < change.entries.size(); ++i)
    check_entry(change.entries[i], i, scene, crowd, first + static_cast<uint32_t>(i),
                group.is_external());
  if (!group.is_external()) require_apart(change.entries, first, crowd);
  crowd.add(index, change.entries);
  change.ids.clear();
  for (size_t i = 0; i < change.entries.size(); ++i) {
    const uint32_t id = first + static_cast<uint32_t>(i);
    change.ids.push_back(id);
    if (const ExternalPose* known = external.pose(id)) {
      ExternalPose pose = *known;
      pose.root.position_m.head<2>() = change.entries[i].position_m;
      pose.root.world_from_root = rotation_to(crowd.headings()[id]);
      pose.velocity_mps = crowd.velocities_mps()[id];
      external.set_pose(id, pose, scene.ground);
    }
  }
}

void require_agents(std::span<const uint32_t> ids, const Crowd& crowd) {
  std::vector<uint32_t> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    throw InputError("ids", "each agent once", fmt::format("agent {} twice", *twice));
  for (size_t i = 0; i < ids.size(); ++i)
    if (!crowd.can_change(ids[i]))
      throw InputError(fmt::format("ids[{}]", i), "an agent that is in the scene now",
                       ids[i] < crowd.size()
                           ? fmt::format("agent {}, which is not, or is recorded", ids[i])
                           : fmt::format("{}; ids go up to {}", ids[i], crowd.size() - 1));
}

void require_steered(std::span<const uint32_t> ids, const Scene& scene, const Crowd& crowd) {
  for (size_t i = 0; i < ids.size(); ++i)
    if (scene.groups[crowd.group_of(ids[i])].is_external())
      throw InputError(fmt::format("ids[{}]", i), "an agent that steering moves",
                       fmt::format("agent {}, which is externally controlled", ids[i]));
}

void set_goal(const CrowdChange& change, const Scene& scene, Crowd& crowd) {
  if (change.goal.size() > kMaxGoalBytes)
    throw InputError("goal", fmt::format("at most {} bytes of text", kMaxGoalBytes),
                     fmt::format("{}", change.goal.size()));
  const Goal goal = read_goal_text(change.goal, "goal", scene);
  crowd.set_goal(change.ids, goal);
}

void set_desired_speed(const CrowdChange& change, Crowd& crowd) {
  if (change.desired_mps.size() != change.ids.size())
    throw InputError("mps", fmt::format("one per agent, {}", change.ids.size()),
                     fmt::format("{}", change.desired_mps.size()));
  for (size_t i = 0; i < change.ids.size(); ++i)
    if (const double mps = change.desired_mps[i];
        !(mps >= kMinDesiredSpeed_mps && mps <= kMaxDesiredSpeed_mps))
      throw InputError(
          fmt::format("mps[{}]", i),
          fmt::format("a speed from {:g} to {:g} m/s", kMinDesiredSpeed_mps, kMaxDesiredSpeed_mps),
          fmt::format("{:g}", mps));
  for (size_t i = 0; i < change.ids.size(); ++i)
    crowd.set_desired_speed(change.ids[i], change.desired_mps[i]);
}

/// Maximum length of a group's name or a goal.
constexpr size_t kMaxTextBytes = kMaxGoalBytes;

void archive_text(Archive& a, std::string& text) {
  std::vector<uint8_t> bytes(text.begin(), text.end());
  a.resized(bytes, kMaxTextBytes);
  text.assign(bytes.begin(), bytes.end());
}

}  // namespace

void apply(CrowdChange& change, const Scene& scene, Crowd& crowd, ExternalAvatars& external) {
  if (change.kind == CrowdChange::Kind::kAdd) return add(change, scene, crowd, external);
  require_agents(change.ids, crowd);
  switch (change.kind) {
    case CrowdChange::Kind::kAdd:
      break;
    case CrowdChange::Kind::kRemove:
      for (const uint32_t id : change.ids) crowd.remove(id);
      break;
    case CrowdChange::Kind::kSetGoal:
      require_steered(change.ids, scene, crowd);
      return set_goal(change, scene, crowd);
    case CrowdChange::Kind::kSetDesiredSpeed:
      require_steered(change.ids, scene, crowd);
      return set_desired_speed(change, crowd);
  }
}

void CrowdChange::archive(Archive& a) {
  a(kind);
  if (kind > Kind::kSetDesiredSpeed) a.reject("a kind of change", "another number");
  a.resized(ids, kMaxBodies);
  a.resized(entries, kMaxBodies);
  a.resized(desired_mps, kMaxBodies);
  archive_text(a, group);
  archive_text(a, goal);
  if (entries.size() != (kind == Kind::kAdd ? ids.size() : 0) ||
      desired_mps.size() != (kind == Kind::kSetDesiredSpeed ? ids.size() : 0))
    a.reject("the values of each agent that is changed", "more or fewer");
}

}  // namespace throng
