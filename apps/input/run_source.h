// What a command runs: the options that name it, and the files that it must not write over.
#pragma once

#include "apps/options/recording_options.h"
#include "lcm_io/replay/run_source.h"

namespace throng {

class OutputPlan;

/// FILE, --avatars, --seconds, --seed, --steering, --part-volume, --exact, --near, --person-near,
/// and what recordings need.
void add_run_source_options(CommandOptions& app, RunSourceOptions& options);

/// The files that it was read from.
void plan_inputs(const Scene& scene, OutputPlan& plan);

}  // namespace throng
