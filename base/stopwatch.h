// Stopwatch measures the time of a stage in nanoseconds; results never depend on it.
#pragma once

#include <chrono>

namespace throng {

class Stopwatch {
 public:
  /// Time since construction or the last lap.
  double ns() const { return between(start_, Clock::now()); }
  /// As ns(), and begins a lap.
  double lap_ns() {
    const auto now = Clock::now();
    const double ns = between(start_, now);
    start_ = now;
    return ns;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point start, Clock::time_point end) {
    return std::chrono::duration<double, std::nano>(end - start).count();
  }
  Clock::time_point start_ = Clock::now();
};

}  // namespace throng
