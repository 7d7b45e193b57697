#include "analysis/validation/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "avatars/mesh/primitives.h"
#include "crowd/spawn.h"

namespace throng::validation {
namespace {

/// Decisions are at 10 Hz regardless of the step. Bodies are not posed, so a long step is enough.
constexpr double kStep_s = 0.05;
constexpr double kWallHeight_m = 3;

const std::shared_ptr<const Model>& adult() {
  static const std::shared_ptr<const Model> model = load_model(adult_urdf());
  return model;
}

std::vector<std::pair<double, double>> pieces(double from, double to, std::vector<double> middles,
                                              double door_m) {
  std::sort(middles.begin(), middles.end());
  std::vector<std::pair<double, double>> out;
  double begin = from;
  for (const double middle : middles) {
    out.emplace_back(begin, middle - 0.5 * door_m);
    begin = middle + 0.5 * door_m;
  }
  out.emplace_back(begin, to);
  return out;
}

}  // namespace

Plan::Plan(const std::string& name, const Rectangle& ground, const SteeringRule& steering,
           uint64_t seed) {
  scene.name = name;
  scene.seed = seed;
  scene.step_s = kStep_s;
  scene.ground = ground;
  scene.part_volume = VolumeKind::kSphere;  // unused, fastest to build
  scene.steering = steering;
}

void Plan::wall(double min_x, double min_y, double max_x, double max_y) {
  Obstacle obstacle;
  obstacle.size_m = {max_x - min_x, max_y - min_y, kWallHeight_m};
  obstacle.centre_m = {0.5 * (min_x + max_x), 0.5 * (min_y + max_y), 0.5 * kWallHeight_m};
  obstacle.mesh = box_mesh(obstacle.size_m);
  solid(std::move(obstacle));
  walls.push_back({{min_x, min_y}, {max_x, max_y}});
}

void Plan::solid(Obstacle obstacle) {
  obstacle.name = fmt::format("wall {}", scene.obstacles.size() + 1);
  scene.obstacles.push_back(std::move(obstacle));
}

void Plan::wall_along_x(double from_x, double to_x, double y, std::vector<double> middles,
                        double door_m) {
  for (const auto& [begin, end] : pieces(from_x, to_x, std::move(middles), door_m))
    wall(begin, y - 0.5 * kWall_m, end, y + 0.5 * kWall_m);
}

void Plan::wall_along_y(double from_y, double to_y, double x, std::vector<double> middles,
                        double door_m) {
  for (const auto& [begin, end] : pieces(from_y, to_y, std::move(middles), door_m))
    wall(x - 0.5 * kWall_m, begin, x + 0.5 * kWall_m, end);
}

Group& Plan::people(int count, const Rectangle& from, const std::vector<Rectangle>& to) {
  Group& group = scene.groups.emplace_back();
  group.name = fmt::format("group {}", scene.groups.size());
  group.model = adult_urdf();
  group.body = adult();
  group.gait_styles = styles_of("plain");  // unused, one gait table is fastest
  group.count = count;
  group.spawn = from;
  Goal goal;
  goal.areas.assign(to.begin(), to.end());
  goal.waypoint = true;
  group.goals = {goal};
  group.on_arrival = OnArrival::kLeave;
  return group;
}

Group& Plan::people_packed(int count, const Rectangle& from, const std::vector<Rectangle>& to) {
  Group& group = people(count, from, to);
  group.density_per_m2 = count / from.area_m2();
  return group;
}

void Plan::people_in_rows(int rows, int columns, const Rectangle& from,
                          const std::vector<Rectangle>& to) {
  // Equal sizes, because all positions have the same spacing.
  constexpr double kHeight_m = 1.70;
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(disc_radius_m(kHeight_m) + 0.005);
  const Eigen::Vector2d low = from.min_m + margin;
  const Eigen::Vector2d size = from.size_m() - 2 * margin;
  const double dx = size.x() / (columns - 0.5);
  const double dy = rows > 1 ? size.y() / (rows - 1) : 0;
  const Eigen::Vector2d slack = Eigen::Vector2d::Constant(1e-4);
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) {
      const Eigen::Vector2d at = low + Eigen::Vector2d((column + 0.5 * (row % 2)) * dx, row * dy);
      Group& one = people(1, {at - slack, at + slack}, to);
      one.height_m = fixed(kHeight_m);
    }
}

Distribution fixed(double value) { return {value, 0, value, value}; }

}  // namespace throng::validation
