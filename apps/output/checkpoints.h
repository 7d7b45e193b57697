// Checkpoints writes checkpoints of a run; resume_if_requested() restores one.
// Invariant: a checkpoint that cannot be written ends the run, which reports it and prints its
// summary.
#pragma once

#include <cstdint>
#include <string>

#include "apps/options/command_line.h"
#include "apps/output/output_plan.h"
#include "scenes/run/simulation.h"

namespace throng {

struct CheckpointOptions {
  std::string file;
  double every_s = 60;  ///< simulated time between checkpoints
  std::string resume;
};

void add_checkpoint_options(CommandOptions& app, CheckpointOptions& options);
void plan_checkpoints(const CheckpointOptions& options, OutputPlan& plan);

/// Restores the simulation from the checkpoint. Throws InputError if the file belongs to another
/// run, or if no frames are left to run.
void resume_if_requested(const CheckpointOptions& options, Simulation& simulation);

class Checkpoints {
 public:
  Checkpoints(const CheckpointOptions& options, double step_s);

  /// After a frame: writes the file if it is due or the run stops.
  void after(Simulation& simulation, const Frame& frame, bool stops);
  int64_t written() const { return written_; }
  /// Reason to stop the run, or "".
  const std::string& failure() const { return failure_; }

 private:
  std::string file_;
  int64_t frames_;  ///< frames between two checkpoints
  int64_t written_ = 0;
  std::string failure_;
};

}  // namespace throng
