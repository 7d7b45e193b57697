// The adult walking: postures by the public function, poses by forward kinematics.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "avatars/avatars.h"

namespace throng::test {

class Walking {
 public:
  explicit Walking(GaitStyle style_in = GaitStyle::kPlain)
      : style(style_in), model(load_model(adult_urdf())), gait(*model, style) {
    for (const Part& part : model->parts) {
      if (part.name == "rightFoot") right_foot = static_cast<size_t>(&part - model->parts.data());
      if (part.name == "leftFoot") left_foot = static_cast<size_t>(&part - model->parts.data());
    }
  }

  static const Walking& adult() { return styles()[0]; }

  static std::span<const Walking> styles() {
    static const std::vector<Walking> all = [] {
      std::vector<Walking> walkings;
      for (size_t i = 0; i < kGaitStyleCount; ++i) walkings.emplace_back(static_cast<GaitStyle>(i));
      return walkings;
    }();
    return all;
  }

  std::string name() const { return std::string(parameters_of(style).name); }

  std::vector<float> posture(float phase, float speed_mps, float scale = 1) const {
    std::vector<float> row(static_cast<size_t>(gait.column_count()));
    gait.postures({&phase, 1}, {&speed_mps, 1}, {&scale, 1}, row);
    return row;
  }

  std::vector<PartPose> poses(std::span<const float> posture) const {
    std::vector<PartPose> poses(model->parts.size());
    const RootFrame root;
    forward_kinematics(model->kinematics, posture, {&root, 1}, poses);
    return poses;
  }

  size_t column(const std::string& joint) const {
    return static_cast<size_t>(model->kinematics.column_of(joint));
  }

  /// Returns a part's lowest vertex and its index.
  std::pair<Eigen::Vector3d, size_t> lowest(size_t part, const PartPose& pose) const {
    const Eigen::Isometry3d root_from_part = to_isometry(pose);
    std::pair<Eigen::Vector3d, size_t> found{{0, 0, std::numeric_limits<double>::infinity()}, 0};
    const std::vector<Eigen::Vector3f>& vertices = model->parts[part].mesh.vertices;
    for (size_t v = 0; v < vertices.size(); ++v) {
      const Eigen::Vector3d p = root_from_part * vertices[v].cast<double>();
      if (p.z() < found.first.z()) found = {p, v};
    }
    return found;
  }

  GaitStyle style;
  std::shared_ptr<const Model> model;
  Gait gait;
  size_t right_foot = 0, left_foot = 0;
};

}  // namespace throng::test
