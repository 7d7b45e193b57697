// Throng and the other engines on the same frames; and on frames to which they have aged.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/crowd.h"
#include "bench/workbench/volume_trials.h"

namespace throng::bench {

/// What is reported of repeated times: the least, the middle and the nearly worst.
/// No mean; a machine's noise is one-sided.
struct TimeStats {
  double min = 0, median = 0, p95 = 0;
};

/// All zero for no values.
TimeStats time_stats_of(std::vector<double> values);

// Throng and the other engines on the same frames.
// An engine whose pairs differ from the reference's in any frame gets agrees = false.

enum class CrowdKind { kSquare, kPlaza };

struct BenchOptions {
  CrowdKind crowd = CrowdKind::kSquare;
  int avatars = 20'000;  ///< of the plaza those who found a place, once it was made
  double per_m2 = 1;
  int frames = 20;
  int warm_up_frames = 3;
  int threads = 1;
  uint64_t seed = 1;
  SimdTarget simd = SimdTarget::kBest;
  PairSearch pair_search = PairSearch::kGrid;
  std::string model{};                 ///< a URDF instead of the bundled adult's
  std::vector<std::string> engines{};  ///< names of engine_kinds(); empty: ours alone
};

/// What a stage of our pass counted and took, medians over the frames.
struct StageRow {
  std::string stage, volume;
  uint64_t updates = 0, tests = 0, passed = 0;
  double ms = 0;  ///< summed over threads
};

struct ThrongResult {
  TimeStats ms;        ///< the whole pass: spheres placed to or-DOP 26 pairs and begin/end events
  TimeStats boxes_ms;  ///< the same less or-DOP tests and events: comparable with boxes only
  uint64_t pairs = 0;  ///< or-DOP pairs of the last frame
  uint64_t box_pairs = 0;  ///< pairs of our own part boxes in the last frame
  uint64_t hash = 0;
  std::string simd;
  std::vector<StageRow> stages;
};

/// A quarter of the frames. People start in a jittered square and mix as they walk on, so pairs and
/// everybody's times grow before they settle: a median over all says only half of it.
struct Quarter {
  int first = 0, last = 0;       ///< frames, from 1
  uint64_t pairs = 0;            ///< or-DOP pairs of its last frame
  double ms = 0;                 ///< median of our whole pass
  std::vector<double> ratios{};  ///< median of each engine's, in the order of the engines
};

struct EngineResult {
  std::string name{}, version{}, what{};
  TimeStats ms;
  uint64_t pairs = 0;  ///< box pairs of the last frame
  bool agrees = true;
  /// Median over frames of its time divided by ours in the same frame.
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
  std::vector<Quarter> quarters;  ///< none for fewer than four frames
  uint64_t reference_pairs = 0;   ///< box pairs of the last frame, by the slow reference

  /// Ratio to the engine with the least median that agrees, and to FCL; 0 without one.
  double ratio_fastest() const;
  double ratio_fcl() const;
};

/// The crowd that the options ask for; sets avatars and per_m2 to what the plaza has.
std::unique_ptr<Crowd> make_crowd(BenchOptions& options);

/// In each frame ours runs, then each engine, so that noise hits all of them alike. Ends after a
/// frame if `stop` says so (empty: never); options.frames of the result are those that were
/// measured.
BenchResult compare(const BenchOptions& options, const Progress& progress,
                    const std::function<bool()>& stop = {});

/// Whether a structure that followed a walking crowd is as good as a fresh one.
/// Aged and fresh are compared on the same frames, ours by counted work as well.
struct AgedEngine {
  std::string name, version;
  double fresh_ms = 0, aged_ms = 0;  ///< medians over options.frames frames
  bool agrees = true;
};

struct AgeingResult {
  int walked_frames = 0;
  uint64_t fresh_work = 0, aged_work = 0;  ///< our updates and tests of every stage, all frames
  double fresh_ms = 0, aged_ms = 0;
  std::vector<AgedEngine> engines;
};

/// Everybody walks `walked_frames` frames; then options.frames frames are measured.
AgeingResult age(BenchOptions options, int walked_frames, const Progress& progress);

}  // namespace throng::bench
