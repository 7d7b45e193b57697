#include "avatars/model/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "avatars/gait/gait_cycle.h"
#include "avatars/gait/gait_pose.h"
#include "avatars/mesh/mesh_file.h"
#include "avatars/mesh/primitives.h"
#include "base/errors.h"
#include "base/limits.h"
#include "base/text.h"

namespace throng {
namespace {

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
class Hash {
 public:
  void add(const void* data, size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) value_ = (value_ ^ at[i]) * 0x100000001b3ull;
  }
  void add(uint64_t number) { add(&number, sizeof number); }
  uint64_t value() const { return value_; }

 private:
  uint64_t value_ = 0xcbf29ce484222325ull;
};

struct Shape {
  Mesh mesh;
  std::string source;
};

Shape shape_of(const Geometry& geometry, const std::string& where,
               std::vector<std::string>& notes) {
  switch (geometry.kind) {
    case Geometry::Kind::kBox:
      return {box_mesh(geometry.box_size_m), "box"};
    case Geometry::Kind::kCylinder:
      return {cylinder_mesh(geometry.radius_m, geometry.length_m), "cylinder"};
    case Geometry::Kind::kCapsule:
      return {capsule_mesh(geometry.radius_m, geometry.length_m), "capsule"};
    case Geometry::Kind::kSphere:
      return {sphere_mesh(geometry.radius_m), "sphere"};
    case Geometry::Kind::kMesh:
      break;
  }
  const std::string path = geometry.mesh_file.string();
  if (path.find("://") != std::string::npos)
    throw InputError(
        where,
        "a package above the URDF, in $ROS_PACKAGE_PATH or in $AMENT_PREFIX_PATH (a folder of its "
        "name, or one with its package.xml)",
        fmt::format("none for '{}'", path));
  return {read_mesh(geometry.mesh_file, {}, &notes),
          escaped(geometry.mesh_file.filename().string())};
}

void append(const Shape& shape, const Geometry& geometry, Part& part) {
  const Eigen::Vector3d scale =
      geometry.kind == Geometry::Kind::kMesh ? geometry.mesh_scale : Eigen::Vector3d::Ones();
  const int first = static_cast<int>(part.mesh.vertices.size());
  for (const Eigen::Vector3f& v : shape.mesh.vertices)
    part.mesh.vertices.emplace_back(
        (geometry.link_from_geometry * scale.cwiseProduct(v.cast<double>())).cast<float>());
  const bool mirrored = scale.prod() < 0;
  for (Eigen::Vector3i triangle : shape.mesh.triangles) {
    if (mirrored) std::swap(triangle[1], triangle[2]);
    part.mesh.triangles.emplace_back(triangle + Eigen::Vector3i::Constant(first));
  }
  part.source += (part.source.empty() ? "" : " + ") + shape.source;
}

/// Returns the geometry used for a link: collision geometry, or visual geometry if there is none.
const std::vector<Geometry>& geometry_of(const Link& link) {
  return link.collision.empty() ? link.visual : link.collision;
}

/// Rejects vertices that are too large or not finite, also after scaling.
void check_coordinates(std::span<const Eigen::Vector3f> vertices, const std::string& source,
                       const Link& link, const std::string& where) {
  for (const Eigen::Vector3f& vertex : vertices)
    if (!(static_cast<double>(vertex.cwiseAbs().maxCoeff()) <= kMaxDescribed))
      throw InputError(
          where,
          fmt::format("every vertex of '{}' within {:g} m of link '{}'", source, kMaxDescribed,
                      link.name),
          fmt::format("one at ({:g}, {:g}, {:g}) m; check the unit of the mesh and its scale",
                      vertex.x(), vertex.y(), vertex.z()));
}

Part part_of(const Link& link, int index, const std::string& where,
             std::vector<std::string>& notes) {
  Part part;
  part.name = link.name;
  part.link = index;
  bool has_cloud = false;
  bool has_surface = false;
  for (const Geometry& geometry : geometry_of(link)) {
    const Shape shape = shape_of(geometry, where, notes);
    const size_t first = part.mesh.vertices.size();
    (shape.mesh.is_point_cloud() ? has_cloud : has_surface) = true;
    append(shape, geometry, part);
    check_coordinates(std::span(part.mesh.vertices).subspan(first), shape.source, link, where);
  }
  if (has_cloud && has_surface)
    throw InputError(where,
                     fmt::format("surfaces only or point clouds only in link '{}'", link.name),
                     "both: " + part.source);
  return part;
}

void add_notes(Model& model) {
  Robot& robot = model.robot;
  const auto replaced = std::count_if(robot.links.begin(), robot.links.end(), [](const Link& link) {
    return !link.collision.empty() && !link.visual.empty();
  });
  if (replaced > 0)
    robot.notes.push_back(
        fmt::format("<visual> of {} links: not used in favour of <collision>", replaced));
  constexpr float kSunk_m = 0.05f;
  if (model.is_person && model.start_box_m.min().z() < -kSunk_m)
    robot.notes.push_back(fmt::format(
        "the root link '{}' is {:.2f} m above the lowest point, but stands on the ground in "
        "a scene: add a root link between the feet",
        robot.links.front().name, -model.start_box_m.min().z()));
}

Eigen::AlignedBox3f start_box_of(const FlatModel& kinematics, const std::vector<Part>& parts) {
  Eigen::AlignedBox3f box;
  if (parts.empty()) return box;
  std::vector<float> posture;
  for (const JointColumn& column : kinematics.columns())
    posture.push_back(std::clamp(0.0f, column.lower, column.upper));
  std::vector<PartPose> poses(parts.size());
  const RootFrame root;
  forward_kinematics(kinematics, posture, std::span(&root, 1), poses);
  for (size_t i = 0; i < parts.size(); ++i) {
    for (const Eigen::Vector3f& v : parts[i].mesh.vertices) {
      Eigen::Vector3f placed;
      for (int axis = 0; axis < 3; ++axis) {
        const float* row = poses[i].rows[axis];
        placed[axis] = row[0] * v.x() + row[1] * v.y() + row[2] * v.z() + row[3];
      }
      box.extend(placed);
    }
  }
  return box;
}

uint64_t hash_of(const std::string& urdf, const std::vector<Part>& parts) {
  Hash hash;
  hash.add(urdf.data(), urdf.size());
  for (const Part& part : parts) {
    hash.add(part.mesh.vertices.size());
    for (const Eigen::Vector3f& v : part.mesh.vertices) hash.add(v.data(), 3 * sizeof(float));
    hash.add(part.mesh.triangles.size());
    for (const Eigen::Vector3i& t : part.mesh.triangles) hash.add(t.data(), 3 * sizeof(int));
  }
  return hash.value();
}

/// Reads all parts. Unreadable ones are added to `unreadable`, or thrown if that is null.
std::vector<Part> parts_of(const Robot& robot, const std::string& where,
                           std::vector<std::string>* unreadable,
                           std::vector<std::string>& assumptions) {
  std::vector<std::string> notes;
  std::vector<Part> parts;
  for (size_t i = 0; i < robot.links.size(); ++i) {
    if (geometry_of(robot.links[i]).empty()) continue;
    try {
      parts.push_back(part_of(robot.links[i], static_cast<int>(i), where, notes));
    } catch (const InputError& error) {
      if (!unreadable) throw;
      unreadable->push_back(fmt::format("link '{}': {}", robot.links[i].name, error.what()));
    }
  }
  for (std::string& note : notes)  // several links may share a mesh
    if (std::find(assumptions.begin(), assumptions.end(), note) == assumptions.end())
      assumptions.push_back(std::move(note));
  if (parts.empty() && !unreadable)
    throw InputError(where, "at least one link with geometry", "none");
  if (parts.size() > kMaxModelParts)
    throw InputError(where, fmt::format("at most {} links with geometry", kMaxModelParts),
                     fmt::format("{}", parts.size()));
  return parts;
}

std::shared_ptr<const Model> assemble(const std::filesystem::path& urdf_file,
                                      std::vector<std::string>* unreadable) {
  const std::string where = urdf_file.string();
  const std::string text = read_urdf_text(urdf_file);
  std::vector<std::string> assumptions;
  Robot robot = parse_urdf(text, urdf_file, &assumptions);
  std::vector<Part> parts = parts_of(robot, where, unreadable, assumptions);
  std::vector<int> links;
  for (const Part& part : parts) links.push_back(part.link);
  FlatModel kinematics(robot, links);
  const uint64_t hash = hash_of(text, parts);
  Eigen::AlignedBox3f box = start_box_of(kinematics, parts);
  // Wheels are polygons, and angles in a URDF have seven digits: 1 mm per metre counts as zero.
  constexpr float kNoStep = 1e-3f;
  if (std::abs(box.min().z()) < kNoStep * box.sizes().z()) box.min().z() = 0;
  Model model{robot.name, std::move(robot), std::move(parts), std::move(kinematics), 0, hash};
  model.start_box_m = box;
  model.assumptions = std::move(assumptions);
  model.is_person = has_human_legs(model) && box.max().z() > 0;
  if (!box.isEmpty()) model.height_m = box.max().z() - (model.is_person ? 0 : box.min().z());
  if (!(model.height_m <= static_cast<float>(kMaxDescribed)))
    throw InputError(where, fmt::format("a model of at most {:g} m", kMaxDescribed),
                     fmt::format("one of {:g} m", model.height_m));
  add_notes(model);
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace

bool has_human_legs(const Model& model) {
  return Walker::find(PosableModel(model), GaitStyle::kPlain).has_value();
}

std::shared_ptr<const Model> load_model(const std::filesystem::path& urdf_file) {
  return assemble(urdf_file, nullptr);
}

std::shared_ptr<const Model> load_readable_model(const std::filesystem::path& urdf_file,
                                                 std::vector<std::string>& unreadable) {
  return assemble(urdf_file, &unreadable);
}

float reach_of(const Model& model) {
  double reach = 0;
  for (size_t i = 0; i < model.parts.size(); ++i) {
    double extent = 0;
    for (const Eigen::Vector3f& vertex : model.parts[i].mesh.vertices)
      extent = std::max(extent, vertex.cast<double>().norm());
    reach = std::max(reach, static_cast<double>(model.kinematics.reach_m()[i]) + extent);
  }
  return static_cast<float>(reach * 1.001);
}

}  // namespace throng
