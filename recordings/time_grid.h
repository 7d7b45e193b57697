// Tables print times, not frames: whether these are those of so many frames a second.
// One rule: a grid is one only if every time lies on it within the rounding of what was printed.
#pragma once

#include <optional>

#include "recordings/sample_store.h"

namespace throng {

struct PrintedTimes {
  double first_s = 0;     ///< of all people
  double rounding_s = 0;  ///< half of the last digit that is printed
};

/// The rate of frames in a file that has their times as well.
class RateEstimator {
 public:
  /// `rounding_s`: half of the last digit printed.
  void take(double frame, double time_s, double rounding_s);
  /// From the least frame to the greatest; none where these are one, or at one time.
  std::optional<double> per_s() const;
  /// The greatest part of per_s() by which rounding of the times may shift it.
  double uncertainty() const;

 private:
  bool is_empty_ = true;
  double first_frame_ = 0, last_frame_ = 0;
  double first_s_ = 0, last_s_ = 0;
  double rounding_s_ = 0;
};

/// Frames a second on which all times of the store lie, counted from the first; none if there is no
/// such rate, or only one time.
std::optional<double> regular_rate(const SampleStore& store, const PrintedTimes& times);

/// Positions a second of the longest track where times are irregular, holes left out; none if it
/// has one time only.
std::optional<double> usual_rate(const SampleStore& store);

/// True if all of them lie on the grid of so many a second.
bool lie_on(const SampleStore& store, const PrintedTimes& times, double per_s);

}  // namespace throng
