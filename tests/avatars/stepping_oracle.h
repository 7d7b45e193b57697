// What stepping should do to one person, slowly: docs/architecture.md, "Feet", in double precision,
// with ifs where lanes select, sines where they have polynomials, and the gait's own cycles in
// place of tables. One rule: nothing of avatars/stepping/ is used.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "avatars/gait/gait_cycle.h"
#include "avatars/gait/gait_pose.h"

namespace throng::test {

/// Of a person from one frame to the next, metres of the world.
struct OracleMotion {
  Eigen::Vector2d way_m = Eigen::Vector2d::Zero();
  double heading_before_rad = 0, heading_after_rad = 0;
  double ahead_mps = 0;
  double scale = 1;
  double step_s = 1.0 / 60;
  bool is_present = true;
  double stride_scale = 1;
  /// So far from where they would do the feet land, root frame at scale 1.
  std::array<Eigen::Vector2d, 2> landing_m = {Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
};

/// From where the gait has the foot, in the root frame at scale 1.
struct OracleFoot {
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  double turn_rad = 0;
  double lift_m = 0;
  /// Of a foot in the air: how fast shift and turn go to what they land with, a swing.
  Eigen::Vector3d speed = Eigen::Vector3d::Zero();
};

struct OracleState {
  double gait_mps = -1;  ///< below 0: has not come in
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

  /// Where the ankle is with the pelvis lowered by `drop_m`, if the leg can reach.
  struct Ankle {
    Eigen::Vector3d at_m;
    Eigen::Vector3d up;  ///< of the leaning foot, unit: from where it stands to the ankle
    /// How much stepping may hold the ankle too high, or too low, along `up`. It lifts a leaning
    /// foot by half the width of its flat sole times the lean's tangent, and takes as much off
    /// where the gait's own leg leans. The edge of a flat foot lies at most 5 mm above its lowest
    /// point (see Leg::shape()): it is so much too high at most. The lowest point of a foot that
    /// rolls over heel or toes lies anywhere between the edges: by as much its height may change
    /// either way.
    double too_high_m = 0, too_low_m = 0;
    double heading_rad = 0, pitch_rad = 0;  ///< of the foot
    double from_hip_m = 0;
    bool is_behind = false;  ///< the hip
  };
  /// `raise_rad`: the heel is higher than the gait has it.
  Ankle ankle(const OracleState& state, double scale, size_t side, double drop_m,
              double raise_rad = 0) const;
  double max_reach_m(size_t side) const {
    return walker_->leg(side).reach_m(Walker::kMinKneeBend_rad);
  }
  /// Where a foot lifts or lands, passes under the body, or trails it by a hair, and where the way
  /// is straight to the side: rounding decides.
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
  std::vector<std::vector<WalkerPose>> cycles_;  ///< by speed
  std::vector<Track> tracks_;
};

}  // namespace throng::test
