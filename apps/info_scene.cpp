#include <fmt/format.h>

#include "apps/info.h"
#include "scenes/scene.h"

namespace throng {
namespace {

std::string describe(const Rectangle& area) {
  return fmt::format("({:g}, {:g}) to ({:g}, {:g}) m", area.min_m.x(), area.min_m.y(),
                     area.max_m.x(), area.max_m.y());
}

std::string_view kind_name(Obstacle::Kind kind) {
  switch (kind) {
    case Obstacle::Kind::kBox:
      return "box";
    case Obstacle::Kind::kCylinder:
      return "cylinder";
    case Obstacle::Kind::kMesh:
      return "mesh";
  }
  return "";
}

void print_group(const Group& group) {
  fmt::print("  {}: {} of '{}', {} parts each, {} goals\n", group.name, group.count,
             group.body->name, group.body->part_count(), group.goals.size());
  fmt::print("    from     {}\n", describe(group.spawn));
  fmt::print("    speed    {:g} +- {:g} m/s, {:g} to {:g}\n", group.speed_mps.mean,
             group.speed_mps.deviation, group.speed_mps.min, group.speed_mps.max);
  fmt::print("    height   {:g} +- {:g} m, {:g} to {:g}\n", group.height_m.mean,
             group.height_m.deviation, group.height_m.min, group.height_m.max);
}

void print_obstacle(const Obstacle& obstacle) {
  fmt::print("  {}: {} {:g} x {:g} x {:g} m at ({:g}, {:g})\n", obstacle.name,
             kind_name(obstacle.kind), obstacle.size_m.x(), obstacle.size_m.y(),
             obstacle.size_m.z(), obstacle.centre_m.x(), obstacle.centre_m.y());
}

}  // namespace

void print_scene_info(const std::string& path_or_name) {
  const Scene scene = load_scene(path_or_name);
  int people = 0;
  for (const Group& group : scene.groups) people += group.count;
  fmt::print("{}: {}\n", scene.name, scene.description);
  fmt::print("  ground     {}\n", describe(scene.ground));
  fmt::print("  avatars    {}, {:.2f} per m2 of ground\n", people, people / scene.ground.area_m2());
  fmt::print("  time       {:g} s in steps of 1/{:g} s, seed {}\n", scene.duration_s,
             1 / scene.step_s, scene.seed);
  fmt::print("  culling    sphere, then {}{}\n", name_of(scene.part_volume),
             scene.exact ? ", then triangles" : "");
  fmt::print("\nGroups:\n");
  for (const Group& group : scene.groups) print_group(group);
  fmt::print("\nObstacles:{}\n", scene.obstacles.empty() ? " none" : "");
  for (const Obstacle& obstacle : scene.obstacles) print_obstacle(obstacle);
}

}  // namespace throng
