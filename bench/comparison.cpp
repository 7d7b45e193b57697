#include "bench/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/errors.h"
#include "bench/crowd.h"
#include "bench/engines/engine.h"
#include "scenes/file/scene.h"
#include "scenes/run/simulation.h"
#include "scenes/run/stages.h"

namespace throng::bench {

TimeStats time_stats_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  const size_t middle = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return {values.front(), median, values[static_cast<size_t>(std::ceil(0.95 * last))]};
}

namespace {

// The bench crowd with steering: the people of the bundled scene `plaza`, who avoid each other and
// walk as in `throng run plaza`. Obstacles are omitted, because the other engines get people only.

class PlazaCrowd : public Crowd {
 public:
  /// Creates `avatars` people on a square enlarged as by --avatars; fewer if not all find a place.
  PlazaCrowd(int avatars, uint64_t seed, int threads);

  void advance() override;
  double per_m2() const { return per_m2_; }

 private:
  explicit PlazaCrowd(std::unique_ptr<Simulation> simulation);
  void take(const Frame& frame);

  std::unique_ptr<Simulation> simulation_;
  std::vector<RootPose> before_;
  double per_m2_ = 0;
};

std::unique_ptr<Simulation> simulation_of(int avatars, uint64_t seed, int threads) {
  Scene scene = load_scene("plaza");
  scene.seed = seed;
  std::vector<std::string> notes;
  scale_to(scene, avatars, notes);
  SimulationOptions options;
  options.threads = threads;
  options.postures = false;
  return std::make_unique<Simulation>(std::move(scene), options);
}

PlazaCrowd::PlazaCrowd(int avatars, uint64_t seed, int threads)
    : PlazaCrowd(simulation_of(avatars, seed, threads)) {}

PlazaCrowd::PlazaCrowd(std::unique_ptr<Simulation> simulation)
    : Crowd(simulation->info().models.front(),
            {.avatars = simulation->info().avatar_count(), .seed = simulation->scene().seed}),
      simulation_(std::move(simulation)) {
  if (simulation_->info().models.size() != 1)
    throw InputError("plaza", "one model for all people", "several");
  scales_ = simulation_->info().scale_of_avatar;
  per_m2_ = count() / ground_area_m2(simulation_->scene());
  take(simulation_->step());
}

void PlazaCrowd::advance() {
  before_ = roots_;
  take(simulation_->step());
  for (size_t i = 0; i < roots_.size(); ++i) {
    const auto walked_m = static_cast<float>((roots_[i].position_m - before_[i].position_m).norm());
    const float phase = phases_[i] + walked_m / gait_.stride_length_m(speeds_[i], scales_[i]);
    phases_[i] = phase - std::floor(phase);
    if (phases_[i] >= 1) phases_[i] = 0;
  }
}

void PlazaCrowd::take(const Frame& frame) {
  roots_.assign(frame.roots.begin(), frame.roots.end());
  speeds_.assign(frame.speeds_mps.begin(), frame.speeds_mps.begin() + count());
}

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct StageSeries {
  StageRow row;
  std::vector<double> ms;
};

class StageTable {
 public:
  void add(const CullingCounters& c, int threads) {
    next_ = 0;
    put("spheres over avatars", c.body_sphere, c.body_sphere.update_ns + c.body_sphere.test_ns);
    put("kinematics", {"", c.posed_bodies, 0, 0, 0, 0}, c.pose_ns);
    put("avatar boxes", c.body_box, c.body_box.test_ns);
    put("part boxes", c.part_box, c.part_box.update_ns + c.part_box.test_ns);
    put("part volumes", c.part_volume, c.part_volume.test_ns);
    put("sort and events", {"", 0, 0, c.part_volume.passed, 0, 0}, c.events_ns);
    double stages_ns = 0;  // the update of the parts is part of kinematics
    for (const StageCounters* stage : culling_stages(c))
      stages_ns += stage->update_ns + stage->test_ns;
    if (threads == 1) put("rest", {}, std::max(0.0, c.wall_ns - c.events_ns - stages_ns));
  }
  std::vector<StageRow> rows() const {
    std::vector<StageRow> out;
    for (const StageSeries& series : stages_) {
      out.push_back(series.row);
      out.back().ms = time_stats_of(series.ms).median;
    }
    return out;
  }

