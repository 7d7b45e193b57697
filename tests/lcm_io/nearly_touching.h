// Compares frames of a run with those of its log culled again: differing pairs, and the distance of
// their parts.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "lcm_io/codec/description.h"
#include "lcm_io/codec/quantise.h"
#include "tests/lcm_io/culled_again.h"
#include "tests/lcm_io/mesh_distance.h"

namespace throng {

/// Tolerance for float poses and the rounding of the description.
inline constexpr double kFloat_m = 2e-5;

/// Displacement of a vertex of this part by half a quantisation step of each joint between it and
/// the root, at the longest possible lever.
inline double joints_m(const Model& model, const Part& part) {
  const std::vector<ColumnRange> ranges = column_ranges(model);
  double moved_m = 0, lever_m = 0;
  for (const Eigen::Vector3f& vertex : part.mesh.vertices)
    lever_m = std::max(lever_m, vertex.cast<double>().norm());
  for (int link = part.link; link > 0;) {
    const Joint& joint = model.robot.joints[static_cast<size_t>(link - 1)];
    double multiplier = 1;
    const Joint* leader = &joint;
    for (; leader->mimic; leader = &model.robot.joints[static_cast<size_t>(leader->mimic->joint)])
      multiplier *= std::abs(leader->mimic->multiplier);
    if (joint.kind != Joint::Kind::kFixed) {
      const auto column = static_cast<size_t>(model.kinematics.column_of(leader->name));
      const double half_step = multiplier * ranges[column].half / (2 * kUnitSteps);
      const bool slides = joint.kind == Joint::Kind::kPrismatic;
      moved_m += slides ? half_step : half_step * lever_m;
      if (slides) lever_m += std::max(std::abs(joint.lower), std::abs(joint.upper));
    }
    lever_m += joint.parent_from_joint.translation().norm();
    link = joint.parent_link;
  }
  return moved_m;
}

/// Maximum displacement of the parts of a body by quantised states. An upright body on the ground
/// deviates along two axes and turns about the third, at most `lever_m` away; others turn about
/// their root.
inline double quantisation_m(const Model& model, double scale, bool is_upright, double lever_m) {
  double moved_m = 0;
  for (const Part& part : model.parts) moved_m = std::max(moved_m, joints_m(model, part));
  const double axes = is_upright ? 2 : 3, components = is_upright ? 2 : 4;
  // An error of a unit quaternion turns by twice its length.
  const double turned_rad = 2 * std::sqrt(components) * 0.5 / kUnitSteps;
  return std::sqrt(axes) * 0.5 * kPositionStep_m + scale * moved_m + turned_rad * lever_m +
         kFloat_m;
}

/// Poses of the parts of bodies; obstacles follow the avatars.
class Placed {
 public:
  explicit Placed(const Simulation& run) : info_(run.info()), scene_(run.scene()) {}

  const Mesh& mesh(uint32_t body, uint32_t part) const {
    return is_avatar(body) ? model(body).parts[part].mesh : obstacle(body).mesh;
  }
  double scale(uint32_t body) const { return static_cast<double>(info_.scale_of_avatar[body]); }
  const Model& model(uint32_t body) const { return *info_.models[info_.model_of_avatar[body]]; }

  double error_m(const CulledFrame& moment, uint32_t body) const {
    if (!is_avatar(body)) return 0;
    const RootPose& root = moment.roots[body];
    const Eigen::Quaternionf& q = root.world_from_root;
    const bool is_upright = root.position_m.z() == 0 && q.x() == 0 && q.y() == 0;
    double lever_m = 0;
    for (uint32_t part = 0; part < model(body).parts.size(); ++part) {
      const Eigen::Affine3d pose = this->pose(moment, body, part);
      for (const Eigen::Vector3f& vertex : mesh(body, part).vertices) {
        const Eigen::Vector3d off = pose * vertex.cast<double>() - root.position_m;
        lever_m = std::max(lever_m, is_upright ? off.head<2>().norm() : off.norm());
      }
    }
    return quantisation_m(model(body), scale(body), is_upright, lever_m);
  }
  Eigen::Affine3d pose(const CulledFrame& moment, uint32_t body, uint32_t part) const {
    if (!is_avatar(body)) {
      const Obstacle& there = obstacle(body);
      return Eigen::Translation3d(there.centre_m) *
             Eigen::AngleAxisd(there.heading_rad, Eigen::Vector3d::UnitZ());
    }
    size_t first = 0;
    for (uint32_t id = 0; id < body; ++id) first += columns(id);
    const RootFrame frame{moment.roots[body].world_from_root, info_.scale_of_avatar[body]};
    std::vector<PartPose> poses(model(body).parts.size());
    forward_kinematics(model(body).kinematics,
                       std::span(moment.postures).subspan(first, columns(body)), {&frame, 1},
                       poses);
    return Eigen::Translation3d(moment.roots[body].position_m) * to_isometry(poses[part]) *
           Eigen::Scaling(scale(body));
  }

 private:
  bool is_avatar(uint32_t body) const { return body < info_.model_of_avatar.size(); }
  size_t columns(uint32_t body) const {
    return static_cast<size_t>(model(body).kinematics.column_count());
  }
  const Obstacle& obstacle(uint32_t body) const {
    return scene_.obstacles[body - info_.model_of_avatar.size()];
  }
  const RunInfo& info_;
  const Scene& scene_;
};

/// Expects that pairs in only one of the two frames nearly touch in the other; returns their
/// number.
inline int expect_near(const Placed& placed, const CulledFrame& run, const CulledFrame& again) {
  std::vector<PairKey> only;
  std::set_symmetric_difference(run.pairs.begin(), run.pairs.end(), again.pairs.begin(),
                                again.pairs.end(), std::back_inserter(only));
  for (const PairKey& pair : only) {
    const bool was = std::binary_search(run.pairs.begin(), run.pairs.end(), pair);
    const CulledFrame& apart = was ? again : run;
    const double bound_m = placed.error_m(run, pair.a()) + placed.error_m(run, pair.b());
    const double gap_m = meshes_m(
        placed.mesh(pair.a(), pair.part_a()), placed.pose(apart, pair.a(), pair.part_a()),
        placed.mesh(pair.b(), pair.part_b()), placed.pose(apart, pair.b(), pair.part_b()), 0.01);
    EXPECT_LE(gap_m, bound_m) << pair.a() << ":" << pair.part_a() << " - " << pair.b() << ":"
                              << pair.part_b() << (was ? " only when run" : " only again");
    EXPECT_LE(gap_m, 5e-4);
  }
  return static_cast<int>(only.size());
}

inline std::set<size_t> absent(const CulledFrame& moment) {
  std::set<size_t> out;
  for (size_t i = 0; i < moment.present.size(); ++i)
    if (moment.present[i] == 0) out.insert(i);
  return out;
}

}  // namespace throng
