// One cycle of walking at one speed: the published curves bent so that feet stand on the ground.
// One rule: a foot in stance rolls from heel to toe without sliding while the root moves one stride
// a cycle.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "avatars/gait/gait_leg.h"
#include "avatars/gait/gait_style.h"

namespace throng {

class GaitCurves;

/// A moment of walking: joint angles, and where they put the feet.
struct WalkerPose {
  std::vector<double> columns;  ///< of a posture row
  Eigen::Matrix3d root_from_pelvis = Eigen::Matrix3d::Identity();
  struct Foot {
    Eigen::Vector3d hip_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d ground_m =
        Eigen::Vector3d::Zero();  ///< below the foot: on the ground, or above
                                  ///< it by as much as the swinging foot is
    FootTarget target;
  };
  std::array<Foot, 2> feet;  ///< right, left
  double shift_m = 0;        ///< of both feet's tracks, forward
};

class Walker {
 public:
  /// Empty if the model is no walker: two legs (see Leg) under a pelvis that moves up and down.
  static std::optional<Walker> find(const PosableModel& model, GaitStyle style);

  double leg_length_m() const { return legs_[0].length_m(); }
  GaitStyle style() const { return style_; }

  /// Postures at phases 0, 1/n, ... of a cycle; n even. relative_speed in leg lengths a second, in
  /// [0, 3]; 0 stands still. Angles are inside the joints' limits.
  std::vector<WalkerPose> cycle(double relative_speed, int n) const;

  const Leg& leg(size_t side) const { return legs_[side]; }
  int vertical_column() const { return vertical_column_; }
  /// The links that the legs hang from the pelvis by.
  const std::array<int, 2>& leg_links() const { return leg_links_; }
  /// Less than this no knee is bent: at less, a millimetre of pelvis is worth several degrees.
  static constexpr double kStraightestKnee_rad = 0.03490658503988659;

 private:
  Walker(const PosableModel& model, GaitStyle style, Leg right, Leg left)
      : model_(&model), style_(style), legs_{std::move(right), std::move(left)} {}

  struct Step;
  struct Instant;
  Instant instant(const GaitCurves& curves, const std::array<Step, 2>& steps, double t) const;
  std::vector<double> fit_to_ground(const GaitCurves& curves, std::vector<Instant>& instants) const;
  void set(std::vector<double>& columns, const std::string& joint, double value) const;

  const PosableModel* model_;
  GaitStyle style_;
  std::array<Leg, 2> legs_;  // right, left
  int pelvis_link_ = -1;
  std::array<int, 2> leg_links_{};
  int vertical_column_ = -1;
  Eigen::Isometry3d pelvis_from_root_ = Eigen::Isometry3d::Identity();  // in the zero posture
};

}  // namespace throng
