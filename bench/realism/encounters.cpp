#include "bench/realism/encounters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/measures/contact_measures.h"
#include "bench/realism/measured_run.h"
#include "scenes/retargeting/recorded_motion.h"
#include "scenes/run/posing.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"

namespace throng::realism {
namespace {

constexpr double kApart_m = 20;
constexpr uint64_t kColumns = 32;
constexpr uint64_t kPlaces = kColumns * kColumns;

class EncounterMotion final : public RecordedMotion {
 public:
  EncounterMotion(const Scene& scene, SimdTarget simd, Workers& workers,
                  std::vector<EncounterPerson> encounter_people)
      : RecordedMotion(scene, simd, workers), passers_(std::move(encounter_people)) {}

  void place(BodyStates& bodies) override {
    RecordedMotion::place(bodies);
    const double own_m = static_cast<double>(models().front()->height_m);
    for (size_t id = 0; id < passers_.size(); ++id) {
      bodies.scales[id] = static_cast<float>(passers_[id].height_m / own_m);
      bodies.phases[id] = static_cast<float>(passers_[id].phase);
      bodies.styles[id] = passers_[id].style;
    }
  }

 private:
  std::vector<EncounterPerson> passers_;
};

}  // namespace

Eigen::Vector2d middle_of(const Encounter& encounter) {
  const uint64_t place = encounter.number() % kPlaces;
  const uint64_t column = place % kColumns, row = place / kColumns;
  return kApart_m * Eigen::Vector2d(static_cast<double>(column), static_cast<double>(row));
}

Scene encounter_scene(std::span<const Encounter> encounters) {
  Scene scene = synthetic_scene(
      "encounters", 2 * encounters.size(), Encounter::kDuration_s,
      [&](size_t person, double time_s) {
        const Encounter& encounter = encounters[person / 2];
        return Eigen::Vector2d(middle_of(encounter) + encounter.place_m(person % 2, time_s));
      });
  scene.ground.min_m.setConstant(-0.5 * kApart_m);
  scene.ground.max_m.setConstant((static_cast<double>(kColumns) - 0.5) * kApart_m);
  return scene;
}

MotionFactory encounter_motion(std::span<const Encounter> encounters) {
  std::vector<EncounterPerson> encounter_people;
  for (const Encounter& encounter : encounters)
    encounter_people.insert(encounter_people.end(), encounter.people().begin(),
                            encounter.people().end());
  return [encounter_people](const Scene& scene, SimdTarget simd, Workers& workers) {
    return std::make_unique<EncounterMotion>(scene, simd, workers, encounter_people);
  };
}

namespace {

/// Number of encounters in one scene.
constexpr uint64_t kBatch = 996;
static_assert(kBatch % kTurns == 0);

class EncounterWatch final : public Sink {
 public:
  explicit EncounterWatch(std::span<const Encounter> encounters) {
    for (const Encounter& encounter : encounters) {
      EncounterResult& result = results_.emplace_back();
      result.number = encounter.number();
      result.kind = encounter.kind();
    }
  }

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override {
    depths_.emplace(run);
    groups_.emplace(run);
  }
  void frame(const RunInfo& run, const Frame& frame) override {
    const double now_s = static_cast<double>(frame.number) * run.step_s;
    for (size_t i = 0; i < results_.size(); ++i) {
      const double apart_m =
          (frame.roots[2 * i + 1].position_m - frame.roots[2 * i].position_m).norm();
      if (apart_m >= results_[i].min_root_distance_m) continue;
      results_[i].min_root_distance_m = apart_m;
      results_[i].min_distance_s = now_s;
    }
    for (const PairEvent& event : frame.events)
      foreign_contacts_ += event.kind == EventKind::kBegin && !are_together(event.pair);
    uint32_t last = UINT32_MAX;
    depths_->find(run, frame, [&](PairKey pair, double depth_m) {
      if (!are_together(pair)) return;
      EncounterResult& result = results_[pair.a() / 2];
      if (pair.a() != last) {
        if (result.touching_frames++ == 0) result.first_touch_s = now_s;
        last = pair.a();
      }
      take(run, pair, depth_m, now_s, result);
    });
  }
  void end(const RunInfo&, const RunEnd&) override {}

  const std::vector<EncounterResult>& results() const { return results_; }
  uint64_t foreign_contacts() const { return foreign_contacts_; }

 private:
  static bool are_together(PairKey pair) { return pair.a() / 2 == pair.b() / 2; }

  void take(const RunInfo& run, PairKey pair, double depth_m, double now_s,
            EncounterResult& result) {
    const size_t group =
        group_pair(groups_->of(pair.a(), pair.part_a()), groups_->of(pair.b(), pair.part_b()));
    result.groups[group] = true;
    result.max_depth_by_group_m[group] = std::max(result.max_depth_by_group_m[group], depth_m);
    if (depth_m < result.max_depth_m) return;
    result.max_depth_m = depth_m;
    result.max_depth_s = now_s;
    const std::vector<Part>& parts = run.models.front()->parts;
    result.max_depth_parts =
        fmt::format("{} and {}", parts[pair.part_a()].name, parts[pair.part_b()].name);
  }

