// Keys of an obstacle: its shape and place.
#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

#include "avatars/mesh/mesh_file.h"
#include "avatars/mesh/primitives.h"
#include "base/errors.h"
#include "base/limits.h"
#include "base/text.h"
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
/// From micrometres to kilometres, with a margin.
constexpr Range kMeshScaleRange{1e-7, 1e4};
constexpr Range kVertexRange{-kMaxDescribed, kMaxDescribed};
/// The unit of a mesh without `scale` is doubted if it is as high, so many times as wide as the
/// ground, or as small.
constexpr double kDoubtedHeight_m = 1000, kDoubtedGrounds = 4, kDoubtedSize_m = 0.02;
constexpr const char* kScaleRemedy =
    "; set 'scale' to the metres per unit of the file, as 0.001 for millimetres";

/// Keys of some kinds only.
const std::map<std::string, std::vector<std::string>>& keys_of_kinds() {
  static const std::map<std::string, std::vector<std::string>> keys = {
      {"box", {"position_m", "yaw_deg", "size_m"}},
      {"cylinder", {"position_m", "yaw_deg", "diameter_m", "height_m"}},
      {"mesh", {"position_m", "yaw_deg", "file", "scale", "up", "vertices", "triangles"}},
      {"polygon", {"polygon", "holes", "top_m"}},
      {"wall", {"line", "thickness_m", "top_m"}}};
  return keys;
}

void expect_keys_of_kind(const Fields& fields) {
  const std::vector<std::string>& own = keys_of_kinds().at(fields.text("kind"));
  std::vector<std::string> absent;
  for (const auto& [kind, keys] : keys_of_kinds())
    for (const std::string& key : keys)
      if (std::find(own.begin(), own.end(), key) == own.end()) absent.push_back(key);
  expect_keys_without(absent, obstacle_keys(), fields);
}

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
                     fmt::format("a vertex at {:g} m{}", farthest_m, kScaleRemedy));
  obstacle.size_m = (high - low).cast<double>();
  if (footprint_of(obstacle).size() < 3 || !(obstacle.size_m.maxCoeff() <= kSizeRange.max))
    throw InputError(fields.where(),
                     fmt::format("a mesh that covers some ground, at most {} m", kSizeRange.max),
                     fmt::format("one of {} x {} x {} m{}", obstacle.size_m.x(),
                                 obstacle.size_m.y(), obstacle.size_m.z(), kScaleRemedy));
}

/// Checks the size of a mesh whose unit is assumed to be the metre.
void doubt_unit(ReadContext& context, const Fields& fields, const Obstacle& obstacle) {
  const Eigen::Vector3d& size = obstacle.size_m;
  const std::string found = fmt::format("{:.4g} x {:.4g} x {:.4g} m", size.x(), size.y(), size.z());
  const double widest_m = kDoubtedGrounds * context.scene.ground.size_m().maxCoeff();
  if (size.z() > kDoubtedHeight_m || size.head<2>().maxCoeff() > widest_m)
    throw InputError(
        fields.where(),
        fmt::format("a mesh at most {:g} m high and {:g} m wide, or 'scale' with it",
                    kDoubtedHeight_m, widest_m),
        fmt::format("one of {}; set 'scale: 0.001' if the file is in millimetres, or 'scale: 1'",
                    found));
  if (size.maxCoeff() < kDoubtedSize_m)
    context.scene.notes.push_back(fmt::format(
        "obstacle '{}' is {}: if the unit of '{}' is not the metre, set 'scale' to the metres per "
        "unit",
        obstacle.name, found, escaped(obstacle.mesh_file.filename().string())));
}

/// Reads a mesh from `vertices` and `triangles`.
Mesh read_mesh_arrays(const Fields& fields) {
  for (const char* key : {"file", "scale", "up"})
    if (const YamlNode* other = fields.find(key))
      throw InputError(fields.where(*other), fmt::format("either 'vertices' or '{}'", key), "both");
  Mesh mesh;
  for (const Eigen::Vector3d& vertex : fields.triples("vertices", 3, kVertexRange))
    mesh.vertices.push_back(vertex.cast<float>());
  const Range indices{0, static_cast<double>(mesh.vertices.size()) - 1};
  for (const Eigen::Vector3d& triangle : fields.triples("triangles", 1, indices)) {
    if (triangle != triangle.array().floor().matrix())
      throw InputError(fields.where(fields.require("triangles")),
                       "three numbers of vertices, from 0, in each triangle",
                       fmt::format("[{}, {}, {}]", triangle.x(), triangle.y(), triangle.z()));
    mesh.triangles.push_back(triangle.cast<int>());
  }
  return mesh;
}

