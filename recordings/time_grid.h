// Time grids find the frame rate of printed times.
// Invariant: a grid is accepted only if every time lies on it within the printed rounding.
#pragma once

#include <optional>

#include "recordings/sample_store.h"

namespace throng {

struct PrintedTimes {
  double first_s = 0;
  double rounding_s = 0;  ///< half of the last printed digit
};

/// RateEstimator finds the rate of a file with frame numbers and times.
class RateEstimator {
 public:
  void take(double frame, double time_s, double rounding_s);
  /// Rate from the smallest frame to the largest; empty with a single frame or time.
  std::optional<double> per_s() const;
  /// Maximum relative error of per_s() due to the rounding of times.
  double uncertainty() const;

 private:
  bool is_empty_ = true;
  double first_frame_ = 0, last_frame_ = 0;
  double first_s_ = 0, last_s_ = 0;
  double rounding_s_ = 0;
};

/// Frame rate whose grid from the first time holds all times of the store. Empty without such a
/// rate, or for a single time.
std::optional<double> regular_rate(const SampleStore& store, const PrintedTimes& times);

/// Positions per second of the longest track with irregular times, without gaps; empty for a single
/// time.
std::optional<double> usual_rate(const SampleStore& store);

/// Returns whether all times lie on the grid of this rate.
bool lie_on(const SampleStore& store, const PrintedTimes& times, double per_s);

}  // namespace throng
