// Walker computes one cycle of walking at one speed: published curves adapted to keep feet on the
// ground.
// Invariant: a foot in stance rolls from heel to toe without sliding while the root moves one
// stride per cycle.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "avatars/gait/gait_pose.h"
#include "avatars/gait/gait_style.h"

namespace throng {

// Leg: joints, roll of the foot, inverse kinematics. Zero posture in root axes, x forward; a foot
// pose is a rotation from it.

struct FootTarget {
  Eigen::Vector3d ankle_m = Eigen::Vector3d::Zero();
  double pitch_rad = 0;    ///< toes up positive
  double heading_rad = 0;  ///< toes to the left positive
};

/// Dimensions of a leg for inverse kinematics and bounds; meshes in the zero posture.
struct LegShape {
  std::array<Eigen::Vector3d, 3> hip_axes;  ///< root axes
  std::array<int, 5> columns{};             ///< columns of the hip's axes, the knee and the ankle
  Eigen::Vector3d hip_m = Eigen::Vector3d::Zero();
  Eigen::Vector2d thigh_m, shank_m;  ///< (x, z), hip to knee to ankle
  double knee_side_m = 0;            ///< knee left of hip
  double ankle_side_m = 0;           ///< ankle left of hip
  double knee_sign = 1, ankle_sign = 1;
  double thigh_radius_m = 0;   ///< maximum distance of a vertex from the line hip to knee
  double shank_radius_m = 0;   ///< same for the line knee to ankle
  Eigen::AlignedBox3d foot_m;  ///< relative to the ankle
  double sole_half_width_m = 0;
};

class Leg {
 public:
  /// Reads the leg off the robot's joint frames. Empty if a joint is missing or the leg has another
  /// form. Form: a hip of three perpendicular axes through one point over two parallel cross-axes
  /// (knee, ankle).
  static std::optional<Leg> find(const PosableModel& model, const std::string& side);

  double length_m() const { return thigh_.norm() + shank_.norm(); }
  Eigen::Vector3d hip_m() const { return hip_; }
  Eigen::Vector3d ankle_m() const { return ankle_; }
  LegShape shape() const;

  /// `pelvis`: displacement of the pelvis from its zero posture, in root axes.
  Eigen::Vector3d hip_m(const Eigen::Isometry3d& pelvis) const { return pelvis * hip_; }

  double reach_m(double knee_flexion_rad) const;

  /// Returns the vector from the point on the ground under the foot's middle plane to the ankle.
  /// The foot is turned by `target` and its lowest point touches the ground, for a hip at `hip_m`.
  Eigen::Vector3d ankle_over_ground_m(const Eigen::Vector3d& hip_m, const FootTarget& target) const;

  /// Returns the advance of the ankle when a flat foot rolls to `pitch_rad` without sliding.
  double roll_m(double pitch_rad) const { return rolled(pitch_rad).ahead_m; }

  /// Ankle position over a rolled foot, in a leg that does not lean.
  struct Rolled {
    double ahead_m;   ///< see roll_m()
    double height_m;  ///< above the ground
  };
  Rolled rolled(double pitch_rad) const;

  /// Returns the up direction of the plane in which the leg bends to reach `target`.
  Eigen::Vector3d up_along_leg(const Eigen::Vector3d& hip_m, const FootTarget& target) const {
    return plane_frame(hip_m, target).col(2);
  }

  /// Sets the leg's five columns; within reach, the foot is at `target`.
  void solve(const Eigen::Isometry3d& pelvis, const FootTarget& target,
             std::vector<double>& columns) const;

 private:
  Eigen::Matrix3d plane_frame(const Eigen::Vector3d& hip_m, const FootTarget& target) const;
  void read_foot(const PosableModel& model, int foot_link);
  void read_limbs(const PosableModel& model, const std::array<int, 5>& joints);

  struct Axis {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitY();
    int column = -1;
  };
  std::array<Axis, 3> hip_axes_;
  Axis knee_axis_, ankle_axis_;
  Eigen::Vector3d hip_, ankle_;
  Eigen::Vector2d thigh_, shank_;  // (x, z), hip to knee to ankle
  double sideways_ = 0;            // ankle left of hip
  double knee_side_ = 0;           // knee left of hip
  double thigh_radius_ = 0, shank_radius_ = 0;
  std::vector<Eigen::Vector3d> foot_;  // relative to the ankle

  struct SolePoint {
    Eigen::Vector2d position;  // (x, z) relative to the ankle
    double arc = 0;            // along the sole, 0 under the flat foot's lowest point
  };
  std::vector<SolePoint> sole_;  // convex, from heel to toe
};

class GaitCurves;

struct WalkerPose {
  std::vector<double> columns;  ///< a posture row
  Eigen::Matrix3d root_from_pelvis = Eigen::Matrix3d::Identity();
  struct Foot {
    Eigen::Vector3d hip_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d ground_m = Eigen::Vector3d::Zero();  ///< on the ground or, in swing, above it
    FootTarget target;
  };
  std::array<Foot, 2> feet;  ///< right, left
  double shift_m = 0;        ///< shift of both feet's tracks, forward
};

class Walker {
 public:
  /// Empty if the model has no two legs (see Leg) under a pelvis that moves up and down.
  static std::optional<Walker> find(const PosableModel& model, GaitStyle style);

  double leg_length_m() const { return legs_[0].length_m(); }
  GaitStyle style() const { return style_; }

  /// Postures at phases 0, 1/n, ... of a cycle; n even. relative_speed in leg lengths per second,
  /// in [0, 3]; 0 stands. Angles are within the joint limits.
  std::vector<WalkerPose> cycle(double relative_speed, int n) const;

  const Leg& leg(size_t side) const { return legs_[side]; }
  int vertical_column() const { return vertical_column_; }
  /// Child links of the joints by which the legs hang from the pelvis.
  const std::array<int, 2>& leg_links() const { return leg_links_; }
  /// Minimum knee flexion. Below it, a millimetre of pelvis height is worth several degrees.
  static constexpr double kMinKneeBend_rad = 0.03490658503988659;

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
