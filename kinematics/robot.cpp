#include "kinematics/robot.h"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <fstream>
#include <map>
#include <mutex>
#include <numbers>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "kinematics/mesh_path.h"
#include "kinematics/plain_urdf.h"
#include "kinematics/urdf_check.h"

namespace throng {
namespace {

class Messages : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR)
      errors += (errors.empty() ? "" : "; ") + text;
  }
  std::string errors;
};

urdf::ModelInterfaceSharedPtr parse_quietly(const std::string& text, Messages& messages) {
  static std::mutex one_at_a_time;  // console_bridge has one handler for the whole process
  const std::lock_guard lock(one_at_a_time);
  console_bridge::useOutputHandler(&messages);
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& error) {
    messages.errors += error.what();
  }
  console_bridge::restorePreviousOutputHandler();
  return model;
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

Eigen::Vector3d to_eigen(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Eigen::Isometry3d to_eigen(const urdf::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  const urdf::Rotation& r = pose.rotation;
  out.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  out.translation() = to_eigen(pose.position);
  return out;
}

/// Applies the rotation of an <origin> given as a quaternion, which urdfdom 3 does not read.
void turn_by_quaternion(const std::vector<XmlElement>& elements, int owner,
                        Eigen::Isometry3d& pose) {
  const int origin = child_of(elements, owner, "origin");
  const std::string* text =
      origin < 0 ? nullptr : elements[static_cast<size_t>(origin)].attribute("quat_xyzw");
  if (text == nullptr) return;
  const std::vector<double> q = finite_numbers(*text).value();
  pose.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
}

/// `owner` is the <visual> or <collision> that urdfdom read as `shape` and `origin`.
Geometry to_geometry(const urdf::Geometry& shape, const urdf::Pose& origin,
                     const std::vector<XmlElement>& elements, int owner,
                     const std::filesystem::path& file) {
  const int tag = elements[static_cast<size_t>(child_of(elements, owner, "geometry"))].first_child;
  const XmlElement& element = elements[static_cast<size_t>(tag)];
  Geometry out;
  out.link_from_geometry = to_eigen(origin);
  turn_by_quaternion(elements, owner, out.link_from_geometry);
  switch (shape.type) {
    case urdf::Geometry::MESH:
      out.kind = Geometry::Kind::kMesh;
      out.mesh_file = resolve_mesh(*element.attribute("filename"), file);
      out.mesh_scale = to_eigen(dynamic_cast<const urdf::Mesh&>(shape).scale);
      break;
    case urdf::Geometry::BOX:
      out.kind = Geometry::Kind::kBox;
      out.box_size_m = to_eigen(dynamic_cast<const urdf::Box&>(shape).dim);
      break;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(shape);
      out.kind = element.name == "capsule" ? Geometry::Kind::kCapsule : Geometry::Kind::kCylinder;
      out.radius_m = cylinder.radius;
      out.length_m = cylinder.length;
      break;
    }
    case urdf::Geometry::SPHERE:
      out.kind = Geometry::Kind::kSphere;
      out.radius_m = dynamic_cast<const urdf::Sphere&>(shape).radius;
      break;
  }
  return out;
}

/// Converts all shapes; throws InputError if urdfdom has dropped some.
template <typename Shapes>
std::vector<Geometry> to_geometries(const Shapes& shapes, std::string_view tag,
                                    const std::vector<XmlElement>& elements,
                                    const UrdfCheckResult& use, int link,
                                    const std::filesystem::path& file) {
  std::vector<int> owners;
  for (int i = elements[static_cast<size_t>(link)].first_child; i >= 0;
       i = elements[static_cast<size_t>(i)].next_sibling)
    if (elements[static_cast<size_t>(i)].name == tag && !use.skipped[static_cast<size_t>(i)])
      owners.push_back(i);
  if (owners.size() != shapes.size())
    throw InputError(at_line(file.string(), elements[static_cast<size_t>(link)].line),
                     fmt::format("{} <{}> that urdfdom reads", owners.size(), tag),
                     fmt::format("{} from it", shapes.size()));
  std::vector<Geometry> out;
  for (size_t i = 0; i < owners.size(); ++i)
    out.push_back(to_geometry(*shapes[i]->geometry, shapes[i]->origin, elements, owners[i], file));
  return out;
}

/// `element` is the <link> that urdfdom read as `link`.
Link to_link(const urdf::Link& link, const std::vector<XmlElement>& elements,
             const UrdfCheckResult& use, int element, const std::filesystem::path& file) {
  Link out;
  out.name = link.name;
  out.visual = to_geometries(link.visual_array, "visual", elements, use, element, file);
  out.collision = to_geometries(link.collision_array, "collision", elements, use, element, file);
  const int inertial = child_of(elements, element, "inertial");
  const int mass = inertial < 0 ? -1 : child_of(elements, inertial, "mass");
  if (mass >= 0)
    out.mass_kg =
        finite_numbers(*elements[static_cast<size_t>(mass)].attribute("value")).value().front();
  return out;
}

