// SmallWorld is a crowd for steering tests: ground, boxes and agents, no files.
#pragma once

#include <memory>

#include "avatars/mesh/primitives.h"
#include "base/workers.h"
#include "crowd/crowd.h"
#include "crowd/navigation/footprints.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"
#include "scenes/file/scene.h"

namespace throng {

inline Obstacle box(double x, double y, double length_m, double width_m, double heading_rad = 0) {
  Obstacle obstacle;
  obstacle.size_m = {length_m, width_m, 3};
  obstacle.centre_m = {x, y, 1.5};
  obstacle.heading_rad = heading_rad;
  obstacle.mesh = box_mesh(obstacle.size_m);
  return obstacle;
}

inline Group group(int count, const Rectangle& spawn, const std::vector<Rectangle>& goals) {
  Group out;
  out.count = count;
  out.spawn = spawn;
  out.goals.assign(goals.begin(), goals.end());
  return out;
}

/// A crowd and everything it refers to.
struct SmallWorld {
  SmallWorld(Scene scene_in, int threads, SimdTarget simd = SimdTarget::kBest)
      : scene(std::move(scene_in)),
        workers(threads),
        map(scene, workers),
        spawned(spawn(scene, map)),
        crowd(map, spawned.people, {scene.seed, scene.step_s, scene.steering, simd}, workers) {}

  Scene scene;
  Workers workers;
  NavigationMap map;
  SpawnResult spawned;
  Crowd crowd;
};

/// The plan of the bundled plaza without models: four groups cross among obstacles.
inline Scene crossing(uint64_t seed, int people) {
  Scene scene;
  scene.seed = seed;
  scene.ground = {{-15, -15}, {15, 15}};
  scene.obstacles = {box(0, 0, 4, 4, 0.5), box(-7, 4, 2, 0.3, 0.9), box(7, -3, 0.4, 3, 0.1),
                     box(5, 7, 1.5, 1.5)};
  const Rectangle north{{-14, 11}, {14, 14.5}};
  const Rectangle south{{-14, -14.5}, {14, -11}};
  const Rectangle east{{11, -14}, {14.5, 14}};
  const Rectangle west{{-14.5, -14}, {-11, 14}};
  scene.groups = {group(people / 4, {{-14, 5}, {14, 14.5}}, {south, north}),
                  group(people / 4, {{-14, -14.5}, {14, -5}}, {north, south}),
                  group(people / 4, {{5, -14}, {14.5, 14}}, {west, east}),
                  group(people / 4, {{-14.5, -14}, {-5, 14}}, {east, west})};
  return scene;
}

}  // namespace throng
