// A scene with an externally controlled group, for tests of its control. The rovers have the last
// ids.
#pragma once

#include <string>

#include "scenes/run/simulation.h"
#include "synthetic_run.h"

namespace throng {

inline const std::string kChannel = "ROBOT_DRIVE";

/// People on an empty square and rovers in the middle, which have the last ids.
inline Scene rover_in_crowd(int people = 200, int robots = 1) {
  Scene scene = load_scene("plaza");
  std::vector<std::string> notes;
  scale_to(scene, people, notes);
  scene.obstacles.clear();
  Group rovers;
  rovers.name = "rovers";
  rovers.body = rover();
  rovers.count = robots;
  const double half_m = 0.5 * robots;
  rovers.spawn = {{-half_m, -half_m}, {half_m, half_m}};
  rovers.goals.emplace_back().areas.push_back(rovers.spawn);
  const auto height_m = static_cast<double>(rover()->height_m);
  rovers.height_m = Distribution{height_m, 0, height_m, height_m};
  rovers.radius_m = 0.35;
  rovers.control_channel = kChannel;
  scene.groups.push_back(rovers);
  return scene;
}

inline uint32_t rover_of(const Simulation& simulation) {
  return static_cast<uint32_t>(simulation.info().avatar_count() - 1);
}

}  // namespace throng
