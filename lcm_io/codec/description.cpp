#include "lcm_io/codec/description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <map>
#include <numbers>

#include "base/errors.h"
#include "base/limits.h"
#include "base/portable_math.h"
#include "base/text.h"
#include "base/version.h"
#include "culling/event_hash.h"

namespace throng {
namespace {

/// Model and group numbers are signed 16-bit; loading enforces kMaxModels and kMaxGroups.
int16_t number_of(uint16_t index) {
  assert(index <= std::numeric_limits<int16_t>::max());
  return static_cast<int16_t>(index);
}

mesh_t to_message(const Mesh& mesh) {
  mesh_t out;
  out.coordinates_m.reserve(mesh.vertices.size() * 3);
  for (const auto& v : mesh.vertices)
    out.coordinates_m.insert(out.coordinates_m.end(), {v.x(), v.y(), v.z()});
  out.indices.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles) out.indices.insert(out.indices.end(), {t.x(), t.y(), t.z()});
  out.coordinate_count = static_cast<int32_t>(out.coordinates_m.size());
  out.index_count = static_cast<int32_t>(out.indices.size());
  return out;
}

Mesh to_mesh(const mesh_t& mesh) {
  Mesh out;
  for (size_t i = 0; i + 2 < mesh.coordinates_m.size(); i += 3)
    out.vertices.emplace_back(mesh.coordinates_m[i], mesh.coordinates_m[i + 1],
                              mesh.coordinates_m[i + 2]);
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out.triangles.emplace_back(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
  return out;
}

joint_t to_message(const Robot& robot, size_t index, int column) {
  const Joint& joint = robot.joints[index];
  const Eigen::Quaterniond rotation(joint.parent_from_joint.linear());
  const Eigen::Vector3d position = joint.parent_from_joint.translation();
  joint_t out{};
  out.name = joint.name;
  out.child_link = robot.links[static_cast<size_t>(joint.child_link)].name;
  out.kind = static_cast<int8_t>(joint.kind);
  out.parent_link = joint.parent_link;
  for (int i = 0; i < 3; ++i) out.position_m[i] = position[i];
  out.rotation_wxyz[0] = rotation.w();
  for (int i = 0; i < 3; ++i) out.rotation_wxyz[i + 1] = rotation.vec()[i];
  for (int i = 0; i < 3; ++i) out.axis[i] = joint.axis[i];
  out.lower = joint.lower;
  out.upper = joint.upper;
  out.mimic_joint = joint.mimic ? joint.mimic->joint : -1;
  out.mimic_multiplier = joint.mimic ? joint.mimic->multiplier : 1;
  out.mimic_offset = joint.mimic ? joint.mimic->offset : 0;
  out.column = column;
  return out;
}

Joint to_joint(const joint_t& joint, int index) {
  Joint out;
  out.name = joint.name;
  out.kind = static_cast<Joint::Kind>(joint.kind);
  out.parent_link = joint.parent_link;
  out.child_link = index + 1;
  const double* r = joint.rotation_wxyz;
  out.parent_from_joint.linear() = Eigen::Quaterniond(r[0], r[1], r[2], r[3]).toRotationMatrix();
  out.parent_from_joint.translation() = Eigen::Map<const Eigen::Vector3d>(joint.position_m);
  out.axis = Eigen::Map<const Eigen::Vector3d>(joint.axis);
  out.lower = joint.lower;
  out.upper = joint.upper;
  if (joint.mimic_joint >= 0)
    out.mimic = Joint::Mimic{joint.mimic_joint, joint.mimic_multiplier, joint.mimic_offset};
  return out;
}

model_t to_message(const Model& model) {
  model_t out;
  out.name = model.name;
  out.height_m = static_cast<double>(model.height_m);
  out.root_link = model.robot.links.front().name;
  for (size_t i = 0; i < model.robot.joints.size(); ++i)
    out.joints.push_back(
        to_message(model.robot, i, model.kinematics.column_of(model.robot.joints[i].name)));
  out.joint_count = static_cast<int32_t>(out.joints.size());
  for (const Part& part : model.parts) {
    part_t& sent = out.parts.emplace_back();
    sent.name = part.name;
    sent.source = part.source;
    sent.link = part.link;
    sent.mesh = to_message(part.mesh);
  }
  out.part_count = static_cast<int32_t>(out.parts.size());
  for (const ColumnRange& range : column_ranges(model)) {
    out.column_middle.push_back(range.middle);
    out.column_half.push_back(range.half);
  }
  out.column_count = static_cast<int32_t>(out.column_middle.size());
  return out;
}

polygon_t to_message(const Polygon& polygon) {
  polygon_t out{};
  const auto add = [&](const Polygon::Ring& ring) {
    out.corners_of_ring.push_back(static_cast<int32_t>(ring.size()));
    for (const Eigen::Vector2d& corner : ring)
      out.coordinates_m.insert(out.coordinates_m.end(), {corner.x(), corner.y()});
  };
  add(polygon.outline);
  for (const Polygon::Ring& hole : polygon.holes) add(hole);
  out.ring_count = static_cast<int32_t>(out.corners_of_ring.size());
  out.coordinate_count = static_cast<int32_t>(out.coordinates_m.size());
  return out;
}

obstacle_t to_message(const Obstacle& obstacle) {
  obstacle_t out{};
  out.name = obstacle.name;
  out.kind = static_cast<int8_t>(obstacle.kind);
  for (int i = 0; i < 3; ++i) out.centre_m[i] = obstacle.centre_m[i];
  out.heading_rad = obstacle.heading_rad;
  for (int i = 0; i < 3; ++i) out.size_m[i] = obstacle.size_m[i];
  out.mesh = to_message(obstacle.mesh);
  return out;
}

}  // namespace

std::vector<ColumnRange> column_ranges(const Model& model) {
  // A joint with followers keeps its full turns, because followers may multiply them.
  std::map<std::string, bool> is_followed;
  for (const Joint& joint : model.robot.joints)
    if (joint.mimic)
      is_followed[model.robot.joints[static_cast<size_t>(joint.mimic->joint)].name] = true;
  std::vector<ColumnRange> ranges;
  for (const JointColumn& column : model.kinematics.columns()) {
    const double lower = static_cast<double>(column.lower);
    const double upper = static_cast<double>(column.upper);
    const bool goes_round = !column.prismatic && upper - lower > kTurn - 1e-6;
    if (goes_round && !is_followed.contains(column.name))
      ranges.push_back({0, std::numbers::pi, true});
    else
      ranges.push_back({(lower + upper) / 2, (upper - lower) / 2, false});
  }
  return ranges;
}

std::vector<ColumnRange> column_ranges(const model_t& described) {
  std::vector<ColumnRange> ranges;
  for (size_t i = 0; i < described.column_middle.size(); ++i)
    ranges.push_back({described.column_middle[i], described.column_half[i], false});
  return ranges;
}

Polygon to_polygon(const polygon_t& polygon) {
  Polygon out;
  size_t next = 0;
  for (size_t ring = 0; ring < polygon.corners_of_ring.size(); ++ring) {
    Polygon::Ring& corners = ring == 0 ? out.outline : out.holes.emplace_back();
    for (int32_t i = 0; i < polygon.corners_of_ring[ring]; ++i, next += 2)
      corners.emplace_back(&polygon.coordinates_m[next]);
  }
  return out;
}

run_description_t describe(const RunInfo& run) {
  const Scene& scene = *run.scene;
  run_description_t out{};
  out.schema = kSchema;
  out.scene = scene.name;
  out.seed = static_cast<int64_t>(scene.seed);
  out.step_s = run.step_s;
  out.part_volume = to_text(scene.part_volume);
  out.exact = run.culler.exact ? 1 : 0;
  for (int i = 0; i < 2; ++i) {
    out.ground_min_m[i] = scene.ground.min_m[i];
    out.ground_max_m[i] = scene.ground.max_m[i];
  }
  for (const Polygon& polygon : scene.floor) out.floor.push_back(to_message(polygon));
  out.floor_count = static_cast<int32_t>(out.floor.size());
  for (const Obstacle& obstacle : scene.obstacles) out.obstacles.push_back(to_message(obstacle));
  out.obstacle_count = static_cast<int32_t>(out.obstacles.size());
  for (const auto& model : run.models) out.models.push_back(to_message(*model));
  out.model_count = static_cast<int32_t>(out.models.size());
  out.avatar_count = run.avatar_count();
  for (const uint16_t model : run.model_of_avatar) out.model_of_avatar.push_back(number_of(model));
  out.scale_of_avatar = run.scale_of_avatar;
  for (const uint16_t group : run.group_of_avatar) out.group_of_avatar.push_back(number_of(group));
  out.groups = run.groups;
  out.control_channels = run.control_channels;
  out.group_count = static_cast<int32_t>(out.groups.size());
  return out;
}

namespace {

std::string omits(const RunInfo& run) {
  if (!run.culling) return "all contacts: the run had no culling";
  if (run.culler.has_budget())
    return "tests beyond the frame's budget: such pairs count as touching, and their level names "
           "the "
           "last test passed";
  return std::string(omitted_by(run.strategy));
}

}  // namespace

std::vector<uint8_t> encode_description(const RunInfo& run) {
  const std::string where = run.scene->file.empty() ? run.scene->name : run.scene->file.string();
  // Checked before encoding, because numbers that overflow cannot be detected in the description.
  if (run.models.size() > kMaxModels || run.groups.size() > kMaxGroups)
    throw InputError(where, fmt::format("at most {} models and {} groups", kMaxModels, kMaxGroups),
                     fmt::format("{} and {}", run.models.size(), run.groups.size()));
  const run_description_t description = describe(run);
  const std::string defect = defect_of(description);
  if (!defect.empty()) throw InputError(where, "a run whose log can be read", defect);
  const auto size = static_cast<size_t>(description.getEncodedSize());
  if (size > kMaxDescriptionBytes)
    throw InputError(
        where, fmt::format("models and obstacles of at most {} MB", kMaxDescriptionBytes >> 20),
        fmt::format("{} MB", size >> 20));
  std::vector<uint8_t> bytes(size);
  description.encode(bytes.data(), 0, static_cast<int>(size));
  return bytes;
}

void describe_checksums(const RunInfo& run, checksums_t& out) {
  out.version = version();
  out.commit = fmt::format("{:<18}", commit());
  out.strategy = name_of(run.strategy);
  out.budget_ms = run.culler.budget_ms.value_or(-1);
  out.budget_tests = run.culler.budget_tests ? static_cast<int64_t>(*run.culler.budget_tests) : -1;
  out.omits = omits(run);
  out.is_last = out.is_repaired = 0;
  out.hash_kind = static_cast<int32_t>(run.culler.has_budget() ? EventHashKind::kEventsAndLevels
                                                               : EventHashKind::kEvents);
  out.hash_at_start = run.resumed ? static_cast<int64_t>(run.resumed->hash) : 0;
}

std::string printable(std::string_view name, size_t max_bytes) {
  std::string out;
  for (size_t at = 0; at < name.size() && out.size() < max_bytes;) {
    const size_t length = printable_character(name.substr(at));
    out += length > 0 ? name.substr(at, length) : "?";
    at += std::max<size_t>(length, 1);
  }
  return out;
}

std::string body_name(const run_description_t& run, uint32_t body) {
  const auto id = static_cast<size_t>(body);
  if (id < run.group_of_avatar.size())
    return fmt::format("{} {}", printable(run.groups[static_cast<size_t>(run.group_of_avatar[id])]),
                       id);
  const size_t obstacle = id - run.group_of_avatar.size();
  return obstacle < run.obstacles.size() ? printable(run.obstacles[obstacle].name)
                                         : fmt::format("body {}", id);
}

std::string part_name(const run_description_t& run, uint32_t body, uint32_t part) {
  const auto id = static_cast<size_t>(body);
  if (part == kWholeBody || id >= run.model_of_avatar.size()) return "";
  const std::vector<part_t>& parts = run.models[static_cast<size_t>(run.model_of_avatar[id])].parts;
  return part < parts.size() ? printable(parts[part].name) : fmt::format("part {}", part);
}

bool has_pair(const run_description_t& run, PairKey pair) {
  const auto has_part = [&run](uint32_t body, uint32_t part) {
    const auto id = static_cast<size_t>(body);
    if (id < run.model_of_avatar.size())
      return part == kWholeBody ||
             part < run.models[static_cast<size_t>(run.model_of_avatar[id])].parts.size();
    return id - run.model_of_avatar.size() < run.obstacles.size() &&
           (part == kWholeBody || part == 0);
  };
  return has_part(pair.a(), pair.part_a()) && has_part(pair.b(), pair.part_b());
}

std::shared_ptr<const Model> to_model(const model_t& described) {
  Robot robot;
  robot.name = described.name;
  robot.links.push_back({described.root_link, {}, {}, {}});
  for (int i = 0; i < described.joint_count; ++i) {
    const joint_t& joint = described.joints[static_cast<size_t>(i)];
    robot.links.push_back({joint.child_link, {}, {}, {}});
    robot.joints.push_back(to_joint(joint, i));
  }
  std::vector<Part> parts;
  std::vector<int> links;
  for (const part_t& part : described.parts) {
    parts.push_back({part.name, part.source, part.link, to_mesh(part.mesh)});
    links.push_back(part.link);
  }
  FlatModel kinematics(robot, links);
  Model model{described.name,
              std::move(robot),
              std::move(parts),
              std::move(kinematics),
              static_cast<float>(described.height_m),
              0};
  model.is_person = has_human_legs(model);
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace throng
