// Stepping: where the feet of walking bodies are, and the legs that put them there.
// One rule: a foot in stance stays where it is on the ground, whatever the root does, and the legs
// follow; what a body's joints or its bounds do not allow is taken off the foot's place, so that
// the posture has no jumps and the bounds always hold.
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

/// Limits of a landing point, shared by stepping and by those who predict it.
struct LandingLimits {
  /// A landing point is predicted this far ahead at most.
  static constexpr float kMaxAhead_s = 0.9f;
  /// Going sideways, the trailing foot lands this far towards the leading one at most.
  static constexpr float kMaxClosing_m = 0.03f;
};

/// Where a walking body is in its gait, and its legs: all that posing reads, a cache line.
struct alignas(64) WalkPosture {
  /// Of the right leg the angles of the hip's three axes, the knee and the ankle, then of the left
  /// one; then as named.
  float numbers[16];
  enum : size_t {
    kDrop = 10,  ///< the pelvis is so much lower than the gait has it, metres at scale 1
    kNode,       ///< of the gait's table, the one before in phase and speed
    kU,          ///< shares of the next phase and the next speed
    kV,
    kShift,  ///< of the pelvis to the left, metres at scale 1, and breath: see QuietStanding
    kBreath,
  };
};

/// Where a gait has the feet at a speed, root frame, metres at scale 1.
struct FootTrack {
  float stance;  ///< share of the cycle that a foot is on the ground
  float shift_m;
  std::array<float, 2> side_m;  ///< right, left
  float stride_m;
  /// Of a foot in stance, by its own phase.
  float x_at(float own_phase) const { return stride_m * (0.5f * stance - own_phase) + shift_m; }
};

/// How far a swinging foot has come from behind the body to before it, by share of the swing.
struct SwingCurve {
  std::array<float, 4> bulge;  ///< the powers of what it is ahead of a straight line
  float at(float u) const {
    return u + u * (1 - u) * (bulge[0] + u * (bulge[1] + u * (bulge[2] + u * bulge[3])));
  }
};

/// The room that a body takes, seen from above; see Stepping::box_of().
struct WalkBounds {
  float x = 0, y = 0;  ///< low and high in grains
};

/// Some avatars of one model on their way from one frame to the next, structure of arrays. Its
/// maker fills what goes in.
struct WalkBatch {
  static constexpr size_t kCapacity = 64;
  static constexpr size_t kMaxLanes = 32;
  /// Of the right foot, then of the left, how far it is from where the gait has it, in the root
  /// frame at scale 1: x and y (metres), turn (radians).
  static constexpr size_t kFeetNumbers = 6;
  /// What keeps joints from jerking. Of a foot in the air how fast each of its numbers goes to what
  /// it lands with, a swing; then as named.
  enum : size_t {
    kCadence = kFeetNumbers,  ///< a second; below 0: as many as the way asks for
    kPelvisDrop,       ///< the pelvis, metres at scale 1; below 0: it stands where the legs have it
    kPelvisDropSpeed,  ///< how fast, m/s
    kGaitRateCount
  };
  using Numbers = float[kCapacity];

  size_t count;
  /// Come out where their owner wants them, who has room for a multiple of 32.
  WalkPosture* postures;
  float step_s;
  // How the root moved: in the world, and its turn before and after (w and z of a quaternion).
  alignas(64) Numbers displacement_x_m, displacement_y_m;
  alignas(64) Numbers w_before, z_before, w_after, z_after;
  alignas(64) Numbers ahead_mps;  ///< its speed, forward
  alignas(64) Numbers scales;
  alignas(64) Numbers present;       ///< 0: nothing changes, 1: walks
  alignas(64) Numbers stride_scale;  ///< so much longer than the gait's own strides theirs are
  /// So far from where it would is the right foot to land (x, y), and the left; root frame,
  /// scale 1.
  alignas(64) Numbers landing[4];
  /// What QuietStanding adds; it comes out as far as the gait's speed and the legs leave room.
  alignas(64) Numbers shift_m = {};
  alignas(64) Numbers breath = {};

  std::array<const Gait*, kCapacity> gaits;

  // Brought along.
  alignas(64) Numbers gait_mps;  ///< what the gait goes by; kNotEntered at first
  alignas(64) Numbers phases;
  alignas(64) Numbers feet[kFeetNumbers];
  alignas(64) Numbers gait_rates[kGaitRateCount];

  // Comes out, as the postures do.
  alignas(64) Numbers bounds_x, bounds_y;  ///< of a WalkBounds
  alignas(64) Numbers lift_m[2];           ///< of a foot that steps where the gait hardly lifts it
  /// Feet that the legs cannot reach as it is: 1 the right, 2 the left, 3 both.
  alignas(64) Numbers out_of_reach;

  std::array<float, kFeetNumbers> feet_of(size_t lane) const {
    std::array<float, kFeetNumbers> out;
    for (size_t i = 0; i < kFeetNumbers; ++i) out[i] = feet[i][lane];
    return out;
  }
  void set_feet(size_t lane, const std::array<float, kFeetNumbers>& numbers) {
    for (size_t i = 0; i < kFeetNumbers; ++i) feet[i][lane] = numbers[i];
  }
  std::array<const float*, kCapacity> tables;  ///< of the gaits; filled by Gait::walk()
  /// What legs need to know of the step: sides and toes of the track, place in the tables.
  alignas(64) Numbers track[4], place[4];
  alignas(64) Numbers next_pelvis_drop[2];  ///< kPelvisDrop and kPelvisDropSpeed, when it is done
  /// Lanes beyond `count`, up to a full register, do as the last one does.
  void fill_up();
};

/// A gait speed that says: this avatar has not come in yet.
inline constexpr float kNotEntered = -1;

class Stepping {
 public:
  /// One cycle a speed, the nodes of the gait's table; `rest_boxes` of the table's cells hold what
  /// does not hang from the hips.
  Stepping(const Walker& walker, const PosableModel& model,
           std::span<const std::vector<WalkerPose>> cycles, float cells_per_sqrt_speed,
           float min_stride, std::span<const RootBox> rest_boxes, const StandingJoints& standing);
  /// To be read from an archive.
  Stepping();
  ~Stepping();
  Stepping(const Stepping& other);
  void archive(Archive& a);

  /// The pelvis sinks no farther for a foot that is too far away.
  static double max_drop_m(const Walker& walker);

  /// See Gait::share_bounds().
  void set_bounds(float centre_z_m, float radius_m, float upright_radius_m);
  /// What is looked up by speed and phase, for WalkBatch::tables.
  const float* table() const;

  /// Walks everybody of the chunk on by a step. A person who walks ahead advances in the cycle by
  /// the way walked; who turns on the spot, goes sideways or has just stopped steps until the feet
  /// are comfortable. A person who has just come in, or is more than a metre away all at once,
  /// stands as the gait has it. Returns the lanes that have no legs even so: they have to take the
  /// gait's.
  uint64_t walk(WalkBatch& batch, SimdTarget target) const;

  FootTrack track_at(float speed_mps, float scale) const;

  /// Puts the legs into a posture row that the gait gave.
  void put(const WalkPosture& posture, float* row) const;
  /// The other way round, for legs and room as the gait has them.
  void take(const float* row, WalkPosture& posture) const;
  /// Boxes hold every part, unless joints are moved otherwise.
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
