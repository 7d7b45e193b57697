#include "scenes/file/polygon_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "avatars/mesh/primitives.h"
#include "base/errors.h"
#include "base/limits.h"
#include "crowd/crowd_plan.h"
#include "geometry/floor.h"
#include "geometry/polygon_union.h"
#include "geometry/wkt.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

/// Margin of the ground around a floor, in metres.
constexpr double kFloorMargin_m = 1;
/// From a kerb to a tower; walls keep their height when a plan is scaled.
constexpr Range kWallHeightRange{0, 1000};

KeyText corner_text(const std::string& name, const std::string& meaning) {
  return {name,
          meaning,
          "required of a rectangle",
          false,
          {.kind = Rule::Kind::kNumbers, .range = kPositionRange, .min = 2, .max = 2}};
}

[[noreturn]] void reject_fault(const std::string& where, const std::string& what,
                               const PolygonFault& fault) {
  throw InputError(where, fmt::format("{} in {}", fault.expected, what), fault.found);
}

/// Removes vertices that repeat the one before, and those exactly on a line between neighbours.
void simplify(Polygon::Ring& ring) {
  const auto is_needless = [&](size_t i) {
    const Eigen::Vector2d &before = ring[(i + ring.size() - 1) % ring.size()], &at = ring[i],
                          &after = ring[(i + 1) % ring.size()];
    const Eigen::Vector2d in = at - before, on = after - at;
    return in.isZero() || (in.x() * on.y() == in.y() * on.x() && in.dot(on) > 0);
  };
  for (size_t i = 0; i < ring.size() && ring.size() > 3;)
    if (is_needless(i))
      ring.erase(ring.begin() + static_cast<ptrdiff_t>(i));
    else
      ++i;
}

void simplify(Polygon& polygon) {
  simplify(polygon.outline);
  for (Polygon::Ring& hole : polygon.holes) simplify(hole);
}

void require_vertices(const std::string& where, const std::string& what, size_t count, size_t max) {
  if (count > max)
    throw InputError(where, fmt::format("at most {} vertices in {}", max, what),
                     fmt::format("{}; simplify the outline", count));
}

/// Checks and mends each polygon, and joins those that touch or overlap.
std::vector<Polygon> checked(ReadContext& context, std::vector<Polygon> polygons,
                             const std::string& where, const std::string& what) {
  require_vertices(where, what, vertex_count(polygons), kMaxVertices);
  std::vector<Polygon> sound;
  for (Polygon& polygon : polygons) {
    simplify(polygon);
    MendedPolygon mend = mended(std::move(polygon));
    if (mend.fault) reject_fault(where, what, *mend.fault);
    if (mend.slivers > 0)
      context.scene.notes.push_back(fmt::format("{}: {}: {}", where, what, slivers_text(mend)));
    std::move(mend.polygons.begin(), mend.polygons.end(), std::back_inserter(sound));
  }
  return sound.size() > 1 ? join(sound, where).polygons : sound;
}

std::vector<Polygon> polygons_of_text(ReadContext& context, const std::string& wkt,
                                      const std::string& where, const std::string& what) {
  return checked(context, parse_wkt(wkt, where), where, what);
}

bool has_polygons(const Fields& fields) {
  return fields.find("polygon") != nullptr || fields.find("wkt") != nullptr;
}

/// Reads the polygons of a map that has_polygons().
std::vector<Polygon> read_polygons(ReadContext& context, const Fields& fields,
                                   const std::string& what) {
  if (fields.find("polygon") != nullptr) {
    for (const char* other : {"wkt", "min_m", "max_m"})
      if (const YamlNode* node = fields.find(other))
        throw InputError(fields.where(*node), fmt::format("one shape of {}", what),
                         fmt::format("'polygon' and '{}'", other));
    return read_polygon(context, fields, what);
  }
  for (const char* other : {"holes", "min_m", "max_m"})
    if (const YamlNode* node = fields.find(other))
      throw InputError(fields.where(*node), fmt::format("one shape of {}", what),
                       fmt::format("'wkt' and '{}'", other));
  return polygons_of_text(context, fields.text("wkt"), fields.where(fields.require("wkt")), what);
}

