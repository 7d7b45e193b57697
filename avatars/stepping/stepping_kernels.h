// Kernels of stepping: the scalar reference and the SIMD loops. Internal to the folder.
// Invariant: both compute the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "avatars/stepping/stepping.h"

namespace throng {

// Lookup tables of stepping as plain numbers: the gait's feet and pelvis by speed and phase, the
// legs, and the body's bounds.
// Invariant: every number is rounded to a grain, which hides the last bits of a C library.

class Archive;

/// One of the root's axes, or its opposite.
struct SignedAxis {
  int index = 0;
  float sign = 1;

  void archive(Archive& a);
};

/// A leg for inverse kinematics and bounds; meshes are measured in the zero posture. Axes are those
/// of the root; points lie in the plane in which the leg bends: (x forward, z up).
struct LegParameters {
  std::array<float, 3> hip_m{};  ///< from the middle between the hips
  std::array<float, 2> thigh_m{}, shank_m{};
  float knee_side_m = 0, ankle_side_m = 0;         ///< left of the hip
  float square_sum_m2 = 0, per_twice_product = 1;  ///< of thigh and shank: a2 + b2, 1 / (2 a b)
  /// Knee angle at which thigh and shank are in line, and the limits of the flexion beyond it.
  float straight_rad = 0, straight_sin = 0, straight_cos = 1;
  float min_bend_cos = 1, max_bend_cos = -1;
  float max_reach_m = 1, max_reach2_m2 = 1;  ///< maximum distance from hip to ankle, and its square
  /// Roll over the toes, by pitch: the ankle's advance and height, and their increments.
  static constexpr int kRolls = 128;
  static constexpr float kMinPitch_rad = -1.6f, kRollsPerRadian = 64;
  struct Roll {
    float ahead_m, height_m, more_ahead_m, more_height_m;

    void archive(Archive& a);
  };
  std::array<Roll, kRolls> rolls{};
  float sole_half_width_m = 0;
  SignedAxis axis1, axis3, axis13;  ///< axes of the hip; the last is 1 x 3
  float hand = 1, knee_sign = 1, ankle_sign = 1;
  std::array<float, 5> lower_rad{}, upper_rad{};  ///< the hip's three, knee, ankle
  float thigh_radius_m = 0, knee_radius_m = 0, shank_radius_m = 0;
  std::array<float, 3> foot_middle_m{}, foot_half_m{};  ///< a box relative to the ankle
  std::array<int, 5> columns{};                         ///< columns of a posture row

  void archive(Archive& a);
};

struct SteppingTables {
  /// A node. Per foot: forward position, height (without roll), ankle height above it, roll, pitch.
  /// Pelvis: rotation (x, y, z of a quaternion) and the middle between the hips.
  static constexpr size_t kNodeFloats = 16;
  /// A track: stance, forward shift, lateral place (right, left), stride, toe angle (sine, cosine),
  /// share of standing.
  static constexpr size_t kTrackFloats = 8;
  /// Per cell: low x, low y, high x, high y of the parts that do not hang from the hips.
  static constexpr size_t kBoxFloats = 4;

  float leg_length_m = 1, per_leg_length = 1;
  float max_sqrt_speed = 1;  ///< of the relative speed
  float cells_per_sqrt_speed = 1;
  float min_stride_m = 0;
  int phases = 1, speeds = 1;
  float max_drop_m = 0;  ///< maximum pelvis drop for a foot that is too far away
  float max_shift_m = 0, max_breath_m = 0;
  // Bounds of all postures: see GaitBounds.
  float sphere_z_m = 0, sphere_m = 0, upright_m = 0;
  // A body's box is stored in grains from the corner of a square around the root.
  float corner_m = 0, grain_m = 1, per_grain = 1;
  static constexpr uint32_t kGrains = 4096;  ///< two such numbers fit into one float exactly
  std::array<LegParameters, 2> legs;         ///< right, left
  /// Tracks by speed, then nodes and boxes: speed-major, phases 0..phases and 0..phases - 1. A node
  /// is a cache line. All tables of a model have the same size.
  struct alignas(64) Line {
    float floats[16];

    void archive(Archive& a);
  };
  std::vector<Line> table;

  void archive(Archive& a);

  size_t speed_node_stride() const { return static_cast<size_t>(phases + 1) * kNodeFloats; }
  size_t track(int32_t speed) const { return static_cast<size_t>(speed) * kTrackFloats; }
  size_t node(int32_t i) const {
    const size_t tracks = (static_cast<size_t>(speeds) * kTrackFloats + 15) / 16 * 16;
    return tracks + static_cast<size_t>(i) * kNodeFloats;
  }
  size_t box(int32_t i) const {
    return node(speeds * (phases + 1)) + static_cast<size_t>(i) * kBoxFloats;
  }
};

/// Scalar reference.
void walk_scalar(const SteppingTables& tables, WalkBatch& batch);
/// `target` is available on this machine, and not kBest.
void walk_simd(const SteppingTables& tables, WalkBatch& batch, SimdTarget target);
/// Solves the legs of one lane with the shift of the feet in `sides` (1 right, 2 left, 3 both)
/// multiplied by `share`; stores the result and returns true if both reach.
bool reach_with(const SteppingTables& tables, WalkBatch& batch, size_t lane, int sides,
                float share);

/// Returns one side of a box as in WalkBounds; see grains_of() of stepping_legs-inl.h.
float grains_between(const SteppingTables& tables, float low_m, float high_m);

}  // namespace throng
