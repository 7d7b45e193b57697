// run_experiments() runs the experiments of the paper; judge() compares results with its claims.
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

// C_o, C_u and C_v are measured separately. Inputs come in random order and never repeat within a
// repetition: no branch is learned. A cost is a median over repetitions, with its spread.

using bench::Cost;
using bench::cost_of;

/// The paper's 500, 1000 and 5000 frames as multiples of the first.
inline constexpr std::array<int, 3> kRunLengths = {1, 2, 10};

struct MethodCosts {
  std::vector<Cost> construction;  ///< per object
  Cost construction_all;           ///< C_o: all objects once
  Cost update;                     ///< C_u
  Cost test;                       ///< C_v
  double primitive_ns = 0;         ///< C_p: exact method only, a test of two boxes or triangles
  std::array<double, kRunLengths.size()>
      run_ms{};  ///< whole runs by the thread's clock, without construction
};

/// `frames` frames of Part I are the input of C_u and C_v. Each volume is built `constructions`
/// times.
std::array<MethodCosts, kMethods.size()> measure_costs(const std::vector<Object>& objects,
                                                       int frames, uint64_t seed,
                                                       int constructions);

// Overlap volumes order the volumes independently of the box, the motion and its speed.
// Every method gets the same random attitudes and positions: differences are not chance.

/// Volume of all positions of one object's origin at which it overlaps another object, averaged
/// over pairs of different objects in random attitudes. For two convex volumes this is the volume
/// of their Minkowski sum. The probability of a collision is proportional to it.
struct OverlapVolume {
  double litres = 0;
  double error_l = 0;               ///< standard error over independent batches of attitudes
  std::vector<double> by_object_l;  ///< mean over the object's partners
};

using OverlapTable = std::array<OverlapVolume, kMethods.size()>;

/// Monte Carlo integration with `attitudes` pairs of attitudes per pair of objects (at least 10)
/// and 100 positions each.
OverlapTable measure_overlap(const std::vector<Object>& objects, int attitudes, uint64_t seed);

/// Returns the longest over the shortest side of the object's box in its own frame.
double elongation(const Object& object);

/// Invariant: counts depend on the options only, and no claim about counts uses times.
struct PaperOptions {
  std::string model = {};  ///< URDF file; empty: the bundled adult
  int frames = 500;        ///< frames of Part I; a multiple of 5
  uint64_t seed = 1;
  int seeds = 1;                ///< number of seeds for the collisions: seed, seed + 1, ...
  int threads = 1;              ///< for the seeds; everything timed uses one
  int constructions = 100;      ///< repetitions for C_o, as many as in the paper
  int attitudes = 100;          ///< pairs of attitudes per pair of objects, for the overlap volumes
  size_t max_objects = 10'000;  ///< maximum size of Part II; at least 500
};

/// Result of a volume with its update rule in Part I.
struct VolumeResult {
  std::string name;
  int frames = 0;
  std::array<double, kMarks> collisions{};         ///< mean over the seeds
  std::array<double, kMarks> deviation{};          ///< standard deviation over the seeds
  Census census;                                   ///< counts of the first seed
  std::array<uint64_t, kMarks> long_collisions{};  ///< ten times the frames, first seed
  MethodCosts costs;
  double false_positive_rate = 0;  ///< fraction of found pairs that do not touch, over all seeds
  uint64_t missed = 0;             ///< over all seeds
  OverlapVolume overlap;           ///< independent of any box

  /// Returns N_u C_u + N_v C_v + C_o for `length` times the frames.
  double total_ms(int length = 1) const;
  /// The same with two updates per test, as the paper counts.
  double total_paper_count_ms(int length = 1) const;

 private:
  double runs_ms(uint64_t updates, int length) const;
};

/// Result of a strategy of Part II, with its cost by the formula in milliseconds over all frames.
struct StrategyCost {
  Strategy strategy = Strategy::kControl;
  StrategyResult result;
  double culling_ms = 0;  ///< N_u C_u + N_v C_v
  double built_ms = 0;    ///< C_o
  double exact_ms = 0;    ///< N_p C_p of the reported pairs

  std::string name() const { return std::string(kStrategies[static_cast<size_t>(strategy)]); }
  double total_ms() const { return culling_ms + built_ms; }
};

/// Results of all strategies for one number of objects.
struct Scale {
  size_t objects = 0;
  std::vector<StrategyCost> strategies;  ///< in the order of kStrategies
};

/// A statement of the paper, tested by the measured numbers.
struct Claim {
  std::string about;  ///< "Table 2", "Fig. 13, counted", ...
  std::string left, right;
  double left_value = 0, right_value = 0;
  std::string relation;  ///< ">" or ">="
  double share = 0;      ///< fraction of the seeds in which it holds; 0 or 1 for a single number
  bool holds = false;    ///< whether it holds in the mean
};

/// From this number of objects on, this strategy is the cheapest that looks at all pairs.
struct Winner {
  std::string measure;  ///< "culling, counted", "with triangles, counted", "culling, measured"
  size_t objects = 0;
  std::string strategy;
};

/// Progress of the experiments; results of later stages are missing.
enum class CompletedStage { kNothing, kCollisions, kOverlapVolumes, kCosts, kAll };

struct PaperResult {
  CompletedStage done = CompletedStage::kNothing;
  PaperOptions options;
  double edge_m = 0;
  std::vector<std::string> objects;
  std::vector<double> elongations;    ///< per object
  std::vector<VolumeResult> volumes;  ///< in the order of kMethods
  std::vector<Scale> scales;
  std::vector<Claim> claims;
  std::vector<Winner> winners;
  double primitive_ns = 0;  ///< C_p

  const Scale* scale(size_t objects) const;
  /// Returns the median over strategies and sizes of the slowest over the fastest tenth of the
  /// runs: 1.0 on an idle machine.
  double noise() const;
  /// Returns the work of a frame of Part I: "15 updates, 105 tests".
  std::string frame_in_words() const;
  double frame_ns(const VolumeResult& volume) const;
};

/// `announce` gets the name of each stage that starts, `keep` the result after each finished stage.
PaperResult run_experiments(const std::vector<Object>& objects, const PaperOptions& options,
                            const std::function<void(const std::string&)>& announce,
                            const std::function<void(const PaperResult&)>& keep = {});

// Each claim is listed with its two numbers, whether or not it holds.

/// Tests Table 2's order for each k and update rule, Table 3's cheapest volumes, and Fig. 13 in
/// counted work and frame rates.
std::vector<Claim> judge(const PaperResult& result, std::span<const CensusTable> censuses);

/// Returns the cheapest strategy by size for each measure; one entry per change.
std::vector<Winner> find_winners(std::span<const Scale> scales);

}  // namespace throng::paper
