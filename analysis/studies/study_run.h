// study_run executes one run of a study, or all runs of a study in parallel.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/studies/study_plan.h"

namespace throng {

// Invariant: measures depend on the run alone; times are stored separately.

class BodyTables;

/// Column that a run fills.
struct StudyMeasure {
  enum class Kind : uint8_t { kInteger, kNumber, kText };
  std::string name;
  Kind kind = Kind::kNumber;
  std::string meaning;
};

/// All measured columns, in the order of the table.
const std::vector<StudyMeasure>& study_measures();

/// Times of a run and the memory of its process.
struct StudyTimes {
  double setup_s = 0;  ///< time before the first frame
  double wall_s = 0;   ///< duration of the whole run
  double cpu_s = 0;    ///< CPU time of the thread that executed the run, without helper threads
  double realtime_factor = 0;
  double peak_rss_mb = 0;  ///< peak memory of the process so far
};
/// Columns of the table of times, in their order.
const std::vector<StudyMeasure>& study_times();

/// A finished run.
struct StudyRow {
  size_t run = 0;                     ///< counted from 0
  std::vector<std::string> measures;  ///< one cell per study_measures()
  std::vector<std::string> times;     ///< one cell per study_times()
};

/// Executes a run. Returns nothing if keep_going() returned false. Throws InputError naming the
/// run.
std::optional<StudyRow> run_one(const StudyPlan& plan, size_t run, int threads,
                                const std::shared_ptr<BodyTables>& tables,
                                const std::function<bool()>& keep_going);

/// The runs of a study for run_all(). Invariant: the order in which runs end affects no result.
struct StudyWork {
  const StudyPlan& plan;
  /// Returns the next run, or nothing at the end; called by one thread at a time.
  std::function<std::optional<size_t>()> next;
  std::function<void(const StudyRow&)> done;  ///< receives results; called by one thread at a time
  std::function<bool()> keep_going;           ///< called from any thread
};

/// Executes runs on `workers` threads, each with `threads_each` threads for its run. The first
/// exception of a run or of done() stops all and is rethrown.
void run_all(const StudyWork& work, int workers, int threads_each);

}  // namespace throng
