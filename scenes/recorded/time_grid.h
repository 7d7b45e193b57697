// Tables print times, not frames: whether these are those of so many frames a second.
// One rule: a grid is one only if every time lies on it within the rounding of what was printed.
#pragma once

#include <optional>

#include "scenes/recorded/sample_store.h"

namespace throng {

struct PrintedTimes {
  double first_s = 0;     ///< of all people
  double rounding_s = 0;  ///< half of the last digit that is printed
};

/// Frames a second on which all times of the store lie, counted from the first; none if there is no
/// such rate, or only one time.
std::optional<double> regular_rate(const SampleStore& store, const PrintedTimes& times);

/// True if all of them lie on the grid of so many a second.
bool lie_on(const SampleStore& store, const PrintedTimes& times, double per_s);

}  // namespace throng
