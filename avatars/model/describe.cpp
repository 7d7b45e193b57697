#include "avatars/model/describe.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace throng {
namespace {

Eigen::AlignedBox3f bounds_of(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v);
  return box;
}

std::string_view surface_of(const Mesh& mesh) {
  if (mesh.is_point_cloud()) return "point cloud";
  if (!is_closed(mesh)) return "open";
  return signed_volume_m3(mesh) > 0 ? "closed" : "closed, inside out";
}

/// Returns "axis z" for a coordinate axis, the numbers otherwise.
std::string axis_of(const Joint& joint) {
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0})
      if ((joint.axis - sign * Eigen::Vector3d::Unit(k)).norm() < 1e-9)
        return fmt::format("axis {}{}", sign < 0 ? "-" : "", "xyz"[k]);
  return fmt::format("axis ({:.3f} {:.3f} {:.3f})", joint.axis.x(), joint.axis.y(), joint.axis.z());
}

std::string describe_joint(const Robot& robot, const Joint& joint) {
  std::string text;
  switch (joint.kind) {
    case Joint::Kind::kFixed:
      return "fixed";
    case Joint::Kind::kRevolute:
      text = fmt::format("revolute, {}, {:.3f} to {:.3f} rad", axis_of(joint), joint.lower,
                         joint.upper);
      break;
    case Joint::Kind::kContinuous:
      text = fmt::format("continuous, {}", axis_of(joint));
      break;
    case Joint::Kind::kPrismatic:
      text = fmt::format("prismatic, {}, {:.3f} to {:.3f} m", axis_of(joint), joint.lower,
                         joint.upper);
      break;
  }
  if (joint.mimic)
    text += fmt::format(", mimics {} x {:g} + {:g}",
                        robot.joints[static_cast<size_t>(joint.mimic->joint)].name,
                        joint.mimic->multiplier, joint.mimic->offset);
  return text;
}

void describe_tree(const Model& model, std::string& out) {
  const Robot& robot = model.robot;
  std::vector<bool> has_part(robot.links.size(), false);
  for (const Part& part : model.parts) has_part[static_cast<size_t>(part.link)] = true;
  std::vector<int> depth(robot.links.size(), 0);
  out += fmt::format("tree: {}{}\n", robot.links[0].name, has_part[0] ? " *" : "");
  for (const Joint& joint : robot.joints) {  // depth first already
    const size_t child = static_cast<size_t>(joint.child_link);
    depth[child] = depth[static_cast<size_t>(joint.parent_link)] + 1;
    out += fmt::format("{:{}}{}{}  ({}: {})\n", "", 2 * depth[child] + 4, robot.links[child].name,
                       has_part[child] ? " *" : "", joint.name, describe_joint(robot, joint));
  }
  out += "      * carries a part\n";
}

void describe_parts(const Model& model, std::string& out) {
  size_t width = 4;
  for (const Part& part : model.parts) width = std::max(width, part.name.size());
  size_t vertices = 0;
  size_t triangles = 0;
  out += fmt::format("{:<{}}  vertices  triangles  size x, y, z (m)     surface      source\n",
                     "part", width);
  for (const Part& part : model.parts) {
    vertices += part.mesh.vertices.size();
    triangles += part.mesh.triangles.size();
    const Eigen::Vector3f size = bounds_of(part.mesh).sizes();
    out += fmt::format("{:<{}}  {:>8}  {:>9}  {:.3f}, {:.3f}, {:.3f}  {:<11}  {}\n", part.name,
                       width, part.mesh.vertices.size(), part.mesh.triangles.size(), size.x(),
                       size.y(), size.z(), surface_of(part.mesh), part.source);
  }
  out += fmt::format("{:<{}}  {:>8}  {:>9}\n", "all", width, vertices, triangles);
}

