// Optimal reciprocal collision avoidance (van den Berg, Guy, Lin, Manocha 2011): half-planes of
// velocities that stay clear of others, and the velocity nearest to the wanted one in all of them.
// One rule: hard planes are never given up; where the others contradict each other, the worst
// violation is made as small as it can be.
#pragma once

#include <Eigen/Core>
#include <span>

#include "crowd/steering/steering.h"

namespace throng {

/// Velocities v with normal . v >= offset_mps.
struct HalfPlane {
  Eigen::Vector2f normal = Eigen::Vector2f::UnitX();  ///< unit
  float offset_mps = 0;

  /// Positive outside: how far v lies from the half-plane.
  float violation_mps(const Eigen::Vector2f& v) const {
    return offset_mps - (normal.x() * v.x() + normal.y() * v.y());
  }
};

/// The other's disc as seen from a walker.
struct Encounter {
  Eigen::Vector2f offset_m;  ///< other's position - own position
  Eigen::Vector2f own_velocity_mps;
  Eigen::Vector2f other_velocity_mps;
  float radius_m = 0;   ///< sum of both radii
  float horizon_s = 2;  ///< no collision for so long
  float step_s = 0.1f;  ///< discs that overlap already part within a step
  float share = 0.5f;   ///< of the change that avoids a collision; both shares make 1
};

/// What the walker contributes to avoiding the collision.
HalfPlane avoidance_plane(const Encounter& encounter);

/// A wall that cannot move aside: never come nearer to it than the clearance left over the horizon.
/// `normal` points from the wall to the walker. Standing still is always allowed, so that any
/// number of walls agree.
HalfPlane wall_plane(const Eigen::Vector2f& normal, float clearance_m, float horizon_s);

/// The velocity of length at most max_speed_mps nearest to `wanted_mps` that satisfies all planes,
/// at most kMaxPlanes. The first `hard` planes must leave standing still possible. If not all can
/// be met, the velocity that violates the worst of the others least.
Eigen::Vector2f choose_velocity(std::span<const HalfPlane> planes, int hard,
                                const Eigen::Vector2f& preferred_mps, float max_speed_mps);

/// Writes what the walls near the i-th of those who decide leave, hard planes, and returns how many
/// they are: at most kMaxWalls. Discs may come `nearer_m` nearer to them than they are wide.
size_t add_walls(const SteeringView& people, size_t i, float slack_m, HalfPlane* planes);

/// Walls, people, and one more.
inline constexpr size_t kMaxPlanes = kMaxWalls + NeighbourGrid::kMaxNeighbours + 1;

/// Rounding of metres a second: below it a plane counts as met, and two directions as one.
inline constexpr float kTiny_mps = 1e-5f;

/// The share of somebody who meets another: who has been stuck makes less way.
inline float avoidance_share(float own_impatience, float other_impatience) {
  return 0.5f + 0.5f * (other_impatience - own_impatience);
}

/// The same for all who decide: the definition.
void decide_orca_scalar(const SteeringView& people, std::span<const uint32_t> slots,
                        float* next_x_mps, float* next_y_mps);
using SteeringFunction = decltype(&decide_orca_scalar);
/// With people as lanes: the same bits.
SteeringFunction orca_on(SimdTarget target);

}  // namespace throng
