#include "viewer/server/run_message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "avatars/gait/gait.h"
#include "base/errors.h"
#include "culling/volumes/aabb.h"
#include "culling/volumes/polytope.h"
#include "culling/volumes/slabs.h"

namespace throng {
namespace {

using nlohmann::json;

constexpr double kMaxInt16 = 32767;
constexpr int64_t kMaxParts = 4 << 20;  // 64 MB per frame
constexpr float kMaxVertex_m = 1e5F;

class MeshSection {
 public:
  /// Appends a mesh and returns where the page finds it in the section.
  json add(std::span<const Eigen::Vector3f> vertices, std::span<const uint32_t> indices) {
    double reach = 1e-6;
    for (const Eigen::Vector3f& v : vertices)
      reach = std::max(reach, static_cast<double>(v.cwiseAbs().maxCoeff()));
    const double step = reach / kMaxInt16;
    json place = {
        {"vertex_step_m", step}, {"vertices", bytes_.size()}, {"vertex_count", vertices.size()}};
    for (const Eigen::Vector3f& v : vertices)
      for (int i = 0; i < 3; ++i)
        put(bytes_, static_cast<int16_t>(std::lround(static_cast<double>(v[i]) / step)));
    align(bytes_, 4);
    place["indices"] = bytes_.size();
    place["index_count"] = indices.size();
    put_all(bytes_, indices);
    return place;
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

std::vector<Eigen::Vector3f> points_of(const mesh_t& mesh) {
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i + 2 < mesh.coordinates_m.size(); i += 3)
    points.emplace_back(mesh.coordinates_m[i], mesh.coordinates_m[i + 1],
                        mesh.coordinates_m[i + 2]);
  if (points.empty()) points.emplace_back(0, 0, 0);
  return points;
}

std::vector<uint32_t> indices_of(const mesh_t& mesh) {
  std::vector<uint32_t> indices;
  for (const int32_t index : mesh.indices) indices.push_back(static_cast<uint32_t>(index));
  return indices;
}

/// Returns k of the run's or-DOPs; 26 for other volumes.
int directions_of(const std::string& part_volume) {
  for (const int k : {14, 18})
    if (part_volume.ends_with(fmt::format("ordop{}", k))) return k;
  return 26;
}

/// Adds the edges of the or-DOP: unique corners, two indices per line.
json add_hull(MeshSection& section, std::span<const Eigen::Vector3f> points, int k) {
  const Polytope solid = polytope_of(Slabs::around(points), k);
  // Corners of adjacent faces differ by rounding: a tolerance of 0.1 mm merges them.
  std::map<std::array<long, 3>, uint32_t> known;
  std::vector<Eigen::Vector3f> corners;
  std::vector<uint32_t> numbers;
  for (const Eigen::Vector3d& corner : solid.corners_m) {
    const Eigen::Vector3d cell = corner * 1e4;
    const auto [at, is_new] = known.try_emplace(
        {std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())}, corners.size());
    if (is_new) corners.push_back(corner.cast<float>());
    numbers.push_back(at->second);
  }
  std::set<std::pair<uint32_t, uint32_t>> edges;
  size_t begin = 0;
  for (const size_t end : solid.face_ends) {
    for (size_t i = begin; i < end; ++i) {
      const uint32_t p = numbers[i];
      const uint32_t q = numbers[i + 1 < end ? i + 1 : begin];
      if (p != q) edges.insert(std::minmax(p, q));
    }
    begin = end;
  }
  std::vector<uint32_t> lines;
  for (const auto& [p, q] : edges) {
    lines.push_back(p);
    lines.push_back(q);
  }
  return section.add(corners, lines);
}

json to_json(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

json describe_model(const model_t& model, bool is_person, const AvatarSphere& sphere,
                    float part_step_m, int k, MeshSection& section) {
  json out = {{"name", model.name},
              {"is_person", is_person},
              {"height_m", model.height_m},
              {"sphere", {{"centre_z_m", sphere.centre_z_m}, {"radius_m", sphere.radius_m}}},
              {"part_step_m", part_step_m}};
  out["parts"] = json::array();
  for (const part_t& part : model.parts) {
    const std::vector<Eigen::Vector3f> points = points_of(part.mesh);
    const Aabb::Fitted box = Aabb::fit(points);
    out["parts"].push_back(
        {{"name", part.name},
         {"link", part.link},
         {"box", {{"centre_m", to_json(box.centre_m)}, {"half_m", to_json(box.half_m)}}},
         {"mesh", section.add(points, indices_of(part.mesh))},
         {"hull", add_hull(section, points, k)}});
  }
  out["joints"] = json::array();
  for (const joint_t& joint : model.joints) {
    const auto& q = joint.rotation_wxyz;
    out["joints"].push_back({{"name", joint.name},
                             {"kind", joint.kind},
                             {"parent_link", joint.parent_link},
                             {"position_m", joint.position_m},
                             {"rotation_wxyz", {q[0], q[1], q[2], q[3]}},
                             {"axis", joint.axis},
                             {"mimic_joint", joint.mimic_joint},
                             {"mimic_multiplier", joint.mimic_multiplier},
                             {"mimic_offset", joint.mimic_offset},
                             {"column", joint.column}});
  }
  return out;
}

json describe_obstacles(const run_description_t& run, MeshSection& section) {
  json all = json::array();
  for (const obstacle_t& obstacle : run.obstacles)
    all.push_back({{"name", obstacle.name},
                   {"kind", obstacle.kind},
                   {"centre_m", obstacle.centre_m},
                   {"heading_rad", obstacle.heading_rad},
                   {"mesh", section.add(points_of(obstacle.mesh), indices_of(obstacle.mesh))}});
  return all;
}

const char* name_of(ViewMode mode) {
  switch (mode) {
    case ViewMode::kLive:
      return "live";
    case ViewMode::kLog:
      return "log";
    case ViewMode::kFile:
      break;
  }
  return "file";
}

/// Rejects descriptions that would take gigabytes or overflow; any sender may have made them.
void require_viewable(const run_description_t& run) {
  int64_t parts = 0;
  for (const int16_t model : run.model_of_avatar)
    parts += run.models[static_cast<size_t>(model)].part_count;
  if (parts > kMaxParts)
    throw InputError(run.scene, fmt::format("at most {} body parts", kMaxParts),
                     fmt::format("{}", parts));
  const auto require = [&](const std::string& name, const mesh_t& mesh) {
    for (const float x : mesh.coordinates_m)
      if (!(std::fabs(x) < kMaxVertex_m))
        throw InputError(name, fmt::format("vertices within {} m", kMaxVertex_m),
                         fmt::format("{}", x));
  };
  for (const model_t& model : run.models)
    for (const part_t& part : model.parts) require(part.name, part.mesh);
  for (const obstacle_t& obstacle : run.obstacles) require(obstacle.name, obstacle.mesh);
}

}  // namespace

RunGeometry::RunGeometry(RunReader& run) {
  const run_description_t& description = *run.run();
  require_viewable(description);
  std::vector<float> max_scale(description.models.size(), 1);
  first_part = {0};
  for (size_t i = 0; i < description.model_of_avatar.size(); ++i) {
    const auto model = static_cast<size_t>(description.model_of_avatar[i]);
    max_scale[model] = std::max(max_scale[model], description.scale_of_avatar[i]);
    first_part.push_back(first_part.back() +
                         static_cast<uint32_t>(description.models[model].part_count));
  }
  for (size_t m = 0; m < description.models.size(); ++m) {
    const std::shared_ptr<const Model> model = run.model(m);
    const Gait gait(*model);
    spheres.push_back({gait.sphere_centre_m().z(), gait.sphere_radius_m()});
    float reach_m = 0.01F;
    for (const float reach : model->kinematics.reach_m()) reach_m = std::max(reach_m, reach);
    part_step_m.push_back(1.01F * reach_m * max_scale[m] / static_cast<float>(kMaxInt16));
  }
}

namespace {

json describe_floor(const run_description_t& run) {
  json floor = json::array();
  for (const polygon_t& polygon : run.floor) {
    json& rings = floor.emplace_back(json::array());
    const double* next = polygon.coordinates_m.data();
    for (const int32_t corners : polygon.corners_of_ring) {
      json& ring = rings.emplace_back(json::array());
      for (int32_t i = 0; i < corners; ++i, next += 2) ring.push_back({next[0], next[1]});
    }
  }
  return floor;
}

}  // namespace

Bytes run_message(RunReader& run, const RunGeometry& geometry, ViewMode mode) {
  const run_description_t& description = *run.run();
  const int k = directions_of(description.part_volume);
  MeshSection section;
  json text = {{"mode", name_of(mode)},
               {"scene", description.scene},
               {"seed", description.seed},
               {"run_id", fmt::format("{:016x}", static_cast<uint64_t>(run.run_id()))},
               {"step_s", description.step_s},
               {"part_volume", description.part_volume},
               {"hull_directions", k},
               {"exact", description.exact != 0},
               {"ground",
                {{"min_m", description.ground_min_m},
                 {"max_m", description.ground_max_m},
                 {"floor", describe_floor(description)}}},
               {"avatars", description.avatar_count}};
  text["models"] = json::array();
  for (size_t m = 0; m < description.models.size(); ++m)
    text["models"].push_back(describe_model(description.models[m], run.model(m)->is_person,
                                            geometry.spheres[m], geometry.part_step_m[m], k,
                                            section));
  text["obstacles"] = describe_obstacles(description, section);
  Bytes tail = section.bytes();
  align(tail, 4);
  text["scale_of_avatar"] = tail.size();
  put_all(tail, std::span<const float>(description.scale_of_avatar));
  text["groups"] = description.groups;
  text["group_of_avatar"] = tail.size();
  put_all(tail, std::span<const int16_t>(description.group_of_avatar));
  align(tail, 4);
  text["model_of_avatar"] = tail.size();
  put_all(tail, std::span<const int16_t>(description.model_of_avatar));

  std::string head = text.dump(-1, ' ', false, json::error_handler_t::replace);
  head.resize((head.size() + 3) / 4 * 4, ' ');
  Bytes out;
  put(out, kRunMessage);
  put(out, static_cast<uint32_t>(head.size()));
  out.insert(out.end(), head.begin(), head.end());
  out.insert(out.end(), tail.begin(), tail.end());
  return out;
}

}  // namespace throng