/// Returns whether some of 17 x 17 points of an area lie on the floor.
bool touches(const Area& area, const PolygonLocator& locator) {
  constexpr int kSteps = 16;
  if (locator.contains(area.middle_m())) return true;
  for (int i = 0; i <= kSteps; ++i)
    for (int k = 0; k <= kSteps; ++k)
      if (locator.contains(area.at(Eigen::Vector2d(i, k) / kSteps))) return true;
  return false;
}

void require_on_ground(ReadContext& context, const std::string& where, const std::string& what,
                       const Area& area) {
  const Scene& scene = context.scene;
  if (!scene.ground.contains(area.bounds().min_m) || !scene.ground.contains(area.bounds().max_m))
    throw InputError(where, fmt::format("{} within the ground ({})", what, to_text(scene.ground)),
                     to_text(area.bounds()));
  if (scene.floor.empty()) return;
  if (!context.floor_locator) context.floor_locator.emplace(scene.floor);
  if (!touches(area, *context.floor_locator))
    throw InputError(where, fmt::format("{} on the walkable ground", what),
                     fmt::format("all of it outside, around [{:g}, {:g}]", area.middle_m().x(),
                                 area.middle_m().y()));
}

std::vector<Polygon> read_floor(ReadContext& context, const Fields& fields) {
  if (has_polygons(fields)) return read_polygons(context, fields, "ground");
  const YamlNode* node = fields.find("file");
  if (node == nullptr) return {};
  const std::filesystem::path path =
      existing_file(context, fields, *node, "a file with well-known text (WKT)");
  return polygons_of_text(context, read_text_file(path, kMaxYamlBytes), path.string(), "ground");
}

}  // namespace

std::vector<Polygon> read_polygon(ReadContext& context, const Fields& fields,
                                  const std::string& what) {
  Polygon polygon{fields.points("polygon", 3, kPositionRange), {}};
  if (fields.find("holes") != nullptr) polygon.holes = fields.rings("holes", kPositionRange);
  const auto open = [](Polygon::Ring& ring) {
    if (ring.size() > 3 && ring.front() == ring.back()) ring.pop_back();
  };
  open(polygon.outline);
  for (Polygon::Ring& hole : polygon.holes) open(hole);
  return checked(context, {std::move(polygon)}, fields.where(fields.require("polygon")), what);
}

Area read_area(ReadContext& context, const Fields& fields, const std::string& what) {
  Area area;
  if (has_polygons(fields)) {
    std::vector<Polygon> polygons = read_polygons(context, fields, what);
    require_vertices(fields.where(), what, vertex_count(polygons), kMaxAreaVertices);
    area = Area(std::move(polygons));
  } else {
    area = read_rectangle(fields, what);
  }
  require_on_ground(context, fields.where(), what, area);
  return area;
}

Area read_area(ReadContext& context, const std::string& file, const YamlNode& node,
               const std::string& what) {
  const Fields fields(file, node, what);
  fields.expect_keys({"min_m", "max_m", "polygon", "holes", "wkt"});
  return read_area(context, fields, what);
}

Rectangle ground_around(const std::vector<Polygon>& floor) {
  const Rectangle ground = bounds_of(floor).grown(kFloorMargin_m);
  const Eigen::Vector2d farthest = Eigen::Vector2d::Constant(kMaxCoordinate_m);
  return {ground.min_m.cwiseMax(-farthest), ground.max_m.cwiseMin(farthest)};
}

