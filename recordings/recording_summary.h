// What people do in a recording, in a few numbers: how many are there, how fast, how dense.
// One rule: seen at evenly spread instants, at most some hundred, so that memory and time stay
// small; walls are not known here.
#pragma once

#include <vector>

#include "recordings/recording.h"

namespace throng {

/// Of many values the middle one, and those that 5 % are below and above.
struct Percentiles {
  double low = 0, median = 0, high = 0;
};
/// Zeros if there are none.
Percentiles percentiles_of(std::vector<float>& values);

struct RecordingSummary {
  double mean_people = 0;  ///< there at once
  int64_t max_people = 0;
  double max_people_at_s = 0;
  Percentiles speed_mps;       ///< over a second
  Percentiles density_per_m2;  ///< within kDensityRadius_m of everybody, that person included
  int64_t heights = 0;         ///< people who have one
  Percentiles height_m;
};

inline constexpr double kDensityRadius_m = 1;

RecordingSummary summary_of(const Recording& recording);

}  // namespace throng