/// `element` is the <joint> that urdfdom read as `joint`.
Joint to_joint(const urdf::Joint& joint, const std::vector<XmlElement>& elements, int element) {
  Joint out;
  out.name = joint.name;
  out.parent_from_joint = to_eigen(joint.parent_to_joint_origin_transform);
  turn_by_quaternion(elements, element, out.parent_from_joint);
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      out.kind = Joint::Kind::kRevolute;
      break;
    case urdf::Joint::CONTINUOUS:
      out.kind = Joint::Kind::kContinuous;
      break;
    case urdf::Joint::PRISMATIC:
      out.kind = Joint::Kind::kPrismatic;
      break;
    default:
      out.kind = Joint::Kind::kFixed;
  }
  if (out.kind == Joint::Kind::kFixed) return out;
  out.axis = to_eigen(joint.axis).normalized();
  if (out.kind == Joint::Kind::kContinuous) {
    out.lower = -std::numbers::pi;
    out.upper = std::numbers::pi;
  } else {
    out.lower = joint.limits->lower;
    out.upper = joint.limits->upper;
  }
  return out;
}

bool is_spherical(const XmlElement& joint) { return *joint.attribute("type") == "spherical"; }

/// Returns NAME_x, extended if another joint or link has that name.
std::string name_along(const std::string& name, char axis,
                       const std::map<std::string, int>& others) {
  std::string along = name + "_" + axis;
  while (others.count(along) != 0) along += axis;
  return along;
}

/// Returns one of the three joints that replace a spherical one: about x, y or z of its frame.
Joint turn_of(const Joint& spherical, char axis, const std::map<std::string, int>& joints) {
  Joint out;
  out.name = name_along(spherical.name, axis, joints);
  out.kind = Joint::Kind::kContinuous;
  if (axis == 'x') out.parent_from_joint = spherical.parent_from_joint;
  out.axis = Eigen::Vector3d::Unit(axis - 'x');
  out.lower = -std::numbers::pi;
  out.upper = std::numbers::pi;
  return out;
}

/// Returns the link between two of these joints.
Link frame_of(const Joint& spherical, char axis, const std::map<std::string, int>& links) {
  Link out;
  out.name = name_along(spherical.name, axis, links);
  return out;
}

std::map<std::string, int> named(const std::vector<XmlElement>& elements,
                                 const UrdfCheckResult& use, std::string_view tag) {
  std::map<std::string, int> out;
  for (size_t i = 1; i < elements.size(); ++i)
    if (elements[i].parent == 0 && elements[i].name == tag && !use.skipped[i])
      out.emplace(*elements[i].attribute("name"), static_cast<int>(i));
  return out;
}

/// Returns joints in depth-first order from the root, siblings as in the file.
std::vector<std::string> joints_from_root(const std::vector<XmlElement>& elements,
                                          const UrdfCheckResult& use,
                                          const urdf::ModelInterface& model) {
  std::map<std::string, std::vector<std::string>> below;  // by parent link, last one first
  for (size_t i = elements.size(); i-- > 1;) {
    if (elements[i].parent != 0 || elements[i].name != "joint" || use.skipped[i]) continue;
    const auto joint = model.joints_.find(*elements[i].attribute("name"));
    if (joint != model.joints_.end())
      below[joint->second->parent_link_name].push_back(joint->first);
  }
  std::vector<std::string> order;
  std::vector<std::string> pending = below[model.getRoot()->name];
  while (!pending.empty()) {
    order.push_back(pending.back());
    pending.pop_back();
    const auto& next = below[model.joints_.at(order.back())->child_link_name];
    pending.insert(pending.end(), next.begin(), next.end());
  }
  return order;
}

void require_names(const urdf::ModelInterface& model, const std::map<std::string, int>& links,
                   const std::map<std::string, int>& joints, const std::string& file,
                   const std::string& errors) {
  bool agrees = model.links_.size() == links.size() && model.joints_.size() == joints.size();
  for (const auto& [name, link] : model.links_) agrees = agrees && links.count(name) != 0;
  for (const auto& [name, joint] : model.joints_) agrees = agrees && joints.count(name) != 0;
  if (!agrees)
    throw InputError(
        file, fmt::format("{} links and {} joints from urdfdom", links.size(), joints.size()),
        fmt::format("{} and {}, or other names{}{}", model.links_.size(), model.joints_.size(),
                    errors.empty() ? "" : ": ", errors));
}

/// Returns the robot's name, or a substitute: no pose depends on it, so a bad name is no error.
std::string name_of_robot(const XmlElement& robot, const std::filesystem::path& file,
                          std::vector<std::string>& notes) {
  const std::string* name = robot.attribute("name");
  const std::string defect = name == nullptr ? "none" : defect_of_name(*name);
  if (defect.empty()) return *name;
  const bool is_blank = name == nullptr || name->find_first_not_of(' ') == std::string::npos;
  std::string other = name_after(is_blank ? file.stem().string() : *name);
  if (!defect_of_name(other).empty()) other = "robot";
  notes.push_back(fmt::format("name of the robot: {}; it is called '{}'", defect, other));
  return other;
}

}  // namespace

