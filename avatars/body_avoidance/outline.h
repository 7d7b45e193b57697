// Outline: how far a body reaches in each direction, seen from above.
// One rule: distances are from the axis that the trunk turns about, at scale 1; they decide how
// a body gives way and bound nothing (see upper_body_bounds.h for that).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "avatars/body_avoidance/standing_arms.h"
#include "avatars/gait/gait_pose.h"
#include "avatars/gait/gait_table.h"

namespace throng {

class Archive;

/// The columns of a posture row that giving way moves; the right arm, then the left.
struct AvoidanceColumns {
  static constexpr size_t kArmJoints = 4;  ///< shoulder flexion and abduction, elbow, wrist
  static constexpr size_t kAbduction = 1;
  int trunk = -1;
  int head = -1;  ///< or none
  std::array<std::array<int, kArmJoints>, 2> arms{};
  /// Where these stand when an arm is drawn in as far as it goes.
  std::array<std::array<float, kArmJoints>, 2> tucked_rad{};
  /// Limits of the arms' joints.
  std::array<std::array<float, kArmJoints>, 2> min_arm_rad{}, max_arm_rad{};
  float min_trunk_rad = 0, max_trunk_rad = 0, min_head_rad = 0, max_head_rad = 0;

  void archive(Archive& a);
};

/// How far something reaches, by direction: 0 is ahead, counter-clockwise.
class RadialProfile {
 public:
  static constexpr int kDirections = 48;
  static constexpr float kPerRadian = kDirections / 6.2831853f;
  /// So many more than there are: runs of directions need not wrap.
  static constexpr int kWrapped = 36;

  void add(double x, double y);
  /// Once everything has been added.
  void close();
  /// A direction counts from 0 to kDirections, once around.
  float at(float direction) const {
    const auto i = static_cast<int>(direction);
    const float share = direction - static_cast<float>(i);
    return reach_m_[i] + share * (reach_m_[i + 1] - reach_m_[i]);
  }
  const float* from(int direction) const { return reach_m_ + direction; }
  /// In any direction.
  float max_m() const { return max_m_; }

  void archive(Archive& a);

 private:
  float reach_m_[kDirections + kWrapped] = {};
  float max_m_ = 0;
};

/// How far an arm below its elbow, or a thigh, reaches in eight directions, seen from above: ahead
/// first, counter-clockwise. In between, as far as the corner of its two neighbours.
struct Octagon {
  std::array<float, 8> reaches_m;

  Octagon() { reaches_m.fill(-1e9f); }
  void add(double x, double y);
  void add(const Octagon& other);
  void archive(Archive& a);
};

/// Right and left.
struct LimbOutlines {
  std::array<Octagon, 2> arms, thighs;

  void add(const LimbOutlines& other);
  void archive(Archive& a);
};

struct Outline;

/// Nothing of a body that is not turned reaches farther, however much of its arms is drawn in, at
/// any phase: to both sides alike, ahead as behind. In between, as far as the corner of an octagon.
struct MaxExtent {
  float ahead_m = 0, oblique_m = 0, aside_m = 0;
  float max_m = 0;  ///< in any direction, turned as well

  MaxExtent() = default;
  explicit MaxExtent(const Octagon& octagon);
  void archive(Archive& a);
};

/// How limbs swing at one speed.
class LimbSweep {
 public:
  static constexpr int kPhases = 16;

  /// Keeps a pointer to the outline that it is of. LimbOutlines by phase.
  LimbSweep(const Outline& outline, const std::array<LimbOutlines, kPhases>& boxes, float sway_m);
  const Outline& outline() const { return *outline_; }
  /// All but the outline.
  void archive(Archive& a);
  /// Within a sixteenth of a cycle, counted in these; they may lie beyond one.
  const LimbOutlines& at(int index) const { return boxes_[static_cast<unsigned>(index) % kPhases]; }
  /// The nearest of a phase from 0.
  static int phase_index(float phase) {
    const float after_half = phase * kPhases + 0.5f;  // rounds faster than lround()
    return static_cast<int>(after_half);
  }
  /// Over a cycle.
  const LimbOutlines& envelope() const { return envelope_; }
  const MaxExtent& max_extent() const { return max_extent_; }
  /// How far the trunk is to either side of the root at most, see GaitCurves::kSwayPhase.
  float sway_m() const { return sway_m_; }

 private:
  const Outline* outline_;
  std::array<LimbOutlines, kPhases> boxes_;
  LimbOutlines envelope_;
  MaxExtent max_extent_;
  float sway_m_;
};

/// Of one style of walking.
struct Outline {
  AvoidanceColumns columns;
  RadialProfile upper;              ///< trunk and head with both arms drawn in
  std::array<Octagon, 2> tucked;    ///< the same arms, right and left
  std::vector<LimbSweep> sweeps;    ///< by speed
  std::vector<LimbSweep> standing;  ///< by ArmHold, each as it is and mirrored
  float per_sqrt_speed = 0;  ///< speeds of `swings` for one of the relative speed's square root
  float leg_length_m = 1;

  const LimbSweep& sweep_at(float speed_mps, float scale) const;
  /// Of a person who stands in a posture: the mean of those who hold their arms so.
  const LimbSweep& standing_sweep(const StandingPosture& posture) const {
    return standing[2 * static_cast<size_t>(posture.hold) + (posture.is_mirrored ? 1 : 0)];
  }
  void archive(Archive& a);
};

/// Nothing for a model without the adult's joints of trunk and arms.
std::unique_ptr<const Outline> outline_of(const PosableModel& model, const GaitTable& table,
                                          float cells_per_sqrt_speed, float leg_length_m);

}  // namespace throng
