// measure_steering() times steps of steering, next to published times of RVO2.
// In a step all people decide and move, as in RVO2's doStep(). In a frame of a run a third of the
// people decide.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/simd.h"
#include "bench/comparison.h"
#include "crowd/steering/steering_rule.h"

namespace throng::bench {

struct SteeringBenchOptions {
  std::vector<int> counts = {1'000, 10'000, 100'000};
  double per_m2 = 1;
  std::optional<int> steps;  ///< measured; default: two million decisions, 9 to 201 steps
  int threads = 1;
  uint64_t seed = 1;
  SimdTarget simd = SimdTarget::kBest;
};

struct SteeringRow {
  SteeringKind model = SteeringKind::kOrca;
  int people = 0;                 ///< number that found a place
  TimeStats ms;                   ///< time per step
  double sweeps = 0;              ///< relaxation sweeps per step, mean
  TimeStats frame_ms;             ///< time per frame of 1/30 s, in which a third decide
  std::optional<double> rvo2_ms;  ///< RVO2's time for this number, if known
};

/// Four groups cross a square without obstacles from side to side; the first 2 s are warm-up.
std::vector<SteeringRow> measure_steering(const SteeringBenchOptions& options,
                                          const Progress& progress);

std::string to_text(const std::vector<SteeringRow>& rows, const SteeringBenchOptions& options,
                    const std::string& cpu);
std::string to_json(const std::vector<SteeringRow>& rows, const SteeringBenchOptions& options,
                    const std::string& cpu);

}  // namespace throng::bench
