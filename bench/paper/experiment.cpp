#include "bench/paper/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/paper/claims.h"

namespace throng::paper {
namespace {

/// The paper's three sizes, and on to where a grid leaves the rest behind.
constexpr std::array<size_t, 9> kSizes = {15, 50, 150, 350, 500, 1000, 2000, 5000, 10000};
/// The paper's first 100 frames.
constexpr int kFrames = 100;
constexpr int kFramesOfMany = 10;
/// Above, few frames say it all.
constexpr size_t kMany = 1000;

int frames_for(size_t objects) { return objects > kMany ? kFramesOfMany : kFrames; }

double of(uint64_t count, const Cost& cost) {
  return static_cast<double>(count) * cost.median_ns * 1e-6;
}

void fill_collisions(std::vector<VolumeResult>& volumes, const std::vector<CensusTable>& censuses) {
  const auto runs = static_cast<double>(censuses.size());
  for (size_t v = 0; v < volumes.size(); ++v) {
    VolumeResult& volume = volumes[v];
    uint64_t found = 0, wrong = 0;
    for (const CensusTable& table : censuses) {
      found += table[v].collisions[kMarks - 1];
      wrong += table[v].false_positives;
      volume.missed += table[v].missed;
      for (size_t mark = 0; mark < kMarks; ++mark)
        volume.collisions[mark] += static_cast<double>(table[v].collisions[mark]) / runs;
    }
    for (size_t mark = 0; mark < kMarks; ++mark) {
      double sum = 0;
      for (const CensusTable& table : censuses) {
        const double off = static_cast<double>(table[v].collisions[mark]) - volume.collisions[mark];
        sum += off * off;
      }
      volume.deviation[mark] = runs > 1 ? std::sqrt(sum / (runs - 1)) : 0;
    }
    volume.census = censuses.front()[v];
    volume.false_positive_rate =
        found == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(found);
  }
}

StrategyCost cost_strategy(const PaperResult& result, Strategy strategy,
                           const std::vector<Object>& objects, size_t count) {
  const VolumeResult& sphere = result.volumes[kSphereMethod];
  const VolumeResult& ordop = result.volumes[kOrdop26Method];
  StrategyCost cost;
  cost.strategy = strategy;
  cost.result = measure_strategy(strategy, objects, count, frames_for(count), result.options.seed);
  const Work& work = cost.result.work;
  cost.culling_ms =
      of(work.sphere_updates, sphere.costs.update) + of(work.sphere_tests, sphere.costs.test) +
      of(work.ordop_updates, ordop.costs.update) + of(work.ordop_tests, ordop.costs.test);
  // Volumes are fitted once a kind of object, however many objects share it.
  if (strategy != Strategy::kControl && strategy != Strategy::kOrdop)
    cost.built_ms += sphere.costs.construction_all.median_ns * 1e-6;
  if (strategy != Strategy::kControl && strategy != Strategy::kSphere)
    cost.built_ms += ordop.costs.construction_all.median_ns * 1e-6;
  cost.exact_ms = static_cast<double>(work.primitives) * result.primitive_ns * 1e-6;
  return cost;
}

}  // namespace

double VolumeResult::total_ms(int length) const { return runs_ms(census.updates, length); }

double VolumeResult::total_paper_way_ms(int length) const {
  return runs_ms(census.updates_paper(), length);
}

double VolumeResult::runs_ms(uint64_t updates, int length) const {
  // Frame 0 is tested in no run, whatever its length.
  const double runs = (static_cast<double>(length) * frames - 1) / (frames - 1);
  return runs * (of(updates, costs.update) + of(census.tests, costs.test)) +
         costs.construction_all.median_ns * 1e-6;
}

const Scale* PaperResult::scale(size_t objects_wanted) const {
  for (const Scale& each : scales)
    if (each.objects == objects_wanted) return &each;
  return nullptr;
}

double PaperResult::noise() const {
  std::vector<double> ratios;
  for (const Scale& each : scales)
    for (const StrategyCost& cost : each.strategies)
      if (cost.result.low_ms > 0) ratios.push_back(cost.result.high_ms / cost.result.low_ms);
  if (ratios.empty()) return 1;
  std::sort(ratios.begin(), ratios.end());
  return ratios[(ratios.size() - 1) / 2];
}

std::string PaperResult::frame_in_words() const {
  return fmt::format("{} updates, {} tests", objects.size(),
                     objects.size() * (objects.size() - 1) / 2);
}

double PaperResult::frame_ns(const VolumeResult& volume) const {
  const auto count = static_cast<double>(objects.size());
  return count * volume.costs.update.median_ns +
         count * (count - 1) / 2 * volume.costs.test.median_ns;
}

PaperResult run_experiments(const std::vector<Object>& objects, const PaperOptions& options,
                            const std::function<void(const std::string&)>& tell,
                            const std::function<void(const PaperResult&)>& keep) {
  PaperResult result;
  const auto finished = [&](Done stage) {
    result.done = stage;
    if (keep) keep(result);
  };
  result.options = options;
  result.edge_m = part_one_box(objects, options.seed).edge_m;
  for (const Object& object : objects) {
    result.objects.push_back(object.name);
    result.elongations.push_back(elongation(object));
  }
  for (const std::string_view name : kMethods) {
    result.volumes.emplace_back();
    result.volumes.back().name = name;
    result.volumes.back().frames = options.frames;
  }

  tell(fmt::format("Part I: collisions over {} frames, {} seeds", options.frames, options.seeds));
  Workers workers(options.threads);
  const std::vector<CensusTable> censuses =
      take_censuses(objects, options.frames, options.seed, options.seeds, workers);
  fill_collisions(result.volumes, censuses);
  const CensusTable longest =
      take_census(objects, kRunLengths.back() * options.frames, options.seed);
  for (size_t v = 0; v < result.volumes.size(); ++v)
    result.volumes[v].long_collisions = longest[v].collisions;
  finished(Done::kCollisions);

  tell("Part I: how much room volumes leave");
  const OverlapTable overlaps = measure_overlap(objects, options.attitudes, options.seed);
  for (size_t v = 0; v < result.volumes.size(); ++v) result.volumes[v].overlap = overlaps[v];
  finished(Done::kRoom);

  tell("Part I: what building, updating and testing cost");
  const auto costs = measure_costs(objects, options.frames, options.seed, options.constructions);
  for (size_t v = 0; v < result.volumes.size(); ++v) result.volumes[v].costs = costs[v];
  result.primitive_ns = costs[kExactMethod].primitive_ns;
  finished(Done::kCosts);

  for (const size_t size : kSizes) {
    if (size > options.largest) break;
    tell(fmt::format("Part II: {} objects", size));
    Scale scale{size, {}};
    for (size_t s = 0; s < kStrategies.size(); ++s)
      scale.strategies.push_back(cost_strategy(result, static_cast<Strategy>(s), objects, size));
    result.scales.push_back(std::move(scale));
    finished(Done::kCosts);
  }
  result.claims = judge(result, censuses);
  result.winners = find_winners(result.scales);
  finished(Done::kAll);
  return result;
}

}  // namespace throng::paper
