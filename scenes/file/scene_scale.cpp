// Scaling of a scene to another number of people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/errors.h"
#include "base/limits.h"
#include "base/portable_math.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene.h"

namespace throng {
namespace {

/// Density in people per m2 of a spawn area, and of the whole ground, above which the plan grows.
/// Random placement reaches about 2 per m2; above one per m2 crossing streams begin to jam.
constexpr double kMaxSpawnDensity = 1.2;
constexpr double kMaxGroundDensity = 1.0;
/// Boxes longer than this share of the ground's shorter side are walls and grow with the plan.
constexpr double kWallShare = 1.0 / 3.0;

/// Divides `total` in proportion to `counts` by largest remainders; the sum is exactly `total`.
std::vector<int64_t> shares_of(const std::vector<int64_t>& counts, int64_t total) {
  const int64_t sum = std::accumulate(counts.begin(), counts.end(), int64_t{0});
  std::vector<int64_t> shares;
  std::vector<size_t> order;
  int64_t given = 0;
  for (size_t i = 0; i < counts.size(); ++i) {
    shares.push_back(counts[i] * total / sum);
    given += shares.back();
    order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return counts[a] * total % sum > counts[b] * total % sum;
  });
  for (int64_t i = 0; i < total - given; ++i) ++shares[order[static_cast<size_t>(i)]];
  return shares;
}

std::vector<int*> counts_of(Scene& scene) {
  std::vector<int*> counts;
  for (Group& group : scene.groups) {
    counts.push_back(&group.count);
    for (Source& source : group.sources) counts.push_back(&source.count);
  }
  return counts;
}

/// Largest ratio of density to its limit; densities of the file itself are always allowed.
/// `starts`: people per group at the start.
double overfill_ratio(const Scene& scene, const std::vector<int64_t>& starts, int64_t before,
                      int64_t total) {
  const auto excess = [](double density, double own_density, double limit) {
    return density / std::max(limit, own_density);
  };
  double worst = excess(static_cast<double>(total) / ground_area_m2(scene),
                        static_cast<double>(before) / ground_area_m2(scene), kMaxGroundDensity);
  for (size_t i = 0; i < starts.size(); ++i) {
    const double area_m2 = scene.groups[i].spawn.area_m2();
    worst = std::max(worst, excess(static_cast<double>(starts[i]) / area_m2,
                                   scene.groups[i].count / area_m2, kMaxSpawnDensity));
  }
  return worst;
}

void grow_obstacle(Obstacle& obstacle, double factor, double wall_m) {
  double x = obstacle.size_m.x() > wall_m ? factor : 1;
  double y = obstacle.size_m.y() > wall_m ? factor : 1;
  // Cylinders and meshes keep their proportions; pieces of one surface stay together.
  if (obstacle.surface != 0) x = y = factor;
  if (obstacle.kind != Obstacle::Kind::kBox) x = y = std::max(x, y);
  obstacle.size_m.x() *= x;
  obstacle.size_m.y() *= y;
  for (Eigen::Vector3f& vertex : obstacle.mesh.vertices)
    vertex = (vertex.cast<double>().cwiseProduct(Eigen::Vector3d(x, y, 1))).cast<float>();
}

void grow_plan(Scene& scene, double factor) {
  const Eigen::Vector2d middle = 0.5 * (scene.ground.min_m + scene.ground.max_m);
  const double wall_m = kWallShare * scene.ground.size_m().minCoeff();
  const auto grow = [&](Area& area) { area = area.scaled(middle, factor); };
  scene.ground = Area(scene.ground).scaled(middle, factor).bounds();
  scale(scene.floor, middle, factor);
  for (Group& group : scene.groups) {
    grow(group.spawn);
    if (group.look_at_m) group.look_at_m = middle + factor * (*group.look_at_m - middle);
    for (Source& source : group.sources) grow(source.area);
    for (Goal& goal : group.goals) {
      for (Area& area : goal.areas) grow(area);
      for (Eigen::Vector2d& corner : goal.queue.line_m)
        corner = middle + factor * (corner - middle);
    }
  }
  for (Door& door : scene.doors)
    for (Eigen::Vector2d* end : {&door.from_m, &door.to_m})
      *end = middle + factor * (*end - middle);
  for (Obstacle& obstacle : scene.obstacles) {
    if (obstacle.lines_floor) continue;
    obstacle.centre_m.head<2>() = middle + factor * (obstacle.centre_m.head<2>() - middle);
    grow_obstacle(obstacle, factor, wall_m);
  }
  const auto wall = std::find_if(scene.obstacles.begin(), scene.obstacles.end(),
                                 [](const Obstacle& each) { return each.lines_floor; });
  if (wall == scene.obstacles.end()) return;
  // Walls come first, see read_ground_value(), and keep their thickness.
  std::vector<Obstacle> others;
  for (Obstacle& obstacle : scene.obstacles)
    if (!obstacle.lines_floor) others.push_back(std::move(obstacle));
  const double height_m = wall->size_m.z();
  scene.obstacles.clear();
  add_walls(scene, height_m, scene.name);
  std::move(others.begin(), others.end(), std::back_inserter(scene.obstacles));
}

double scale_box(Scene& scene, int total, std::vector<std::string>& notes) {
  PartsBox& box = *scene.box;
  const double factor = cube_root(static_cast<double>(total) / box.count);
  const double edge_m = factor * box.edge_m;
  if (!(edge_m <= kMaxEdge_m))
    throw InputError("avatars", fmt::format("a box of at most {} m", kMaxEdge_m),
                     fmt::format("{:.0f} m for {} parts", edge_m, total));
  box.edge_m = edge_m;
  box.count = total;
  scene.ground.max_m = Eigen::Vector2d::Constant(0.5 * box.edge_m);
  scene.ground.min_m = -scene.ground.max_m;
  notes.push_back(
      fmt::format("{} parts: the box of '{}' is now {:.2f} m wide", total, scene.name, box.edge_m));
  scene.content_hash = content_hash_of(scene);
  return factor;
}

}  // namespace

