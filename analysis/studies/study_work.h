// Carries out the runs of a study, several at once.
// One rule: a run a worker, and whoever is free takes the next; the order in which runs end never
// reaches a result.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "analysis/studies/study_run.h"

namespace throng {

struct StudyWork {
  const StudyPlan& plan;
  /// The next run, or nothing when there is none left; one thread at a time.
  std::function<std::optional<size_t>()> next;
  std::function<void(const StudyRow&)> done;  ///< one thread at a time
  std::function<bool()> keep_going;           ///< from any thread
};

/// `workers` threads, each with as many for its own run. What a run or done() throws ends all and
/// is thrown again.
void carry_out_all(const StudyWork& work, int workers, int threads_each);

}  // namespace throng
