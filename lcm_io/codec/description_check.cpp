// Checks of a received description, equivalent to the checks of a URDF.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <span>

#include "base/limits.h"
#include "lcm_io/codec/description.h"

namespace throng {
namespace {

bool all_sane(std::span<const double> values) {
  for (const double v : values)
    if (!(std::abs(v) <= kMaxDescribed)) return false;
  return true;
}

bool is_in(int32_t index, size_t count) { return index >= 0 && static_cast<size_t>(index) < count; }

std::string defect_of(const mesh_t& mesh) {
  if (mesh.coordinate_count == 0 || mesh.coordinate_count % 3 != 0)
    return fmt::format("{} coordinates in a mesh", mesh.coordinate_count);
  if (mesh.index_count % 3 != 0) return fmt::format("{} indices in a mesh", mesh.index_count);
  for (const float c : mesh.coordinates_m)
    if (!(std::abs(static_cast<double>(c)) <= kMaxDescribed))
      return "a coordinate that is not finite";
  const auto vertices = static_cast<size_t>(mesh.coordinate_count / 3);
  for (const int32_t i : mesh.indices)
    if (!is_in(i, vertices)) return fmt::format("vertex {} of {}", i, vertices);
  return "";
}

std::string defect_of(const joint_t& joint, int index, const model_t& model) {
  if (joint.name.empty() || joint.child_link.empty()) return "an empty name";
  if (joint.kind < 0 || joint.kind > 3) return fmt::format("joint kind {}", joint.kind);
  if (joint.parent_link < 0 || joint.parent_link > index)
    return fmt::format("parent link {} of joint {}", joint.parent_link, index);
  if (!all_sane(joint.position_m) || !all_sane(joint.rotation_wxyz) || !all_sane(joint.axis) ||
      !all_sane(std::array{joint.lower, joint.upper, joint.mimic_multiplier, joint.mimic_offset}))
    return "a number out of range";
  const double* r = joint.rotation_wxyz;
  const double* a = joint.axis;
  if (std::abs(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3] - 1) > 1e-6)
    return "a rotation that is not a unit quaternion";
  if (joint.kind != 0 && std::abs(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 1) > 1e-6)
    return "an axis that is not a unit vector";
  if (joint.lower > joint.upper) return "lower limit above upper limit";
  if (joint.mimic_joint != -1) {
    if (!is_in(joint.mimic_joint, model.joints.size()) || joint.mimic_joint == index)
      return fmt::format("mimic of joint {}", joint.mimic_joint);
    int32_t leader = joint.mimic_joint;
    for (size_t steps = 0; leader >= 0; ++steps) {
      if (!is_in(leader, model.joints.size()) || steps > model.joints.size())
        return "a cycle of mimic joints";
      if (model.joints[static_cast<size_t>(leader)].kind == 0) return "mimic of a fixed joint";
      leader = model.joints[static_cast<size_t>(leader)].mimic_joint;
    }
  }
  return "";
}

std::string defect_of(const polygon_t& polygon) {
  if (polygon.ring_count < 1) return "a polygon without an outline";
  int64_t coordinates = 0;
  for (const int32_t corners : polygon.corners_of_ring) {
    if (corners < 3) return fmt::format("a ring of {} corners", corners);
    coordinates += int64_t{2} * corners;
  }
  if (coordinates != polygon.coordinate_count)
    return fmt::format("{} coordinates for {} corners", polygon.coordinate_count, coordinates / 2);
  return all_sane(polygon.coordinates_m) ? "" : "a number out of range";
}

std::string defect_of_tree(const model_t& model) {
  if (model.joint_count > kMaxLinks) return fmt::format("{} joints", model.joint_count);
  if (model.root_link.empty()) return "an empty name";
  std::set<std::string> links = {model.root_link}, joints;
  std::vector<int> depth = {0};
  int columns = 0;
  for (int i = 0; i < model.joint_count; ++i) {
    const joint_t& joint = model.joints[static_cast<size_t>(i)];
    std::string defect = defect_of(joint, i, model);
    if (!defect.empty()) return defect;
    if (!links.insert(joint.child_link).second || !joints.insert(joint.name).second)
      return "two links or joints with the same name";
    depth.push_back(depth[static_cast<size_t>(joint.parent_link)] + 1);
    if (depth.back() > kMaxChainDepth)
      return fmt::format("a chain of more than {} links", kMaxChainDepth);
    const bool moves = joint.kind != 0 && joint.mimic_joint < 0;
    if (moves ? !is_in(joint.column, model.column_middle.size()) : joint.column != -1)
      return fmt::format("column {}", joint.column);
    columns += moves ? 1 : 0;
  }
  if (columns != model.column_count)
    return fmt::format("{} columns for {} moving joints", model.column_count, columns);
  return "";
}

std::string defect_of(const model_t& model) {
  std::string defect = defect_of_tree(model);
  if (!defect.empty()) return defect;
  if (model.part_count > kMaxModelParts) return fmt::format("{} parts", model.part_count);
  for (const part_t& part : model.parts) {
    if (!is_in(part.link, model.joints.size() + 1)) return fmt::format("link {}", part.link);
    defect = defect_of(part.mesh);
    if (!defect.empty()) return defect;
  }
  if (!all_sane(model.column_middle) || !all_sane(model.column_half) ||
      !all_sane({&model.height_m, 1}))
    return "a number out of range";
  return "";
}

}  // namespace

std::string defect_of(const run_description_t& run) {
  if (run.schema != kSchema)
    return fmt::format("schema {}, this program reads {}", run.schema, kSchema);
  if (!(run.step_s > 0 && run.step_s <= kMaxDescribed)) return "a step that is not positive";
  if (!all_sane(run.ground_min_m) || !all_sane(run.ground_max_m)) return "a number out of range";
  for (const polygon_t& polygon : run.floor)
    if (std::string defect = defect_of(polygon); !defect.empty()) return defect;
  for (const obstacle_t& obstacle : run.obstacles) {
    if (obstacle.kind < 0 || obstacle.kind > 3)
      return fmt::format("obstacle kind {}", obstacle.kind);
    if (!all_sane(obstacle.centre_m) || !all_sane(obstacle.size_m) ||
        !all_sane({&obstacle.heading_rad, 1}))
      return "a number out of range";
    std::string defect = defect_of(obstacle.mesh);
    if (!defect.empty()) return "obstacle '" + obstacle.name + "': " + defect;
  }
  for (const model_t& model : run.models) {
    std::string defect = defect_of(model);
    if (!defect.empty()) return "model '" + model.name + "': " + defect;
  }
  for (const int16_t model : run.model_of_avatar)
    if (!is_in(model, run.models.size()))
      return fmt::format("model {} of {}", model, run.models.size());
  for (const int16_t group : run.group_of_avatar)
    if (!is_in(group, run.groups.size()))
      return fmt::format("group {} of {}", group, run.groups.size());
  for (const float scale : run.scale_of_avatar)
    if (!(scale >= 1 / static_cast<float>(kMaxDescribed) && scale <= kMaxScale))
      return "a scale out of range";
  return "";
}

}  // namespace throng
