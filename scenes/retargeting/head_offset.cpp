#include "scenes/retargeting/head_offset.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "base/portable_math.h"

namespace throng {
namespace {

int head_of(const Model& model) {
  for (size_t i = 0; i < model.parts.size(); ++i)
    if (model.parts[i].name == "head") return static_cast<int>(i);
  return -1;
}

Eigen::Vector3f middle_of(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  return box.center();
}

/// Lower cell index of a table position, and the weight of the next node.
std::pair<int, float> cell_of(float at, int last) {
  const float inside = std::clamp(at, 0.0f, static_cast<float>(last));
  const int index = std::min(static_cast<int>(inside), last - 1);
  return {index, inside - static_cast<float>(index)};
}

/// Phase of the maximum of the fundamental wave of a cycle, in turns.
double leftmost_of(std::span<const Eigen::Vector2f> cycle) {
  double along = 0, across = 0;
  for (size_t i = 0; i < cycle.size(); ++i) {
    const SinCos wave =
        sin_cos(2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(cycle.size()));
    along += static_cast<double>(cycle[i].y()) * wave.cos;
    across += static_cast<double>(cycle[i].y()) * wave.sin;
  }
  return arc_tan2(across, along) / (2 * std::numbers::pi);
}

}  // namespace

HeadOffset::HeadOffset(const Model& model, const Gait& gait) {
  const int head = head_of(model);
  if (head < 0) return;
  const Eigen::Vector3f middle = middle_of(model.parts[static_cast<size_t>(head)].mesh);
  std::vector<float> row(static_cast<size_t>(gait.column_count()));
  std::vector<PartPose> poses(static_cast<size_t>(model.part_count()));
  for (int speed = 0; speed < kSpeeds; ++speed) {
    for (int node = 0; node <= kPhases; ++node) {
      const float phase = static_cast<float>(node % kPhases) / kPhases;
      const float speed_mps = static_cast<float>(speed) * kSpeedCell_mps, scale = 1;
      gait.postures({&phase, 1}, {&speed_mps, 1}, {&scale, 1}, row);
      const RootFrame root;
      forward_kinematics(model.kinematics, row, {&root, 1}, poses);
      const PartPose& pose = poses[static_cast<size_t>(head)];
      Eigen::Vector2f place;
      for (int axis = 0; axis < 2; ++axis) {
        const float* r = pose.rows[axis];
        place[axis] = r[0] * middle.x() + r[1] * middle.y() + r[2] * middle.z() + r[3];
      }
      nodes_m_.push_back(place);
    }
    const std::span<const Eigen::Vector2f> cycle(nodes_m_.end() - (kPhases + 1), kPhases);
    const auto phase = static_cast<float>(leftmost_of(cycle));
    const float last = leftmost_.empty() ? phase : leftmost_.back();
    leftmost_.push_back(last + std::remainder(phase - last, 1.0f));
  }
  leftmost_.front() = leftmost_[1];  // standing people do not sway
}

Eigen::Vector2f HeadOffset::offset_m(float phase, float speed_mps, float scale) const {
  if (nodes_m_.empty()) return Eigen::Vector2f::Zero();
  const auto [s, v] = cell_of(speed_mps / (scale * kSpeedCell_mps), kSpeeds - 1);
  const auto [p, u] = cell_of(phase * kPhases, kPhases);
  const int node = s * (kPhases + 1) + p;
  const Eigen::Vector2f* low = &nodes_m_[static_cast<size_t>(node)];
  const Eigen::Vector2f* high = low + kPhases + 1;
  return scale *
         ((1 - v) * ((1 - u) * low[0] + u * low[1]) + v * ((1 - u) * high[0] + u * high[1]));
}

float HeadOffset::leftmost_phase(float speed_mps, float scale) const {
  if (leftmost_.empty()) return 0;
  const auto [s, v] = cell_of(speed_mps / (scale * kSpeedCell_mps), kSpeeds - 1);
  return phase_of(
      std::lerp(leftmost_[static_cast<size_t>(s)], leftmost_[static_cast<size_t>(s) + 1], v));
}

}  // namespace throng
