// One run of a scene: people placed, then step by step steering, gait, culling.
// One rule: the same scene, seed and options give the same frames for any number of threads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/workers.h"
#include "scenes/scene.h"
#include "scenes/sink.h"

namespace throng {

struct SimulationOptions {
  int threads = 1;
  PairSearch pair_search = PairSearch::kGrid;
  SimdTarget simd = SimdTarget::kBest;
};

class Simulation {
 public:
  /// Loads the models, places the people, fits the volumes. Throws InputError.
  Simulation(Scene scene, const SimulationOptions& options);
  ~Simulation();

  const RunInfo& info() const;
  /// What the user should know: people who could not be placed, spawn areas that were enlarged.
  const std::vector<std::string>& notes() const;

  /// Advances by scene.step_s. The frame's spans hold until the next step.
  const Frame& step();
  /// Ends every pair that still touches.
  RunEnd finish();

  FrameTimes& times();  ///< the runner adds publish_ns and frame_ns here

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
