// import_plan() detects the kind of a floor plan, converts it to metres and cleans its shapes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/errors.h"
#include "base/rectangle.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"
#include "recordings/units.h"
#include "scenes/import/plan_layers.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

struct PlanReader {
  bool (*knows)(std::string_view head);
  ImportedPlan (*read)(const ImportOptions& options);
  bool has_layers;
};

/// In the order in which they are tried.
constexpr std::array kPlanReaders = {
    PlanReader{is_dxf, read_dxf, true},
    PlanReader{is_vadere_scenario, read_vadere_scenario, false},
    PlanReader{is_geojson, read_geojson, true},
    PlanReader{is_wkt_plan, read_wkt_plan, false},
    PlanReader{is_jupedsim_database, read_jupedsim_database, false},
    PlanReader{is_jupedsim_geometry, read_jupedsim_geometry, false},
    PlanReader{is_occupancy_grid, read_occupancy_grid, false}};

/// Scenes reach 100 km from the origin.
constexpr double kMaxUnshifted_m = 90'000;
constexpr double kMinPlan_m = 0.5;
constexpr double kMaxPlan_m = 20'000;
/// Coordinates are rounded to it: the grid of polygons, and the decimals of a scene.
constexpr double kPlanGrid_m = 1e-4;

struct ForeignPlan {
  std::string_view mark;
  std::string_view found;
};
constexpr ForeignPlan kForeignPlans[] = {
    {"ISO-10303-21", "an IFC or STEP file; export the plan as DXF or WKT"},
    {"%PDF", "a PDF file; export the plan as DXF"},
    {"<svg", "an SVG picture; export the plan as DXF"},
    {std::string_view("\0\0\x27\x0a", 4), "a shapefile; export it as WKT or GeoJSON"},
    {"PK\x03\x04", "a zip file; unpack it first"},
    {"\x1f\x8b", "a compressed file; unpack it first"}};

std::string head_of(const RegularFile& file) {
  std::string head(static_cast<size_t>(std::min<uint64_t>(file.size(), kPlanHeadBytes)), '\0');
  file.read(std::as_writable_bytes(std::span(head)));
  return head;
}

[[noreturn]] void reject_unknown_kind(const std::string& file, std::string_view head) {
  std::string_view first_line = head;
  while (!first_line.empty() && (first_line[0] == '\n' || first_line[0] == '\r'))
    first_line.remove_prefix(1);
  first_line = first_line.substr(0, first_line.find_first_of("\r\n"));
  std::string found = head.empty() ? "an empty file" : in_quotes(first_line);
  for (const ForeignPlan& each : kForeignPlans)
    if (head.starts_with(each.mark) || (each.mark == "<svg" && head.find(each.mark) != head.npos))
      found = each.found;
  throw InputError(file,
                   "a floor plan: DXF, WKT, GeoJSON, the map.yaml of a ROS occupancy grid, "
                   "JuPedSim or Vadere",
                   found);
}

ImportedPlan read_plan(const ImportOptions& options) {
  const std::string file = options.file.string();
  const std::string head =
      head_of(RegularFile(options.file, "a floor plan", kMaxPlanDatabaseBytes));
  for (const PlanReader& reader : kPlanReaders) {
    if (!reader.knows(head)) continue;
    const LayerChoice choice(options);  // checks the uses
    if (!choice.is_empty() && !reader.has_layers)
      throw InputError("--layer", "a plan with layers: DXF or GeoJSON",
                       reader.read(options).kind + ", which has none; leave the option out");
    return reader.read(options);
  }
  reject_unknown_kind(file, head);
}

template <typename Each>
void for_each_ring(ImportedPlan& plan, const Each& each) {
  const auto both = [&](Polygon& polygon) {
    each(polygon.outline);
    for (Polygon::Ring& hole : polygon.holes) each(hole);
  };
  for (Polygon& polygon : plan.walkable) both(polygon);
  for (auto* named : {&plan.obstacles, &plan.starts, &plan.goals})
    for (NamedPolygon& area : *named) both(area.polygon);
  for (PlanWall& wall : plan.walls) each(wall.line_m);
}

