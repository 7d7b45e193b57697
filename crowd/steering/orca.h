// ORCA, optimal reciprocal collision avoidance (van den Berg, Guy, Lin, Manocha 2011), chooses the
// velocity nearest to the preferred one within half-planes of collision-free velocities.
// Invariant: hard planes are never violated beyond rounding. If the others contradict each other,
// their worst violation is minimal.
#pragma once

#include <Eigen/Core>
#include <span>

#include "crowd/steering/steering.h"

namespace throng {

/// Velocities v with normal . v >= offset_mps.
struct HalfPlane {
  Eigen::Vector2f normal = Eigen::Vector2f::UnitX();  ///< unit
  float offset_mps = 0;

  /// Distance of v from the half-plane; positive outside.
  float violation_mps(const Eigen::Vector2f& v) const {
    return offset_mps - (normal.x() * v.x() + normal.y() * v.y());
  }
};

/// Another agent's disc relative to the deciding agent.
struct Encounter {
  Eigen::Vector2f offset_m;  ///< other's position - own position
  Eigen::Vector2f own_velocity_mps;
  Eigen::Vector2f other_velocity_mps;
  float radius_m = 0;   ///< sum of both radii
  float horizon_s = 2;  ///< time without collision
  float step_s = 0.1f;  ///< discs that overlap already separate within a step
  float share = 0.5f;   ///< fraction of the avoiding change; both shares sum to 1
};

/// Half-plane that gives the agent its share of avoiding the collision.
HalfPlane avoidance_plane(const Encounter& encounter);

/// Half-plane of a wall: an agent approaches by at most the clearance over the horizon. `normal`
/// points from the wall to the agent. Standing still is always allowed: walls never contradict.
HalfPlane wall_plane(const Eigen::Vector2f& normal, float clearance_m, float horizon_s);

/// Returns the velocity of length at most max_speed_mps nearest to `preferred_mps` that satisfies
/// all planes, at most kMaxPlanes.
/// The first `hard` planes must allow standing still. If the planes contradict each other, the
/// worst violation of the others is minimal.
Eigen::Vector2f choose_velocity(std::span<const HalfPlane> planes, int hard,
                                const Eigen::Vector2f& preferred_mps, float max_speed_mps);

/// Writes the hard planes of the walls near the i-th deciding agent; returns their number, at most
/// kMaxWalls. Discs may come `slack_m` closer to walls than their radii.
size_t add_walls(const SteeringView& people, size_t i, float slack_m, HalfPlane* planes);

/// Walls, neighbours, and one more.
inline constexpr size_t kMaxPlanes = kMaxWalls + NeighbourGrid::kMaxNeighbours + 1;

/// Rounding in m/s: below it a plane counts as satisfied, and two directions as equal.
inline constexpr float kTiny_mps = 1e-5f;

/// Share of an agent in avoiding another: an agent that has been stuck avoids less.
inline float avoidance_share(float own_impatience, float other_impatience) {
  return 0.5f + 0.5f * (other_impatience - own_impatience);
}

/// The definition.
void decide_orca_scalar(const SteeringView& people, std::span<const uint32_t> slots,
                        float* next_x_mps, float* next_y_mps);
using SteeringFunction = decltype(&decide_orca_scalar);
/// Agents as lanes: results are bitwise equal.
SteeringFunction orca_on(SimdTarget target);

}  // namespace throng
