// Postures over speed and phase, and the sphere that holds a body in all of them.
// One rule: between its nodes a posture is bilinear; gait.cpp reads it so, the sphere's bound
// relies on it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "avatars/gait/gait_pose.h"
#include "avatars/stepping/standing.h"
#include "base/pose.h"

namespace throng {

/// Rows of column_count floats, each padded to a multiple of 4; speed-major, phases 0..phases of
/// which the last repeats the first. One phase and one speed for a model that keeps still.
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
  /// Floats from a row to the next phase's, and to the next speed's.
  size_t phase_stride() const { return static_cast<size_t>(row_floats); }
  size_t speed_stride() const { return static_cast<size_t>(phases + 1) * phase_stride(); }
};

/// Where a posture lies between the nodes.
struct GaitPosition {
  int speed = 0, phase = 0;
  float u = 0, v = 0;  ///< shares of the next phase and the next speed
};

/// What holds every vertex of every part in every posture between the nodes, whichever way the head
/// is turned.
struct GaitBounds {
  double centre_z_m = 0;  ///< of the sphere: on the root's z axis where the radius is smallest
  double radius_m = 0;
  double upright_radius_m = 0;  ///< of the cylinder around the root's z axis
  // Boxes in the root frame, one for each cell between the nodes (speed-major, max(speeds - 1, 1)
  // times phases).
  std::vector<RootBox> whole;  ///< of every part
  std::vector<RootBox> rest;   ///< of those that do not hang from the legs' roots
};
/// What does not hang from `leg_roots` (links) may be lowered by up to max_drop_m, and be moved as
/// standing does; the boxes hold it where it is.
GaitBounds bounds_around(const PosableModel& model, const GaitTable& table,
                         std::span<const int> leg_roots = {}, double max_drop_m = 0,
                         const StandingJoints& standing = {});

/// What the model has for standing, within the limits of its joints.
StandingJoints standing_joints(const PosableModel& model, const GaitTable& table,
                               double max_sqrt_speed);

}  // namespace throng
