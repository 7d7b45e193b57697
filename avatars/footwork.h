// Feet that stay where they are put: while the body walks curves, turns on the spot, goes sideways,
// starts and stops, a planted foot keeps its place on the ground and its leg follows.
// One rule: on a straight way at a constant speed nothing is added to the tabulated gait.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "avatars/gait_cycle.h"
#include "avatars/gait_leg.h"

namespace throng {

/// A foot as seen from the root: where its sole's middle is, at scale 1. The foot's own heading at
/// rest is not counted.
struct FootPlace {
  float x_m = 0;
  float y_m = 0;
  float heading_rad = 0;
  float lift_m = 0;  ///< above what the gait lifts it
};

/// The feet of one avatar, right and left: what stepping remembers of the way so far.
struct Feet {
  std::array<FootPlace, 2> places;
  std::array<FootPlace, 2> offsets;  ///< of a swinging foot: from where the gait has it
  std::array<bool, 2> planted{};
};

/// How a root moved in a step, in metres of the world.
struct RootMotion {
  float forward_m = 0;  ///< in the root's axes before the step
  float left_m = 0;
  float turn_rad = 0;
  float step_s = 1.0f / 60;
  float speed_mps = 0;
  float scale = 1;
};

class Footwork {
 public:
  /// speeds x (phases + 1) poses, speed-major, as a GaitTable has them.
  Footwork(const Walker& walker, const PosableModel& model,
           std::span<const std::vector<WalkerPose>> poses_by_speed, float cells_per_root_speed);

  /// Puts both feet where the gait has them.
  void start(float phase, float speed_mps, float scale, Feet& feet) const;

  /// Moves the feet on with the root. `stride_m` is a gait cycle's length. Returns the new phase.
  float advance(const RootMotion& motion, float stride_m, float phase, Feet& feet) const;

  /// Bends the legs of a posture row so that the feet are in their places; lowers the pelvis where
  /// a leg is too short.
  void plant(const Feet& feet, float phase, float speed_mps, float scale, float* row) const;

  /// Writes a column of a row, within its joint's limits.
  void set(int column, float value, float* row) const;

  /// No vertex of a planted leg is farther from the root's z axis.
  float reach_m() const { return reach_m_; }

 private:
  struct LegShape {
    std::array<Eigen::Vector3f, 3> hip_axes;
    std::array<int, 5> columns{};
    Eigen::Vector2f thigh, shank;
    float sideways = 0, straight_cos = 1, straight_sin = 0, straight_rad = 0;
    float knee_sign = 1, ankle_sign = 1, rest_heading_rad = 0, longest_m = 1;
  };

  /// Floats of a node: a foot's origin, ankle from it, pitch and hip, twice; then the pelvis.
  static constexpr int kFootFloats = 9;
  static constexpr int kFloats = 2 * kFootFloats + 9;

  float root_speed(float speed_mps, float scale) const;
  void blend(float phase, float root_speed, int floats, float* node) const;
  void natural(float phase, float root_speed, std::array<FootPlace, 2>& places) const;
  FootPlace landing(const RootMotion& motion, float phase_rate, float root_speed, int side) const;
  void keep_in_reach(FootPlace& place) const;
  void solve(int side, const Eigen::Vector3f& hip, const Eigen::Vector3f& ankle,
             const FootPlace& place, float pitch_rad, const Eigen::Matrix3f& pelvis,
             float* row) const;

  int phases_ = 0;
  int speeds_ = 0;
  float cells_per_root_speed_ = 1;
  float leg_length_m_ = 1;
  float farthest_m_ = 1;  ///< a foot's place from the z axis, at most
  float reach_m_ = 0;
  int vertical_column_ = -1;
  std::array<LegShape, 2> legs_;
  std::vector<float> nodes_;
  std::vector<float> lower_, upper_;  ///< limits by column
};

}  // namespace throng
