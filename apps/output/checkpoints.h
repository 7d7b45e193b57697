// Checkpoints of a run on request, and going on from one.
// One rule: a checkpoint that cannot be written ends the run, which says so and keeps its summary.
#pragma once

#include <cstdint>
#include <string>

#include "apps/options/command_line.h"
#include "apps/output/output_plan.h"
#include "scenes/run/simulation.h"

namespace throng {

struct CheckpointOptions {
  std::string file;
  double every_s = 60;  ///< simulated
  std::string resume;
};

void add_checkpoint_options(CommandOptions& app, CheckpointOptions& options);
void plan_checkpoints(const CheckpointOptions& options, OutputPlan& plan);

/// Puts the simulation where the checkpoint was taken. Throws InputError if the file is none of
/// this run, or if nothing is left to run.
void resume_if_requested(const CheckpointOptions& options, Simulation& simulation);

class Checkpoints {
 public:
  Checkpoints(const CheckpointOptions& options, double step_s);

  /// After a frame: writes the file if it is due or the run `stops`.
  void after(Simulation& simulation, const Frame& frame, bool stops);
  int64_t written() const { return written_; }
  /// Why the run has to stop, or "".
  const std::string& failure() const { return failure_; }

 private:
  std::string file_;
  int64_t frames_;  ///< between two checkpoints
  int64_t written_ = 0;
  std::string failure_;
};

}  // namespace throng