void read_ground_value(ReadContext& context, const YamlNode& node, const std::string& file,
                       Scene& scene) {
  const Fields fields(file, node, "ground");
  fields.expect_keys({"min_m", "max_m", "polygon", "holes", "wkt", "file", "wall_height_m"});
  std::vector<Polygon> floor = read_floor(context, fields);
  if (floor.empty()) {
    scene.ground = read_rectangle(fields, "ground");
  } else if (!scene.floor.empty()) {
    throw InputError(fields.where(),
                     "a rectangle as ground, because the recording has a walkable area",
                     "polygons; add geometry: false to the recording, or give a rectangle");
  } else if (const auto rectangle = rectangle_of(floor.front()); rectangle && floor.size() == 1) {
    scene.ground = *rectangle;
  } else {
    scene.ground = ground_around(floor);
    scene.floor = std::move(floor);
  }
  const double height_m = fields.number_or("wall_height_m", kWallHeightRange, 0);
  if (height_m > 0) add_walls(scene, height_m, fields.where());
}

Obstacle prism_obstacle(std::string name, const Polygon::Ring& ring, double bottom_m,
                        double top_m) {
  const Rectangle bounds = bounds_of(ring);
  const Eigen::Vector2d middle = bounds.middle_m();
  Obstacle obstacle;
  obstacle.name = std::move(name);
  obstacle.kind = Obstacle::Kind::kPolygon;
  obstacle.centre_m = {middle.x(), middle.y(), 0.5 * (bottom_m + top_m)};
  obstacle.size_m = {bounds.size_m().x(), bounds.size_m().y(), top_m - bottom_m};
  Polygon::Ring local;
  for (const Eigen::Vector2d& corner : ring) local.push_back(corner - middle);
  obstacle.mesh = prism_mesh(local, obstacle.size_m.z());
  return obstacle;
}

void add_walls(Scene& scene, double height_m, const std::string& where) {
  const std::vector<Polygon> floor =
      scene.floor.empty() ? std::vector<Polygon>{polygon_of(scene.ground)} : scene.floor;
  const std::vector<FloorStrip> strips = strips_around(floor);
  if (static_cast<int64_t>(strips.size() + scene.obstacles.size()) > kMaxObstacles)
    throw InputError(where,
                     fmt::format("at most {} walls and obstacles; without walls (wall_height_m: 0, "
                                 "geometry: false of a recording) edges still stop agents",
                                 kMaxObstacles),
                     fmt::format("{}", strips.size() + scene.obstacles.size()));
  for (const FloorStrip& strip : strips) {
    scene.obstacles.push_back(prism_obstacle(fmt::format("wall {}", scene.obstacles.size() + 1),
                                             {strip.begin(), strip.end()}, 0, height_m));
    scene.obstacles.back().lines_floor = true;
  }
}

std::vector<KeyText> area_key_texts() {
  return {corner_text("min_m", "south-west corner of a rectangle"),
          corner_text("max_m", "north-east corner of a rectangle"),
          {"polygon",
           "corners `[x, y]` of a polygon, in either direction",
           "required of a polygon",
           false,
           {.kind = Rule::Kind::kPoints, .range = kPositionRange, .min = 3}},
          {"holes",
           "holes of the polygon, each a list of corners",
           "none",
           false,
           {.kind = Rule::Kind::kRings, .range = kPositionRange, .min = 3}},
          {"wkt",
           "POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION as well-known text; pieces that touch or "
           "overlap are joined",
           "required of text",
           false,
           {}}};
}

MapText area_text() {
  return {.name = "area",
          .meaning = "A rectangle, a polygon with holes, or well-known text, in metres",
          .keys = area_key_texts(),
          .choices = {{"min_m", "max_m"}, {"polygon"}, {"wkt"}}};
}

MapText ground_text() {
  MapText text{.name = "ground",
               .meaning = "Walkable ground: an area as above, or a file with its text",
               .keys = area_key_texts(),
               .choices = {{"min_m", "max_m"}, {"polygon"}, {"wkt"}, {"file"}}};
  text.keys.push_back(
      {"file", "file with well-known text, relative to the scene file", "none", false, {}});
  text.keys.push_back({"wall_height_m",
                       "height of walls along the edges, which are obstacles; edges without walls "
                       "stop agents but make no contacts",
                       "0",
                       false,
                       {.kind = Rule::Kind::kNumber, .range = kWallHeightRange}});
  return text;
}

}  // namespace throng