double scale_to(Scene& scene, int total, std::vector<std::string>& notes) {
  const int64_t max = kMaxBodies - static_cast<int64_t>(scene.obstacles.size());
  if (total < 1 || total > max)
    throw InputError("avatars", fmt::format("1 to {} people in scene '{}'", max, scene.name),
                     fmt::format("{}", total));
  if (scene.box) return scale_box(scene, total, notes);
  if (scene.recorded)
    throw InputError("--avatars", "a scene whose people can be scaled",
                     fmt::format("'{}', whose people were recorded", scene.name));
  for (const Group& group : scene.groups)
    if (!group.starts.positions_m.empty())
      throw InputError("--avatars", "a scene whose people can be scaled",
                       fmt::format("group '{}' with 'positions_m'", group.name));
  const std::vector<int*> numbers = counts_of(scene);
  std::vector<int64_t> counts;
  for (const int* number : numbers) counts.push_back(*number);
  const int64_t before = std::accumulate(counts.begin(), counts.end(), int64_t{0});
  if (before == 0)
    throw InputError("avatars", fmt::format("people in scene '{}' to scale", scene.name),
                     "empty groups");
  const std::vector<int64_t> shares = shares_of(counts, total);
  std::vector<int64_t> starts;
  for (size_t i = 0, number = 0; i < scene.groups.size(); ++i) {
    starts.push_back(shares[number]);
    number += 1 + scene.groups[i].sources.size();
  }
  const double factor = std::sqrt(std::max(1.0, overfill_ratio(scene, starts, before, total)));
  if (factor * factor * scene.ground.area_m2() > kMaxGround_m2)
    throw InputError(
        "avatars", fmt::format("a ground of at most {} m2", kMaxGround_m2),
        fmt::format("{:.0f} m2 for {} people", factor * factor * scene.ground.area_m2(), total));
  const Eigen::Vector2d middle = scene.ground.middle_m();
  const Eigen::Vector2d farthest = middle.cwiseAbs() + 0.5 * factor * scene.ground.size_m();
  if (!(farthest.maxCoeff() <= kMaxCoordinate_m))
    throw InputError("avatars", fmt::format("a ground within {} m of the origin", kMaxCoordinate_m),
                     fmt::format("{:.0f} m for {} people", farthest.maxCoeff(), total));
  if (factor > 1) {
    grow_plan(scene, factor);
    const Eigen::Vector2d size = scene.ground.size_m();
    notes.push_back(
        fmt::format("{} people need more space: the plan of '{}' grew by a factor of {:.2f} to "
                    "{:.1f} m x {:.1f} m",
                    total, scene.name, factor, size.x(), size.y()));
  }
  for (size_t i = 0; i < shares.size(); ++i) *numbers[i] = static_cast<int>(shares[i]);
  for (Group& group : scene.groups)
    for (Source& source : group.sources)
      source.rate_per_s *= static_cast<double>(total) / static_cast<double>(before);
  scene.content_hash = content_hash_of(scene);
  return factor;
}

}  // namespace throng
