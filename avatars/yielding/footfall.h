// Footfalls: where the legs of somebody who walks are and will be.
// One rule: what is predicted is what Stepping does if the root goes straight on.
#pragma once

#include <Eigen/Core>
#include <array>

#include "avatars/stepping/stepping.h"

namespace throng {

/// Somebody's steps, as the ground has them: metres, from any point that all share.
struct Steps {
  Eigen::Vector2f root_m, velocity_mps;
  Eigen::Vector2f ahead;  ///< unit: the way the root faces
  float scale;
  float phase, cycles_ps;
  /// Another rhythm from then on.
  float later_ps, later_s;
  FootTrack track;
  const SwingShares* swing;
  std::array<float, 4>
      shift_m;  ///< of the feet from where the gait has them: right x, y, left x, y
  /// How far from where it would the next step of each foot lands.
  std::array<float, 4> landing_m;
};

/// A leg, seen from above: points of it near the ground, in the middle of the shin and at the knee.
struct LegPlace {
  Eigen::Vector2f foot_m, shin_m, knee_m;
  bool stays;   ///< on the ground, or has hardly left it
  float share;  ///< of a change to where it lands next that it has followed by then
};

/// Where a leg goes.
class LegPath {
 public:
  LegPath() = default;
  /// So far ahead it is known.
  LegPath(const Steps& steps, size_t side, float most_s);
  LegPlace at(float ahead_s) const;
  /// When a foot that is about to land does so; negative: not in the next step.
  float lands_s() const;

 private:
  Eigen::Vector2f root_in(float ahead_s) const { return root_m_ + ahead_s * velocity_mps_; }
  Eigen::Vector2f world(float x, float y) const;
  float cycles_in(float ahead_s) const;
  float time_of(float cycles) const;
  Eigen::Vector2f goal_m(float ahead_s, bool next) const;
  void go_on_to(int cycle);

  Eigen::Vector2f root_m_, velocity_mps_, ahead_, left_;
  /// From one landing to the next; the first has begun.
  struct Cycle {
    Eigen::Vector2f stands_m;  ///< where the foot stands in it
    Eigen::Vector2f off_m;     ///< from where the gait has it when it lifts: root frame, scale 1
    Eigen::Vector2f goal_m;    ///< and when it lands after that
  };
  static constexpr int kMostCycles = 8;
  std::array<Cycle, kMostCycles> cycles_;
  int last_ = 0;                  ///< of them
  Eigen::Vector2f relative_mps_;  ///< the velocity in the root frame, scale 1
  Eigen::Vector2f shift_m_;       ///< of the next landing
  const SwingShares* swing_;
  float own_, stance_, scale_;
  float cycles_ps_, later_ps_, later_s_;
  float lands_x_m_, lifts_x_m_, passes_x_m_, side_m_;
  float kept_;  ///< what is left of off_m_ now, of what it was when the foot lifted
  bool is_right_;
};

}  // namespace throng