void convert_to_metres(ImportedPlan& plan, const ImportOptions& options) {
  const std::optional<double> unit_m = options.unit_m ? options.unit_m : plan.unit_m;
  if (!unit_m)
    throw InputError(options.file.string(), "a unit of length, as in --unit m",
                     plan.kind + " without one");
  const UnitScale scale(*unit_m);
  for_each_ring(plan, [&](std::vector<Eigen::Vector2d>& ring) {
    for (Eigen::Vector2d& point : ring) point = {scale.si(point.x()), scale.si(point.y())};
  });
  for (PlanWall& wall : plan.walls) wall.thickness_m = scale.si(wall.thickness_m);
}

/// Throws InputError for sizes that a wrong unit explains; shifts map coordinates to the origin.
void place(ImportedPlan& plan, const std::string& file) {
  std::optional<Rectangle> bounds = plan_bounds(plan);
  if (!bounds) throw InputError(file, "areas or walls", fmt::format("{} without any", plan.kind));
  const Eigen::Vector2d size_m = bounds->size_m();
  if (!(size_m.maxCoeff() >= kMinPlan_m && size_m.maxCoeff() <= kMaxPlan_m))
    throw InputError(
        file, fmt::format("a plan of {} m to {} km", kMinPlan_m, kMaxPlan_m / 1000),
        fmt::format("{:.4g} m by {:.4g} m; --unit states another unit", size_m.x(), size_m.y()));
  const Eigen::Vector2d min = bounds->min_m, max = bounds->max_m;
  if (std::max(min.cwiseAbs().maxCoeff(), max.cwiseAbs().maxCoeff()) <= kMaxUnshifted_m) return;
  plan.shift_m = min;
  for_each_ring(plan, [&](std::vector<Eigen::Vector2d>& ring) {
    for (Eigen::Vector2d& point : ring) point -= plan.shift_m;
  });
}

void round_to_grid(std::vector<Eigen::Vector2d>& points) {
  for (Eigen::Vector2d& point : points)
    for (double& value : point) value = std::round(value / kPlanGrid_m) / (1 / kPlanGrid_m);
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

/// Whether the corners do not lie on one line. A figure of eight has an extent, but no area.
bool has_extent(const Polygon::Ring& ring) {
  if (ring.size() < 3) return false;
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : ring)
    if ((corner - ring[0]).norm() > along.norm()) along = corner - ring[0];
  return std::any_of(ring.begin(), ring.end(), [&](const Eigen::Vector2d& corner) {
    const Eigen::Vector2d arm = corner - ring[0];
    return std::abs(along.x() * arm.y() - along.y() * arm.x()) > 0.5 * kPlanGrid_m * along.norm();
  });
}

/// Whether a polygon without repeated corners is left; holes without extent are dropped.
bool clean(Polygon& polygon) {
  const auto clean_ring = [](Polygon::Ring& ring) {
    round_to_grid(ring);
    while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    return has_extent(ring);
  };
  if (!clean_ring(polygon.outline)) return false;
  std::erase_if(polygon.holes, [&](Polygon::Ring& hole) { return !clean_ring(hole); });
  return true;
}

/// Whether a wall of pieces that a scene accepts is left.
bool clean(std::vector<Eigen::Vector2d>& line) {
  constexpr double kMinPiece_m = 0.0011;
  round_to_grid(line);
  std::vector<Eigen::Vector2d> out;
  for (size_t i = 0; i < line.size(); ++i) {
    const bool is_last = i + 1 == line.size();
    // The last corner stays: it may close the wall or meet another one.
    while (is_last && out.size() > 1 && (out.back() - line[i]).norm() < kMinPiece_m) out.pop_back();
    if (out.empty() || (out.back() - line[i]).norm() >= kMinPiece_m) out.push_back(line[i]);
  }
  line = std::move(out);
  return line.size() >= 2;
}

