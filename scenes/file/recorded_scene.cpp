#include "scenes/file/recorded_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "avatars/mesh/primitives.h"
#include "base/errors.h"
#include "base/portable_math.h"
#include "base/text.h"
#include "crowd/crowd_plan.h"
#include "geometry/polygon_union.h"
#include "scenes/file/scene_keys.h"

namespace throng {
namespace {

constexpr double kMaxStep_s = 1.0 / 60;
/// Margin of the ground around recorded positions, in metres: bodies extend beyond them.
constexpr double kMargin_m = 1;
// Walls around a walkable area stand outside of it and have the height of a storey.
constexpr double kWallHeight_m = 2.5;
constexpr double kWallThickness_m = 0.05;
constexpr double kMinWall_m = 1e-3;

double step_of(const RecordingFacts& facts, const RecordedPeople& people,
               const std::string& where) {
  if (facts.fps == 0) {
    if (people.recorded_frames)
      throw InputError(where, "a recording with frames for 'sampling: recorded'",
                       "footsteps, which begin and end at any time");
    return kMaxStep_s;
  }
  if (people.recorded_frames) return 1 / facts.fps;
  const double steps = std::ceil(1 / (facts.fps * kMaxStep_s) - 1e-9);
  return 1 / (facts.fps * std::max(1.0, steps));
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool is_before(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

/// Corners that several rings share, sorted: the area continues behind them.
std::vector<Eigen::Vector2d> shared_corners(const std::vector<Polygon>& area) {
  std::vector<Eigen::Vector2d> all, shared;
  for (const Polygon& polygon : area) {
    all.insert(all.end(), polygon.outline.begin(), polygon.outline.end());
    for (const Polygon::Ring& hole : polygon.holes) all.insert(all.end(), hole.begin(), hole.end());
  }
  std::sort(all.begin(), all.end(), is_before);
  for (size_t i = 1; i < all.size(); ++i)
    if (all[i] == all[i - 1]) shared.push_back(all[i]);
  return shared;
}

/// Adds a box along each edge, on the side that is not walkable.
void add_walls(Polygon::Ring ring, bool walkable_inside, const std::vector<Eigen::Vector2d>& shared,
               std::vector<Obstacle>& walls) {
  if ((doubled_area(ring) > 0) != walkable_inside) std::reverse(ring.begin(), ring.end());
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& corner : ring)
    if (corners.empty() || (corner - corners.back()).norm() >= kMinWall_m)
      corners.push_back(corner);
  const size_t count = corners.size();
  for (size_t i = 0; i < count && count > 1; ++i) {
    const Eigen::Vector2d &before = corners[(i + count - 1) % count], &from = corners[i],
                          &to = corners[(i + 1) % count], &after = corners[(i + 2) % count];
    const Eigen::Vector2d along = (to - from).normalized(), out(along.y(), -along.x());
    // Walls meet in a corner where the area bends outwards; elsewhere they would reach into the
    // area.
    const auto reach_m = [&](const Eigen::Vector2d& corner, double turn) {
      const bool ends = std::binary_search(shared.begin(), shared.end(), corner, is_before);
      return turn > 0 && !ends ? kWallThickness_m : 0;
    };
    const double early_m = reach_m(from, cross(from - before, to - from));
    const double late_m = reach_m(to, cross(to - from, after - to));
    const Eigen::Vector2d middle =
        0.5 * (from - early_m * along + to + late_m * along) + 0.5 * kWallThickness_m * out;
    Obstacle wall;
    wall.name = fmt::format("wall {}", walls.size() + 1);
    wall.centre_m = {middle.x(), middle.y(), 0.5 * kWallHeight_m};
    wall.heading_rad = arc_tan2(along.y(), along.x());
    wall.size_m = {(to - from).norm() + early_m + late_m, kWallThickness_m, kWallHeight_m};
    wall.mesh = box_mesh(wall.size_m);
    walls.push_back(std::move(wall));
  }
}

Rectangle ground_of(const RecordingFacts& facts, const std::vector<Polygon>& area) {
  Rectangle ground = facts.bounds;
  for (const Polygon& polygon : area)
    for (const Eigen::Vector2d& corner : polygon.outline) {
      ground.min_m = ground.min_m.cwiseMin(corner);
      ground.max_m = ground.max_m.cwiseMax(corner);
    }
  return ground.grown(kMargin_m);
}

void add_geometry(Scene& scene, const std::string& where) {
  const std::vector<Eigen::Vector2d> shared = shared_corners(scene.area);
  for (const Polygon& polygon : scene.area) {
    add_walls(polygon.outline, true, shared, scene.obstacles);
    for (const Polygon::Ring& hole : polygon.holes) add_walls(hole, false, shared, scene.obstacles);
  }
  if (static_cast<int64_t>(scene.obstacles.size()) > kMaxObstacles)
    throw InputError(where,
                     fmt::format("at most {} walls and obstacles; geometry: false omits the "
                                 "walls of the file",
                                 kMaxObstacles),
                     fmt::format("{}", scene.obstacles.size()));
}

}  // namespace

Group recorded_group() {
  Group group;
  group.name = "recorded";
  group.model = adult_urdf();
  return group;
}

void take_people(const Recording& recording, Group& group) {
  group.recorded = static_cast<int64_t>(recording.people().size());
  for (const RecordedPerson& person : recording.people()) {
    group.recorded_heights += person.height_m ? 1 : 0;
    group.tallest_recorded_m = std::max(group.tallest_recorded_m, person.height_m.value_or(0));
  }
}

void apply_recording(Scene& scene, bool has_ground, const std::string& where) {
  RecordedPeople& people = *scene.recorded;
  people.recording = read_recording(people.options);
  const RecordingFacts& facts = people.recording->facts();
  scene.step_s = step_of(facts, people, where);
  // A run ends before the frame at its end time; the last recorded frame is a step earlier.
  scene.duration_s = facts.duration_s + scene.step_s;
  if (people.geometry) scene.area = recorded_area(facts, people.options.file.string()).polygons;
  if (!has_ground) scene.ground = ground_of(facts, scene.area);
  add_geometry(scene, where);
  take_people(*people.recording, scene.groups.back());
}

Scene recorded_scene(const RecordingOptions& options, bool recorded_frames) {
  Scene scene;
  scene.file = options.file;
  scene.name = name_after(options.file.stem().string());
  scene.recorded.emplace().options = options;
  scene.recorded->recorded_frames = recorded_frames;
  scene.groups.push_back(recorded_group());
  apply_recording(scene, false, options.file.string());
  scene.description = scene.recorded->recording->facts().kind;
  scene.content_hash = content_hash_of(scene);
  return scene;
}

}  // namespace throng
