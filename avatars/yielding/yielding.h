// Giving way: how a body makes room for those near it, and for walls: the trunk turned into a gap,
// arms drawn in, before it is needed and until it is not any more.
// One rule: the border between two who are near is the middle of the gap between them as both are
// now, worked out by each from the same state, so that neither waits for the other; nobody near,
// nothing changes.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "avatars/yielding/outline.h"

namespace throng {

/// How far a body gives way: all that its posture needs to know.
struct Yield {
  float trunk_rad = 0;  ///< the trunk is turned to the left of the hips by so much
  float hips_rad =
      0;  ///< the hips are turned to the left of the way by so much, as of the next frame
  std::array<float, 2> arms{};  ///< share of being drawn in: right, left
  /// So far from where it would does the right foot land (x, y), and the left; as of the next
  /// frame, in the root frame at scale 1.
  std::array<float, 4> landing_m{};
  float stretch =
      1;  ///< so much longer than the gait's own strides theirs are; as of the next frame
  bool is_none() const { return trunk_rad == 0 && arms[0] == 0 && arms[1] == 0; }
};

/// An arm that is drawn in comes nearer to the body first, and goes on swinging; then it hangs
/// still.
struct DrawnArm {
  float tucked = 0;  ///< share of the way to the body
  float stilled = 0;

  explicit DrawnArm(float share);
  /// The least share at which the arm is this still.
  static float share_of(float stilled);
  static constexpr float kTucked = 0.25f;  ///< so much of being drawn in tucks the arm
};

/// How far it does, and how fast that changes.
struct YieldMotion {
  float turn_rad = 0, turn_rps = 0;  ///< of the trunk, from the way
  std::array<float, 2> arms{}, arms_ps{};
  bool is_near = false;  ///< of what is wanted: somebody or something is within reach
};

/// Of a turn of the trunk the hips take so much; the waist does the rest.
inline constexpr float kHipsShare = 0.25f;

/// A body that makes room, as it is now.
struct Yielder {
  const Outline* outline = nullptr;
  const Swings* swung = nullptr;  ///< of the outline, at the speed it walks at
  float scale = 1;
  YieldMotion motion{};
};

/// Where in its cycle somebody is, and how many cycles pass a second.
struct Rhythm {
  float phase = 0, cycles_ps = 0;
};

/// Something near, as a body sees it: metres and radians, x is the way of that body.
struct NearBody {
  float x_m, y_m;
  float vx_mps, vy_mps;  ///< relative to the body that looks
  float heading_rad;     ///< of its way, relative, too
  float heading_cos, heading_sin;
  const Yielder* yielder;  ///< null: it does not give way and is a disc
  float radius_m;          ///< of the disc
  Rhythm rhythm;
};

/// A wall in the direction (x, y), seen likewise.
struct NearWall {
  float x, y;
  float distance_m;  ///< of the root
  float approach_mps;
};

/// Farther away nothing is given way to.
inline constexpr float kYieldReach_m = 0.95f;
/// How far ahead in time bodies look.
inline constexpr float kYieldAhead_s = 0.9f;

/// Whether what is there and goes so, relative to a body, may have to be given way to.
inline bool comes_near(float x_m, float y_m, float vx_mps, float vy_mps) {
  constexpr float kReach_m = 1.001f * kYieldReach_m;  // it is decided in the body's own axes
  const float square = x_m * x_m + y_m * y_m, along = -(x_m * vx_mps + y_m * vy_mps);
  if (square <= kReach_m * kReach_m) return true;
  // Its way's nearest point; further than kYieldAhead_s ahead it is farther yet.
  const float speed_square = vx_mps * vx_mps + vy_mps * vy_mps;
  return along > 0 && square * speed_square - along * along <= kReach_m * kReach_m * speed_square;
}

/// How far a body should give way; speeds are 0.
YieldMotion wanted_yield(const Yielder& own, const Rhythm& rhythm, std::span<const NearBody> near,
                         std::span<const NearWall> walls);

/// A step towards it, within the speeds and accelerations of yield_limits.
void follow(const YieldMotion& wanted, float step_s, YieldMotion& motion);

/// Puts it into a posture row.
void put_yield(const YieldColumns& columns, const Yield& yield, std::span<float> row);

/// What joints do when a body gives way.
struct YieldLimits {
  float trunk_rps = 2.6f, trunk_rps2 = 14;
  float arm_ps = 3, arm_ps2 = 18;  ///< shares of being drawn in a second
};
inline constexpr YieldLimits kYieldLimits;

}  // namespace throng
