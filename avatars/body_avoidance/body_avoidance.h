// Giving way: how a body makes room for those near it, and for walls: the trunk turned into a gap,
// arms drawn in, before it is needed and until it is not any more.
// One rule: the constraint between two who are near is the middle of the gap between them as both
// are now, worked out by each from the same state, so that neither waits for the other; nobody
// near, nothing changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "avatars/body_avoidance/outline.h"
#include "base/simd.h"

namespace throng {

/// How far a body gives way: all that its posture needs to know.
struct AvoidancePosture {
  float trunk_rad = 0;  ///< the trunk is turned to the left of the hips by so much
  float hips_rad =
      0;  ///< the hips are turned to the left of the way by so much, as of the next frame
  std::array<float, 2> arms{};  ///< share of being drawn in: right, left
  float standing = 0;           ///< share of the StandingPosture
  /// So far from where it would does the right foot land (x, y), and the left; as of the next
  /// frame, in the root frame at scale 1.
  std::array<float, 4> landing_m{};
  float stride_scale =
      1;  ///< so much longer than the gait's own strides theirs are; as of the next frame
  bool is_none() const { return trunk_rad == 0 && arms[0] == 0 && arms[1] == 0 && standing == 0; }
};

/// An arm that is drawn in comes nearer to the body first, and goes on swinging; then it hangs
/// still.
struct ArmTuck {
  float tuck = 0;  ///< share of the way to the body
  float swing_damping = 0;

  explicit ArmTuck(float share);
  /// The least share at which the arm is this still.
  static float share_of(float swing_damping);
  static constexpr float kTuckShare = 0.25f;  ///< so much of being drawn in tucks the arm
};

/// How far it does, and how fast that changes.
struct AvoidanceMotion {
  float turn_rad = 0, turn_rps = 0;  ///< of the trunk, from the way
  std::array<float, 2> arms{}, arms_ps{};
  float standing = 0, standing_ps = 0;  ///< see follow_standing()
  // Of what is wanted:
  bool has_constraints = false;  ///< somebody or something is within reach
  bool is_urgent = false;        ///< as it is turned now, the trunk lacks more room than it has to

  /// Of what gives way: a StandingPosture does not count.
  bool is_at_rest() const {
    return turn_rad == 0 && turn_rps == 0 && arms[0] == 0 && arms[1] == 0 && arms_ps[0] == 0 &&
           arms_ps[1] == 0;
  }
};

/// Of a turn of the trunk the hips take so much; the waist does the rest.
inline constexpr float kHipsShare = 0.25f;

/// A body as others see it, and as it sees itself: metres from any point and along any axes that
/// all share.
struct alignas(64) BodyState2d {
  float x_m = 0, y_m = 0;  ///< of the axis that the trunk turns about
  float vx_mps = 0, vy_mps = 0;
  float cos = 1, sin = 0;           ///< of its way
  float phase = 0, cadence_hz = 0;  ///< where in its cycle it is; cycles a second
  float turn_rad = 0;               ///< of the trunk, from the way; below a quarter turn
  std::array<float, 2> arms{};      ///< share of being drawn in: right, left
  float scale = 1;
  float disc_m = 0;                  ///< radius of a disc, which does not give way
  float sway_m = 0;                  ///< of the trunk, to either side
  const LimbSweep* sweep = nullptr;  ///< of its outline, at the speed it walks at; null: a disc

  /// As its gait has it.
  bool is_at_rest() const { return turn_rad == 0 && arms[0] == 0 && arms[1] == 0; }
};
static_assert(sizeof(BodyState2d) == 64);  // one cache line

/// A wall in the direction (x, y) from a body: x is its way.
struct WallState2d {
  float x, y;
  float distance_m;  ///< of the root
  float approach_mps;
};

/// Farther away nothing is given way to.
inline constexpr float kAvoidanceReach_m = 0.95f;
/// How far ahead in time bodies look.
inline constexpr float kAvoidanceHorizon_s = 0.9f;

/// Nobody looks at more people, or at more walls.
inline constexpr size_t kMaxAvoidedBodies = 16, kMaxAvoidedWalls = 4;

/// How far a body that is no disc should give way; speeds are 0.
AvoidanceMotion target_avoidance(const BodyState2d& own,
                                 std::span<const BodyState2d* const> neighbours,
                                 std::span<const WallState2d> walls, SimdTarget target);

/// A step towards it, within the speeds and accelerations of yield_limits.
void follow(const AvoidanceMotion& target, float step_s, AvoidanceMotion& motion);

/// A step towards the posture of a person who stands, or back from it. Arms that are drawn in are
/// so whatever the posture: see apply_avoidance().
void follow_standing(bool stands, float step_s, AvoidanceMotion& motion);

/// Puts it into a posture row. `posture` is that of the person; its head is not moved here, see
/// Gait::apply_head_yaw().
void apply_avoidance(const AvoidanceColumns& columns, const AvoidancePosture& avoidance,
                     const StandingPosture& posture, std::span<float> row);

/// What joints do when a body gives way.
struct AvoidanceLimits {
  float trunk_rps = 2.6f, trunk_rps2 = 14;
  float arm_ps = 3, arm_ps2 = 18;  ///< shares of being drawn in a second
  /// Shares of a StandingPosture a second: it is taken up in some 1.5 s and left in less than 1 s.
  float standing_ps = 0.8f, leaving_ps = 1.8f, standing_ps2 = 8;
};
inline constexpr AvoidanceLimits kAvoidanceLimits;

}  // namespace throng
