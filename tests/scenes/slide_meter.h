// SlideMeter measures how far planted feet slide, by the lowest vertex of the posed foot.
// It uses postures only; the gait phase defines which foot is planted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "avatars/gait/gait_curves.h"
#include "scenes/run/posing.h"
#include "scenes/run/simulation.h"

namespace throng {

/// Slide distance of each stance.
struct Slides {
  std::vector<double> all_m;

  void add(const Slides& others) {
    all_m.insert(all_m.end(), others.all_m.begin(), others.all_m.end());
  }
  /// Fraction of stances with a smaller slide.
  double quantile_m(double share) const {
    std::vector<double> sorted = all_m;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
};

/// Measures the planted feet of all people, frame by frame.
class SlideMeter {
 public:
  explicit SlideMeter(const Simulation& simulation) : simulation_(simulation) {
    const Model& model = *simulation.info().models.front();
    for (const Part& part : model.parts)
      for (size_t side = 0; side < 2; ++side)
        if (part.name == (side == 0 ? "rightFoot" : "leftFoot"))
          parts_[side] = static_cast<size_t>(&part - model.parts.data());
    feet_.resize(simulation.info().model_of_avatar.size());
    // A stride is kStridePerSqrtSpeed times the root of speed times leg length.
    const float root = Gait(model).stride_length_m(1, 1) / static_cast<float>(kStridePerSqrtSpeed);
    leg_m_ = root * root;
  }

  void watch(const Frame& frame) {
    const Model& model = *simulation_.info().models.front();
    const BodyStates& bodies = simulation_.bodies();
    std::vector<PartPose> poses(model.parts.size());
    for (size_t id = 0; id < feet_.size(); ++id) {
      if (!frame.present.empty() && frame.present[id] == 0) {
        feet_[id] = {};
        continue;
      }
      const size_t begin = frame.posture_offsets[id], end = frame.posture_offsets[id + 1];
      const RootFrame root{frame.roots[id].world_from_root, bodies.scales[id]};
      forward_kinematics(model.kinematics, frame.postures.subspan(begin, end - begin), {&root, 1},
                         poses);
      const float leg_m = leg_m_ * bodies.scales[id];
      const double stance =
          stance_fraction(static_cast<double>(std::max(0.0f, bodies.gait_mps[id]) / leg_m));
      for (size_t side = 0; side < 2; ++side) {
        const float phase = bodies.phases[id];
        const float own = side == 0 ? phase : phase + (phase < 0.5f ? 0.5f : -0.5f);
        watch(model.parts[parts_[side]].mesh, poses[parts_[side]], frame.roots[id].position_m,
              static_cast<double>(bodies.scales[id]), static_cast<double>(own) < stance,
              feet_[id][side]);
      }
    }
  }

  Slides slides;  ///< one per completed stance

 private:
  struct Foot {
    bool was_planted = false;
    double slid_m = 0;
    size_t contact = 0;
    Eigen::Vector3d was_m = Eigen::Vector3d::Zero();
  };

  void watch(const Mesh& mesh, const PartPose& pose, const Eigen::Vector3d& position, double scale,
             bool is_planted, Foot& foot) {
    if (!is_planted) {
      if (foot.was_planted) slides.all_m.push_back(foot.slid_m);
      foot = {};
      return;
    }
    const Eigen::Isometry3d turned = to_isometry(pose);
    const auto place = [&](size_t v) -> Eigen::Vector3d {
      return position + turned.linear() * (scale * mesh.vertices[v].cast<double>()) +
             turned.translation();
    };
    if (foot.was_planted) foot.slid_m += (place(foot.contact) - foot.was_m).head<2>().norm();
    foot.was_planted = true;
    double low = 1e9;
    for (size_t v = 0; v < mesh.vertices.size(); ++v)
      if (const Eigen::Vector3d p = place(v); p.z() < low)
        low = p.z(), foot.contact = v, foot.was_m = p;
  }

  const Simulation& simulation_;
  std::array<size_t, 2> parts_{};
  std::vector<std::array<Foot, 2>> feet_;
  float leg_m_ = 1;
};

}  // namespace throng
