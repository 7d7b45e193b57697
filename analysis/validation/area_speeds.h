// Density and speed of an area, moment by moment: one over the mean cell of its people, and their
// speed, weighted by cell.
// One rule: measured as recordings are: Voronoi cells cut at the walls, and how far somebody gets
// in a second.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/judging.h"
#include "analysis/validation/trial.h"
#include "analysis/validation/trial_moments.h"

namespace throng::validation {

/// The cell of a person at a moment, m2 or m; 0 for none.
using CellOf = std::function<double(const Moment&, size_t)>;
CellOf voronoi_cells(const Scene& scene);

/// Of the people of an area at a moment; none without anybody.
std::optional<DensitySpeed> density_and_speed(const Moment& moment, const Velocities& velocities,
                                              const Rectangle& area, const CellOf& cell);

class AreaSpeeds {
 public:
  /// Moments are half a second apart, so that a second's displacement has one in its middle.
  static constexpr double kSample_s = 0.5;

  AreaSpeeds(const Trial& trial, CellOf cell, std::vector<Rectangle> areas);

  /// Once a step; `counts`: whether its moments become samples.
  void watch(const Trial& trial, bool counts = true);

  /// One an area and moment with somebody in it.
  const std::vector<DensitySpeed>& samples() const { return samples_; }

 private:
  CellOf cell_;
  std::vector<Rectangle> areas_;
  RecentCrowd crowd_;
  Velocities velocities_;
  Every clock_{kSample_s};
  std::vector<DensitySpeed> samples_;
};

}  // namespace throng::validation
