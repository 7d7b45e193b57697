// The figure of a run's separation: how near a robot came to each region, and what was required.
// One rule: memory does not grow with the run; each point is the frame of its stretch that came
// nearest.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/figure.h"
#include "scenes/separation/separation_monitor.h"

namespace throng {

class SeparationHistory {
 public:
  /// A run of so many frames at most, as far as it is known.
  SeparationHistory(const RunInfo& run, int64_t frames);

  void add(int64_t frame, std::span<const RegionSeparation> rows);

  /// Of the robot that was too near for the longest time, or else came nearest; the regions that
  /// people have. False: no robot came within the margin.
  bool has_figure() const;
  Figure figure(const RunInfo& run, const SeparationTotals& totals) const;

 private:
  struct Point {
    float lo_m = RegionSeparation::kFar;
    float required_m = RegionSeparation::kUnknown;
    bool is_short = false;
  };
  static constexpr int64_t kPoints = 600;
  struct Robot {
    uint64_t short_frames = 0;  ///< of all regions together
    float least_m = RegionSeparation::kFar;
    std::array<std::vector<Point>, kBodyRegions> regions;  ///< by stretch; empty: always far
  };

  size_t worst() const;

  double step_s_;
  float near_m_;
  int64_t stretch_;  ///< frames
  size_t points_ = 0;
  int64_t first_frame_ = -1;
  std::vector<int32_t> index_;  ///< by avatar, into robots_; -1: not yet
  std::vector<std::unique_ptr<Robot>> robots_;
  std::vector<uint32_t> ids_;
};

}  // namespace throng
