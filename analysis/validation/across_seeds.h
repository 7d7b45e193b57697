// What several seeds say of a test: its verdict is that of all of them, its figures are their mean
// and their worst.
// One rule: nothing is lost; each seed's own outcome stays beside what they come to together.
#pragma once

#include <cstdint>
#include <span>

#include "analysis/validation/validation.h"

namespace throng::validation {

struct SeedOutcome {
  uint64_t seed = 0;
  Outcome outcome;
  double wall_s = 0;
};

/// Fails if any seed fails, differs if any differs, is skipped if all are. Of one seed: its own
/// outcome. Readings are matched by `at` and `what`; the mean is that of the seeds that have one.
Outcome across_seeds(std::span<const SeedOutcome> seeds);

/// How far a reading lies from what is accepted: above 0 outside of it, 0 where nothing is asked.
double excess(const Reading& reading, double value);

}  // namespace throng::validation
