// run() runs a simulation to its end, feeds the sinks, and returns a summary of cost and results.
// Invariant: the summary holds all that `throng run` prints about the run itself; measured times
// never affect a result.
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

struct ProximitySummary {
  bool is_enabled = false;
  uint64_t pairs = 0;          ///< number of rows of parts over all frames
  uint64_t closest_parts = 0;  ///< number of rows of closest parts over all frames
  uint64_t pairs_peak = 0;     ///< maximum number of rows of parts in a frame
  float min_distance_m = 0;    ///< least lower bound over all rows
  Quantiles ms;                ///< wall-clock time of the search, including contact points
  uint64_t hash = 0;
};

struct ContactPointSummary {
  bool is_enabled = false;
  uint64_t points = 0;
  uint64_t points_peak = 0;
  float max_depth_m = 0;
};

struct RunSummary {
  int64_t frames = 0;  ///< frames of this process; a resumed run counts from its checkpoint on
  int avatars = 0;
  int unplaced = 0;
  int64_t parts = 0;  ///< number of parts of all avatars
  double simulated_s = 0;
  double wall_s = 0;  ///< time from the first step to the end of the last sink
  double realtime_factor = 0;
  bool stopped_early = false;

  Quantiles frame_ms;
  Quantiles cull_ms;  ///< culling pass: spheres, kinematics of survivors, tests, sorted pairs
  std::array<double, kStageCount> stage_ms{};
  CullingCounters totals;  ///< tests and nanoseconds of every stage, summed over the frames

  uint64_t begins = 0;  ///< begins, ends and hash cover the whole run, also after a resume
  uint64_t persists = 0;
  uint64_t ends = 0;  ///< includes the ends at the end of the run
  uint64_t pairs_peak = 0;
  ProximitySummary proximity;
  ContactPointSummary contact_points;
  int64_t frames_cut = 0;  ///< frames in which the budget left pairs undecided
  uint64_t hash = 0;
  uint64_t run_id = 0;

  PopulationCounters population;
  std::vector<Stranding> strandings;
  uint64_t queuing_peak = 0;   ///< largest number of agents in queues at once
  double max_overlap_m = 0;    ///< largest overlap of steering discs over the run
  double longest_stall_s = 0;  ///< longest time that an agent stood still without queueing
  SteeringCounters steering;
};

/// Quantiles of samples by sorting. The median of an even number is the lower middle value; all are
/// 0 if empty.
Quantiles quantiles_of(std::vector<float> samples);

/// Number of frames of a run: one at the start, then one per step; at least one.
int64_t frame_count(double duration_s, double step_s);

/// Calls begin() on every sink, steps until scene().duration_s or until keep_going() returns false,
/// then calls end(). An empty keep_going always continues. It is called after each published frame
/// and may wait to pace the run; its time counts as wall_s, not as the frame's.
RunSummary run(Simulation& simulation, std::span<Sink* const> sinks,
               const std::function<bool(const Frame&)>& keep_going = {});

}  // namespace throng
