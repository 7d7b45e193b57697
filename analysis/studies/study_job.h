// StudyJob distributes the runs of a study, collects their results and makes the tables.
// Invariant: the tables do not depend on the order of runs, threads, shards or interruptions.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "analysis/studies/journal.h"
#include "analysis/studies/study_plan.h"
#include "analysis/studies/study_run.h"
#include "analysis/studies/study_table.h"

namespace throng {

/// Every count-th run, from the index-th on; both from 1.
struct StudyShard {
  size_t index = 1;
  size_t count = 1;
};

class StudyJob {
 public:
  /// Opens the journal of the table `out` and skips its runs; an empty path keeps no journal.
  /// `plan` must outlive the job. Throws InputError if the journal belongs to another study,
  /// EnvironmentError if it cannot be written.
  StudyJob(const StudyPlan& plan, const StudyShard& shard, std::filesystem::path out);

  const StudyPlan& plan() const { return plan_; }
  /// Number of runs of the shard.
  size_t requested() const { return requested_; }
  /// Number of runs that the journal lacked when it was opened.
  size_t left() const { return left_; }
  /// Number of finished runs, including those of the journal.
  size_t finished() const;
  bool is_complete() const { return finished() >= requested_; }

  /// Next run, or nothing at the end. Thread-safe, like the functions below.
  std::optional<size_t> next();
  /// Takes back a run that did not finish.
  void return_run(size_t run);
  /// Adds a result, also to the journal. Returns the number of results added so far.
  size_t add(const StudyRow& row);

  /// The table of a complete job, and its times, in the order of runs.
  StudyTable table() const;
  StudyTable times() const;
  /// Writes both tables and removes the journal. Throws EnvironmentError.
  void write();

 private:
  std::vector<StudyRow> sorted_rows() const;

  const StudyPlan& plan_;
  std::filesystem::path out_;
  std::optional<Journal> journal_;
  mutable std::mutex mutex_;
  std::deque<size_t> todo_;
  std::vector<StudyRow> rows_;
  size_t requested_ = 0, left_ = 0;
};

/// Executes the remaining runs of a job on `threads` threads; a run gets several if fewer runs are
/// left. Calls `on_added` after each run with the number of results added so far.
void run_job(StudyJob& job, int threads, const std::function<void(size_t)>& on_added,
             const std::function<bool()>& keep_going);

/// File name of the times of a table.
std::filesystem::path times_of(const std::filesystem::path& table);

}  // namespace throng
