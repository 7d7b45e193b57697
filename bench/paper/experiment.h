// All of the paper's experiments, run once, and what they say about its claims.
// One rule: counts depend on the seed alone; times are this machine's, and no claim about counts
// rests on one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/paper/census.h"
#include "bench/paper/costs.h"
#include "bench/paper/overlap.h"
#include "bench/paper/strategies.h"

namespace throng::paper {

struct PaperOptions {
  std::string model = {};  ///< a URDF instead of the bundled adult's
  int frames = 500;        ///< of Part I; a multiple of 5
  uint64_t seed = 1;
  int seeds = 1;            ///< seed, seed + 1, ... for the collisions
  int threads = 1;          ///< over seeds; nothing that is timed
  int constructions = 100;  ///< repetitions of what C_o measures, as many as the paper's
  int attitudes = 100;      ///< pairs of attitudes a pair of objects, for the overlap volumes
  size_t largest = 10'000;  ///< objects of Part II; at least 500
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
  double total_paper_way_ms(int length = 1) const;

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
enum class Done { kNothing, kCollisions, kRoom, kCosts, kAll };

struct PaperResult {
  Done done = Done::kNothing;
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
                            const std::function<void(const std::string&)>& tell,
                            const std::function<void(const PaperResult&)>& keep = {});

}  // namespace throng::paper
