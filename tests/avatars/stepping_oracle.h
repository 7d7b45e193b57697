// SteppingOracle computes stepping of one person slowly, as documented in docs/motion.md. It uses
// double precision, branches instead of lane selection, exact sines instead of polynomials, and the
// gait's cycles instead of tables.
// Invariant: it uses nothing of avatars/stepping/.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "avatars/gait/gait_cycle.h"
#include "avatars/gait/gait_pose.h"

namespace throng::test {

/// Motion of a person from one frame to the next, in metres of the world.
struct OracleMotion {
  Eigen::Vector2d displacement_m = Eigen::Vector2d::Zero();
  double heading_before_rad = 0, heading_after_rad = 0;
  double ahead_mps = 0;
  double scale = 1;
  double step_s = 1.0 / 60;
  bool is_present = true;
  double stride_scale = 1;
  /// Shift of the next landing of each foot, root frame at scale 1.
  std::array<Eigen::Vector2d, 2> landing_m = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
};

/// Offset from the foot's place in the gait, root frame at scale 1.
struct OracleFoot {
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  double turn_rad = 0;
  double lift_m = 0;
  /// Speed of shift and turn of a foot in the air towards the landing, per swing.
  Eigen::Vector3d speed = Eigen::Vector3d::Zero();
};

struct OracleState {
  double gait_mps = -1;  ///< below 0: has not entered
  double phase = 0;
  double cadence_hz = -1;          ///< below 0: not known yet
  std::array<OracleFoot, 2> feet;  ///< right, left
};

class SteppingOracle {
 public:
  SteppingOracle(const Model& model, GaitStyle style, double upright_radius_m);
  SteppingOracle(const SteppingOracle&) = delete;  // the walker points to its model
  SteppingOracle& operator=(const SteppingOracle&) = delete;

  OracleState step(const OracleState& before, const OracleMotion& motion) const;

  /// Ankle with the pelvis lowered by `drop_m`, if the leg can reach.
  struct Ankle {
    Eigen::Vector3d at_m;
    Eigen::Vector3d up;  ///< unit vector of the leaning foot, from its standing point to the ankle
    /// Permitted deviation of stepping along `up`. Stepping lifts a leaning foot by half its flat
    /// sole's width times the lean's tangent, less the same for the gait's own leg. The edge of a
    /// flat foot lies at most 5 mm above its lowest point (see Leg::shape()), which bounds the
    /// excess. The lowest point of a foot that rolls over heel or toes lies between the edges; its
    /// height may deviate by as much either way.
    double too_high_m = 0, too_low_m = 0;
    double heading_rad = 0, pitch_rad = 0;  ///< of the foot
    double from_hip_m = 0;
    bool is_behind = false;  ///< behind the hip
  };
  /// `raise_rad`: additional pitch of the raised heel.
  Ankle ankle(const OracleState& state, double scale, size_t side, double drop_m,
              double raise_rad = 0) const;
  double max_reach_m(size_t side) const {
    return walker_->leg(side).reach_m(Walker::kMinKneeBend_rad);
  }
  /// Whether rounding decides: a foot lifts, lands or passes the body, or moves exactly sideways.
  bool is_at_a_turning_point(const OracleState& before, const OracleState& after,
                             const OracleMotion& motion) const;

 private:
  struct Track {
    double stance = 0, shift_m = 0, stride_m = 0, toes_out_rad = 0;
    std::array<double, 2> side_m{};
    double x_at(double own_phase) const { return stride_m * (0.5 * stance - own_phase) + shift_m; }
  };
  struct Landing {
    Eigen::Vector2d shift_m;
    double turn_rad = 0;
  };
  double sqrt_speed(double mps, double scale) const;
  Track track_of(int node) const;
  Track track_at(double sqrt_speed, int cell) const;
  int cell_of(double sqrt_speed) const;
  double cycles_per_s(const OracleState& s, const OracleMotion& m, const Track& before,
                      const Track& after) const;
  Landing landing(const OracleMotion& m, double cycles_per_s, const Track& track,
                  size_t side) const;
  OracleFoot swing_foot(const OracleFoot& foot, const Landing& goal, double own, double own_next,
                        double rate, double step_s, const Track& track) const;
  OracleFoot stance_foot(const OracleState& s, const OracleMotion& m, const Track& before,
                         const Track& after, double own_next, size_t side) const;

  PosableModel posable_;
  GaitStyle style_;
  std::optional<Walker> walker_;
  double leg_m_ = 0, upright_radius_m_ = 0;
  std::vector<std::vector<WalkerPose>> cycles_;  ///< indexed by speed
  std::vector<Track> tracks_;
};

}  // namespace throng::test
