#include "avatars/body_avoidance/standing_arms.h"

#include <algorithm>
#include <utility>

#include "avatars/body_avoidance/outline.h"
#include "base/random.h"

namespace throng {
namespace {

using ArmAngles = std::array<float, StandingPosture::kArmJoints>;

constexpr float kRadians = 3.14159265358979323846f / 180;

/// Shoulder flexion and abduction, elbow and wrist flexion, in degrees.
struct HoldParameters {
  float share;  ///< share of people
  ArmAngles right_deg, left_deg;
  ArmAngles both_deg;  ///< variation between people to either side, equal in both arms
  ArmAngles each_deg;  ///< additional variation of each arm
};

constexpr ArmAngles kHangs_deg = {1, 2, 11, 6};
constexpr ArmAngles kPocket_deg = {-24, -7, 43, 8};

// Hands stay near the body and do not reach people in front or behind. Joined hands lie one in the
// other: they vary little, and one is above the other.
constexpr std::array<HoldParameters, kArmHoldCount> kHolds = {{
    {0.34f, kHangs_deg, kHangs_deg, {3, 1, 5, 4}, {2, 1.5f, 4, 3}},
    {0.15f, kPocket_deg, kPocket_deg, {3, 1.5f, 5, 5}, {2, 1, 3, 4}},
    {0.13f, kPocket_deg, kHangs_deg, {2, 1.5f, 4, 4}, {2, 1, 4, 4}},
    {0.13f, {3, -9, 19, 54}, {6, -9, 12, 60}, {3, 1, 4, 2}, {0.5f, 0, 1, 2}},
    {0.09f, {-11, -9, 71, 64}, {-13, -9, 65, 66}, {3, 1, 5, 2}, {0.5f, 0, 1, 2}},
    {0.08f, {-20, -9, 7, 54}, {-22, -9, 4, 60}, {2, 1, 2, 2}, {0.5f, 0, 1, 2}},
    {0.08f, {-14, -6, 93, 20}, kHangs_deg, {2, 1.5f, 4, 5}, {1, 1, 2, 3}},
}};

std::array<float, 4> draws(uint64_t seed, uint64_t id, uint32_t number) {
  const uint64_t bits = random_bits({seed, id, 0, Purpose::kStandingPosture}, number);
  std::array<float, 4> out;
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(static_cast<int32_t>(bits >> (16 * i) & 0xffff)) * 0x1.0p-15f - 1;
  return out;
}

ArmHold hold_of(float share) {
  size_t hold = 0;
  for (; hold + 1 < kHolds.size() && share >= kHolds[hold].share; ++hold)
    share -= kHolds[hold].share;
  return static_cast<ArmHold>(hold);
}

}  // namespace

StandingPosture mean_standing_posture(ArmHold hold, bool is_mirrored) {
  const HoldParameters& parameters = kHolds[static_cast<size_t>(hold)];
  StandingPosture posture{hold, is_mirrored, {parameters.right_deg, parameters.left_deg}};
  if (is_mirrored) std::swap(posture.arms_rad[0], posture.arms_rad[1]);
  for (ArmAngles& arm : posture.arms_rad)
    for (float& angle : arm) angle *= kRadians;
  return posture;
}

StandingPosture standing_posture(uint64_t seed, uint64_t id) {
  const std::array<float, 4> whole = draws(seed, id, 0), both = draws(seed, id, 1);
  StandingPosture posture = mean_standing_posture(hold_of(0.5f + 0.5f * whole[0]), whole[1] < 0);
  posture.trunk_rad = kMaxStandingTrunk_rad * whole[2];
  // The cube keeps most heads nearly straight.
  posture.head_rad = kMaxStandingHead_rad * whole[3] * whole[3] * whole[3];
  const HoldParameters& parameters = kHolds[static_cast<size_t>(posture.hold)];
  for (uint32_t side = 0; side < 2; ++side) {
    const std::array<float, 4> each = draws(seed, id, 2 + side);
    for (size_t i = 0; i < StandingPosture::kArmJoints; ++i)
      posture.arms_rad[side][i] +=
          kRadians * (parameters.both_deg[i] * both[i] + parameters.each_deg[i] * each[i]);
  }
  return posture;
}

double share_of(ArmHold hold) {
  return static_cast<double>(kHolds[static_cast<size_t>(hold)].share);
}

void apply_standing_arms(const AvoidanceColumns& columns, const StandingPosture& posture,
                         float share, std::span<float> row) {
  static_assert(StandingPosture::kArmJoints == AvoidanceColumns::kArmJoints);
  for (size_t side = 0; side < 2; ++side)
    for (size_t i = 0; i < AvoidanceColumns::kArmJoints; ++i) {
      float& angle = row[static_cast<size_t>(columns.arms[side][i])];
      const float to = std::clamp(posture.arms_rad[side][i], columns.min_arm_rad[side][i],
                                  columns.max_arm_rad[side][i]);
      angle += share * (to - angle);
    }
}

}  // namespace throng
