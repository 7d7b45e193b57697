// repeat() measures the cost of one operation by the thread's clock, with median and spread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <utility>
#include <vector>

#include "base/random.h"

namespace throng::bench {

/// Processor time of this thread. On an idle machine it equals the wall clock; on a busy one it
/// excludes the time of other processes. Reading it takes 0.5 us.
class ThreadClock {
 public:
  /// Nanoseconds since construction or the last lap.
  double lap_ns() {
    const double now_ns = read_ns();
    const double ns = now_ns - start_ns_;
    start_ns_ = now_ns;
    return ns;
  }

 private:
  static double read_ns() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
  }
  double start_ns_ = read_ns();
};

// Inputs should come in random order and not repeat within a repetition: no branch is learned.

/// Median, 10th and 90th percentile over the repetitions, in nanoseconds.
struct Cost {
  double median_ns = 0;
  double low_ns = 0;
  double high_ns = 0;
  int repetitions = 0;
};

/// Computes the cost from unsorted samples.
inline Cost cost_of(std::vector<double> samples_ns) {
  if (samples_ns.empty()) return {};
  std::sort(samples_ns.begin(), samples_ns.end());
  const size_t last = samples_ns.size() - 1;
  return {samples_ns[last / 2], samples_ns[last / 10], samples_ns[last - last / 10],
          static_cast<int>(samples_ns.size())};
}

/// Keeps the compiler from removing a computation that is only timed.
inline void use(const void* value) { asm volatile("" : : "r"(value) : "memory"); }

/// A measurement ends after this time, but not before kMinRepetitions.
inline constexpr double kBudget_ns = 0.15e9;
inline constexpr int kMinRepetitions = 7;
inline constexpr int kMaxRepetitions = 101;

/// Repeats `body`, which performs `count` operations, and returns the cost of one.
template <typename Body>
Cost repeat(size_t count, const Body& body) {
  std::vector<double> samples_ns;
  double spent_ns = 0;
  body();  // caches and clocks warm up
  while (static_cast<int>(samples_ns.size()) < kMaxRepetitions &&
         (static_cast<int>(samples_ns.size()) < kMinRepetitions || spent_ns < kBudget_ns)) {
    ThreadClock watch;
    body();
    const double ns = watch.lap_ns();
    spent_ns += ns;
    samples_ns.push_back(ns / static_cast<double>(count));
  }
  return cost_of(std::move(samples_ns));
}

/// Shuffles by Fisher and Yates, equally on all machines.
template <typename T>
void shuffle(std::vector<T>& items, uint64_t seed) {
  const RandomKey key{seed, 0, 1, Purpose::kBoxWorld};
  for (size_t i = items.size(); i > 1; --i)
    std::swap(items[i - 1], items[random_bits(key, static_cast<uint32_t>(i)) % i]);
}

}  // namespace throng::bench
