// StrategyRun runs Part II: n objects, whose pairs a strategy tests.
// The strategies are those of culling/strategies/paper_search.h; here they are fed and counted.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "base/simd.h"
#include "bench/paper/methods.h"
#include "culling/kernels/kernels.h"

namespace throng::paper {

enum class Strategy {
  kControl,     ///< objects move, nothing is tested
  kSphere,      ///< spheres, every pair
  kOrdop,       ///< or-DOPs, every pair
  kHybridOne,   ///< sphere, then or-DOP, of one object of interest against all others
  kHybridAll,   ///< both volumes of every object updated; sphere then or-DOP, pair by pair
  kTwoPass,     ///< spheres of all pairs first, or-DOPs of the survivors only (Seq Sp-OrD)
  kTwoPassGrid  ///< the same with a grid for the first pass; not in the paper
};

inline constexpr std::array<std::string_view, 7> kStrategies = {
    "control", "sphere", "ordop", "hybrid_one", "hybrid_all", "two_pass", "two_pass_grid"};

/// Counts, summed over the frames.
struct Work {
  uint64_t sphere_updates = 0;
  uint64_t sphere_tests = 0;
  uint64_t ordop_updates = 0;
  uint64_t ordop_tests = 0;
  uint64_t passed = 0;      ///< pairs reported
  uint64_t primitives = 0;  ///< tests that the exact test of those pairs takes: N_p

  uint64_t updates() const { return sphere_updates + ordop_updates; }
  uint64_t tests() const { return sphere_tests + ordop_tests; }
  bool operator==(const Work&) const = default;
};

/// Returns Part II's box, with the density of Part I's. Every other object is static.
BoxDynamics part_two_world(const std::vector<Object>& objects, size_t count, uint64_t seed);

class StrategyRun {
 public:
  StrategyRun(Strategy strategy, const std::vector<Object>& objects, size_t count, uint64_t seed,
              SimdTarget simd = SimdTarget::kBest);
  ~StrategyRun();

  /// Moves the objects by a step, then culls.
  void frame();
  /// Returns the pairs of the last frame, sorted, a < b.
  std::vector<SlotPair> pairs() const;
  /// Adds the triangle tests of pairs() to work().primitives; returns how many pairs touch.
  size_t count_primitives();
  const Work& work() const;
  const BoxDynamics& world() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Counts and times of a strategy over some frames.
struct StrategyResult {
  size_t objects = 0;
  int frames = 0;
  Work work;
  double frame_ms = 0;  ///< mean frame of the fastest run: disturbances only add time
  /// Over all runs, or over the frames of a single run; their spread shows the machine's noise.
  double median_ms = 0, low_ms = 0, high_ms = 0;  ///< median, 10th and 90th percentile
  int samples = 0;
  double fps() const { return frame_ms > 0 ? 1e3 / frame_ms : 0; }
};

/// Counts in one run. If it was short, times further runs of the same frames on this thread.
StrategyResult measure_strategy(Strategy strategy, const std::vector<Object>& objects, size_t count,
                                int frames, uint64_t seed);

}  // namespace throng::paper
