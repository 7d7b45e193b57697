// Outline stores how far a body reaches in each direction, seen from above. Distances are from the
// axis that the trunk turns about, at scale 1.
// Outlines decide the target posture only; bounds for culling are in upper_body_bounds.h.
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

/// Columns of a posture row that body avoidance moves; right arm first.
struct AvoidanceColumns {
  static constexpr size_t kArmJoints = 4;  ///< shoulder flexion and abduction, elbow, wrist
  static constexpr size_t kAbduction = 1;
  int trunk = -1;
  int head = -1;  ///< -1: no head joint
  std::array<std::array<int, kArmJoints>, 2> arms{};
  std::array<std::array<float, kArmJoints>, 2> tucked_rad{};
  std::array<std::array<float, kArmJoints>, 2> min_arm_rad{}, max_arm_rad{};
  float min_trunk_rad = 0, max_trunk_rad = 0, min_head_rad = 0, max_head_rad = 0;

  void archive(Archive& a);
};

/// Reach by direction: 0 is ahead, counter-clockwise.
class RadialProfile {
 public:
  static constexpr int kDirections = 48;
  static constexpr float kPerRadian = kDirections / 6.2831853f;
  /// Additional entries for runs of directions, which need not wrap around.
  static constexpr int kWrapped = 36;

  void add(double x, double y);
  /// Call after the last add().
  void close();
  /// Returns the reach at a direction from 0 to kDirections, once around.
  float at(float direction) const {
    const auto i = static_cast<int>(direction);
    const float share = direction - static_cast<float>(i);
    return reach_m_[i] + share * (reach_m_[i + 1] - reach_m_[i]);
  }
  const float* from(int direction) const { return reach_m_ + direction; }
  float max_m() const { return max_m_; }

  void archive(Archive& a);

 private:
  float reach_m_[kDirections + kWrapped] = {};
  float max_m_ = 0;
};

/// Reach of a forearm or a thigh in eight directions, seen from above: ahead first,
/// counter-clockwise. Between two directions: the corner of the octagon.
struct Octagon {
  std::array<float, 8> reaches_m;

  Octagon() { reaches_m.fill(-1e9f); }
  void add(double x, double y);
  void add(const Octagon& other);
  void archive(Archive& a);
};

struct LimbOutlines {
  std::array<Octagon, 2> arms, thighs;

  void add(const LimbOutlines& other);
  void archive(Archive& a);
};

struct Outline;

/// Upper bound on the reach of a body that is not turned, at any tuck and phase, symmetric in both
/// axes. Between the directions: the corner of the octagon.
struct MaxExtent {
  float ahead_m = 0, oblique_m = 0, aside_m = 0;
  float max_m = 0;  ///< in any direction, also when turned

  MaxExtent() = default;
  explicit MaxExtent(const Octagon& octagon);
  void archive(Archive& a);
};

class LimbSweep {
 public:
  static constexpr int kPhases = 16;

  /// Keeps a pointer to the outline. `boxes`: outlines by gait phase.
  LimbSweep(const Outline& outline, const std::array<LimbOutlines, kPhases>& boxes, float sway_m);
  const Outline& outline() const { return *outline_; }
  /// Reads or writes all but the outline.
  void archive(Archive& a);
  /// Returns the outlines within a sixteenth of a cycle around a phase index; any index is valid.
  const LimbOutlines& at(int index) const { return boxes_[static_cast<unsigned>(index) % kPhases]; }
  static int phase_index(float phase) {
    const float after_half = phase * kPhases + 0.5f;  // rounds faster than lround()
    return static_cast<int>(after_half);
  }
  const LimbOutlines& envelope() const { return envelope_; }
  const MaxExtent& max_extent() const { return max_extent_; }
  /// Returns the maximum sway of the trunk to either side, see GaitCurves::kSwayPhase.
  float sway_m() const { return sway_m_; }

 private:
  const Outline* outline_;
  std::array<LimbOutlines, kPhases> boxes_;
  LimbOutlines envelope_;
  MaxExtent max_extent_;
  float sway_m_;
};

struct Outline {
  AvoidanceColumns columns;
  RadialProfile upper;              ///< trunk and head with both arms tucked
  std::array<Octagon, 2> tucked;    ///< tucked arms: right, left
  std::vector<LimbSweep> sweeps;    ///< indexed by speed
  std::vector<LimbSweep> standing;  ///< by ArmHold, each as defined and mirrored
  float per_sqrt_speed = 0;         ///< index into `sweeps` per square root of the relative speed
  float leg_length_m = 1;

  const LimbSweep& sweep_at(float speed_mps, float scale) const;
  /// Returns the sweep of a standing person: the mean over all people with the same arm hold.
  const LimbSweep& standing_sweep(const StandingPosture& posture) const {
    return standing[2 * static_cast<size_t>(posture.hold) + (posture.is_mirrored ? 1 : 0)];
  }
  void archive(Archive& a);
};

/// Returns the outline, or null for a model without the adult's trunk and arm joints.
std::unique_ptr<const Outline> outline_of(const PosableModel& model, const GaitTable& table,
                                          float cells_per_sqrt_speed, float leg_length_m);

}  // namespace throng