  std::vector<EncounterResult> results_;
  std::optional<ContactDepths> depths_;
  std::optional<PartGroups> groups_;
  uint64_t foreign_contacts_ = 0;
};

std::string cm(double metres) { return fmt::format("{:.1f}", 100 * metres); }

/// Returns the smallest value that at least `share` of the sorted values do not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<size_t>(rank, 1, sorted.size()) - 1];
}

std::string kind_line(const std::string& name, const std::vector<EncounterResult>& results,
                      const std::function<bool(const EncounterResult&)>& counts) {
  size_t all = 0;
  std::vector<double> depths;
  for (const EncounterResult& result : results) {
    if (!counts(result)) continue;
    ++all;
    if (result.touches()) depths.push_back(result.max_depth_m);
  }
  std::sort(depths.begin(), depths.end());
  const auto deeper = static_cast<size_t>(
      std::count_if(depths.begin(), depths.end(), [](double depth_m) { return depth_m > 0.01; }));
  return fmt::format(
      "  {:<10}{:>11}{:>8}{:>9.1f}{:>9}{:>9}{:>9}{:>9}{:>8}\n", name, all, depths.size(),
      all == 0 ? 0.0 : 100 * static_cast<double>(depths.size()) / static_cast<double>(all),
      cm(quantile(depths, 0.5)), cm(quantile(depths, 0.9)), cm(quantile(depths, 0.99)),
      cm(depths.empty() ? 0 : depths.back()), deeper);
}

std::string parts_lines(const std::vector<EncounterResult>& results) {
  std::string text;
  std::vector<std::pair<size_t, std::string>> lines;
  for (size_t group = 0; group < kGroupPairs; ++group) {
    size_t count = 0;
    double max_depth_m = 0;
    for (const EncounterResult& result : results) {
      count += result.groups[group];
      max_depth_m = std::max(max_depth_m, result.max_depth_by_group_m[group]);
    }
    if (count > 0)
      lines.emplace_back(
          count, fmt::format("  {:<18}{:>7}{:>9.1f}{:>9}\n", name_of_group_pair(group), count,
                             100 * static_cast<double>(count) / static_cast<double>(results.size()),
                             cm(max_depth_m)));
  }
  std::stable_sort(lines.begin(), lines.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& line : lines) text += line.second;
  return text;
}

std::string worst_lines(const std::vector<EncounterResult>& results,
                        const EncounterOptions& options) {
  std::vector<const EncounterResult*> worst;
  for (const EncounterResult& result : results)
    if (result.touches()) worst.push_back(&result);
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto* a, const auto* b) { return a->max_depth_m > b->max_depth_m; });
  if (worst.size() > options.worst) worst.resize(options.worst);
  std::string text;
  for (const EncounterResult* each : worst)
    text += fmt::format("  {:>6}{:>7} cm at {:.2f} s, {}: {}\n", each->number,
                        cm(each->max_depth_m), each->max_depth_s, each->max_depth_parts,
                        Encounter(options.seed, each->number).description());
  return text;
}

}  // namespace

EncounterRuns run_encounters(const EncounterOptions& options, Sink* listener,
                             const std::function<void(uint64_t)>& progress) {
  EncounterRuns out;
  const uint64_t end = options.first + options.count;
  for (uint64_t first = options.first - options.first % kTurns; first < end; first += kBatch) {
    const uint64_t batch_end = std::min(first + kBatch, end);
    std::vector<Encounter> encounters;
    for (uint64_t number = first; number < batch_end; ++number) {
      encounters.emplace_back(options.seed, number);
      if (number >= options.first)
        out.redrawn += static_cast<uint64_t>(encounters.back().rejected());
    }
    Scene scene = encounter_scene(encounters);
    set_switches(scene);
    Simulation simulation(std::move(scene),
                          {.threads = options.threads, .motion = encounter_motion(encounters)});
    EncounterWatch watch(encounters);
    std::vector<Sink*> sinks = {&watch};
    if (listener != nullptr) sinks.push_back(listener);
    run(simulation, sinks);
    for (const EncounterResult& result : watch.results()) {
      if (result.number < options.first) continue;  // simulated for its turn only
      if (result.is_sound())
        out.results.push_back(result);
      else
        out.rejected.push_back(result.number);
    }
    out.foreign_contacts += watch.foreign_contacts();
    if (progress) progress(batch_end - options.first);
  }
  return out;
}

std::string encounter_report(const EncounterRuns& runs, const EncounterOptions& options) {
  std::string text = fmt::format(
      "{} encounters of two people, seed {}; {} draws rejected because their paths broke a bound, "
      "{} because discs of {} m met after retargeting; {} contacts with other encounters\n",
      runs.results.size(), options.seed, runs.redrawn, runs.rejected.size(), Encounter::kDisc_m,
      runs.foreign_contacts);
  text += fmt::format("\n  {:<10}{:>11}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}\n", "", "encounters",
                      "touch", "%", "50 %", "90 %", "99 %", "max", "> 1 cm");
  text += fmt::format("  {:<38}{}\n", "", "deepest point of touching ones, cm");
  text += kind_line("all", runs.results, [](const EncounterResult&) { return true; });
  for (size_t kind = 0; kind < kEncounterKinds; ++kind)
    text += kind_line(name_of(static_cast<EncounterKind>(kind)), runs.results,
                      [kind](const EncounterResult& result) {
                        return result.kind == static_cast<EncounterKind>(kind);
                      });
  text += fmt::format("\n  {:<18}{:>7}{:>9}{:>9}\n", "parts", "touch", "%", "max, cm");
  text += parts_lines(runs.results);
  text += fmt::format("\n  deepest; `realism encounter NUMBER --seed {} --log FILE` runs one\n",
                      options.seed);
  return text + worst_lines(runs.results, options);
}

}  // namespace throng::realism
