// The two ways of walking a chunk on. Internal to the folder.
// One rule: both give the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "avatars/stepping/stepping.h"

namespace throng {

// What stepping looks up, as plain numbers: the gait's feet and pelvis by speed and phase, the
// legs, and the room that a body has. Internal to the folder. One rule: every number is rounded to
// a grain, so that the last bits of a C library do not reach a result.

class Archive;

/// One of the root's axes, or its opposite.
struct SignedAxis {
  int index = 0;
  float sign = 1;

  void archive(Archive& a);
};

/// A leg as bending and bounding it takes; meshes count as they lie in the zero posture. Axes are
/// those of the root, points lie in the plane that the leg bends in: (x forward, z up).
struct LegParameters {
  std::array<float, 3> hip_m{};  ///< from the middle between the hips
  std::array<float, 2> thigh_m{}, shank_m{};
  float knee_side_m = 0, ankle_side_m = 0;         ///< left of the hip
  float square_sum_m2 = 0, per_twice_product = 1;  ///< of thigh and shank: a2 + b2, 1 / (2 a b)
  /// The knee's angle at which thigh and shank are one line, and the limits of what it is bent
  /// beyond that.
  float straight_rad = 0, straight_sin = 0, straight_cos = 1;
  float min_bend_cos = 1, max_bend_cos = -1;
  float max_reach_m = 1, max_reach2_m2 = 1;  ///< of the hip's farthest ankle, and its square
  /// How a foot rolls over its toes, by pitch from the lowest on: how far ahead the ankle is, how
  /// high, and how much more each of these at the next node.
  static constexpr int kRolls = 128;
  static constexpr float kMinPitch_rad = -1.6f, kRollsPerRadian = 64;
  struct Roll {
    float ahead_m, height_m, more_ahead_m, more_height_m;

    void archive(Archive& a);
  };
  std::array<Roll, kRolls> rolls{};
  float sole_half_width_m = 0;
  SignedAxis axis1, axis3, axis13;  ///< of the hip; the last is 1 x 3
  float hand = 1, knee_sign = 1, ankle_sign = 1;
  std::array<float, 5> lower_rad{}, upper_rad{};  ///< the hip's three, knee, ankle
  float thigh_radius_m = 0, knee_radius_m = 0, shank_radius_m = 0;
  std::array<float, 3> foot_middle_m{}, foot_half_m{};  ///< a box from the ankle
  std::array<int, 5> columns{};                         ///< of a posture row

  void archive(Archive& a);
};

struct SteppingTables {
  /// A node: of each foot how far forward and how high it is (without what it has rolled on), the
  /// ankle's height over that, how far it has rolled, its pitch; then the pelvis: its turn (x, y, z
  /// of a quaternion) and the middle between the hips.
  static constexpr size_t kNodeFloats = 16;
  /// Of the track of both feet at a speed: stance, shift forward, the right's side and the left's,
  /// stride, sine and cosine of the angle that toes point outwards by, how much of standing.
  static constexpr size_t kTrackFloats = 8;
  /// Low x, low y, high x, high y of what does not hang from the hips, by cell.
  static constexpr size_t kBoxFloats = 4;

  float leg_length_m = 1, per_leg_length = 1;
  float max_sqrt_speed = 1;  ///< of the relative speed
  float cells_per_sqrt_speed = 1;
  float min_stride_m = 0;
  int phases = 1, speeds = 1;
  float max_drop_m = 0;  ///< the pelvis sinks no farther for a foot that is too far away
  // What standing adds at most, and how far a breath moves anything.
  float max_shift_m = 0, max_breath_m = 0;
  // The room of all postures: see GaitBounds.
  float sphere_z_m = 0, sphere_m = 0, upright_m = 0;
  // A body's box is kept in grains from the corner of a square around the root.
  float corner_m = 0, grain_m = 1, per_grain = 1;
  static constexpr uint32_t kGrains =
      4096;                           ///< two such numbers make one that a float holds exactly
  std::array<LegParameters, 2> legs;  ///< right, left
  /// Tracks by speed, then nodes and boxes, speed-major, phases 0..phases and 0..phases - 1. A node
  /// is a cache line. All tables of a model have the same size.
  struct alignas(64) Line {
    float floats[16];

    void archive(Archive& a);
  };
  std::vector<Line> table;

  void archive(Archive& a);

  size_t speed_node_stride() const { return static_cast<size_t>(phases + 1) * kNodeFloats; }
  /// Where they begin; nodes and cells are counted.
  size_t track(int32_t speed) const { return static_cast<size_t>(speed) * kTrackFloats; }
  size_t node(int32_t i) const {
    const size_t tracks = (static_cast<size_t>(speeds) * kTrackFloats + 15) / 16 * 16;
    return tracks + static_cast<size_t>(i) * kNodeFloats;
  }
  size_t box(int32_t i) const {
    return node(speeds * (phases + 1)) + static_cast<size_t>(i) * kBoxFloats;
  }
};

/// A lane after the other: the reference.
void walk_scalar(const SteppingTables& tables, WalkBatch& batch);
/// `target` is one that this machine has, not kBest.
void walk_simd(const SteppingTables& tables, WalkBatch& batch, SimdTarget target);
/// The legs of one lane with the shift of the feet in `sides` (1 right, 2 left, 3 both) taken times
/// `share`, which stays if both legs reach; returns whether they do.
bool reach_with(const SteppingTables& tables, WalkBatch& batch, size_t lane, int sides,
                float share);

/// A side of a box as WalkBounds has it; see grains_of() of stepping_legs-inl.h.
float grains_between(const SteppingTables& tables, float low_m, float high_m);

}  // namespace throng
