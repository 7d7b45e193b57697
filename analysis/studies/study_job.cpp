#include "analysis/studies/study_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/version.h"

namespace throng {
namespace {

std::string owner_of(const StudyPlan& plan, const StudyShard& shard) {
  return fmt::format("study {:016x}; part {}/{}; throng {} {}", plan.identity(), shard.index,
                     shard.count, version(), commit());
}

}  // namespace

std::filesystem::path times_of(const std::filesystem::path& table) {
  std::filesystem::path file = table;
  file += ".times.csv";
  return file;
}

StudyJob::StudyJob(const StudyPlan& plan, const StudyShard& shard, std::filesystem::path out)
    : plan_(plan), out_(std::move(out)) {
  if (!out_.empty()) {
    journal_.emplace(journal_of(out_), owner_of(plan, shard));
    rows_ = journal_->done();
  }
  std::vector<uint8_t> is_done(plan.runs(), 0);
  for (const StudyRow& row : rows_)
    if (row.run < plan.runs()) is_done[row.run] = 1;
  for (size_t run = shard.index - 1; run < plan.runs(); run += shard.count) {
    ++requested_;
    if (is_done[run] == 0) todo_.push_back(run);
  }
  left_ = todo_.size();
}

size_t StudyJob::finished() const {
  const std::lock_guard lock(mutex_);
  return rows_.size();
}

std::optional<size_t> StudyJob::next() {
  const std::lock_guard lock(mutex_);
  if (todo_.empty()) return {};
  const size_t run = todo_.front();
  todo_.pop_front();
  return run;
}

void StudyJob::return_run(size_t run) {
  const std::lock_guard lock(mutex_);
  todo_.push_front(run);
}

size_t StudyJob::add(const StudyRow& row) {
  const std::lock_guard lock(mutex_);
  if (journal_) journal_->add(row);
  rows_.push_back(row);
  return rows_.size() - (requested_ - left_);
}

std::vector<StudyRow> StudyJob::sorted_rows() const {
  const std::lock_guard lock(mutex_);
  std::vector<StudyRow> rows = rows_;
  std::sort(rows.begin(), rows.end(),
            [](const StudyRow& a, const StudyRow& b) { return a.run < b.run; });
  return rows;
}

StudyTable StudyJob::table() const {
  StudyTable out{plan_.columns(), {}};
  for (const StudyMeasure& measure : study_measures()) out.columns.push_back(measure.name);
  for (const StudyRow& row : sorted_rows()) {
    std::vector<std::string>& cells = out.rows.emplace_back(plan_.cells(row.run));
    cells.insert(cells.end(), row.measures.begin(), row.measures.end());
  }
  return out;
}

StudyTable StudyJob::times() const {
  StudyTable out{{"run", "runs", "study"}, {}};
  for (const StudyMeasure& time : study_times()) out.columns.push_back(time.name);
  for (const StudyRow& row : sorted_rows()) {
    std::vector<std::string> cells = plan_.cells(row.run);
    cells.resize(3);
    cells.insert(cells.end(), row.times.begin(), row.times.end());
    out.rows.push_back(std::move(cells));
  }
  return out;
}

void StudyJob::write() {
  write_table(out_, table());
  write_table(times_of(out_), times());
  journal_->remove();
}

void run_job(StudyJob& job, int threads, const std::function<void(size_t)>& on_added,
             const std::function<bool()>& keep_going) {
  if (job.left() == 0) return;
  const int workers = std::clamp(static_cast<int>(job.left()), 1, threads);
  run_all({job.plan(), [&job] { return job.next(); },
           [&](const StudyRow& row) { on_added(job.add(row)); }, keep_going},
          workers, threads / workers);
}

}  // namespace throng
