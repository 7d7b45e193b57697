// GaitCurves computes published joint angles over the gait cycle, before feet are fitted to the
// ground.
// Invariant: every curve is continuous in phase and in speed, also where the published tables
// change.
//
// Sources: Boulic, Thalmann & Thalmann, "A global human walking model with real-time kinematic
// personification", The Visual Computer 6, 1990. Knee in stance and foot pitch: measured cycle of
// the OpenSim tutorial (normal.mot).
#pragma once

#include <array>
#include <span>

#include "avatars/gait/gait_style.h"

namespace throng {

/// Periodic function of the cycle fraction: a monotone cubic (Fritsch & Butland 1984) through its
/// knots, which does not overshoot them.
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
  std::array<Knot, kMaxKnots + 1> knots_{};  // the first one again, a cycle later
  std::array<double, kMaxKnots + 1> slopes_{};
  int count_ = 0;
};

/// Boulic's cycle length in leg lengths over sqrt(RV), RV = leg lengths per second.
inline constexpr double kStridePerSqrtSpeed = 1.346;

double stance_fraction(double relative_speed, GaitStyle style = GaitStyle::kPlain);

/// Returns the cycle length in leg lengths over sqrt(RV).
double stride_per_sqrt_speed(GaitStyle style);

/// Curves at one speed. Angles in radians; phase as cycle fraction, 0 = heel strike of the joint's
/// side (the right side for pelvis and trunk).
class GaitCurves {
 public:
  /// relative_speed: RV, leg lengths per second, in [0, 3].
  explicit GaitCurves(double relative_speed, GaitStyle style = GaitStyle::kPlain);

  double knee_flexion(double t) const { return knee_(t); }
  double elbow_flexion(double t) const;
  /// Positive forward; negative at heel strike of the same side.
  double shoulder_flexion(double t) const;
  /// Pitch of the sole, toes up positive; zero while the foot is flat.
  double foot_pitch(double t) const { return foot_pitch_(t); }

  /// Positive turns left. The right hip leads at right heel strike.
  double pelvis_yaw(double t) const;
  double pelvis_pitch(double t) const;    ///< positive leans forward
  double pelvis_roll(double t) const;     ///< positive raises the left hip
  double pelvis_lateral(double t) const;  ///< in leg lengths, positive to the left
  double pelvis_forward(double t) const;  ///< in leg lengths; the head surges less
  /// Phase at which the pelvis passes the middle towards the right: sway is a sine from there.
  static constexpr double kSwayPhase = 0.1;
  /// Amplitude of the pelvis's rise and fall, in leg lengths.
  double bob_amplitude() const { return 0.015 * relative_speed_; }
  const StyleParameters& style() const { return *style_; }
  /// Yaw of the thorax relative to the root, opposite to the pelvis.
  double thorax_yaw(double t) const { return -style_->twist * thorax_(t); }

 private:
  double relative_speed_;
  const StyleParameters* style_;
  PeriodicCurve knee_, elbow_, thorax_, foot_pitch_;
};

}  // namespace throng
