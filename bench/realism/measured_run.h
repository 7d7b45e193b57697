// run_measured() runs a scene, a retargeted recording or synthetic paths for measuring sinks.
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

// Switches that apply to every measured scene.
// Invariant: nothing else changes a scene; before and after differ by the switches only.

/// --body-avoidance off: bodies walk as if they were alone.
inline bool with_body_avoidance = true;

inline void set_switches(Scene& scene) {
  scene.exact = true;
  if (!with_body_avoidance) scene.body_avoidance = false;
}

// Synthetic recordings have a sample per frame of the run: nothing is interpolated.

inline constexpr double kSyntheticStep_s = 1.0 / 60;

/// Returns a recording of `people` adults whose roots follow `place_m`, on a ground around them.
/// The caller may enlarge the ground.
Scene synthetic_scene(const std::string& name, size_t people, double duration_s,
                      const std::function<Eigen::Vector2d(size_t person, double time_s)>& place_m);

/// Returns people of all styles who walk straight ahead, each alone, at 0.5 to 1.9 m/s.
Scene plain_walking(double duration_s);

// A measured scene runs like `throng run --exact`, except for set_switches().

/// Opens a scene file, a bundled scene or a recording. Throws InputError.
Scene open_measured_run(const std::string& name, std::optional<double> seconds);

/// Runs the scene with the sinks that `sinks_of` creates before the first step.
void run_measured(Scene scene, int threads, bool culling,
                  const std::function<std::vector<Sink*>(const Simulation&)>& sinks_of);

}  // namespace throng::realism
