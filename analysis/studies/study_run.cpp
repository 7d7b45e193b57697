#include "analysis/studies/study_run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <exception>
#include <mutex>
#include <thread>

#include "analysis/contacts/contact_statistics.h"
#include "analysis/part_names.h"
#include "base/errors.h"
#include "scenes/run/body_tables.h"
#include "scenes/run/runner.h"

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;
using Kind = StudyMeasure::Kind;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double thread_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Measures speed, presence and leaving times of people.
class Movement {
 public:
  void frame(const Frame& frame, double step_s) {
    const double now_s = static_cast<double>(frame.number) * step_s;
    entered_s_.resize(frame.roots.size(), -1);
    for (size_t id = 0; id < frame.roots.size(); ++id) {
      const bool is_there = frame.present.empty() || frame.present[id] != 0;
      if (is_there) {
        ++person_frames_;
        speeds_mps_ += static_cast<double>(frame.speeds_mps[id]);
        if (entered_s_[id] < 0) entered_s_[id] = now_s;
      } else if (entered_s_[id] >= 0) {
        ++left_;
        last_left_s_ = now_s;
        stayed_s_ += now_s - entered_s_[id];
        entered_s_[id] = -1;
      }
    }
    ++frames_;
  }

  double mean_speed_mps() const { return mean(speeds_mps_, person_frames_); }
  double mean_present() const { return mean(static_cast<double>(person_frames_), frames_); }
  std::optional<double> last_left_s() const { return if_any(last_left_s_); }
  std::optional<double> mean_stay_s() const { return if_any(mean(stayed_s_, left_)); }

 private:
  static double mean(double sum, uint64_t count) {
    return count == 0 ? 0 : sum / static_cast<double>(count);
  }
  std::optional<double> if_any(double value) const {
    return left_ > 0 ? std::optional(value) : std::nullopt;
  }

  std::vector<double> entered_s_;  ///< indexed by person; negative: not in the scene
  uint64_t person_frames_ = 0, frames_ = 0, left_ = 0;
  double speeds_mps_ = 0, stayed_s_ = 0, last_left_s_ = 0;
};

class StudyMeasures final : public Sink {
 public:
  void begin(const RunInfo& run) override {
    step_s_ = run.step_s;
    contacts_ = std::make_unique<ContactStatistics>(run);
  }
  void frame(const RunInfo&, const Frame& frame) override {
    movement_.frame(frame, step_s_);
    contacts_->frame(frame);
  }
  void end(const RunInfo&, const RunEnd& end) override { contacts_->end(end); }

  const Movement& movement() const { return movement_; }
  const ContactStatistics& contacts() const { return *contacts_; }

 private:
  double step_s_ = 0;
  Movement movement_;
  std::unique_ptr<ContactStatistics> contacts_;
};

std::vector<uint64_t> contacts_by_kind(const PartMatrix& parts) {
  std::vector<uint64_t> counts(kGroupPairs, 0);
  std::vector<PartGroup> groups;
  for (const std::string& name : parts.names) groups.push_back(part_group(name));
  for (size_t i = 0; i < groups.size(); ++i)
    for (size_t k = 0; k <= i; ++k)  // the matrix is symmetric
      counts[group_pair(groups[i], groups[k])] += parts.counts[i * groups.size() + k];
  return counts;
}

/// Collects cells in the order of study_measures().
class Cells {
 public:
  void integer(uint64_t value) { cells_.push_back(fmt::format("{}", value)); }
  void number(double value) { cells_.push_back(fmt::format("{:.9g}", value + 0.0)); }
  void number(const std::optional<double>& value) {
    if (value)
      number(*value);
    else
      cells_.emplace_back();
  }
  void hash(uint64_t value) { cells_.push_back(fmt::format("{:016x}", value)); }
  std::vector<std::string> take() { return std::move(cells_); }

 private:
  std::vector<std::string> cells_;
};

std::vector<std::string> measures_of(const RunSummary& summary, const StudyMeasures& measures,
                                     double plan_growth) {
  Cells cells;
  const PopulationCounters& population = summary.population;
  int stranded = 0;
  for (const Stranding& stranding : summary.strandings) stranded += stranding.people;
  cells.number(summary.simulated_s);
  cells.integer(static_cast<uint64_t>(summary.avatars));
  cells.number(plan_growth);
  cells.integer(static_cast<uint64_t>(summary.unplaced));
  for (const uint64_t count : {population.entered, population.left, population.present,
                               population.waiting_to_enter, population.scheduled})
    cells.integer(count);
  cells.integer(static_cast<uint64_t>(stranded));
  const Movement& movement = measures.movement();
  cells.number(movement.mean_present());
  cells.number(movement.mean_speed_mps());
  cells.number(movement.mean_stay_s());
  cells.number(movement.last_left_s());
  cells.integer(summary.queuing_peak);
  cells.number(summary.longest_stall_s);
  cells.number(summary.max_overlap_m);
  cells.number(summary.steering.mean_heading_rate_radps());
  const ContactTotals totals = measures.contacts().totals();
  cells.integer(totals.contacts);
  cells.number(totals.per_person_min());
  cells.integer(totals.people_touched);
  cells.number(totals.person_s > 0 ? totals.touching_s / totals.person_s : 0);
  cells.number(totals.median_s);
  cells.integer(totals.obstacle_contacts);
  cells.integer(summary.begins);
  cells.integer(summary.pairs_peak);
  for (const uint64_t count : contacts_by_kind(measures.contacts().parts())) cells.integer(count);
  cells.hash(summary.run_id);
  cells.hash(summary.hash);
  return cells.take();
}

}  // namespace