Robot parse_urdf(const std::string& whole, const std::filesystem::path& file,
                 std::vector<std::string>* assumptions) {
  std::vector<std::string> notes;
  std::string text = whole;
  // Written by C programs that include a string's terminator.
  while (!text.empty() && text.back() == '\0') text.pop_back();
  if (text.find('<') == std::string::npos) text = whole;
  if (text.size() < whole.size())
    notes.push_back(fmt::format("the last {} bytes are zero: skipped", whole.size() - text.size()));
  auto elements = scan_xml(text, file.string(), kUrdfLimits);
  const size_t notes_before = notes.size();
  std::string used = blank_ignored_tags(text, elements, notes);
  if (notes.size() > notes_before) {
    text = std::move(used);
    elements = scan_xml(text, file.string(), kUrdfLimits);
  }
  const UrdfCheckResult use = check_urdf(elements, file.string());
  Messages messages;
  const auto model = parse_quietly(plain_urdf(elements, use), messages);
  messages.errors = one_line(messages.errors);
  if (!model || !model->getRoot())
    throw InputError(file.string(), "a URDF that urdfdom reads",
                     messages.errors.empty() ? "one that it rejects" : messages.errors);
  const std::map<std::string, int> links = named(elements, use, "link");
  const std::map<std::string, int> joints = named(elements, use, "joint");
  require_names(*model, links, joints, file.string(), messages.errors);

  Robot robot;
  robot.name = name_of_robot(elements[0], file, notes);
  const std::string& root = model->getRoot()->name;
  robot.links.push_back(to_link(*model->getRoot(), elements, use, links.at(root), file));
  std::map<std::string, int> link_index{{root, 0}};
  std::map<std::string, int> joint_index;
  for (const std::string& name : joints_from_root(elements, use, *model)) {
    const urdf::Joint& joint = *model->joints_.at(name);
    const std::string& child = joint.child_link_name;
    const Joint out = to_joint(joint, elements, joints.at(name));
    const Link link = to_link(*model->links_.at(child), elements, use, links.at(child), file);
    int parent = link_index.at(joint.parent_link_name);
    const auto add_below = [&](Joint&& added, Link&& below) {
      added.parent_link = std::exchange(parent, static_cast<int>(robot.links.size()));
      added.child_link = parent;
      robot.joints.push_back(std::move(added));
      robot.links.push_back(std::move(below));
    };
    if (is_spherical(elements[static_cast<size_t>(joints.at(name))]))
      for (const char axis : {'x', 'y', 'z'})
        add_below(turn_of(out, axis, joints),
                  axis == 'z' ? Link(link) : frame_of(out, axis, links));
    else
      add_below(Joint(out), Link(link));
    link_index[child] = parent;
    joint_index[name] = static_cast<int>(robot.joints.size()) - 1;
  }
  for (Joint& joint : robot.joints) {
    const auto read = model->joints_.find(joint.name);
    if (read == model->joints_.end()) continue;  // one of three joints that replace a spherical one
    const auto& mimic = read->second->mimic;
    if (!mimic || joint.kind == Joint::Kind::kFixed) continue;
    joint.mimic = {joint_index.at(mimic->joint_name), mimic->multiplier, mimic->offset};
  }
  robot.notes = std::move(notes);
  const auto add = [&robot](const std::vector<std::string>& more) {
    robot.notes.insert(robot.notes.end(), more.begin(), more.end());
  };
  add(use.notes);
  add(unused_in_urdf(elements));
  if (!messages.errors.empty()) add({"urdfdom reports: " + escaped(messages.errors)});
  if (assumptions != nullptr)
    assumptions->insert(assumptions->end(), use.assumptions.begin(), use.assumptions.end());
  return robot;
}

std::string read_urdf_text(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw InputError(file.string(), "a URDF file", "a directory");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "a URDF file", error.message());
  if (size > kUrdfLimits.bytes)
    throw InputError(file.string(), fmt::format("at most {} bytes", kUrdfLimits.bytes),
                     fmt::format("{}", size));
  std::ifstream in(file, std::ios::binary);
  std::string text(size, '\0');
  in.read(text.data(), static_cast<std::streamsize>(size));
  if (!in) throw InputError(file.string(), "a readable file", "an error while reading");
  return text;
}

Robot read_urdf(const std::filesystem::path& file) {
  return parse_urdf(read_urdf_text(file), file);
}

bool is_urdf(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  std::ifstream in(file, std::ios::binary);
  std::string head;
  // One page usually shows whether it is XML; copyright notices may be longer.
  for (const size_t bytes : {size_t{4096}, size_t{1} << 20}) {
    const size_t had = head.size();
    head.resize(bytes);
    in.read(head.data() + had, static_cast<std::streamsize>(bytes - had));
    head.resize(had + static_cast<size_t>(in.gcount()));
    if (root_tag_of(head) == "robot") return true;
    if (head.find_first_not_of(" \t\r\n\xef\xbb\xbf") != head.find('<')) return false;
  }
  return false;
}

}  // namespace throng
