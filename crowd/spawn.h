// Placing people: apart from each other, off the obstacles, with a way to their goal.
// One rule: every person asked for is placed or counted as not placed, and the same seed places
// alike.
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

/// An audience looks to its stage give or take this; nobody farther off than the other.
inline constexpr double kFacing_rad = 0.1;
inline constexpr double kMaxFacing_rad = 0.25;

}  // namespace tuning

/// One person at the start of a run.
struct AgentSpec {  // NOLINT(clang-analyzer-optin.performance.Padding): by meaning
  uint32_t group = 0;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d heading = Eigen::Vector2d::UnitX();  ///< unit
  double radius_m = 0;                                 ///< of the steering disc
  /// What is left of that radius at first, where people are placed closer than their discs are.
  float radius_scale = 1;
  double height_m = 0;
  double desired_speed_mps = 0;
  double phase = 0;  ///< of the gait cycle, in [0, 1)
  GaitStyle style = GaitStyle::kPlain;
  /// Something outside moves it and says when it is there: see Crowd::set_present(). It is there
  /// from the start if `entrance` says so.
  bool is_external = false;
  /// What it looks at while it stands; none: at its way.
  std::optional<Eigen::Vector2d> look_at_m;
  double premovement_s = 0;  ///< stands still for so long after entering
  /// Index into NavigationMap::entrances() of somebody who enters later, at enters_s or as soon as
  /// there is room after that; until then the place is the middle of that area.
  uint32_t entrance = kFromTheStart;
  double enters_s = 0;
  /// How fast it then walks; none: at its free speed, or as those ahead let it.
  std::optional<double> enters_mps{};
  /// Those of one party, who have consecutive ids, have the same number here.
  uint32_t social_group = kAlone;

  static constexpr uint32_t kFromTheStart = UINT32_MAX;
  static constexpr uint32_t kAlone = UINT32_MAX;
};

struct SpawnResult {
  std::vector<AgentSpec> people;  ///< those who are led, then group by group
  std::vector<int> unplaced;      ///< by group, of those who should stand there at the start
  std::vector<std::string> notes;
};

/// Throws darts (at first 0.3 m between discs, then closer, at last touching) until a place is free
/// or patience ends; groups with a density stand as bodies do (crowd/dense_placement.h).
/// People who enter later are listed, not placed: of each group first those who stand there, then
/// those of its sources, in the order they enter.
SpawnResult spawn(const CrowdPlan& plan, const NavigationMap& map,
                  std::span<const AgentSpec> external = {});

/// How many walk together, beginning with somebody of a group that has `left` people left, itself
/// included; 1: it walks alone.
int draw_group_size(const Group& group, uint64_t seed, uint64_t id, int left);

/// Somebody of a group: size, speed and gait as the seed draws them for `id`.
AgentSpec make_agent(const CrowdPlan& plan, size_t group, uint64_t id);

/// Radius of the steering disc: 0.22 m for a person of 1.70 m. Half the shoulder breadth is 0.255
/// m, so that shoulders and arms touch where discs do not.
double disc_radius_m(double height_m);

/// How far from walls somebody starts: the disc, or half the depth of the trunk where a scene makes
/// the disc narrower than that.
double wall_gap_m(double radius_m, double height_m);

}  // namespace throng
