// take_census() runs Part I: 15 objects in a box, every pair tested per frame, volume by volume.
// Updates and tests are counted where they happen. Frame 0 holds the start and is not tested: 500
// frames are 499 times 105 tests, the paper's 52395.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/workers.h"
#include "bench/paper/methods.h"

namespace throng::paper {

inline constexpr size_t kMarks = 5;

/// Results and counts of one method in one run.
struct Census {
  std::array<uint64_t, kMarks> collisions{};  ///< overlapping pairs, summed up to each mark
  uint64_t updates = 0;
  uint64_t tests = 0;
  uint64_t missed = 0;           ///< touching pairs that were not found; must be 0
  uint64_t false_positives = 0;  ///< pairs found that do not touch
  uint64_t primitives = 0;       ///< tests of boxes and triangles, exact method only: N_p

  /// Number of updates as the paper counts: two per test.
  uint64_t updates_paper() const { return 2 * tests; }
  bool operator==(const Census&) const = default;
};

using CensusTable = std::array<Census, kMethods.size()>;

/// Runs `frames` frames for every method, on the same motion.
CensusTable take_census(const std::vector<Object>& objects, int frames, uint64_t seed);

/// Runs seeds first_seed, first_seed + 1, ...; the result is equal for any number of threads.
std::vector<CensusTable> take_censuses(const std::vector<Object>& objects, int frames,
                                       uint64_t first_seed, int seeds, Workers& workers);

}  // namespace throng::paper
