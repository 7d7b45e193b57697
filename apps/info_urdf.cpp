#include <fmt/format.h>

#include <numbers>

#include "apps/info.h"
#include "avatars/model.h"

namespace throng {
namespace {

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

std::string describe(const Joint& joint, const Robot& robot) {
  std::string text;
  switch (joint.kind) {
    case Joint::Kind::kFixed:
      text = "fixed";
      break;
    case Joint::Kind::kRevolute:
      text = fmt::format("revolute {:.0f}..{:.0f} deg", degrees(joint.lower), degrees(joint.upper));
      break;
    case Joint::Kind::kContinuous:
      text = "continuous";
      break;
    case Joint::Kind::kPrismatic:
      text = fmt::format("prismatic {:.3f}..{:.3f} m", joint.lower, joint.upper);
      break;
  }
  if (joint.mimic) {
    const std::string& leader = robot.joints[static_cast<size_t>(joint.mimic->joint)].name;
    text +=
        fmt::format(", mimics {} x {} + {}", leader, joint.mimic->multiplier, joint.mimic->offset);
  }
  return text;
}

const Part* part_of(const Model& model, int link) {
  for (const Part& part : model.parts)
    if (part.link == link) return &part;
  return nullptr;
}

int depth_of(const Robot& robot, int link) {
  int depth = 0;
  while (link > 0) {
    link = robot.joints[static_cast<size_t>(link - 1)].parent_link;
    ++depth;
  }
  return depth;
}

/// Links in the order of a walk down the tree, children in the order of the file.
std::vector<int> tree_order(const Robot& robot) {
  std::vector<std::vector<int>> children(robot.links.size());
  for (const Joint& joint : robot.joints)
    children[static_cast<size_t>(joint.parent_link)].push_back(joint.child_link);
  std::vector<int> order;
  std::vector<int> open = {0};
  while (!open.empty()) {
    const int link = open.back();
    open.pop_back();
    order.push_back(link);
    const std::vector<int>& below = children[static_cast<size_t>(link)];
    open.insert(open.end(), below.rbegin(), below.rend());
  }
  return order;
}

void print_link(const Model& model, int link) {
  const Robot& robot = model.robot;
  std::string line(static_cast<size_t>(2 + 2 * depth_of(robot, link)), ' ');
  line += robot.links[static_cast<size_t>(link)].name;
  if (link > 0) {
    const Joint& joint = robot.joints[static_cast<size_t>(link - 1)];
    line += fmt::format("  ({}: {})", joint.name, describe(joint, robot));
  }
  if (const Part* part = part_of(model, link); part != nullptr)
    line += fmt::format("  [{}, {} vertices, {} triangles]", part->source,
                        part->mesh.vertices.size(), part->mesh.triangles.size());
  fmt::print("{}\n", line);
}

}  // namespace

void print_urdf_info(const std::filesystem::path& file) {
  const std::shared_ptr<const Model> model = load_model(file);
  const Robot& robot = model->robot;
  size_t vertices = 0;
  size_t triangles = 0;
  for (const Part& part : model->parts) {
    vertices += part.mesh.vertices.size();
    triangles += part.mesh.triangles.size();
  }
  fmt::print("{}: robot '{}'\n", file.string(), model->name);
  fmt::print("  links      {}\n", robot.links.size());
  fmt::print("  joints     {}, of which {} move by themselves\n", robot.joints.size(),
             model->kinematics.column_count());
  fmt::print("  parts      {} with {} vertices and {} triangles\n", model->part_count(), vertices,
             triangles);
  fmt::print("  height     {:.3f} m\n", static_cast<double>(model->height_m));
  fmt::print("\nTree: link (joint) [shape]\n");
  for (const int link : tree_order(robot)) print_link(*model, link);
  if (robot.notes.empty()) {
    fmt::print("\nNot understood: nothing\n");
  } else {
    fmt::print("\nNot understood, and ignored:\n");
    for (const std::string& note : robot.notes) fmt::print("  {}\n", note);
  }
}

}  // namespace throng
