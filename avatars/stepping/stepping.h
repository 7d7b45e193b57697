// Stepping places the feet of walking bodies and solves their legs.
// Invariant: a foot in stance stays fixed on the ground, regardless of the root. If joints or
// bounds prevent it, the foot is moved instead: postures have no jumps, and the bounds always hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/pose.h"
#include "base/simd.h"

namespace throng {

class Archive;
class Gait;
class PosableModel;
class Walker;
struct StandingJoints;
struct SteppingTables;
struct WalkerPose;

/// Limits of a landing point, shared with its prediction.
struct LandingLimits {
  /// Maximum prediction time of a landing point.
  static constexpr float kMaxAhead_s = 0.9f;
  /// When walking sideways, limit of the trailing foot's landing point towards the leading foot.
  static constexpr float kMaxClosing_m = 0.03f;
};

/// Gait position and legs of a walking body: all data that posing reads, one cache line.
struct alignas(64) WalkPosture {
  /// Joint positions of the right leg (hip's axes, knee, ankle), of the left, then as named below.
  float numbers[16];
  enum : size_t {
    kDrop = 10,  ///< pelvis below its height in the gait, metres at scale 1
    kNode,       ///< node of the gait's table before it in phase and speed
    kU,          ///< fractions towards the next phase and the next speed
    kV,
    kShift,  ///< pelvis to the left, metres at scale 1; and breath: see QuietStanding
    kBreath,
  };
};

/// Feet of a gait at one speed; root frame, scale 1.
struct FootTrack {
  float stance;  ///< share of the cycle that a foot is on the ground
  float shift_m;
  std::array<float, 2> side_m;  ///< right, left
  float stride_m;
  /// Returns x of a foot in stance, by the foot's own phase.
  float x_at(float own_phase) const { return stride_m * (0.5f * stance - own_phase) + shift_m; }
};

/// Advance of a swinging foot from behind the body to before it, over the swing.
struct SwingCurve {
  std::array<float, 4> bulge;  ///< polynomial coefficients of the lead over a straight line
  float at(float u) const {
    return u + u * (1 - u) * (bulge[0] + u * (bulge[1] + u * (bulge[2] + u * bulge[3])));
  }
};

/// Bounds of a body seen from above; see Stepping::box_of().
struct WalkBounds {
  float x = 0, y = 0;  ///< low and high in grains, packed
};

/// Avatars of one model in one step, as a structure of arrays. The caller fills the inputs.
struct WalkBatch {
  static constexpr size_t kCapacity = 64;
  static constexpr size_t kMaxLanes = 32;
  /// Offset of the right, then the left foot from the gait: x, y (metres), turn (radians); root
  /// frame, scale 1.
  static constexpr size_t kFeetNumbers = 6;
  /// Rates that keep joints from jerking: of the feet in the air, per swing; then as named.
  enum : size_t {
    kCadence = kFeetNumbers,  ///< cycles per second; below 0: derived from the distance walked
    kPelvisDrop,       ///< pelvis drop, metres at scale 1; below 0: take the legs' value at once
    kPelvisDropSpeed,  ///< speed of the pelvis drop, m/s
    kGaitRateCount
  };
  using Numbers = float[kCapacity];

  size_t count;
  /// Output, owned by the caller, with capacity for a multiple of 32.
  WalkPosture* postures;
  float step_s;
  // Root motion: displacement in the world, yaw before and after (w and z of a quaternion).
  alignas(64) Numbers displacement_x_m, displacement_y_m;
  alignas(64) Numbers w_before, z_before, w_after, z_after;
  alignas(64) Numbers ahead_mps;  ///< forward speed of the root
  alignas(64) Numbers scales;
  alignas(64) Numbers present;       ///< 0: unchanged, 1: walks
  alignas(64) Numbers stride_scale;  ///< actual stride over the gait's stride
  /// Shift of the next landing of the right foot (x, y) and the left; root frame, scale 1.
  alignas(64) Numbers landing[4];
  /// Addition by QuietStanding; returned as limited by the gait's speed and the legs.
  alignas(64) Numbers shift_m = {};
  alignas(64) Numbers breath = {};

