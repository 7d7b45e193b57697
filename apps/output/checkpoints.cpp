#include "apps/output/checkpoints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "scenes/run/checkpoint.h"
#include "scenes/run/runner.h"

namespace throng {

void add_checkpoint_options(CommandOptions& app, CheckpointOptions& options) {
  Option* file = app.add_option("--checkpoint", options.file,
                                "Write the state of the run to FILE at intervals, for --resume")
                     ->type_name("FILE");
  app.add_option("--checkpoint-every", options.every_s,
                 fmt::format("Simulated seconds between checkpoints [{}]", options.every_s))
      ->check(number_option(0, 1e7, true, "a number of seconds above 0"))
      ->needs(file)
      ->type_name("S");
  app.add_option("--resume", options.resume,
                 "Resume from a checkpoint of a run with the same scene and options")
      ->type_name("FILE");
}

void plan_checkpoints(const CheckpointOptions& options, OutputPlan& plan) {
  // A resumed run may write to the file that it was resumed from, which was read before.
  if (options.resume.empty() || !(identify(options.resume) == identify(options.file)))
    plan.reads("which --resume reads", options.resume);
  plan.writes({.option = "--checkpoint", .path = options.file});
}

void resume_if_requested(const CheckpointOptions& options, Simulation& simulation) {
  if (options.resume.empty()) return;
  resume(simulation, options.resume);
  const int64_t frames = frame_count(simulation.scene().duration_s, simulation.info().step_s);
  if (simulation.next_frame() >= frames)
    throw InputError(options.resume, fmt::format("a run of more than {} frames", frames),
                     fmt::format("{} done; increase --seconds", simulation.next_frame()));
}

Checkpoints::Checkpoints(const CheckpointOptions& options, double step_s)
    : file_(options.file), frames_(std::max<int64_t>(1, std::llround(options.every_s / step_s))) {}

void Checkpoints::after(Simulation& simulation, const Frame& frame, bool stops) {
  if (file_.empty() || !(stops || (frame.number + 1) % frames_ == 0)) return;
  try {
    write_checkpoint(file_, checkpoint_of(simulation));
    ++written_;
  } catch (const EnvironmentError& error) {
    failure_ = error.what();
  }
}

}  // namespace throng