const std::vector<StudyMeasure>& study_measures() {
  static const std::vector<StudyMeasure> measures = [] {
    std::vector<StudyMeasure> all = {
        {"simulated_s", Kind::kNumber, "simulated duration"},
        {"people", Kind::kInteger, "number of people of the scene, present or not"},
        {"plan_growth", Kind::kNumber,
         "factor by which `avatars` enlarged the sides of the plan; 1: not enlarged"},
        {"unplaced", Kind::kInteger, "people without a place at the start"},
        {"entered", Kind::kInteger, "people who entered, including those present at the start"},
        {"left", Kind::kInteger, "people who left at their last goal"},
        {"present", Kind::kInteger, "people present at the end"},
        {"waiting", Kind::kInteger, "people due but still outside at the end, for lack of space"},
        {"scheduled", Kind::kInteger, "people not due before the end"},
        {"stranded", Kind::kInteger, "people without a path to a goal"},
        {"mean_present", Kind::kNumber, "number of people present, mean over frames"},
        {"mean_speed_mps", Kind::kNumber,
         "mean speed over people and the frames of their "
         "presence"},
        {"mean_stay_s", Kind::kNumber, "mean time from entering to leaving, of people who left"},
        {"last_left_s", Kind::kNumber, "time at which the last person left"},
        {"queuing_peak", Kind::kInteger, "maximum number of people queuing at a time"},
        {"longest_stall_s", Kind::kNumber,
         "longest time that a walking agent stood still outside "
         "of queues"},
        {"max_overlap_m", Kind::kNumber, "maximum overlap of two steering discs"},
        {"mean_heading_rate_radps", Kind::kNumber, "mean rate of turn of headings"},
        {"contacts", Kind::kInteger,
         "contacts of two people, from their first touching pair of parts to the last"},
        {"contacts_per_person_min", Kind::kNumber, "contacts per person and minute"},
        {"people_touched", Kind::kInteger, "people with at least one contact"},
        {"contact_time_share", Kind::kNumber,
         "share of the people's time that is spent in "
         "contact"},
        {"median_contact_s", Kind::kNumber,
         "median duration of contacts that begin and end "
         "within the run"},
        {"obstacle_contacts", Kind::kInteger, "contacts of a person and an obstacle"},
        {"part_contacts", Kind::kInteger, "contacts of two parts, including those of obstacles"},
        {"part_pairs_peak", Kind::kInteger, "maximum number of touching pairs of parts at a time"},
    };
    for (size_t pair = 0; pair < kGroupPairs; ++pair) {
      std::string name = "contacts_" + name_of_group_pair(pair);
      std::replace(name.begin(), name.end(), ' ', '_');
      all.push_back({std::move(name), Kind::kInteger,
                     "contacts of two parts of two people: " + name_of_group_pair(pair)});
    }
    all.push_back({"run_id", Kind::kText,
                   "hash of the scene, the seed and all options that "
                   "affect results"});
    all.push_back({"hash", Kind::kText, "hash of all events"});
    return all;
  }();
  return measures;
}

const std::vector<StudyMeasure>& study_times() {
  static const std::vector<StudyMeasure> times = {
      {"setup_s", Kind::kNumber, "time before the first frame"},
      {"wall_s", Kind::kNumber, "duration of the whole run"},
      {"cpu_s", Kind::kNumber,
       "CPU time of the thread that executed the run, without helper threads"},
      {"realtime_factor", Kind::kNumber, "simulated duration over wall time of the frames"},
      {"peak_rss_mb", Kind::kNumber, "peak memory of the process so far, in MB"},
  };
  return times;
}

std::optional<StudyRow> run_one(const StudyPlan& plan, size_t run, int threads,
                                const std::shared_ptr<BodyTables>& tables,
                                const std::function<bool()>& keep_going) {
  const auto start = Clock::now();
  const double start_s = thread_s();
  try {
    PlannedRun planned = plan.planned(run);
    Simulation simulation(std::move(planned.scene), {.threads = threads,
                                                     .culler = planned.culler,
                                                     .strategy = planned.strategy,
                                                     .tables = tables});
    const double setup_s = seconds_since(start);
    StudyMeasures measures;
    Sink* const sink = &measures;
    const RunSummary summary =
        throng::run(simulation, {&sink, 1}, [&](const Frame&) { return keep_going(); });
    if (summary.stopped_early) return std::nullopt;
    StudyRow row{run, measures_of(summary, measures, planned.plan_growth), {}};
    for (const double value : {setup_s, seconds_since(start), thread_s() - start_s,
                               summary.realtime_factor, peak_rss_mb()})
      row.times.push_back(fmt::format("{:.4g}", value));
    return row;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: run {}", plan.study().file.string(), run + 1),
                     "a scene that runs without errors", error.what());
  }
}

void run_all(const StudyWork& work, int workers, int threads_each) {
  std::mutex mutex;
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  const auto tables = std::make_shared<BodyTables>();
  const auto keep_going = [&] { return !failed && work.keep_going(); };
  const auto carry_out_some = [&] {
    try {
      while (keep_going()) {
        std::optional<size_t> run;
        {
          const std::lock_guard lock(mutex);
          run = work.next();
        }
        if (!run) return;
        const std::optional<StudyRow> row =
            run_one(work.plan, *run, threads_each, tables, keep_going);
        if (!row) return;
        const std::lock_guard lock(mutex);
        work.done(*row);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < workers; ++i) others.emplace_back(carry_out_some);
  carry_out_some();
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace throng