void describe_size(const Model& model, std::string& out) {
  if (model.start_box_m.isEmpty()) return;
  const Eigen::Vector3f size = model.start_box_m.sizes();
  out += fmt::format("size: {:.3f} x {:.3f} x {:.3f} m with every joint at zero\n", size.x(),
                     size.y(), size.z());
  if (model.is_person)
    out += fmt::format(
        "height: {:.3f} m above the root; a person: has human legs, walks with its root on the "
        "ground, and is scaled to people's heights\n",
        model.height_m);
  else
    out += fmt::format(
        "height: {:.3f} m; a robot: no human legs, keeps its size unless a scene sets height_m, "
        "and "
        "stands on its lowest point, its root '{}' {:.3f} m above the ground\n",
        model.height_m, model.robot.links.front().name, model.root_height_m());
}

}  // namespace

std::string describe_model(const Model& model) {
  const auto count_joints = [&](auto&& is_counted) {
    return std::count_if(model.robot.joints.begin(), model.robot.joints.end(), is_counted);
  };
  std::string out =
      fmt::format("model '{}': {} links, {} joints, {} parts\n", model.name,
                  model.robot.links.size(), model.robot.joints.size(), model.parts.size());
  out += fmt::format("degrees of freedom: {} ({} fixed joints, {} mimic joints)\n",
                     model.kinematics.column_count(),
                     count_joints([](const Joint& j) { return j.kind == Joint::Kind::kFixed; }),
                     count_joints([](const Joint& j) { return j.mimic.has_value(); }));
  describe_size(model, out);
  out += fmt::format("content hash: {:016x}\n\n", model.content_hash);
  describe_tree(model, out);
  out += "\n";
  describe_parts(model, out);
  out += model.robot.notes.empty() ? "\nignored content: none\n" : "\nignored content:\n";
  for (const std::string& note : model.robot.notes) out += "  " + note + "\n";
  for (const std::string& assumption : model.assumptions)
    out += fmt::format("note: {}\n", assumption);
  return out;
}

std::string describe_urdf(const std::filesystem::path& file, bool& complete) {
  std::vector<std::string> unreadable;
  std::string out = describe_model(*load_readable_model(file, unreadable));
  complete = unreadable.empty();
  if (complete) return out;
  out += "\nunreadable shapes; scenes reject this model until they are repaired:\n";
  for (const std::string& line : unreadable) out += "  " + line + "\n";
  return out;
}

std::vector<std::string> notes_on(std::span<const std::shared_ptr<const Model>> models) {
  std::vector<std::string> notes;
  for (const std::shared_ptr<const Model>& model : models)
    for (const std::string& assumption : model->assumptions) {
      std::string note = fmt::format("model '{}': {}", model->name, assumption);
      if (std::find(notes.begin(), notes.end(), note) == notes.end())
        notes.push_back(std::move(note));
    }
  return notes;
}

std::string describe_tri(const TriFile& tri, const std::string& file_name) {
  const TriDialect& dialect = tri.dialect;
  std::vector<std::string_view> traits;
  if (dialect.keyword) traits.push_back("TRI keyword");
  traits.push_back(dialect.counts_on_one_line ? "counts on one line" : "counts before each list");
  if (!tri.mesh.is_point_cloud()) traits.push_back(dialect.one_based ? "1-based" : "0-based");
  if (dialect.comments) traits.push_back("comments");
  if (dialect.crlf) traits.push_back("CRLF");
  if (dialect.byte_order_mark) traits.push_back("byte order mark");
  const Eigen::AlignedBox3f box = bounds_of(tri.mesh);
  std::string out = fmt::format("{}: {} vertices, {} triangles\n", file_name,
                                tri.mesh.vertices.size(), tri.mesh.triangles.size());
  out += fmt::format("dialect: {}\n", fmt::join(traits, ", "));
  out += fmt::format("bounding box: ({:.4f}, {:.4f}, {:.4f}) to ({:.4f}, {:.4f}, {:.4f}) m\n",
                     box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(),
                     box.max().z());
  out += fmt::format("surface: {}\n", surface_of(tri.mesh));
  if (!tri.mesh.is_point_cloud() && is_closed(tri.mesh))
    out += fmt::format("volume: {:.6f} m3\n", signed_volume_m3(tri.mesh));
  return out;
}

}  // namespace throng
