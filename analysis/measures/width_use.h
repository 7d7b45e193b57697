// How the width of the way is used: the time that people spend in each lane of half a metre across
// the direction in which most of them walk.
// One rule: that direction is found out by watching, so places are kept as a map of the ground.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "analysis/measures/measure_table.h"
#include "analysis/measures/recent_crowd.h"
#include "analysis/measures/speed_and_spacing.h"

namespace throng {

class WidthUse {
 public:
  static constexpr double kLane_m = 0.5;

  explicit WidthUse(const Scene& scene);

  void take(const Moment& moment, const Velocities& velocities);

  /// Unit; the way most walk, whichever of the two along it more do. X where nobody walked.
  Eigen::Vector2d main_direction() const;
  /// Lanes from the right edge of the area to the left, as one walks.
  MeasureTable table() const;

 private:
  Rectangle ground_;
  std::vector<Eigen::Vector2d> outline_;  ///< corners of the walkable area
  double cell_m_;
  int columns_;
  int rows_;
  std::vector<uint32_t> visits_;
  Eigen::Matrix2d spread_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
};

}  // namespace throng
