// Random places: rooms that overlap or are joined by passages, on grounds of any shape.
#pragma once

#include <utility>
#include <vector>

#include "geometry/polygon_union.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene.h"
#include "tests/geometry/random_polygons.h"

namespace throng::test {

/// A straight piece of a wall.
struct WallPiece {
  Eigen::Vector2d from, to;
};

inline void add_ring(const Polygon::Ring& ring, std::vector<WallPiece>& walls) {
  for (size_t i = 0; i < ring.size(); ++i) walls.push_back({ring[i], ring[(i + 1) % ring.size()]});
}

struct RandomWorld {
  Scene scene;
  std::vector<WallPiece> walls;  ///< edges of the floor and of all obstacles
};

/// Rooms that overlap or are joined by passages of all widths down to 1 mm, with pillars, concave
/// obstacles and walls of 1 mm. One world in a hundred is a room with 10 000 corners. A world
/// without groups stands for a draw that is not valid.
inline RandomWorld random_world(uint64_t seed) {
  RandomPolygons random(seed);
  RandomWorld world;
  world.scene.seed = seed;
  world.scene.step_s = 0.05;
  const double far_m = random.whole(0, 4) == 0 ? 99'000 : 0;
  const Eigen::Vector2d origin(far_m, -far_m);
  std::vector<Polygon> rooms;
  const bool has_many_corners = seed % 100 == 50;
  const int count = has_many_corners ? 1 : random.whole(1, 4);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d middle = origin + Eigen::Vector2d(7 * i, random.uniform(-2, 2));
    const int corners = has_many_corners ? 10'000 : random.whole(4, 24);
    const double radius_m = has_many_corners ? 8 : 3.4;  // at least 5 mm per corner
    Polygon room{random.star(middle, radius_m - 1.2, radius_m, corners), {}};
    if (random.whole(0, 1) == 0) room.holes = {random.star(middle, 0.3, 0.8, random.whole(3, 9))};
    rooms.push_back(std::move(room));
    if (i == 0) continue;
    const double half_m = 0.5 * (random.whole(0, 7) == 0 ? 0.001 : random.uniform(0.05, 1.6));
    const Eigen::Vector2d from = middle - Eigen::Vector2d(7, 0);
    rooms.push_back({{from + Eigen::Vector2d(1.5, -half_m), from + Eigen::Vector2d(5.5, -half_m),
                      from + Eigen::Vector2d(5.5, half_m), from + Eigen::Vector2d(1.5, half_m)},
                     {}});
    for (Eigen::Vector2d& corner : rooms.back().outline)
      corner = (corner * 1e4).array().round() / 1e4;
  }
  std::erase_if(rooms, [](const Polygon& room) { return fault_of(room).has_value(); });
  if (rooms.empty()) return world;
  world.scene.floor = rooms.size() > 1 ? join(rooms, "").polygons : std::move(rooms);
  world.scene.ground = ground_around(world.scene.floor);
  for (const Polygon& polygon : world.scene.floor) {
    add_ring(polygon.outline, world.walls);
    for (const Polygon::Ring& hole : polygon.holes) add_ring(hole, world.walls);
  }
  const int obstacles = random.whole(0, 3);
  for (int i = 0; i < obstacles; ++i) {
    const Eigen::Vector2d at =
        origin + Eigen::Vector2d(random.uniform(-2, 7 * count - 5), random.uniform(-2, 2));
    const Polygon obstacle{random.whole(0, 3) == 0 ? random.sliver(at, 1.5)
                                                   : random.star(at, 0.2, 1.2, random.whole(3, 14)),
                           {}};
    if (fault_of(obstacle)) continue;
    add_ring(obstacle.outline, world.walls);
    for (const Polygon::Ring& piece : convex_pieces_of(obstacle)) {
      world.scene.obstacles.push_back(prism_obstacle("", piece, 0, 2));
      world.scene.obstacles.back().surface = static_cast<uint32_t>(i + 1);
    }
  }
  Group group;
  group.count = 6;
  group.on_arrival = OnArrival::kLeave;
  // In the first room: a passage may be too narrow for all of them.
  group.spawn =
      Rectangle{origin - Eigen::Vector2d::Constant(1.4), origin + Eigen::Vector2d::Constant(1.4)};
  const Polygon goal{random.star(origin + Eigen::Vector2d(7 * (count - 1) + 1.5, 0.5), 0.5, 1.2,
                                 random.whole(3, 9)),
                     {}};
  if (fault_of(goal)) return {};
  group.goals.emplace_back(Area(std::vector<Polygon>{goal}));
  world.scene.groups.push_back(std::move(group));
  return world;
}

}  // namespace throng::test
