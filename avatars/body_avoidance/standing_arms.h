// StandingPosture describes how a standing person holds the arms, the trunk and the head.
// Invariant: it depends on seed and id alone, and stays within the limits of the joints.
//
// The shares and angles are estimates, set by eye on pictures of the body. The adult has no joint
// that turns an upper arm about its own axis; hence no arms folded before the chest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace throng {

struct AvoidanceColumns;

enum class ArmHold : uint8_t {
  kHanging,
  kInPockets,      ///< both hands
  kOneInPocket,    ///< the right hand; the left arm hangs
  kJoinedLow,      ///< hands joined below the belly
  kJoinedHigh,     ///< hands joined before the belly
  kBehindBack,     ///< hands joined behind the back
  kOneHandRaised,  ///< the right hand before the body, as if it held something; the left hangs
};
inline constexpr size_t kArmHoldCount = 7;

struct StandingPosture {
  static constexpr size_t kArmJoints = 4;  ///< those of AvoidanceColumns

  ArmHold hold = ArmHold::kHanging;
  bool is_mirrored = false;                                 ///< right and left change places
  std::array<std::array<float, kArmJoints>, 2> arms_rad{};  ///< right, left
  float trunk_rad = 0, head_rad = 0;                        ///< turned to the left
};

/// Limits of StandingPosture::trunk_rad and head_rad, to either side.
inline constexpr float kMaxStandingTrunk_rad = 0.07f, kMaxStandingHead_rad = 0.2f;

StandingPosture standing_posture(uint64_t seed, uint64_t id);
/// Returns the mean posture of all people with this arm hold.
StandingPosture mean_standing_posture(ArmHold hold, bool is_mirrored);
double share_of(ArmHold hold);

/// Moves the arms of a posture row towards those of a posture, by `share` from 0 to 1.
void apply_standing_arms(const AvoidanceColumns& columns, const StandingPosture& posture,
                         float share, std::span<float> row);

}  // namespace throng
