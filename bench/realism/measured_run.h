// What is measured: a scene, a recording dressed in bodies, or ways that are made up here.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "scenes/file/scene.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"

namespace throng::realism {

// What is switched on or off in every scene that is measured.
// The only place that changes a scene, so that before and after differ by it alone.

/// --yielding off: bodies walk as if they were alone.
inline bool with_body_avoidance = true;

inline void set_switches(Scene& scene) {
  scene.exact = true;
  if (!with_body_avoidance) scene.body_avoidance = false;
}

// A scene of people on ways that are made up here, as a recording.
// Recorded at every frame of the run, so that nothing is between two samples.

inline constexpr double kSyntheticStep_s = 1.0 / 60;

/// Roots of `people` adults go where `place_m` says. On a ground around them; a larger one is the
/// caller's business.
Scene synthetic_scene(const std::string& name, size_t people, double duration_s,
                      const std::function<Eigen::Vector2d(size_t person, double time_s)>& place_m);

/// People of all styles who walk straight on, each alone, at 0.5 to 1.9 m/s.
Scene plain_walking(double duration_s);

// What is measured: a scene, or a recording dressed in bodies.
// It is run as `throng run --exact` runs it, but for what set_switches() changes.

/// A scene file, a bundled scene's name or a recording. Throws InputError.
Scene open_measured_run(const std::string& name, std::optional<double> seconds);

/// Runs it for the sinks that `sinks_of` makes of the simulation before its first step.
void run_measured(Scene scene, int threads, bool culling,
                  const std::function<std::vector<Sink*>(const Simulation&)>& sinks_of);

}  // namespace throng::realism
