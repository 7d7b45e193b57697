// Part I: 15 objects in a box, every pair tested in every frame, one volume at a time.
// One rule: updates and tests are counted where they happen; frame 0 is where objects start and is
// not tested, so that 500 frames are 499 times 105 tests, as the paper's 52395 says.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/workers.h"
#include "bench/paper/methods.h"

namespace throng::paper {

inline constexpr size_t kMarks = 5;

/// What one method found and did in one run.
struct Census {
  std::array<uint64_t, kMarks> collisions{};  ///< overlapping pairs, summed over the frames so far
  uint64_t updates = 0;
  uint64_t tests = 0;
  uint64_t missed = 0;           ///< pairs that touch and were not found; 0 is a law
  uint64_t false_positives = 0;  ///< pairs found that do not touch
  uint64_t primitives = 0;       ///< tests of boxes and triangles, exact method only: N_p

  /// The paper counts two updates a test.
  uint64_t updates_paper() const { return 2 * tests; }
  bool operator==(const Census&) const = default;
};

using CensusTable = std::array<Census, kMethods.size()>;

/// One run of `frames` frames for every method, on the same motion.
CensusTable take_census(const std::vector<Object>& objects, int frames, uint64_t seed);

/// The runs of seeds first, first + 1, ...; the same for any number of threads.
std::vector<CensusTable> take_censuses(const std::vector<Object>& objects, int frames,
                                       uint64_t first_seed, int seeds, Workers& workers);

}  // namespace throng::paper