void read_mesh_obstacle(ReadContext& context, const Fields& fields, Obstacle& obstacle) {
  if (fields.find("vertices") != nullptr || fields.find("triangles") != nullptr) {
    obstacle.mesh = read_mesh_arrays(fields);
    measure_mesh(fields, obstacle);
    return;
  }
  const std::vector<std::string> axes = {"x", "y", "z"};  // in the order of UpAxis
  std::optional<UpAxis> up;
  const std::optional<size_t> axis = fields.word("up", axes);
  if (axis) up = static_cast<UpAxis>(*axis);
  obstacle.mesh_file = existing_file(context, fields, fields.require("file"), "a mesh file");
  const double scale = fields.number_or("scale", kMeshScaleRange, 1);
  const std::string key =
      fmt::format("{} {} {}", scale, axis ? axes[*axis] : "-", obstacle.mesh_file.string());
  auto known = context.meshes.find(key);
  if (known == context.meshes.end())
    known = context.meshes
                .emplace(key, read_upright_mesh(obstacle.mesh_file, static_cast<float>(scale), up))
                .first;
  obstacle.mesh = known->second;
  measure_mesh(fields, obstacle);
  if (fields.find("scale") == nullptr) doubt_unit(context, fields, obstacle);
}

void make_shape(ReadContext& context, const Fields& fields, Obstacle& obstacle) {
  switch (obstacle.kind) {
    case Obstacle::Kind::kBox: {
      const std::vector<double> size = fields.numbers("size_m", 3, kSizeRange);
      obstacle.size_m = {size[0], size[1], size[2]};
      obstacle.mesh = box_mesh(obstacle.size_m);
      break;
    }
    case Obstacle::Kind::kCylinder: {
      const double diameter_m = fields.number("diameter_m", kSizeRange);
      obstacle.size_m = {diameter_m, diameter_m, fields.number("height_m", kSizeRange)};
      obstacle.mesh = cylinder_mesh(0.5 * diameter_m, obstacle.size_m.z());
      break;
    }
    case Obstacle::Kind::kPolygon:
      break;  // made of pieces, see make_pieces()
    case Obstacle::Kind::kMesh: {
      read_mesh_obstacle(context, fields, obstacle);
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
    rings = wall_rings(fields);
  } else {
    for (const Polygon& polygon : read_polygon(context, fields, obstacle.name))
      for (Polygon::Ring& piece : convex_pieces_of(polygon)) rings.push_back(std::move(piece));
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
  expect_keys_of_kind(fields);
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
      custom_key<Obstacle>(
          "file",
          "mesh: a mesh file relative to the scene file: `.tri`, `.stl`, `.obj`, `.dae`, "
          "`.ply` and many others, see reliability",
          "required of a mesh without `vertices`", {})
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

/// The hash of a mesh covers these keys: it is that of the scaled and turned vertices.
std::vector<Key<Obstacle>> later_rows_of_obstacles() {
  return {
      custom_key<Obstacle>("scale", "mesh: metres per unit of the file, 0.001 for millimetres", "1",
                           {.kind = Rule::Kind::kNumber, .range = kMeshScaleRange}),
      custom_key<Obstacle>(
          "up",
          "mesh: axis of the file that points up; with `y`, its x stays x; with `x`, its -y "
          "becomes x",
          "the axis that a `.dae` file states; `y` for glTF, VRML and X3D; otherwise `z`",
          {.kind = Rule::Kind::kWord, .words = {"z", "y", "x"}}),
      custom_key<Obstacle>("vertices", "mesh: vertices `[x, y, z]` in place of a file", "`file`",
                           {.kind = Rule::Kind::kVertices, .range = kVertexRange, .min = 3}),
      custom_key<Obstacle>("triangles",
                           "mesh: three numbers of `vertices` per triangle, from 0, "
                           "counter-clockwise seen from outside",
                           "required with `vertices`", {.kind = Rule::Kind::kTriangles, .min = 1})};
}

}  // namespace

const KeyTable<Obstacle>& obstacle_keys() {
  static const KeyTable<Obstacle> table = {
      .text = {.name = "obstacle", .meaning = "A solid body that does not move"},
      .title = "an obstacle",
      .keys = rows_of_obstacles(),
      .later = later_rows_of_obstacles(),
      .complete = complete_obstacle};
  return table;
}

}  // namespace throng
