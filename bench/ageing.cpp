#include "bench/ageing.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "bench/boxes.h"
#include "bench/engines/engines.h"
#include "scenes/run/stages.h"

namespace throng::bench {
namespace {

using Clock = std::chrono::steady_clock;

double timed_ms(const std::function<void()>& work) {
  const Clock::time_point start = Clock::now();
  work();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

uint64_t work_of(const CullingCounters& c) {
  uint64_t sum = c.posed_bodies;
  for (const StageCounters* stage : culling_stages(c)) sum += stage->updates + stage->tests;
  return sum;
}

struct Pair {
  std::unique_ptr<Engine> aged, fresh;
  AgedEngine result;
  std::vector<double> aged_ms, fresh_ms;
};

}  // namespace

AgeingResult age(BenchOptions options, int walked_frames, const Progress& progress) {
  AgeingResult out;
  out.walked_frames = walked_frames;
  const std::unique_ptr<Crowd> made = make_crowd(options);
  Crowd& crowd = *made;
  crowd.simd = options.simd;
  const auto type = crowd.body_type();
  Workers workers(options.threads);
  const CullerOptions culling{.pair_search = options.pair_search, .simd = options.simd};
  Culler aged({type}, culling, workers), fresh({type}, culling, workers);
  CrowdBoxes boxes(crowd, type);
  std::vector<Pair> rivals;
  for (const EngineKind& kind : engine_kinds()) {
    const std::string name(kind.name);
    if (kind.make == nullptr ||
        std::count(options.engines.begin(), options.engines.end(), name) == 0)
      continue;
    Pair pair{kind.make(options.threads), kind.make(options.threads), {}, {}, {}};
    pair.result = {name, pair.aged->version()};
    rivals.push_back(std::move(pair));
  }
  if (!rivals.empty()) {
    const BoxList list = boxes.compute();
    for (Pair& pair : rivals) pair.aged->build(list);
  }
  for (int frame = 0; frame < walked_frames; ++frame) {
    crowd.advance();
    aged.step(crowd.view(), crowd);
    if (rivals.empty()) continue;
    const BoxList list = boxes.compute();
    for (Pair& pair : rivals) pair.aged->update(list);
    progress(fmt::format("walked {} of {} frames", frame + 1, walked_frames));
  }
  fresh.step(crowd.view(), crowd);  // grows its buffers
  for (Pair& pair : rivals) pair.fresh->build(boxes.compute());
  std::vector<double> aged_ms, fresh_ms;
  std::vector<BoxPair> found;
  for (int frame = 0; frame < options.frames; ++frame) {
    crowd.advance();
    aged_ms.push_back(timed_ms([&] { aged.step(crowd.view(), crowd); }));
    fresh_ms.push_back(timed_ms([&] { fresh.step(crowd.view(), crowd); }));
    out.aged_work += work_of(aged.counters());
    out.fresh_work += work_of(fresh.counters());
    if (rivals.empty()) continue;
    const BoxList list = boxes.compute();
    const std::vector<BoxPair> reference = reference_pairs(list);
    for (Pair& pair : rivals) {
      const auto run = [&](Engine& engine) {
        const double ms = timed_ms([&] {
          engine.update(list);
          engine.pairs(found);
        });
        std::sort(found.begin(), found.end());
        pair.result.agrees &= found == reference;
        return ms;
      };
      pair.fresh_ms.push_back(run(*pair.fresh));
      pair.aged_ms.push_back(run(*pair.aged));
    }
    progress(fmt::format("measured {} of {} frames", frame + 1, options.frames));
  }
  out.aged_ms = spread_of(aged_ms).median;
  out.fresh_ms = spread_of(fresh_ms).median;
  for (Pair& pair : rivals) {
    pair.result.aged_ms = spread_of(pair.aged_ms).median;
    pair.result.fresh_ms = spread_of(pair.fresh_ms).median;
    out.engines.push_back(std::move(pair.result));
  }
  return out;
}

}  // namespace throng::bench
