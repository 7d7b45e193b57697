// How hard people speed up, slow down and turn, over a tenth of a second.
// One rule: of heads, as a camera sees them with all their sway, and of the body's way apart.
#pragma once

#include "analysis/measures/histogram.h"
#include "analysis/measures/measure_table.h"
#include "analysis/measures/recent_crowd.h"

namespace throng {

class Accelerations {
 public:
  explicit Accelerations(double sample_s);

  /// Whether samples come about ten times a second; otherwise the table stays empty.
  bool is_measured() const { return is_measured_; }
  /// The moment before the newest.
  void take(const RecentCrowd& crowd);

  MeasureTable table() const;
  /// Of bodies, in m/s2.
  const Histogram& of_bodies() const { return roots_mps2_; }

 private:
  double sample_s_;
  bool is_measured_;
  Histogram heads_mps2_;
  Histogram roots_mps2_;
};

}  // namespace throng
