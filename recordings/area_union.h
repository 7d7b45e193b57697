// JoinedArea is the walkable area of a recording, whose adjoining and overlapping polygons are one.
// Invariant: a polygon without a slit that neither adjoins nor overlaps another stays as it is, bit
// by bit.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "recordings/recording.h"
#include "recordings/walkable_wkt.h"

namespace throng {

struct JoinedArea {
  std::vector<AreaPolygon> polygons;
  /// Pairs of polygons with a gap wider than rounding, which is closed; a polygon with such a slit
  /// is a pair with itself.
  int64_t gaps = 0;
  double max_gap_m = 0;  ///< the widest of these gaps
  Eigen::Vector2d max_gap_at_m = Eigen::Vector2d::Zero();
};

/// The union of polygons in metres. Slits of up to 1 mm within a ring are closed like gaps between
/// polygons, but a hole that is as narrow all over is an obstacle and stays. Corners of the
/// polygons keep their coordinates; where edges cross there are new ones, exact to 0.1 mm. Corners
/// that only the cut between two polygons has made are left out if they lie within 1 mm of a
/// straight line. Throws InputError that begins with `where` if polygons that adjoin lie too far
/// out, or cross too often.
JoinedArea join(std::vector<AreaPolygon> polygons, const std::string& where);

/// What the file's text says, in the metres of the scene. Throws InputError that begins with
/// `where`.
JoinedArea recorded_area(const RecordingFacts& facts, const std::string& where);

}  // namespace throng
