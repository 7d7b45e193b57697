// Body avoidance turns the trunk and tucks the arms to keep clear of neighbours and walls.
// Invariant: both bodies of a pair compute the same mid-gap line from the same frame; without
// neighbours in reach the gait posture is unchanged.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "avatars/body_avoidance/outline.h"
#include "base/simd.h"

namespace throng {

/// Posture change of one body: all that apply_avoidance() needs.
struct AvoidancePosture {
  float trunk_rad = 0;  ///< rotation of the trunk relative to the hips, positive to the left
  float hips_rad =
      0;  ///< rotation of the hips relative to the direction of travel, from the next frame on
  std::array<float, 2> arms{};  ///< share of a full tuck: right, left
  float standing = 0;           ///< share of the StandingPosture, from 0 to 1
  /// Shift of the next landing (right x, y, left x, y), from the next frame on; root frame.
  std::array<float, 4> landing_m{};
  float stride_scale = 1;  ///< actual stride over the gait's stride, from the next frame on
  bool is_none() const { return trunk_rad == 0 && arms[0] == 0 && arms[1] == 0 && standing == 0; }
};

/// Tucking first brings a swinging arm nearer to the body; then it damps the swing.
struct ArmTuck {
  float tuck = 0;  ///< share of the path to the body
  float swing_damping = 0;

  explicit ArmTuck(float share);
  /// Returns the smallest share with this swing damping.
  static float share_of(float swing_damping);
  static constexpr float kTuckShare = 0.25f;  ///< up to this share only `tuck` grows
};

struct AvoidanceMotion {
  float turn_rad = 0, turn_rps = 0;  ///< trunk relative to the direction of travel
  std::array<float, 2> arms{}, arms_ps{};
  float standing = 0, standing_ps = 0;  ///< see follow_standing()
  // Set by target_avoidance() only:
  bool has_constraints = false;  ///< a neighbour or a wall is within reach
  bool is_urgent = false;        ///< at its current rotation the trunk has a larger clearance
                                 ///< deficit than necessary

  /// Trunk and arms are where the gait has them. A StandingPosture does not count.
  bool is_at_rest() const {
    return turn_rad == 0 && turn_rps == 0 && arms[0] == 0 && arms[1] == 0 && arms_ps[0] == 0 &&
           arms_ps[1] == 0;
  }
};

/// Share of a trunk rotation that the hips take; the waist takes the rest.
inline constexpr float kHipsShare = 0.25f;

/// State of a body as others and it itself see it: metres from a common point along common axes.
struct alignas(64) BodyState2d {
  float x_m = 0, y_m = 0;  ///< axis that the trunk turns about
  float vx_mps = 0, vy_mps = 0;
  float cos = 1, sin = 0;           ///< direction of travel
  float phase = 0, cadence_hz = 0;  ///< gait phase; cycles per second
  float turn_rad = 0;               ///< trunk relative to the direction of travel; below pi/2
  std::array<float, 2> arms{};      ///< share of a full tuck: right, left
  float scale = 1;
  float disc_m = 0;                  ///< radius of a disc, which does not adapt
  float sway_m = 0;                  ///< sway of the trunk to either side
  const LimbSweep* sweep = nullptr;  ///< outline at its current speed; null: a disc

  bool is_at_rest() const { return turn_rad == 0 && arms[0] == 0 && arms[1] == 0; }
};
static_assert(sizeof(BodyState2d) == 64);  // one cache line

/// A wall in the direction (x, y) from a body, where x is the body's direction of travel.
struct WallState2d {
  float x, y;
  float distance_m;  ///< from the root
  float approach_mps;
};

/// Bodies and walls farther away are ignored.
inline constexpr float kAvoidanceReach_m = 0.95f;
/// Time in which bodies predict their neighbours.
inline constexpr float kAvoidanceHorizon_s = 0.9f;

inline constexpr size_t kMaxAvoidedBodies = 16, kMaxAvoidedWalls = 4;

/// Returns the target posture of a body that is not a disc; the speeds are 0.
AvoidanceMotion target_avoidance(const BodyState2d& own,
                                 std::span<const BodyState2d* const> neighbours,
                                 std::span<const WallState2d> walls, SimdTarget target);

/// Advances `motion` by one step towards `target`, within the rates of kAvoidanceLimits.
void follow(const AvoidanceMotion& target, float step_s, AvoidanceMotion& motion);

/// Advances the share of the standing posture by one step. Tucked arms stay tucked in any posture:
/// see apply_avoidance().
void follow_standing(bool stands, float step_s, AvoidanceMotion& motion);

/// Applies body avoidance to a posture row. `posture` is the person's standing posture; its head is
/// moved by Gait::apply_head_yaw() instead.
void apply_avoidance(const AvoidanceColumns& columns, const AvoidancePosture& avoidance,
                     const StandingPosture& posture, std::span<float> row);

struct AvoidanceLimits {
  float trunk_rps = 2.6f, trunk_rps2 = 14;
  float arm_ps = 3, arm_ps2 = 18;  ///< shares of a full tuck per second
  /// Shares of a StandingPosture per second: reached in about 1.5 s, left in less than 1 s.
  float standing_ps = 0.8f, leaving_ps = 1.8f, standing_ps2 = 8;
};
inline constexpr AvoidanceLimits kAvoidanceLimits;

}  // namespace throng
