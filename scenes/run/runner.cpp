#include "scenes/run/runner.h"

#include <algorithm>
#include <cmath>

#include "base/stopwatch.h"

namespace throng {
namespace {

/// Latest samples of a stage. A day at 60 Hz has five million frames; a quarter of a million give
/// the same median.
class Samples {
 public:
  explicit Samples(int64_t expected) {
    // Written once, to take all memory from the first frame on: later growth is then a leak.
    values_.resize(static_cast<size_t>(std::min<int64_t>(expected, kMaxSamples)));
    values_.clear();
  }

  void add(double value_ms) {
    const auto value = static_cast<float>(value_ms);
    if (static_cast<int64_t>(values_.size()) < kMaxSamples)
      values_.push_back(value);
    else
      values_[next_++ % values_.size()] = value;
  }
  Quantiles quantiles() const { return quantiles_of(values_); }
  double median() const { return quantiles().median; }

 private:
  static constexpr int64_t kMaxSamples = 1 << 18;
  std::vector<float> values_;
  size_t next_ = 0;
};

struct Measurements {
  explicit Measurements(int64_t frames) : frame(frames), cull(frames), proximity(frames) {
    stages.reserve(kStageCount);  // copies lose the reserved capacity
    for (size_t i = 0; i < kStageCount; ++i) stages.emplace_back(frames);
  }

  void add(const FrameTimes& times, const CullingCounters& counters) {
    frame.add(times.frame_ns * 1e-6);
    proximity.add((counters.proximity.update_ns + counters.proximity.test_ns) * 1e-6);
    cull.add((counters.wall_ns - counters.events_ns) * 1e-6);
    for (size_t i = 0; i < kStageCount; ++i) stages[i].add(times.stage_ns[i] * 1e-6);
  }

  void summarise(RunSummary& summary) const {
    summary.frame_ms = frame.quantiles();
    summary.cull_ms = cull.quantiles();
    summary.proximity.ms = proximity.quantiles();
    for (size_t i = 0; i < kStageCount; ++i) summary.stage_ms[i] = stages[i].median();
  }

  Samples frame, cull, proximity;
  std::vector<Samples> stages;
};

void add_counters(CullingCounters& total, const CullingCounters& frame) {
  const auto totals = culling_stages(total);
  const auto stages = culling_stages(frame);
  for (size_t i = 0; i < stages.size(); ++i) {
    *totals[i] += *stages[i];
    totals[i]->volume = stages[i]->volume;
  }
  total.primitive_tests += frame.primitive_tests;
  for (size_t level = 0; level < kPairLevels; ++level) total.levels[level] += frame.levels[level];
  total.posed_bodies += frame.posed_bodies;
  total.pose_ns += frame.pose_ns;
  total.events_ns += frame.events_ns;
  total.wall_ns += frame.wall_ns;
  total.buffers_grown += frame.buffers_grown;
}

void add_proximity(ProximitySummary& proximity, const Frame& frame) {
  proximity.pairs += frame.proximity_pairs.size();
  proximity.closest_parts += frame.closest_parts.size();
  proximity.pairs_peak = std::max(proximity.pairs_peak, uint64_t{frame.proximity_pairs.size()});
  for (const ProximityRows& rows : {frame.proximity_pairs, frame.closest_parts})
    for (const ProximityPair& row : rows)
      proximity.min_distance_m = std::min(proximity.min_distance_m, row.lo_m);
}

void add_contact_points(ContactPointSummary& summary, const Frame& frame) {
  summary.points += frame.contact_points.size();
  summary.points_peak = std::max(summary.points_peak, uint64_t{frame.contact_points.size()});
  for (const ContactPoint& point : frame.contact_points)
    summary.max_depth_m = std::max(summary.max_depth_m, point.depth_m);
}

void add_frame(RunSummary& summary, const Frame& frame, bool exact,
               const SteeringCounters& steering) {
  summary.persists += frame.persisting;
  const auto last = static_cast<uint8_t>(exact ? PairLevel::kTriangles : PairLevel::kPartVolume);
  const auto undecided = [last](uint8_t level) { return level < last; };
  summary.frames_cut += std::any_of(frame.levels.begin(), frame.levels.end(), undecided);
  summary.pairs_peak = std::max(summary.pairs_peak, uint64_t{frame.pairs.size()});
  summary.max_overlap_m = std::max(summary.max_overlap_m, steering.max_overlap_m);
  summary.queuing_peak = std::max(summary.queuing_peak, steering.queuing);
  summary.longest_stall_s = std::max(summary.longest_stall_s, steering.longest_stall_s);
  add_counters(summary.totals, *frame.counters);
  if (summary.proximity.is_enabled) add_proximity(summary.proximity, frame);
  if (summary.contact_points.is_enabled) add_contact_points(summary.contact_points, frame);
}

RunSummary describe(const Simulation& simulation) {
  const RunInfo& info = simulation.info();
  RunSummary summary;
  summary.avatars = info.avatar_count();
  summary.unplaced = simulation.unplaced();
  summary.run_id = info.run_id;
  summary.proximity.is_enabled = info.culler.proximity.is_enabled();
  summary.contact_points.is_enabled = info.culler.proximity.contact_points;
  summary.proximity.min_distance_m = info.culler.proximity.max_margin_m();
  for (const uint16_t model : info.model_of_avatar)
    summary.parts += info.models[model]->part_count();
  return summary;
}

}  // namespace

Quantiles quantiles_of(std::vector<float> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto at = [&](double share) {
    const double rank = std::ceil(share * static_cast<double>(samples.size())) - 1;
    return static_cast<double>(samples[static_cast<size_t>(std::max(0.0, rank))]);
  };
  return {at(0.5), at(0.95), static_cast<double>(samples.back())};
}

int64_t frame_count(double duration_s, double step_s) {
  return std::max<int64_t>(1, std::llround(duration_s / step_s));
}

RunSummary run(Simulation& simulation, std::span<Sink* const> sinks,
               const std::function<bool(const Frame&)>& keep_going) {
  const RunInfo& info = simulation.info();
  const int64_t frames = frame_count(simulation.scene().duration_s, info.step_s);
  RunSummary summary = describe(simulation);
  Measurements measurements(frames);
  simulation.serve(sinks);
  for (Sink* sink : sinks) sink->begin(info);
  const Stopwatch watch;
  FrameTimes& times = simulation.times();
  while (simulation.next_frame() < frames && !summary.stopped_early) {
    const Stopwatch frame_watch;
    const Frame& frame = simulation.step();
    const Stopwatch publish_watch;
    for (Sink* sink : sinks) sink->frame(info, frame);
    times[Stage::kPublish] = publish_watch.ns();
    times.frame_ns = frame_watch.ns();
    measurements.add(times, *frame.counters);
    add_frame(summary, frame, info.culler.exact, simulation.steering());
    ++summary.frames;
    summary.stopped_early = keep_going && !keep_going(frame) && simulation.next_frame() < frames;
  }
  summary.steering = simulation.steering();
  const RunEnd end = simulation.finish();
  for (Sink* sink : sinks) sink->end(info, end);
  summary.wall_s = watch.ns() * 1e-9;
  summary.simulated_s = static_cast<double>(summary.frames) * info.step_s;
  summary.realtime_factor = summary.wall_s > 0 ? summary.simulated_s / summary.wall_s : 0;
  summary.begins = end.begins;
  summary.ends = end.ends;
  summary.hash = end.hash;
  summary.proximity.hash = end.proximity_hash;
  summary.population = simulation.population();
  summary.strandings = simulation.strandings();
  measurements.summarise(summary);
  return summary;
}

}  // namespace throng
