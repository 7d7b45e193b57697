// Runs a simulation to its end, feeds the sinks, and sums up what it cost and found.
// One rule: the summary holds everything that `throng run` prints or writes as JSON about the run
// itself; what is measured never reaches a result.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"

namespace throng {

struct Quantiles {
  double median = 0;
  double p95 = 0;
  double max = 0;
};

/// Distances, where a margin is asked.
struct ProximitySummary {
  bool is_enabled = false;
  uint64_t pairs = 0;        ///< rows over all frames, as the next
  uint64_t people = 0;       ///< of two people
  uint64_t pairs_peak = 0;   ///< rows of a frame
  float min_distance_m = 0;  ///< the least lower bound of all
  Quantiles ms;              ///< the search, by the clock; of contact points, too
  uint64_t hash = 0;
};

/// Where parts touch, where that is asked.
struct ContactPointSummary {
  bool is_enabled = false;
  uint64_t points = 0;       ///< over all frames
  uint64_t points_peak = 0;  ///< of a frame
  float max_depth_m = 0;
};

struct RunSummary {
  int64_t frames = 0;  ///< of this run; a resumed one has fewer than its duration
  int avatars = 0;
  int unplaced = 0;
  int64_t parts = 0;       ///< of all avatars together
  double simulated_s = 0;  ///< frames x step
  double wall_s = 0;       ///< from the first step to the last sink's end
  double realtime_factor = 0;
  bool stopped_early = false;  ///< keep_going() said no

  Quantiles frame_ms;
  Quantiles cull_ms;  ///< the culling pass: spheres, kinematics of survivors, to sorted pairs
  std::array<double, kStageCount> stage_ms{};  ///< medians, by Stage
  CullingCounters totals;                      ///< N and ns of every stage, summed over the frames

  uint64_t begins = 0;  ///< as ends and the hash, of the whole run, also of a resumed one
  uint64_t persists = 0;
  uint64_t ends = 0;  ///< those of the last moment included
  uint64_t pairs_peak = 0;
  ProximitySummary proximity;
  ContactPointSummary contact_points;
  int64_t frames_cut = 0;  ///< in which a deadline left pairs undecided
  uint64_t hash = 0;
  uint64_t run_id = 0;

  PopulationCounters population;      ///< at the end
  std::vector<Stranding> strandings;  ///< at the end
  uint64_t queuing_peak = 0;          ///< people queuing at once
  double max_overlap_m = 0;           ///< of steering discs, over the run
  double longest_stall_s = 0;  ///< how long a walker stood still without queuing, over the run
  SteeringCounters steering;   ///< at the end
};

/// Quantiles of samples by sorting; the median of an even number is the lower one. Zeros if empty.
Quantiles quantiles_of(std::vector<float> samples);

/// Frames a run of this length has: one at the start, then one a step; at least one.
int64_t frame_count(double duration_s, double step_s);

/// Calls begin() on every sink, then steps until scene().duration_s or until keep_going() says no,
/// then end(). keep_going is called after each frame was published (and may wait, to pace the run:
/// that time counts as wall_s, not as the frame's); empty means always.
RunSummary run(Simulation& simulation, std::span<Sink* const> sinks,
               const std::function<bool(const Frame&)>& keep_going = {});

}  // namespace throng
