// A scene of people on ways that are made up here, as a recording.
// One rule: recorded at every frame of the run, so that nothing is between two samples.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "scenes/file/scene.h"

namespace throng::realism {

inline constexpr double kMadeStep_s = 1.0 / 60;

/// Roots of `people` adults go where `place_m` says. On a ground around them; a larger one is the
/// caller's business.
Scene made_scene(const std::string& name, size_t people, double duration_s,
                 const std::function<Eigen::Vector2d(size_t person, double time_s)>& place_m);

/// People of all styles who walk straight on, each alone, at 0.5 to 1.9 m/s.
Scene plain_walking(double duration_s);

}  // namespace throng::realism