  std::array<const Gait*, kCapacity> gaits;

  // State from step to step.
  alignas(64) Numbers gait_mps;  ///< speed of the gait; kNotEntered at first
  alignas(64) Numbers phases;
  alignas(64) Numbers feet[kFeetNumbers];
  alignas(64) Numbers gait_rates[kGaitRateCount];

  // Outputs, in addition to `postures`.
  alignas(64) Numbers bounds_x, bounds_y;  ///< a WalkBounds
  alignas(64) Numbers lift_m[2];           ///< lift of a foot beyond the gait's
  /// Feet that the legs cannot reach: 1 right, 2 left, 3 both.
  alignas(64) Numbers out_of_reach;

  std::array<float, kFeetNumbers> feet_of(size_t lane) const {
    std::array<float, kFeetNumbers> out;
    for (size_t i = 0; i < kFeetNumbers; ++i) out[i] = feet[i][lane];
    return out;
  }
  void set_feet(size_t lane, const std::array<float, kFeetNumbers>& numbers) {
    for (size_t i = 0; i < kFeetNumbers; ++i) feet[i][lane] = numbers[i];
  }
  std::array<const float*, kCapacity> tables;  ///< tables of the gaits; filled by Gait::walk()
  /// Inputs of the legs: lateral place and toe angle of the track, place in the tables.
  alignas(64) Numbers track[4], place[4];
  alignas(64) Numbers next_pelvis_drop[2];  ///< kPelvisDrop and kPelvisDropSpeed after the step
  /// Fills lanes beyond `count`, up to a full register, with copies of the last.
  void fill_up();
};

/// Gait speed of an avatar that has not entered yet.
inline constexpr float kNotEntered = -1;

class Stepping {
 public:
  /// `cycles`: one per speed of the gait's table. `rest_boxes`: per cell, all but the legs.
  Stepping(const Walker& walker, const PosableModel& model,
           std::span<const std::vector<WalkerPose>> cycles, float cells_per_sqrt_speed,
           float min_stride, std::span<const RootBox> rest_boxes, const StandingJoints& standing);
  Stepping();
  ~Stepping();
  Stepping(const Stepping& other);
  void archive(Archive& a);

  /// Returns the maximum pelvis drop for a foot that is too far away.
  static double max_drop_m(const Walker& walker);

  /// See Gait::share_bounds().
  void set_bounds(float centre_z_m, float radius_m, float upright_radius_m);
  /// Returns the lookup table by speed and phase, for WalkBatch::tables.
  const float* table() const;

  /// Advances all avatars by one step. Ahead, the cycle follows the distance walked. On the spot,
  /// sideways or after a stop, a person steps until the feet are comfortable. After entering, or a
  /// jump of more than a metre, it stands as in the gait. Returns the lanes whose legs fail
  /// nevertheless: they must take the gait's.
  uint64_t walk(WalkBatch& batch, SimdTarget target) const;

  FootTrack track_at(float speed_mps, float scale) const;

  /// Writes the legs into a posture row of the gait.
  void put(const WalkPosture& posture, float* row) const;
  /// Inverse of put(), for legs and bounds of the gait.
  void take(const float* row, WalkPosture& posture) const;
  /// Boxes contain all parts, unless joints are moved otherwise.
  RootBox box_of(const WalkBounds& packed_bounds, float scale) const;
  WalkBounds walk_bounds_of(const RootBox& box, float scale) const;

 private:
  void read_leg(const Walker& walker, const PosableModel& model, size_t side);
  void add_node(const Walker& walker, const WalkerPose& pose, float* to);
  void add_track(const Walker& walker, const std::vector<WalkerPose>& cycle, double sqrt_speed,
                 double standing, float* to);
  bool settle(WalkBatch& batch, size_t lane) const;

  std::unique_ptr<SteppingTables> tables_;
  int vertical_column_ = -1;
  int lateral_column_ = -1;                 ///< or -1
  std::array<int, 2> arm_columns_{-1, -1};  ///< or -1
};

}  // namespace throng
