// One run of a study, and all runs of one, several at once.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/studies/study_plan.h"

namespace throng {

// One run of a study, carried out and measured.
// What is measured depends on the run alone; what the clock says stays apart from it.

class BodyTables;

/// A column that a run fills.
struct StudyMeasure {
  enum class Kind : uint8_t { kInteger, kNumber, kText };
  std::string name;
  Kind kind = Kind::kNumber;
  std::string meaning;
};

/// In the order of the table.
const std::vector<StudyMeasure>& study_measures();

/// What the clock says of a run, and of the process that carried it out.
struct StudyTimes {
  double setup_s = 0;  ///< before the first frame
  double wall_s = 0;   ///< all of it
  double cpu_s = 0;    ///< of the thread that carried it out; others that helped have their own
  double realtime_factor = 0;
  double peak_rss_mb = 0;  ///< of the process so far
};
const std::vector<std::string>& study_times_columns();

/// A finished run.
struct StudyRow {
  size_t run = 0;                     ///< counted from 0
  std::vector<std::string> measures;  ///< a cell each
  std::vector<std::string> times;     ///< a cell each
};

/// Nothing if keep_going() said no before the end. Throws InputError, naming the run.
std::optional<StudyRow> run_one(const StudyPlan& plan, size_t run, int threads,
                                const std::shared_ptr<BodyTables>& tables,
                                const std::function<bool()>& keep_going);

// Carries out the runs of a study, several at once.
// A run a worker, and whoever is free takes the next; the order in which runs end never
// reaches a result.

struct StudyWork {
  const StudyPlan& plan;
  /// The next run, or nothing when there is none left; one thread at a time.
  std::function<std::optional<size_t>()> next;
  std::function<void(const StudyRow&)> done;  ///< one thread at a time
  std::function<bool()> keep_going;           ///< from any thread
};

/// `workers` threads, each with as many for its own run. What a run or done() throws ends all and
/// is thrown again.
void run_all(const StudyWork& work, int workers, int threads_each);

}  // namespace throng