/// Keeps what a scene accepts: obstacles and walls that reach onto the ground, and the parts of
/// starts and goals on it.
void keep_to_ground(ImportedPlan& plan) {
  if (plan.walkable.empty()) return;
  // Walls along the edge reach onto the ground by half of their thickness.
  constexpr double kArea_m = -0.001, kWall_m = 0.01;
  const Rectangle ground = bounds_of(plan.walkable);
  const auto is_outside = [&](const std::vector<Eigen::Vector2d>& points, double grown_m) {
    const Rectangle bounds = bounds_of(points);
    return (bounds.min_m.array() - grown_m >= ground.max_m.array()).any() ||
           (bounds.max_m.array() + grown_m <= ground.min_m.array()).any();
  };
  size_t dropped = std::erase_if(plan.obstacles, [&](const NamedPolygon& each) {
    return is_outside(each.polygon.outline, kArea_m);
  });
  dropped += std::erase_if(plan.walls,
                           [&](const PlanWall& each) { return is_outside(each.line_m, kWall_m); });
  if (dropped > 0)
    plan.left_out.push_back(counted(dropped, "obstacle or wall", "obstacles and walls") +
                            " outside the walkable areas");
  size_t cut = 0;
  const auto clip = [&](Polygon& polygon) {
    const Polygon whole = polygon;
    polygon.outline = clipped_to(std::move(polygon.outline), ground);
    for (Polygon::Ring& hole : polygon.holes) hole = clipped_to(std::move(hole), ground);
    if (polygon == whole) return true;
    ++cut;
    return clean(polygon);
  };
  for (const auto& [named, what] :
       {std::pair(&plan.starts, "start"), std::pair(&plan.goals, "goal")})
    std::erase_if(*named, [&, what = what](NamedPolygon& each) {
      if (clip(each.polygon)) return false;
      --cut;
      plan.left_out.push_back(
          fmt::format("the {} {} outside the walkable areas", what, in_quotes(each.name)));
      return true;
    });
  if (cut > 0)
    plan.left_out.push_back("parts outside the walkable areas of " +
                            counted(cut, "start or goal", "starts and goals"));
}

/// See mended(). Slivers that were dropped are named as left out.
std::vector<Polygon> sound(Polygon polygon, const std::string& what, const std::string& file,
                           ImportedPlan& plan) {
  MendedPolygon mend = mended(std::move(polygon));
  if (mend.fault)
    throw InputError(file, fmt::format("{} in {}", mend.fault->expected, what),
                     mend.fault->found + " (metres); correct the plan there");
  if (mend.slivers > 0) plan.left_out.push_back(fmt::format("{}: {}", what, slivers_text(mend)));
  return std::move(mend.polygons);
}

void clean(ImportedPlan& plan, const std::string& file) {
  size_t dropped = std::erase_if(plan.walkable, [](Polygon& each) { return !clean(each); });
  for (auto* named : {&plan.obstacles, &plan.starts, &plan.goals})
    dropped += std::erase_if(*named, [](NamedPolygon& each) { return !clean(each.polygon); });
  if (dropped > 0) plan.left_out.push_back(counted(dropped, "area") + " without extent");
  const size_t dropped_walls =
      std::erase_if(plan.walls, [](PlanWall& wall) { return !clean(wall.line_m); });
  if (dropped_walls > 0)
    plan.left_out.push_back(counted(dropped_walls, "wall") + " without length");
  std::vector<Polygon> walkable;
  for (Polygon& each : plan.walkable)
    for (Polygon& piece : sound(std::move(each), "walkable areas", file, plan))
      walkable.push_back(std::move(piece));
  plan.walkable = std::move(walkable);
  for (auto* named : {&plan.obstacles, &plan.starts, &plan.goals})
    for (NamedPolygon& each : *named) {
      const std::string what = "the area " + in_quotes(each.name);
      std::vector<Polygon> pieces = sound(std::move(each.polygon), what, file, plan);
      if (pieces.size() > 1)
        throw InputError(file, fmt::format("one connected polygon in {}", what),
                         fmt::format("{} pieces between its holes", pieces.size()));
      each.polygon = std::move(pieces.front());
    }
}

}  // namespace

std::optional<Rectangle> plan_bounds(const ImportedPlan& plan) {
  std::vector<Eigen::Vector2d> points;
  const auto add = [&](const std::vector<Eigen::Vector2d>& more) {
    points.insert(points.end(), more.begin(), more.end());
  };
  for (const Polygon& area : plan.walkable) add(area.outline);
  for (const auto* named : {&plan.obstacles, &plan.starts, &plan.goals})
    for (const NamedPolygon& area : *named) add(area.polygon.outline);
  for (const PlanWall& wall : plan.walls) add(wall.line_m);
  return points.empty() ? std::nullopt : std::optional(bounds_of(points));
}

ImportedPlan import_plan(const ImportOptions& options) {
  ImportedPlan plan = read_plan(options);
  convert_to_metres(plan, options);
  const std::string file = options.file.string();
  place(plan, file);
  clean(plan, file);
  keep_to_ground(plan);
  if (!plan_bounds(plan))
    throw InputError(file, "areas or walls", fmt::format("{} without any", plan.kind));
  return plan;
}

}  // namespace throng
