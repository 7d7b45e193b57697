// Keys of an obstacle: its shape and place.
#include <algorithm>
#include <numbers>
#include <utility>

#include "avatars/mesh/primitives.h"
#include "avatars/mesh/tri.h"
#include "base/errors.h"
#include "base/limits.h"
#include "crowd/navigation/footprints.h"
#include "scenes/file/key_tables.h"
#include "scenes/file/polygon_values.h"
#include "scenes/file/scene_values.h"

namespace throng {
namespace {

// 1 mm is the thickness of a tape. Floats resolve it up to 10 km, the wall of the largest scene.
constexpr Range kSizeRange{1e-3, 1e4};
constexpr Range kBottomRange{-10, 1000};
constexpr Range kTopRange{-9, 2000};
constexpr Range kThicknessRange{1e-3, 100};
constexpr double kWallThickness_m = 0.1;
constexpr Range kHeadingRange{-360, 360};

double lowest_m(const Mesh& mesh) {
  float lowest = mesh.vertices.front().z();
  for (const Eigen::Vector3f& vertex : mesh.vertices) lowest = std::min(lowest, vertex.z());
  return static_cast<double>(lowest);
}

void read_obstacle_name(ReadContext& context, Fields& fields, Obstacle& obstacle) {
  obstacle.name =
      fields.name_or("name", fmt::format("obstacle {}", context.scene.obstacles.size() + 1));
  require_new(fields, obstacle.name, context.obstacle_names);
}

void measure_mesh(const Fields& fields, Obstacle& obstacle) {
  Eigen::Vector3f low = obstacle.mesh.vertices.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const float farthest_m = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  if (!(static_cast<double>(farthest_m) <= kMaxDescribed))
    throw InputError(fields.where(),
                     fmt::format("a mesh within {:g} m of its origin", kMaxDescribed),
                     fmt::format("a vertex at {:g} m", farthest_m));
  obstacle.size_m = (high - low).cast<double>();
  if (footprint_of(obstacle).size() < 3 || !(obstacle.size_m.maxCoeff() <= kSizeRange.max))
    throw InputError(fields.where(),
                     fmt::format("a mesh that covers some ground, at most {} m", kSizeRange.max),
                     fmt::format("one of {} x {} x {} m", obstacle.size_m.x(), obstacle.size_m.y(),
                                 obstacle.size_m.z()));
}

void make_shape(const ReadContext& context, const Fields& fields, Obstacle& obstacle) {
  switch (obstacle.kind) {
    case Obstacle::Kind::kBox: {
      expect_keys_without(
          {"diameter_m", "height_m", "file", "polygon", "holes", "line", "thickness_m", "top_m"},
          obstacle_keys(), fields);
      const std::vector<double> size = fields.numbers("size_m", 3, kSizeRange);
      obstacle.size_m = {size[0], size[1], size[2]};
      obstacle.mesh = box_mesh(obstacle.size_m);
      break;
    }
    case Obstacle::Kind::kCylinder: {
      expect_keys_without({"size_m", "file", "polygon", "holes", "line", "thickness_m", "top_m"},
                          obstacle_keys(), fields);
      const double diameter_m = fields.number("diameter_m", kSizeRange);
      obstacle.size_m = {diameter_m, diameter_m, fields.number("height_m", kSizeRange)};
      obstacle.mesh = cylinder_mesh(0.5 * diameter_m, obstacle.size_m.z());
      break;
    }
    case Obstacle::Kind::kPolygon:
      break;  // made of pieces, see make_pieces()
    case Obstacle::Kind::kMesh: {
      expect_keys_without(
          {"size_m", "diameter_m", "height_m", "polygon", "holes", "line", "thickness_m", "top_m"},
          obstacle_keys(), fields);
      obstacle.mesh_file = existing_file(context, fields, fields.require("file"), "a .tri file");
      obstacle.mesh = read_tri(obstacle.mesh_file).mesh;
      measure_mesh(fields, obstacle);
      break;
    }
  }
}

constexpr const char* kWall = "wall";

bool is_wall(const Fields& fields) { return fields.text("kind") == kWall; }

/// Bottom and top of a polygon or wall.
std::pair<double, double> read_heights(const Fields& fields) {
  const double bottom_m = fields.number_or("bottom_m", kBottomRange, 0);
  const double top_m = fields.number("top_m", kTopRange);
  if (!(top_m - bottom_m >= kSizeRange.min))
    throw InputError(fields.where(fields.require("top_m")),
                     fmt::format("'top_m' above 'bottom_m' ({} m)", bottom_m),
                     fmt::format("{} m", top_m));
  return {bottom_m, top_m};
}

/// Boxes along a polyline that overlap at its corners.
std::vector<Polygon::Ring> wall_rings(const Fields& fields) {
  const std::vector<Eigen::Vector2d> line = fields.points("line", 2, kPositionRange);
  const double half_m = 0.5 * fields.number_or("thickness_m", kThicknessRange, kWallThickness_m);
  const bool is_closed = line.front() == line.back();
  std::vector<Polygon::Ring> rings;
  for (size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d span = line[i] - line[i - 1];
    if (!(span.norm() >= kSizeRange.min))
      throw InputError(fields.where(fields.require("line")),
                       fmt::format("corners at least {} m apart in 'line'", kSizeRange.min),
                       fmt::format("[{}, {}] twice", line[i].x(), line[i].y()));
    const Eigen::Vector2d along = span.normalized(),
                          aside = half_m * Eigen::Vector2d(-along.y(), along.x());
    const double early_m = i > 1 || is_closed ? half_m : 0;
    const double late_m = i + 1 < line.size() || is_closed ? half_m : 0;
    const Eigen::Vector2d from = line[i - 1] - early_m * along, to = line[i] + late_m * along;
    rings.push_back({from - aside, to - aside, to + aside, from + aside});
  }
  return rings;
}

/// A polygon or wall becomes one obstacle for each convex piece: contacts are then found on the
/// surface, not on a hull around it.
void make_pieces(ReadContext& context, const Fields& fields, Obstacle& obstacle) {
  std::vector<Polygon::Ring> rings;
  if (is_wall(fields)) {
    expect_keys_without(
        {"size_m", "diameter_m", "height_m", "file", "polygon", "holes", "position_m", "yaw_deg"},
        obstacle_keys(), fields);
    rings = wall_rings(fields);
  } else {
    expect_keys_without({"size_m", "diameter_m", "height_m", "file", "line", "thickness_m",
                         "position_m", "yaw_deg"},
                        obstacle_keys(), fields);
    rings = convex_pieces_of(read_polygon(context, fields, obstacle.name));
  }
  const auto [bottom_m, top_m] = read_heights(fields);
  const std::string name = obstacle.name;
  const uint32_t surface = rings.size() > 1 ? ++context.surfaces : 0;
  for (size_t i = 0; i < rings.size(); ++i) {
    const std::string piece_name = rings.size() > 1 ? fmt::format("{} {}", name, i + 1) : name;
    if (rings.size() > 1) require_new(fields, piece_name, context.obstacle_names);
    Obstacle piece = prism_obstacle(piece_name, rings[i], bottom_m, top_m);
    piece.surface = surface;
    if (i == 0)
      obstacle = std::move(piece);
    else
      context.more_obstacles.push_back(std::move(piece));
  }
}

void complete_obstacle(ReadContext& context, const Fields& fields, Obstacle& obstacle) {
  if (obstacle.kind == Obstacle::Kind::kPolygon) {
    const size_t first = context.more_obstacles.size();
    make_pieces(context, fields, obstacle);
    const auto is_outside = [&](const Obstacle& piece) {
      return clipped(footprint_of(piece), context.scene.ground).empty();
    };
    if (is_outside(obstacle) &&
        std::all_of(context.more_obstacles.begin() + static_cast<ptrdiff_t>(first),
                    context.more_obstacles.end(), is_outside))
      throw InputError(fields.where(),
                       fmt::format("obstacle '{}' on the ground ({})", obstacle.name,
                                   to_text(context.scene.ground)),
                       fmt::format("all of it outside, {}; move it or enlarge the ground",
                                   to_text(bounds_of(footprint_of(obstacle)))));
    return;
  }
  if (fields.find("position_m") == nullptr)
    throw InputError(fields.where(), "the key 'position_m' in an obstacle", "none");
  make_shape(context, fields, obstacle);
  const bool is_mesh = obstacle.kind == Obstacle::Kind::kMesh;
  obstacle.centre_m.z() += is_mesh ? -lowest_m(obstacle.mesh) : 0.5 * obstacle.size_m.z();
  const Rectangle& ground = context.scene.ground;
  const std::vector<Eigen::Vector2d> footprint = footprint_of(obstacle);
  if (clipped(footprint, ground).empty())
    throw InputError(
        fields.where(),
        fmt::format("obstacle '{}' on the ground ({})", obstacle.name, to_text(ground)),
        fmt::format("all of it outside, {}; move it or enlarge the ground",
                    to_text(bounds_of(footprint))));
}

void add_mesh(Hasher& hash, const Obstacle& obstacle) {
  for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) hash.add(static_cast<double>(vertex[axis]));
  for (const Eigen::Vector3i& triangle : obstacle.mesh.triangles)
    for (int corner = 0; corner < 3; ++corner) hash.add(static_cast<uint64_t>(triangle[corner]));
}

std::vector<Key<Obstacle>> rows_of_obstacles() {
  const auto size_rule = [](int64_t count) {
    return Rule{.kind = count == 1 ? Rule::Kind::kNumber : Rule::Kind::kNumbers,
                .range = kSizeRange,
                .min = count,
                .max = count};
  };
  return {
      custom_key<Obstacle>("name", "unique in the scene", "`obstacle 1`, ...", {})
          .with_reader(read_obstacle_name)
          .with_hash(&Obstacle::name),
      word<Obstacle, Obstacle::Kind>(
          "kind",
          "`box`, `cylinder`, `mesh`, `polygon` (upright over an outline) or `wall` (upright along "
          "a line)",
          &Obstacle::kind,
          {{"box", Obstacle::Kind::kBox},
           {"cylinder", Obstacle::Kind::kCylinder},
           {"mesh", Obstacle::Kind::kMesh},
           {"polygon", Obstacle::Kind::kPolygon},
           {kWall, Obstacle::Kind::kPolygon}})
          .required(),
      custom_key<Obstacle>("yaw_deg", "rotation about z in degrees, counter-clockwise", "0",
                           {.kind = Rule::Kind::kNumber, .range = kHeadingRange})
          .with_reader([](ReadContext&, Fields& fields, Obstacle& obstacle) {
            const double yaw_deg = fields.number_or("yaw_deg", kHeadingRange, 0);
            obstacle.heading_rad = yaw_deg * (std::numbers::pi / 180);
          })
          .with_hash(&Obstacle::heading_rad),
      custom_key<Obstacle>(
          "position_m", "`[x, y]` of the centre, of a mesh of its origin",
          "required, except of a polygon or wall",
          {.kind = Rule::Kind::kNumbers, .range = kPositionRange, .min = 2, .max = 2})
          .with_reader([](ReadContext&, Fields& fields, Obstacle& obstacle) {
            if (fields.find("position_m") == nullptr) return;
            const std::vector<double> place = fields.numbers("position_m", 2, kPositionRange);
            obstacle.centre_m = {place[0], place[1], 0};
          })
          .with_hash([](Hasher& hash, const Obstacle& obstacle) {
            for (int axis = 0; axis < 3; ++axis) hash.add(obstacle.centre_m[axis]);
          }),
      custom_key<Obstacle>(
          "bottom_m",
          "height of the lower end above the ground, of a mesh of its lowest vertex; agents "
          "pass below an obstacle that is at least 0.1 m above the tallest avatar",
          "0", {.kind = Rule::Kind::kNumber, .range = kBottomRange})
          .with_reader([](ReadContext&, Fields& fields, Obstacle& obstacle) {
            obstacle.centre_m.z() = fields.number_or("bottom_m", kBottomRange, 0);
          }),
      custom_key<Obstacle>("size_m", "box: edge lengths `[x, y, z]`, from 0.001",
                           "required of a box", size_rule(3)),
      custom_key<Obstacle>("diameter_m", "cylinder: diameter", "required of a cylinder",
                           size_rule(1)),
      custom_key<Obstacle>("height_m", "cylinder: length", "required of a cylinder", size_rule(1)),
      custom_key<Obstacle>("file", "mesh: a `.tri` file relative to the scene file",
                           "required of a mesh", {})
          .with_hash(add_mesh),
      custom_key<Obstacle>("polygon",
                           "polygon: corners `[x, y]`; a concave outline is divided into convex "
                           "pieces, each an obstacle: `NAME 1`, ...",
                           "required of a polygon",
                           {.kind = Rule::Kind::kPoints, .range = kPositionRange, .min = 3}),
      custom_key<Obstacle>("holes", "polygon: holes, each a list of corners", "none",
                           {.kind = Rule::Kind::kRings, .range = kPositionRange, .min = 3}),
      custom_key<Obstacle>("line",
                           "wall: corners `[x, y]` of its middle line; a closed wall repeats the "
                           "first one. Each straight piece is an obstacle",
                           "required of a wall",
                           {.kind = Rule::Kind::kPoints, .range = kPositionRange, .min = 2}),
      custom_key<Obstacle>("thickness_m", "wall: thickness", "0.1",
                           {.kind = Rule::Kind::kNumber, .range = kThicknessRange}),
      custom_key<Obstacle>("top_m", "polygon, wall: height of the upper end above the ground",
                           "required of a polygon or wall",
                           {.kind = Rule::Kind::kNumber, .range = kTopRange})};
}

}  // namespace

const KeyTable<Obstacle>& obstacle_keys() {
  static const KeyTable<Obstacle> table = {
      .text = {.name = "obstacle", .meaning = "A solid body that does not move"},
      .title = "an obstacle",
      .keys = rows_of_obstacles(),
      .complete = complete_obstacle};
  return table;
}

}  // namespace throng
