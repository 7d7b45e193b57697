// Joint angles over the gait cycle, as published: what walking should look like before feet meet
// ground. One rule: every curve is continuous in phase and in speed, also where the published
// tables change.
//
// Sources: Boulic, Thalmann & Thalmann, "A global human walking model with real-time kinematic
// personification", The Visual Computer 6, 1990; the OpenSim tutorial's measured cycle (normal.mot)
// for the knee in stance and the pitch of the foot.
#pragma once

#include <array>
#include <span>

#include "avatars/gait/gait_style.h"

namespace throng {

/// A periodic function of the cycle fraction: a monotone cubic (Fritsch & Butland 1984) through its
/// knots, so it never swings beyond them.
class PeriodicCurve {
 public:
  struct Knot {
    double t = 0;
    double value = 0;
  };

  /// Knots in increasing t that span less than one cycle; 2 to 8 of them.
  explicit PeriodicCurve(std::span<const Knot> knots);

  double operator()(double t) const;

 private:
  static constexpr int kMaxKnots = 8;
  std::array<Knot, kMaxKnots + 1> knots_{};  // the first again, a cycle later
  std::array<double, kMaxKnots + 1> slopes_{};
  int count_ = 0;
};

/// Boulic's cycle length in leg lengths is kStridePerSqrtSpeed * sqrt(RV), RV = leg lengths a
/// second.
inline constexpr double kStridePerSqrtSpeed = 1.346;

/// The fraction of the cycle that a foot spends on the ground.
double stance_fraction(double relative_speed, GaitStyle style = GaitStyle::kPlain);

/// Cycle length in leg lengths, over sqrt(RV).
double stride_per_sqrt_speed(GaitStyle style);

/// The curves of one speed. Angles in radians, phase as cycle fraction, 0 = heel strike of the side
/// asked for (the right one where the trunk is concerned).
class GaitCurves {
 public:
  /// relative_speed: RV, leg lengths a second, in [0, 3].
  explicit GaitCurves(double relative_speed, GaitStyle style = GaitStyle::kPlain);

  double knee_flexion(double t) const { return knee_(t); }
  double elbow_flexion(double t) const;
  /// Positive forward, so backward at heel strike of the same side.
  double shoulder_flexion(double t) const;
  /// Pitch of the sole, toes up positive; zero while the foot is flat.
  double foot_pitch(double t) const { return foot_pitch_(t); }

  /// Positive turns left. The right hip leads at right heel strike.
  double pelvis_yaw(double t) const;
  double pelvis_pitch(double t) const;    ///< positive leans forward
  double pelvis_roll(double t) const;     ///< positive raises the left hip
  double pelvis_lateral(double t) const;  ///< in leg lengths, positive to the left
  double pelvis_forward(double t) const;  ///< in leg lengths; the head surges less
  /// The pelvis is in the middle then, and goes to the right: a sine from there on.
  static constexpr double kSwayPhase = 0.1;
  /// Amplitude of the pelvis's rise and fall, in leg lengths.
  double bob_amplitude() const { return 0.015 * relative_speed_; }
  const StyleParameters& style() const { return *style_; }
  /// Of the thorax against the root, opposite to the pelvis.
  double thorax_yaw(double t) const { return -style_->twist * thorax_(t); }

 private:
  double relative_speed_;
  const StyleParameters* style_;
  PeriodicCurve knee_, elbow_, thorax_, foot_pitch_;
};

}  // namespace throng
