#include "analysis/measures/recent_crowd.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace throng {

Heads::Heads(const RunInfo& run) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    Kind& kind = kinds_.emplace_back();
    for (const Part& part : model->parts) {
      if (part.name != "head") continue;
      kind.kinematics.emplace(model->robot, std::span(&part.link, 1));
      Eigen::AlignedBox3f box;
      for (const Eigen::Vector3f& vertex : part.mesh.vertices) box.extend(vertex);
      kind.centre_m = box.center();
    }
  }
  for (size_t id = 0; id < run.model_of_avatar.size(); ++id)
    kinds_[run.model_of_avatar[id]].avatars.push_back(static_cast<uint32_t>(id));
}

void Heads::find(const RunInfo& run, const Frame& frame, std::span<Eigen::Vector2d> out) {
  for (const Kind& kind : kinds_) {
    if (!kind.kinematics) {
      for (const uint32_t id : kind.avatars) out[id] = frame.roots[id].position_m.head<2>();
      continue;
    }
    rows_.clear();
    roots_.clear();
    poses_.resize(kind.avatars.size());
    for (const uint32_t id : kind.avatars) {
      rows_.push_back(frame.postures.data() + frame.posture_offsets[id]);
      roots_.push_back({frame.roots[id].world_from_root, run.scale_of_avatar[id]});
    }
    forward_kinematics(*kind.kinematics, rows_, roots_, poses_);
    for (size_t i = 0; i < kind.avatars.size(); ++i) {
      const uint32_t id = kind.avatars[i];
      const double scale = static_cast<double>(run.scale_of_avatar[id]);
      out[id] = (frame.roots[id].position_m +
                 to_isometry(poses_[i]) * (scale * kind.centre_m.cast<double>()))
                    .head<2>();
    }
  }
}

RecentCrowd::RecentCrowd(size_t people, size_t length) : moments_(length) {
  for (Moment& moment : moments_) {
    moment.heads_m.resize(people, Eigen::Vector2d::Zero());
    moment.roots_m.resize(people, Eigen::Vector2d::Zero());
    moment.present.resize(people, 0);
    moment.stay.resize(people, 0);
  }
}

void RecentCrowd::pushed() {
  const Moment& before = moments_[newest_];
  Moment& now = next();
  for (size_t i = 0; i < now.present.size(); ++i) {
    const bool same = before.present[i] != 0 &&
                      (now.heads_m[i] - before.heads_m[i]).squaredNorm() < kJump_m * kJump_m;
    const size_t stay = now.present[i] == 0 ? 0 : same ? before.stay[i] + 1u : 1u;
    now.stay[i] = static_cast<uint16_t>(std::min(stay, moments_.size()));
  }
  newest_ = newest_ + 1 == moments_.size() ? 0 : newest_ + 1;
}

}  // namespace throng
