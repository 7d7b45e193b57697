// What a step of steering costs, beside the reference cost of RVO2's published code.
// One rule: a step decides for everybody and moves everybody, as RVO2's doStep() does, and nothing
// else is in the time. In a frame of a run people take turns in deciding.
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
  std::optional<int> steps;  ///< to measure; otherwise two million decisions, 9 to 201 steps
  int threads = 1;
  uint64_t seed = 1;
  SimdTarget simd = SimdTarget::kBest;
};

struct SteeringRow {
  SteeringKind model = SteeringKind::kOrca;
  int people = 0;                 ///< who found a place
  TimeStats ms;                   ///< of a step
  double sweeps = 0;              ///< of relaxation in a step, mean
  TimeStats frame_ms;             ///< of a 30th of a second, in which a third of them decide
  std::optional<double> rvo2_ms;  ///< RVO2's for so many, where known
};

/// Four groups cross a square without obstacles, from side to side; the first 2 s are warm-up.
std::vector<SteeringRow> measure_steering(const SteeringBenchOptions& options,
                                          const Progress& progress);

std::string to_text(const std::vector<SteeringRow>& rows, const SteeringBenchOptions& options,
                    const std::string& cpu);
std::string to_json(const std::vector<SteeringRow>& rows, const SteeringBenchOptions& options,
                    const std::string& cpu);

}  // namespace throng::bench