 private:
  void put(const char* name, const StageCounters& counters, double ns) {
    if (next_ == stages_.size()) stages_.emplace_back();
    StageSeries& series = stages_[next_++];
    series.row = {
        name, std::string(counters.volume), counters.updates, counters.tests, counters.passed, 0};
    series.ms.push_back(ns * 1e-6);
  }
  std::vector<StageSeries> stages_;
  size_t next_ = 0;
};

struct Contender {
  std::unique_ptr<Engine> engine;
  EngineResult result;
  std::vector<double> ms, ratios, ratios_boxes;
};

std::vector<Contender> contenders(const BenchOptions& options, std::vector<Skipped>& skipped) {
  std::vector<Contender> out;
  for (const EngineKind& kind : engine_kinds()) {
    const std::string name(kind.name);
    if (std::find(options.engines.begin(), options.engines.end(), name) == options.engines.end()) {
      skipped.push_back({name, kind.make ? "not requested" : std::string(kind.missing)});
    } else if (kind.make == nullptr) {
      skipped.push_back({name, std::string(kind.missing)});
    } else {
      Contender contender;
      contender.engine = kind.make(options.threads);
      contender.result.name = contender.engine->name();
      contender.result.version = contender.engine->version();
      contender.result.what = contender.engine->what();
      out.push_back(std::move(contender));
    }
  }
  return out;
}

/// Times one frame of one engine; its pairs are compared outside of that time.
double run_frame(Contender& contender, const BoxList& boxes, bool first,
                 const std::vector<BoxPair>& reference, std::vector<BoxPair>& found) {
  const Clock::time_point start = Clock::now();
  if (first)
    contender.engine->build(boxes);
  else
    contender.engine->update(boxes);
  contender.engine->pairs(found);
  const double ms = ms_since(start);
  std::sort(found.begin(), found.end());
  contender.result.agrees &= found == reference;
  contender.result.pairs = found.size();
  return ms;
}

std::vector<Quarter> quarters_of(const std::vector<double>& throng_ms,
                                 const std::vector<uint64_t>& pairs,
                                 const std::vector<Contender>& rivals) {
  std::vector<Quarter> out;
  const size_t frames = throng_ms.size();
  if (frames < 4) return out;
  for (size_t quarter = 0; quarter < 4; ++quarter) {
    const size_t first = quarter * frames / 4, end = (quarter + 1) * frames / 4;
    const auto median = [&](const std::vector<double>& values) {
      const auto begin = values.begin();
      return time_stats_of(
                 {begin + static_cast<ptrdiff_t>(first), begin + static_cast<ptrdiff_t>(end)})
          .median;
    };
    out.push_back(
        {static_cast<int>(first) + 1, static_cast<int>(end), pairs[end - 1], median(throng_ms)});
    for (const Contender& rival : rivals) out.back().ratios.push_back(median(rival.ratios));
  }
  return out;
}

}  // namespace

std::unique_ptr<Crowd> make_crowd(BenchOptions& options) {
  if (options.crowd == CrowdKind::kSquare)
    return std::make_unique<Crowd>(
        load_model(options.model.empty() ? adult_urdf() : std::filesystem::path(options.model)),
        CrowdShape{.avatars = options.avatars, .per_m2 = options.per_m2, .seed = options.seed});
  auto plaza = std::make_unique<PlazaCrowd>(options.avatars, options.seed, options.threads);
  options.avatars = plaza->count();
  options.per_m2 = plaza->per_m2();
  return plaza;
}

