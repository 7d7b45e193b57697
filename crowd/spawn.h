// spawn() places agents apart from each other, off obstacles, with a path to their goal.
// Invariant: each agent is placed or counted as unplaced; equal seeds give equal placements.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "crowd/crowd_plan.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/people.h"

namespace throng {
namespace tuning {

/// Random deviation of an audience's headings from the look-at point, and its bound.
inline constexpr double kFacing_rad = 0.1;
inline constexpr double kMaxFacing_rad = 0.25;

}  // namespace tuning

/// One agent at the start of a run.
struct AgentSpec {  // NOLINT(clang-analyzer-optin.performance.Padding): by meaning
  uint32_t group = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();  ///< unit
  double radius_m = 0;                                 ///< radius of the steering disc
  /// Current over nominal radius; below 1 where agents are placed closer than their discs.
  float radius_scale = 1;
  double height_m = 0;
  double desired_speed_mps = 0;
  double phase = 0;  ///< phase of the gait cycle, [0, 1)
  GaitStyle style = GaitStyle::kPlain;
  /// Controlled from outside the simulation, see Crowd::set_present(). Present from the start if
  /// `entrance` is kFromTheStart.
  bool is_external = false;
  /// Point to look at while standing; none: along its path.
  std::optional<Eigen::Vector2d> look_at_m;
  double premovement_s = 0;  ///< stands for this time after entering
  /// Index into NavigationMap::entrances() for an agent that enters later, at enters_s or once
  /// there is room, or kSpare. Its position is then the middle of that area, or of the start area.
  uint32_t entrance = kFromTheStart;
  double enters_s = 0;
  /// Speed on entry; none: its desired speed, or what agents ahead allow.
  std::optional<double> enters_mps{};
  /// Number of its social group, whose members have consecutive ids.
  uint32_t social_group = kAlone;

  static constexpr uint32_t kFromTheStart = UINT32_MAX;
  /// Entrance of an agent that is outside until Crowd::add().
  static constexpr uint32_t kSpare = UINT32_MAX - 1;
  static constexpr uint32_t kAlone = UINT32_MAX;
};

struct SpawnResult {
  std::vector<AgentSpec> people;  ///< externally controlled agents, then group by group
  std::vector<int> unplaced;      ///< per group, of the agents of the start
  std::vector<std::string> notes;
};

/// Places agents at random until each has a free place or the attempts are used up. Gaps between
/// discs shrink from 0.3 m to zero. Groups with a density use crowd/dense_placement.h. Agents that
/// enter later are listed without being placed. Each group has its agents of the start first, then
/// those of its sources in order of entry, then its spare ones.
SpawnResult spawn(const CrowdPlan& plan, const NavigationMap& map,
                  std::span<const AgentSpec> external = {});

/// Returns the size of the social group that begins with agent `id` of a group with `left` agents
/// left, including itself; 1: it walks alone.
int draw_group_size(const Group& group, uint64_t seed, uint64_t id, int left);

/// Draws size, speed and gait of agent `id` of a group.
AgentSpec make_agent(const CrowdPlan& plan, size_t group, uint64_t id);

/// Radius of the steering disc: 0.22 m for a person of 1.70 m. Half the shoulder breadth is
/// 0.255 m: shoulders and arms touch where discs do not.
double disc_radius_m(double height_m);

/// Explicit places: discs may overlap by half, and come within half a radius of walls.
inline double min_apart_m(double radius_m, double other_radius_m) {
  return 0.5 * (radius_m + other_radius_m);
}
inline double min_clearance_m(double radius_m) { return 0.5 * radius_m; }

/// Minimum distance to walls at the start: the disc's radius, at least half the depth of the trunk.
double wall_gap_m(double radius_m, double height_m);

}  // namespace throng
