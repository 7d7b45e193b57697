// RecordingSummary describes a recording in a few numbers: people, speeds, densities.
// It samples at most a few hundred equidistant instants, to limit memory and time, and ignores
// walls.
#pragma once

#include <vector>

#include "recordings/recording.h"

namespace throng {

/// Median of values, and their 5 % and 95 % percentiles.
struct Percentiles {
  double low = 0, median = 0, high = 0;
};
/// Zeros for no values. Reorders `values`.
Percentiles percentiles_of(std::vector<float>& values);

struct RecordingSummary {
  double mean_people = 0;
  int64_t max_people = 0;
  double max_people_at_s = 0;
  Percentiles speed_mps;       ///< over 1 s
  Percentiles density_per_m2;  ///< within kDensityRadius_m of each person, including that person
  int64_t heights = 0;
  Percentiles height_m;
};

inline constexpr double kDensityRadius_m = 1;

RecordingSummary summary_of(const Recording& recording);

}  // namespace throng
