// Whether a structure that followed a walking crowd is as good as a fresh one.
// One rule: aged and fresh are compared on the same frames, ours by counted work as well.
#pragma once

#include <string>
#include <vector>

#include "bench/comparison.h"

namespace throng::bench {

struct AgedEngine {
  std::string name, version;
  double fresh_ms = 0, aged_ms = 0;  ///< medians over options.frames frames
  bool agrees = true;
};

struct AgeingResult {
  int walked_frames = 0;
  uint64_t fresh_work = 0, aged_work = 0;  ///< our updates and tests of every stage, all frames
  double fresh_ms = 0, aged_ms = 0;
  std::vector<AgedEngine> engines;
};

/// Everybody walks `walked_frames` frames; then options.frames frames are measured.
AgeingResult age(BenchOptions options, int walked_frames, const Progress& progress);

}  // namespace throng::bench
