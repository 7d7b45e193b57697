// Instructions that a benchmark retires, where the machine lets us count them.
// One rule: where it does not (most virtual machines), nothing is reported instead of a guess.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>

namespace throng::bench {

/// Counts this thread's user-space instructions while it lives (Linux perf events); sets the
/// counter `instructions`, one item's, at the end.
class CountInstructions {
 public:
  /// `items`: what one iteration of the state's loop does.
  CountInstructions(benchmark::State& state, int64_t items);
  ~CountInstructions();
  CountInstructions(const CountInstructions&) = delete;
  CountInstructions& operator=(const CountInstructions&) = delete;

 private:
  benchmark::State& state_;
  int64_t items_;
  int counter_;  // a file descriptor, -1 without one
};

}  // namespace throng::bench