BenchResult compare(const BenchOptions& options, const Progress& progress,
                    const std::function<bool()>& stop) {
  BenchResult out;
  out.options = options;
  const std::unique_ptr<Crowd> made = make_crowd(out.options);
  Crowd& crowd = *made;
  crowd.simd = options.simd;
  const auto type = crowd.body_type();
  Workers workers(options.threads);
  Culler culler({type},
                {.pair_search = options.pair_search, .simd = options.simd, .check_spheres = false},
                workers);
  CrowdBoxes crowd_boxes(crowd, type);
  std::vector<Contender> rivals = contenders(options, out.skipped);
  StageTable stages;
  std::vector<double> throng_ms, throng_boxes_ms;
  std::vector<uint64_t> pairs;
  std::vector<BoxPair> found;
  for (int frame = -options.warm_up_frames; frame < options.frames; ++frame) {
    if (stop && stop()) break;
    crowd.advance();
    const Clock::time_point start = Clock::now();
    culler.step(crowd.view(), crowd);
    const double ms = ms_since(start);
    const CullingCounters& c = culler.counters();
    const double boxes_ms = ms - (c.part_volume.test_ns / options.threads + c.events_ns) * 1e-6;
    if (frame >= 0) {
      throng_ms.push_back(ms);
      pairs.push_back(culler.pairs().size());
      throng_boxes_ms.push_back(boxes_ms);
      stages.add(c, options.threads);
    }
    if (rivals.empty()) continue;
    const BoxList boxes = crowd_boxes.compute();
    const std::vector<BoxPair> reference = reference_pairs(boxes);
    out.reference_pairs = reference.size();
    for (size_t i = 0; i < rivals.size(); ++i) {
      // Rotates the order: no engine always runs with the caches that the same other engine left.
      Contender& rival =
          rivals[(i + static_cast<size_t>(frame + options.warm_up_frames)) % rivals.size()];
      const double rival_ms =
          run_frame(rival, boxes, frame == -options.warm_up_frames, reference, found);
      if (frame < 0) continue;
      rival.ms.push_back(rival_ms);
      rival.ratios.push_back(rival_ms / ms);
      rival.ratios_boxes.push_back(rival_ms / boxes_ms);
    }
    progress(fmt::format("frame {} of {}", frame + 1, options.frames));
  }
  out.options.frames = static_cast<int>(throng_ms.size());
  out.throng = {.ms = time_stats_of(throng_ms),
                .boxes_ms = time_stats_of(throng_boxes_ms),
                .pairs = culler.pairs().size(),
                .box_pairs = culler.counters().part_box.passed,
                .hash = culler.hash(),
                .simd = std::string(name_of(resolved(options.simd))),
                .stages = stages.rows()};
  out.quarters = quarters_of(throng_ms, pairs, rivals);
  for (Contender& rival : rivals) {
    rival.result.ms = time_stats_of(rival.ms);
    rival.result.ratio = time_stats_of(rival.ratios).median;
    rival.result.ratio_boxes = time_stats_of(rival.ratios_boxes).median;
    out.engines.push_back(std::move(rival.result));
  }
  return out;
}

double BenchResult::ratio_fastest() const {
  const EngineResult* best = nullptr;
  for (const EngineResult& engine : engines)
    if (engine.agrees && (best == nullptr || engine.ms.median < best->ms.median)) best = &engine;
  return best == nullptr ? 0 : best->ratio;
}

double BenchResult::ratio_fcl() const {
  for (const EngineResult& engine : engines)
    if (engine.name == "fcl" && engine.agrees) return engine.ratio;
  return 0;
}

namespace {

double timed_ms(const std::function<void()>& work) {
  const Clock::time_point start = Clock::now();
  work();
  return ms_since(start);
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
  const CullerOptions culling{
      .pair_search = options.pair_search, .simd = options.simd, .check_spheres = false};
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
  out.aged_ms = time_stats_of(aged_ms).median;
  out.fresh_ms = time_stats_of(fresh_ms).median;
  for (Pair& pair : rivals) {
    pair.result.aged_ms = time_stats_of(pair.aged_ms).median;
    pair.result.fresh_ms = time_stats_of(pair.fresh_ms).median;
    out.engines.push_back(std::move(pair.result));
  }
  return out;
}

}  // namespace throng::bench
