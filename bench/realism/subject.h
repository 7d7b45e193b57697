// What is measured: a scene, or a recording dressed in bodies.
// One rule: it is run as `throng run --exact` runs it, but for what scene_switches.h changes.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "scenes/file/scene.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"

namespace throng::realism {

/// A scene file, a bundled scene's name or a recording. Throws InputError.
Scene open_subject(const std::string& name, std::optional<double> seconds);

/// Runs it for the sinks that `sinks_of` makes of the simulation before its first step.
void run_subject(Scene scene, int threads, bool culling,
                 const std::function<std::vector<Sink*>(const Simulation&)>& sinks_of);

}  // namespace throng::realism
