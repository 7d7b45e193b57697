// All of the paper's experiments, run once, and what they say about its claims.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/paper/census.h"
#include "bench/paper/methods.h"
#include "bench/paper/strategies.h"
#include "bench/workbench/repeat.h"

namespace throng::paper {

// C_o, C_u and C_v, each measured on its own.
// Inputs come in random order and never repeat within a repetition, so that no branch is
// learned; a cost is a median over repetitions, with its spread.

using bench::Cost;
using bench::cost_of;

/// The paper's 500, 1000 and 5000 frames, as multiples of the first.
inline constexpr std::array<int, 3> kRunLengths = {1, 2, 10};

struct MethodCosts {
  std::vector<Cost> construction;  ///< by object
  Cost construction_all;           ///< C_o: all objects once
  Cost update;                     ///< C_u
  Cost test;                       ///< C_v
  double primitive_ns = 0;         ///< C_p: exact only, a test of two boxes or triangles
  std::array<double, kRunLengths.size()>
      run_ms{};  ///< whole runs by the thread's clock, construction apart
};

/// `frames` frames of Part I feed C_u and C_v; each volume is built `constructions` times.
std::array<MethodCosts, kMethods.size()> measure_costs(const std::vector<Object>& objects,
                                                       int frames, uint64_t seed,
                                                       int constructions);

// How much room two objects have in which a volume says that they collide: what orders the volumes,
// whatever box the objects fly in and however fast.
// Every method judges the same random attitudes and places, so that differences between
// methods are not chance.

/// The volume of all places of one object's origin at which it overlaps another, mean over pairs of
/// different objects in random attitudes: of two convex volumes that is the volume of their
/// Minkowski sum, and what the chance to collide is proportional to.
struct OverlapVolume {
  double litres = 0;
  double error_l = 0;               ///< standard error over independent batches of attitudes
  std::vector<double> by_object_l;  ///< mean over its partners
};

using OverlapTable = std::array<OverlapVolume, kMethods.size()>;

/// Monte Carlo with `attitudes` pairs of attitudes a pair of objects (at least 10), 100 places
/// each.
OverlapTable measure_overlap(const std::vector<Object>& objects, int attitudes, uint64_t seed);

/// Longest over shortest side of the box around an object's points in its own frame.
double elongation(const Object& object);

/// All of the paper's experiments, run once, and what they say about its claims.
/// Counts depend on the seed alone; times are this machine's, and no claim about counts
/// rests on one.
struct PaperOptions {
  std::string model = {};  ///< a URDF instead of the bundled adult's
  int frames = 500;        ///< of Part I; a multiple of 5
  uint64_t seed = 1;
  int seeds = 1;                ///< seed, seed + 1, ... for the collisions
  int threads = 1;              ///< over seeds; nothing that is timed
  int constructions = 100;      ///< repetitions of what C_o measures, as many as the paper's
  int attitudes = 100;          ///< pairs of attitudes a pair of objects, for the overlap volumes
  size_t max_objects = 10'000;  ///< objects of Part II; at least 500
};

/// A volume under an update rule, in Part I.
struct VolumeResult {
  std::string name;
  int frames = 0;
  std::array<double, kMarks> collisions{};         ///< mean over the seeds
  std::array<double, kMarks> deviation{};          ///< standard deviation over the seeds
  Census census;                                   ///< of the first seed
  std::array<uint64_t, kMarks> long_collisions{};  ///< ten times the frames, first seed
  MethodCosts costs;
  double false_positive_rate = 0;  ///< of the pairs found, over all seeds, those that do not touch
  uint64_t missed = 0;             ///< over all seeds
  OverlapVolume overlap;           ///< what orders the collisions, measured without any box

  /// N_u C_u + N_v C_v + C_o for `length` times the frames.
  double total_ms(int length = 1) const;
  /// The same with two updates a test, as the paper counts.
  double total_paper_count_ms(int length = 1) const;

 private:
  double runs_ms(uint64_t updates, int length) const;
};

/// A strategy of Part II with its cost by the formula, milliseconds over all frames.
struct StrategyCost {
  Strategy strategy = Strategy::kControl;
  StrategyResult result;
  double culling_ms = 0;  ///< N_u C_u + N_v C_v
  double built_ms = 0;    ///< C_o
  double exact_ms = 0;    ///< N_p C_p of the pairs reported

  std::string name() const { return std::string(kStrategies[static_cast<size_t>(strategy)]); }
  double total_ms() const { return culling_ms + built_ms; }
};

/// All strategies at one number of objects.
struct Scale {
  size_t objects = 0;
  std::vector<StrategyCost> strategies;  ///< in the order of kStrategies
};

/// A statement of the paper that our numbers support or not.
struct Claim {
  std::string about;  ///< "Table 2", "Fig. 13, counted", ...
  std::string left, right;
  double left_value = 0, right_value = 0;
  std::string relation;  ///< ">" or ">="
  double share = 0;      ///< of the seeds in which it holds; 0 or 1 where there is one number
  bool holds = false;    ///< in the mean
};

/// From this many objects on, this strategy is the cheapest that looks at all pairs.
struct Winner {
  std::string measure;  ///< "culling, counted", "with triangles, counted", "culling, measured"
  size_t objects = 0;
  std::string strategy;
};

/// How far the experiments came. What comes later is not there yet.
enum class CompletedStage { kNothing, kCollisions, kOverlapVolumes, kCosts, kAll };

struct PaperResult {
  CompletedStage done = CompletedStage::kNothing;
  PaperOptions options;
  double edge_m = 0;
  std::vector<std::string> objects;
  std::vector<double> elongations;    ///< of the objects
  std::vector<VolumeResult> volumes;  ///< in the order of kMethods
  std::vector<Scale> scales;
  std::vector<Claim> claims;
  std::vector<Winner> winners;
  double primitive_ns = 0;  ///< C_p

  const Scale* scale(size_t objects) const;
  /// How much slower the slowest tenth of all runs of a strategy was than the fastest tenth, the
  /// median over strategies and sizes: 1.0 on a machine that does nothing else.
  double noise() const;
  /// "15 updates, 105 tests": what a frame of Part I takes.
  std::string frame_in_words() const;
  double frame_ns(const VolumeResult& volume) const;
};

/// `tell` hears what comes next; `keep` gets the result so far whenever a stage of it is finished.
PaperResult run_experiments(const std::vector<Object>& objects, const PaperOptions& options,
                            const std::function<void(const std::string&)>& announce,
                            const std::function<void(const PaperResult&)>& keep = {});

// Which of the paper's orders our numbers support, and where one strategy overtakes another.
// Every statement is listed with its two numbers, also where it fails.

/// Table 2's order for each k and update rule, Table 3's cheapest volumes, and Fig. 13's in counted
/// work and in frame rates.
std::vector<Claim> judge(const PaperResult& result, std::span<const CensusTable> censuses);

/// The cheapest strategy by size, three ways; one entry wherever it changes.
std::vector<Winner> find_winners(std::span<const Scale> scales);

}  // namespace throng::paper
