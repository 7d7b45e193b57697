// Comparison of Throng with other engines on the same frames, fresh and aged.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/crowd.h"
#include "bench/workbench/volume_trials.h"

namespace throng::bench {

/// Statistics of repeated times. No mean, because the noise of a machine is one-sided.
struct TimeStats {
  double min = 0, median = 0, p95 = 0;
};

/// Returns all zeros without values.
TimeStats time_stats_of(std::vector<double> values);

// Invariant: an engine whose pairs differ from the reference in any frame gets agrees = false.

enum class CrowdKind { kSquare, kPlaza };

struct BenchOptions {
  CrowdKind crowd = CrowdKind::kSquare;
  int avatars = 20'000;  ///< for the plaza: the number that found a place, set by make_crowd()
  double per_m2 = 1;
  int frames = 20;
  int warm_up_frames = 3;
  int threads = 1;
  uint64_t seed = 1;
  SimdTarget simd = SimdTarget::kBest;
  PairSearch pair_search = PairSearch::kGrid;
  std::string model{};                 ///< URDF file; empty: the bundled adult
  std::vector<std::string> engines{};  ///< names of engine_kinds(); empty: Throng alone
};

/// Counts and time of a stage of Throng's pass, medians over the frames.
struct StageRow {
  std::string stage, volume;
  uint64_t updates = 0, tests = 0, passed = 0;
  double ms = 0;  ///< summed over threads
};

struct ThrongResult {
  TimeStats ms;            ///< the whole pass, from spheres to or-DOP 26 pairs and events
  TimeStats boxes_ms;      ///< without or-DOP tests and events, for comparison with boxes only
  uint64_t pairs = 0;      ///< or-DOP pairs of the last frame
  uint64_t box_pairs = 0;  ///< pairs of Throng's part boxes in the last frame
  uint64_t hash = 0;
  std::string simd;
  std::vector<StageRow> stages;
};

/// A quarter of the frames. People start in a jittered square and mix while walking: pairs and all
/// times grow before they settle, which one median would hide.
struct Quarter {
  int first = 0, last = 0;       ///< frames, from 1
  uint64_t pairs = 0;            ///< or-DOP pairs of the last frame of the quarter
  double ms = 0;                 ///< median of Throng's whole pass
  std::vector<double> ratios{};  ///< median ratio of each engine, in engine order
};

struct EngineResult {
  std::string name{}, version{}, what{};
  TimeStats ms;
  uint64_t pairs = 0;  ///< box pairs of the last frame
  bool agrees = true;
  /// Median over frames of the engine's time divided by Throng's time in the same frame.
  double ratio = 0, ratio_boxes = 0;
};

struct Skipped {
  std::string name, reason;
};

struct BenchResult {
  BenchOptions options;
  ThrongResult throng;
  std::vector<EngineResult> engines;
  std::vector<Skipped> skipped;
  std::vector<Quarter> quarters;  ///< empty for fewer than four frames
  uint64_t reference_pairs = 0;   ///< box pairs of the last frame by the reference

  /// Returns the ratio of the fastest agreeing engine, and that of FCL; 0 without one.
  double ratio_fastest() const;
  double ratio_fcl() const;
};

/// Creates the crowd of the options; sets avatars and per_m2 to those of the plaza.
std::unique_ptr<Crowd> make_crowd(BenchOptions& options);

/// Runs Throng and then each engine in every frame: noise affects all alike. Ends after a frame if
/// `stop` returns true (empty: never). options.frames of the result counts the measured frames.
BenchResult compare(const BenchOptions& options, const Progress& progress,
                    const std::function<bool()>& stop = {});

/// Compares structures that followed a walking crowd with fresh ones, on the same frames.
/// For Throng, the counted work is also compared.
struct AgedEngine {
  std::string name, version;
  double fresh_ms = 0, aged_ms = 0;  ///< medians over options.frames frames
  bool agrees = true;
};

struct AgeingResult {
  int walked_frames = 0;
  uint64_t fresh_work = 0, aged_work = 0;  ///< Throng's updates and tests of all stages and frames
  double fresh_ms = 0, aged_ms = 0;
  std::vector<AgedEngine> engines;
};

/// Lets the crowd walk for `walked_frames` frames, then measures options.frames frames.
AgeingResult age(BenchOptions options, int walked_frames, const Progress& progress);

}  // namespace throng::bench
