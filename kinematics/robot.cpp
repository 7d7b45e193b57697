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
#include <system_error>

#include "base/errors.h"
#include "base/text.h"
#include "kinematics/mesh_path.h"
#include "kinematics/urdf_check.h"
#include "kinematics/urdf_idle.h"

namespace throng {
namespace {

/// Collects what urdfdom would have printed.
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

/// Line breaks and tabs inside attribute values become spaces: XML 1.0 asks for it, tinyxml does
/// not do it, and urdfdom then finds no number.
std::string with_plain_values(std::string text, const std::vector<XmlElement>& elements,
                              const char* scanned) {
  for (const XmlElement& element : elements)
    for (const auto& [name, value] : element.attributes) {
      const size_t open =
          text.find_first_of("\"'", static_cast<size_t>(name.data() + name.size() - scanned));
      const size_t close = text.find(text[open], open + 1);
      for (size_t i = open; i < close; ++i)
        if (text[i] == '\n' || text[i] == '\r' || text[i] == '\t') text[i] = ' ';
    }
  return text;
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

Geometry to_geometry(const urdf::Geometry& shape, const urdf::Pose& origin,
                     const std::filesystem::path& file) {
  Geometry out;
  out.link_from_geometry = to_eigen(origin);
  switch (shape.type) {
    case urdf::Geometry::MESH: {
      const auto& mesh = dynamic_cast<const urdf::Mesh&>(shape);
      out.kind = Geometry::Kind::kMesh;
      out.mesh_file = resolve_mesh(mesh.filename, file);
      out.mesh_scale = to_eigen(mesh.scale);
      break;
    }
    case urdf::Geometry::BOX:
      out.kind = Geometry::Kind::kBox;
      out.box_size_m = to_eigen(dynamic_cast<const urdf::Box&>(shape).dim);
      break;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(shape);
      out.kind = Geometry::Kind::kCylinder;
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

Link to_link(const urdf::Link& link, const std::filesystem::path& file) {
  Link out;
  out.name = link.name;
  for (const auto& visual : link.visual_array)
    out.visual.push_back(to_geometry(*visual->geometry, visual->origin, file));
  for (const auto& collision : link.collision_array)
    out.collision.push_back(to_geometry(*collision->geometry, collision->origin, file));
  if (link.inertial) out.mass_kg = link.inertial->mass;
  return out;
}

Joint to_joint(const urdf::Joint& joint) {
  Joint out;
  out.name = joint.name;
  out.parent_from_joint = to_eigen(joint.parent_to_joint_origin_transform);
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

/// Joints in depth-first order from the root, siblings as they stand in the file.
std::vector<std::string> joints_from_root(const std::vector<XmlElement>& elements,
                                          const urdf::ModelInterface& model) {
  std::map<std::string, std::vector<std::string>> below;  // by parent link, last one first
  for (size_t i = elements.size(); i-- > 1;) {
    if (elements[i].parent != 0 || elements[i].name != "joint") continue;
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

int shapes_in(const std::vector<XmlElement>& elements) {
  int count = 0;
  for (const XmlElement& element : elements) {
    if (element.name != "visual" && element.name != "collision") continue;
    const XmlElement& owner = elements[static_cast<size_t>(element.parent)];
    count += owner.name == "link" && owner.parent == 0 ? 1 : 0;
  }
  return count;
}

/// What both readings of the same text have to agree on; urdfdom drops what it cannot read.
void check_nothing_lost(const std::vector<XmlElement>& elements, const Robot& robot,
                        const std::string& file, const std::string& errors) {
  int links = 0;
  for (const XmlElement& element : elements) links += element.parent == 0 && element.name == "link";
  int shapes = 0;
  for (const Link& link : robot.links)
    shapes += static_cast<int>(link.visual.size() + link.collision.size());
  const int shapes_expected = shapes_in(elements);
  if (static_cast<int>(robot.links.size()) == links && shapes == shapes_expected) return;
  throw InputError(file,
                   fmt::format("{} links with {} shapes from urdfdom", links, shapes_expected),
                   fmt::format("{} with {}{}{}", robot.links.size(), shapes,
                               errors.empty() ? "" : ": ", errors));
}

/// urdfdom reads entities in its own way: what it made of the names is checked, too.
void check_names(const Robot& robot, const std::string& file) {
  const auto check = [&file](const char* of, const std::string& name) {
    const std::string defect = defect_of_name(name);
    if (!defect.empty()) throw InputError(file, fmt::format("a name for each {}", of), defect);
  };
  check("robot", robot.name);
  for (const Link& link : robot.links) check("link", link.name);
  for (const Joint& joint : robot.joints) check("joint", joint.name);
}

}  // namespace

Robot parse_urdf(const std::string& whole, const std::filesystem::path& file) {
  std::vector<std::string> notes;
  std::string text = whole;
  // Programs in C that write a string with its end do this.
  while (!text.empty() && text.back() == '\0') text.pop_back();
  if (text.find('<') == std::string::npos) text = whole;
  if (text.size() < whole.size())
    notes.push_back(fmt::format("the last {} bytes are zero: skipped", whole.size() - text.size()));
  auto elements = scan_xml(text, file.string(), kUrdfCaps);
  const size_t notes_before = notes.size();
  std::string used = without_idle(text, elements, notes);
  if (notes.size() > notes_before) {
    text = std::move(used);
    elements = scan_xml(text, file.string(), kUrdfCaps);
  }
  check_urdf(elements, file.string());
  Messages messages;
  const auto model = parse_quietly(with_plain_values(text, elements, text.data()), messages);
  messages.errors = one_line(messages.errors);
  if (!model || !model->getRoot())
    throw InputError(file.string(), "a URDF that urdfdom reads",
                     messages.errors.empty() ? "one that it refuses" : messages.errors);

  Robot robot;
  robot.name = model->getName();
  robot.links.push_back(to_link(*model->getRoot(), file));
  std::map<std::string, int> link_index{{robot.links[0].name, 0}};
  std::map<std::string, int> joint_index;
  const auto order = joints_from_root(elements, *model);
  for (const std::string& name : order) {
    const urdf::Joint& joint = *model->joints_.at(name);
    Joint out = to_joint(joint);
    out.parent_link = link_index.at(joint.parent_link_name);
    out.child_link = static_cast<int>(robot.links.size());
    link_index[joint.child_link_name] = out.child_link;
    joint_index[name] = static_cast<int>(robot.joints.size());
    robot.links.push_back(to_link(*model->links_.at(joint.child_link_name), file));
    robot.joints.push_back(std::move(out));
  }
  for (Joint& joint : robot.joints) {
    const auto& mimic = model->joints_.at(joint.name)->mimic;
    if (!mimic || joint.kind == Joint::Kind::kFixed) continue;
    joint.mimic = {joint_index.at(mimic->joint_name), mimic->multiplier, mimic->offset};
  }
  check_nothing_lost(elements, robot, file.string(), messages.errors);
  check_names(robot, file.string());
  robot.notes = std::move(notes);
  const std::vector<std::string> unused = unused_in_urdf(elements);
  robot.notes.insert(robot.notes.end(), unused.begin(), unused.end());
  if (!messages.errors.empty()) robot.notes.push_back("urdfdom says: " + escaped(messages.errors));
  return robot;
}

std::string read_urdf_text(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw InputError(file.string(), "a URDF file", "a directory");
  const auto size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "a URDF file", error.message());
  if (size > kUrdfCaps.bytes)
    throw InputError(file.string(), fmt::format("at most {} bytes", kUrdfCaps.bytes),
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

}  // namespace throng
