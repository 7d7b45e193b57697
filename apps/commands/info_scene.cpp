#include <fmt/format.h>

#include <numeric>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "apps/commands/info.h"
#include "avatars/model/describe.h"
#include "base/text.h"
#include "crowd/navigation/flow_field.h"
#include "crowd/navigation/footprints.h"
#include "crowd/navigation/nav_mesh.h"
#include "crowd/navigation/walkable.h"
#include "scenes/file/scene.h"

namespace throng {
namespace {

constexpr size_t kMaxListedObstacles = 30;

std::string describe(const Rectangle& area) {
  return fmt::format("({:g}, {:g}) to ({:g}, {:g}) m", area.min_m.x(), area.min_m.y(),
                     area.max_m.x(), area.max_m.y());
}

std::string describe(const std::vector<Polygon>& polygons, double area_m2) {
  return fmt::format("{:.1f} m2 with {} corners in {}", area_m2, vertex_count(polygons),
                     describe(bounds_of(polygons)));
}

std::string describe(const Area& area) {
  return area.is_rectangle() ? describe(area.bounds()) : describe(area.polygons(), area.area_m2());
}

std::string describe_ground(const Scene& scene) {
  return scene.floor.empty() ? describe(scene.ground)
                             : describe(scene.floor, ground_area_m2(scene));
}

std::string_view kind_name(Obstacle::Kind kind) {
  switch (kind) {
    case Obstacle::Kind::kBox:
      return "box";
    case Obstacle::Kind::kCylinder:
      return "cylinder";
    case Obstacle::Kind::kMesh:
      return "mesh";
    case Obstacle::Kind::kPolygon:
      return "polygon";
  }
  return "";
}

/// Lengths of the paths between a group's goals, from the centre of its spawn area.
void add_path_lengths(std::string& text, const Group& group, const NavMesh& mesh) {
  Eigen::Vector2d from = group.count > 0 || group.sources.empty()
                             ? group.spawn.middle_m()
                             : group.sources.front().area.middle_m();
  text += "    path     ";
  for (size_t i = 0; i < group.goals.size(); ++i) {
    const Path path = mesh.path(from, group.goals[i].areas);
    if (i > 0) text += ", ";
    if (path.arrives)
      append(text, "{:.1f} m to goal {}", path.length_m(), i + 1);
    else
      append(text, "none to goal {}", i + 1);
    if (path.corners_m.size() > 2) append(text, " by {} corners", path.corners_m.size() - 2);
    if (!path.corners_m.empty()) from = path.corners_m.back();
  }
  text += '\n';
}

void add_distribution(std::string& text, const char* what, const Distribution& d,
                      const char* unit) {
  append(text, "    {:<8} {:g} +- {:g} {}, {:g} to {:g}\n", what, d.mean, d.std_dev, unit, d.min,
         d.max);
}

/// Sizes and speeds: common ones once, others by age group.
void add_people(std::string& text, const Group& group) {
  const double sum = std::accumulate(group.ages.begin(), group.ages.end(), 0.0);
  const bool by_age = !group.speed_mps || !group.height_m;
  for (size_t i = 0; i < kAgeCount && by_age; ++i) {
    if (group.ages[i] == 0) continue;
    const AgeGroup& age = age_group(static_cast<Age>(i));
    if (group.ages != kAdultsOnly)
      append(text, "    {:.0f} % {}\n", 100 * group.ages[i] / sum, age.name);
    if (!group.speed_mps) add_distribution(text, "speed", age.speed_mps, "m/s");
    if (!group.height_m) add_distribution(text, "height", age.height_m, "m");
  }
  if (group.speed_mps) add_distribution(text, "speed", *group.speed_mps, "m/s");
  if (group.height_m) add_distribution(text, "height", *group.height_m, "m");
}

void add_recorded(std::string& text, const Scene& scene) {
  const Group& group = scene.groups.back();
  const RecordingFacts& facts = scene.recorded->recording->facts();
  append(text, "  {}: {} of '{}', {} parts each\n", group.name, group.recorded, group.body->name,
         group.body->part_count());
  append(text, "    tracks   of {}, {} '{}', {:.6g} s\n",
         facts.tracked_point == TrackedPoint::kHead ? "heads" : "centres", facts.kind,
         scene.recorded->options.file.filename().string(), facts.duration_s);
  append(text, "    size     {}\n", describe_size(group));
}

/// "10 s after the start", "2 s after all members of 'a' have been at goal 1".
std::string describe(const TriggerRule& rule) {
  if (rule.group.empty()) return fmt::format("{:g} s after the start", rule.delay_s);
  const std::string goal = rule.goal > 0 ? fmt::format("goal {}", rule.goal) : "the last goal";
  return fmt::format("{:g} s after all members of '{}' have been at {}", rule.delay_s, rule.group,
                     goal);
}

void add_door(std::string& text, const Door& door) {
  append(text, "  {}: ({:g}, {:g}) to ({:g}, {:g})\n", door.name, door.from_m.x(), door.from_m.y(),
         door.to_m.x(), door.to_m.y());
  for (const TriggerRule& rule : door.opens) append(text, "    opens    {}\n", describe(rule));
  for (const TriggerRule& rule : door.closes) append(text, "    closes   {}\n", describe(rule));
}

void add_queues(std::string& text, const Group& group) {
  for (size_t i = 0; i < group.goals.size(); ++i) {
    const Goal& goal = group.goals[i];
    if (!goal.is_limited()) continue;
    append(text, "    queue    for goal {}, which serves {} at once", i + 1, goal.max_inside());
    if (goal.areas.size() > 1) append(text, " in each of {} areas", goal.areas.size());
    append(text, ", {:g} m apart\n", goal.queue.spacing_m);
  }
}

void add_group(std::string& text, const Group& group, const NavMesh& mesh) {
  append(text, "  {}: {} of '{}', {} parts each, {} goals\n", group.name, group.total(),
         group.body->name, group.body->part_count(), group.goals.size());
  if (group.count > 0) append(text, "    from     {}\n", describe(group.spawn));
  if (group.density_per_m2 > 0)
    append(text, "    density  {:g} per m2 of free ground\n", group.density_per_m2);
  if (group.after) append(text, "    after    {}\n", describe(*group.after));
  if (group.social_groups)
    append(text, "    together {:g} % in social groups of 2, 3 and 4 as {:g} to {:g} to {:g}\n",
           100 * group.social_groups->share, group.social_groups->sizes[0],
           group.social_groups->sizes[1], group.social_groups->sizes[2]);
  for (const Source& source : group.sources)
    append(text, "    source   {} at {:g} per s from {:g} s on, {}\n", source.count,
           source.rate_per_s, source.start_s, describe(source.area));
  if (!group.control_channel.empty())
    append(text, "    control  by messages on the LCM channel {} only\n", group.control_channel);
  else if (group.is_external())
    append(text, "    control  by the program that steps the run only\n");
  if (group.spare > 0) append(text, "    spare    {}, until the run adds them\n", group.spare);
  if (!group.is_external()) add_path_lengths(text, group, mesh);
  add_queues(text, group);
  append(text, "    size     {}\n", describe_size(group));
  add_people(text, group);
}

void add_obstacle(std::string& text, const StatedObstacle& stated) {
  const Obstacle& first = *stated.pieces.front();
  Eigen::Vector2d size_m = first.size_m.head<2>(), middle_m = first.centre_m.head<2>();
  if (stated.pieces.size() > 1) {
    Rectangle bounds = bounds_of(footprint_of(first));
    for (const Obstacle* piece : stated.pieces)
      bounds = bounds.joined(bounds_of(footprint_of(*piece)));
    size_m = bounds.size_m();
    middle_m = bounds.middle_m();
  }
  append(text, "  {}: {} {:g} x {:g} x {:g} m at ({:g}, {:g})", stated.name, kind_name(first.kind),
         size_m.x(), size_m.y(), first.size_m.z(), middle_m.x(), middle_m.y());
  if (stated.pieces.size() > 1) append(text, ", in {} pieces", stated.pieces.size());
  text += '\n';
}

void add_obstacles(std::string& text, const Scene& scene) {
  append(text, "\nObstacles:{}\n", scene.obstacles.empty() ? " none" : "");
  size_t walls = 0, listed = 0, left = 0;
  for (const Obstacle& obstacle : scene.obstacles) walls += obstacle.lines_floor ? 1 : 0;
  for (const StatedObstacle& stated : stated_obstacles(scene)) {
    const Obstacle& first = *stated.pieces.front();
    if (first.lines_floor) {
      if (walls > 0)
        append(text, "  walls: {} along the edges of the ground, {:g} m high\n", walls,
               first.size_m.z());
      walls = 0;
    } else if (listed < kMaxListedObstacles) {
      add_obstacle(text, stated);
      ++listed;
    } else {
      ++left;
    }
  }
  if (left > 0) append(text, "  and {} more\n", left);
}

/// Assumptions made about the scene's models.
void add_notes(std::string& text, const Scene& scene) {
  std::vector<std::shared_ptr<const Model>> models;
  for (const Group& group : scene.groups)
    if (group.body != nullptr) models.push_back(group.body);
  if (scene.box && scene.box->body != nullptr) models.push_back(scene.box->body);
  for (const std::string& note : notes_on(models)) append(text, "note: {}\n", note);
}

}  // namespace

std::vector<StatedObstacle> stated_obstacles(const Scene& scene) {
  std::vector<StatedObstacle> out;
  std::unordered_map<uint32_t, size_t> by_surface;
  for (const Obstacle& obstacle : scene.obstacles) {
    const auto [at, is_first] = obstacle.surface == 0
                                    ? std::pair(by_surface.end(), true)
                                    : by_surface.try_emplace(obstacle.surface, out.size());
    if (is_first)
      out.push_back({obstacle.name, {&obstacle}});
    else
      out[at->second].pieces.push_back(&obstacle);
  }
  // Pieces have their numbers behind the name.
  constexpr std::string_view kFirst = " 1";
  for (StatedObstacle& each : out)
    if (each.pieces.size() > 1 && each.name.ends_with(kFirst))
      each.name.erase(each.name.size() - kFirst.size());
  return out;
}

std::optional<NavMesh> navigation_mesh_of(const Scene& scene) {
  const bool follows_recording = scene.recorded && scene.groups.size() == 1;
  if (scene.box || follows_recording) return std::nullopt;
  const Walkable walkable(scene);
  const FlowGrid grid(walkable);
  return NavMesh(scene.ground, walkable.footprints(), grid.passages(), grid.closures(),
                 scene.floor);
}

std::string describe_scene(const Scene& scene, const std::optional<NavMesh>& mesh) {
  std::string text;
  int people = 0;
  for (const Group& group : scene.groups) people += static_cast<int>(group.total());
  if (scene.box) people = scene.box->count;
  append(text, "{}: {}\n", scene.name, scene.description);
  append(text, "  ground     {}\n", describe_ground(scene));
  append(text, "  avatars    {}, {:.2f} per m2 of ground\n", people,
         people / ground_area_m2(scene));
  append(text, "  time       {:g} s in steps of 1/{:g} s, seed {}\n", scene.duration_s,
         1 / scene.step_s, scene.seed);
  append(text, "  culling    sphere, then {}{}\n", to_text(scene.part_volume),
         scene.exact ? ", then triangles" : "");
  if (scene.box) {
    const PartsBox& box = *scene.box;
    append(text,
           "  box        {} loose parts of '{}' in a cube of {:g} m; {:g} to {:g} m/s, up to "
           "{:g} rad/s\n",
           box.count, box.body->name, box.edge_m, box.min_speed_mps, box.max_speed_mps,
           box.max_spin_radps);
    add_notes(text, scene);
    return text;
  }
  std::string groups;
  if (mesh) {
    append(text, "  paths      navigation mesh of {} polygons from voxels of {:.2g} m\n",
           mesh->polygon_count(), mesh->voxel_m());
    for (const Group& group : scene.groups)
      if (group.recorded == 0) add_group(groups, group, *mesh);
  }
  if (scene.recorded) add_recorded(groups, scene);
  text += "\nGroups:\n" + groups;
  add_obstacles(text, scene);
  for (const std::string& note : scene.notes) append(text, "  note: {}\n", note);
  if (!scene.doors.empty()) text += "\nDoors:\n";
  for (const Door& door : scene.doors) add_door(text, door);
  add_notes(text, scene);
  return text;
}

}  // namespace throng
