// GaitTable stores postures over speed and phase; GaitBounds bounds a body in all of them.
// Invariant: between its nodes a posture is bilinear, as gait.cpp reads it; the bounds rely on it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "avatars/gait/gait_pose.h"
#include "avatars/stepping/standing.h"
#include "base/pose.h"

namespace throng {

/// Rows of column_count floats, padded to a multiple of 4, speed-major. Phases 0..phases; the last
/// repeats the first. One phase and one speed for a model without a gait.
struct GaitTable {
  int columns = 0;
  int row_floats = 0;
  int phases = 0;  ///< cells around the cycle
  int speeds = 0;  ///< nodes, uniform in the square root of the relative speed
  std::vector<float> rows;

  GaitTable(int column_count, int phase_cells, int speed_nodes)
      : columns(column_count),
        row_floats((column_count + 3) / 4 * 4),
        phases(phase_cells),
        speeds(speed_nodes),
        rows(static_cast<size_t>(row_floats) * static_cast<size_t>(phase_cells + 1) *
             static_cast<size_t>(speed_nodes)) {}

  float* row(int speed, int phase) {
    return rows.data() + (static_cast<ptrdiff_t>(speed) * (phases + 1) + phase) * row_floats;
  }
  const float* row(int speed, int phase) const {
    return const_cast<GaitTable*>(this)->row(speed, phase);
  }
  /// Number of floats to the row of the next phase, and of the next speed.
  size_t phase_stride() const { return static_cast<size_t>(row_floats); }
  size_t speed_stride() const { return static_cast<size_t>(phases + 1) * phase_stride(); }
};

struct GaitPosition {
  int speed = 0, phase = 0;
  float u = 0, v = 0;  ///< fractions towards the next phase and the next speed
};

/// Bounds of all vertices in every posture between the nodes, at any head yaw.
struct GaitBounds {
  double centre_z_m = 0;  ///< sphere's centre on the root's z axis
  double radius_m = 0;
  double upright_radius_m = 0;  ///< radius of the cylinder around the root's z axis
  // Boxes in the root frame by cell: speed-major, max(speeds - 1, 1) times phases.
  std::vector<RootBox> whole;  ///< around all parts
  std::vector<RootBox> rest;   ///< around parts that do not hang from the legs' roots
};
/// Computes the bounds. Parts that do not hang from `leg_roots` (links) may be lowered by up to
/// max_drop_m and moved by standing. The boxes do not include these changes.
GaitBounds bounds_around(const PosableModel& model, const GaitTable& table,
                         std::span<const int> leg_roots = {}, double max_drop_m = 0,
                         const StandingJoints& standing = {});

StandingJoints standing_joints(const PosableModel& model, const GaitTable& table,
                               double max_sqrt_speed);

}  // namespace throng
