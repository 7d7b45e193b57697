// Elapsed time of a stage, for the counters; never for a decision that changes a result.
#pragma once

#include <chrono>

namespace throng {

class Stopwatch {
 public:
  /// Nanoseconds since construction or the last lap.
  double lap_ns() {
    const auto now = std::chrono::steady_clock::now();
    const double ns = std::chrono::duration<double, std::nano>(now - start_).count();
    start_ = now;
    return ns;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace throng
