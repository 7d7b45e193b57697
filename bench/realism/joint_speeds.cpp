#include "bench/realism/joint_speeds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/elementary.h"

namespace throng::realism {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

std::string without_side(const std::string& joint) {
  for (const char* side : {"left_", "right_"})
    if (joint.starts_with(side)) return joint.substr(std::string(side).size());
  return joint;
}

double turn_deg(const Eigen::Quaternionf& before, const Eigen::Quaternionf& after) {
  const auto yaw = [](const Eigen::Quaternionf& q) {
    return 2 * std::atan2(static_cast<double>(q.z()), static_cast<double>(q.w()));
  };
  return std::remainder(yaw(after) - yaw(before), 2 * std::numbers::pi) / kDegree;
}

}  // namespace

JointMotion::JointMotion(bool is_prismatic_in)
    : is_prismatic(is_prismatic_in),
      speeds(0, is_prismatic ? 0.001 : 1, 5000),
      accelerations(0, is_prismatic ? 0.02 : 50, 8000) {}

JointSpeeds::JointSpeeds() : standing_turns_(0, 0.25, 8000), turns_(0, 0.25, 8000) {}

void JointSpeeds::begin(const RunInfo& run) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<Column>& columns = columns_.emplace_back();
    if (!model->is_person) continue;
    for (const JointColumn& column : model->kinematics.columns()) {
      const std::string name = without_side(column.name);
      const JointLimit* const found = limit_of(name);
      const JointLimit limit = found ? *found : JointLimit{"", BodyHalf::kUpper, kNone, kNone};
      JointMotion& motion = joints_.try_emplace(name, column.prismatic).first->second;
      columns.push_back({&motion, column.prismatic ? 1 : 1 / kDegree, index(limit.half),
                         limit.speed_per_s, limit.acceleration_per_s2});
    }
  }
  known_.assign(run.model_of_avatar.size(), 0);
}

void JointSpeeds::take(const RunInfo& run, const Frame& frame, size_t id) {
  const std::vector<Column>& columns = columns_[run.model_of_avatar[id]];
  const size_t first = frame.posture_offsets[id];
  std::array<bool, kBodyHalves> is_fast{}, is_hard{};
  for (size_t i = 0; i < columns.size(); ++i) {
    const Column& column = columns[i];
    const double now = static_cast<double>(frame.postures[first + i]);
    const double before = static_cast<double>(before_[first + i]);
    const double speed = column.unit * std::abs(now - before) / run.step_s;
    column.motion->speeds.add(speed);
    column.motion->over_speed += speed > column.most_speed;
    is_fast[column.half] |= speed > column.most_speed;
    if (known_[id] < 2) continue;
    const double earlier = static_cast<double>(earlier_[first + i]);
    const double acceleration =
        column.unit * std::abs(now - 2 * before + earlier) / (run.step_s * run.step_s);
    column.motion->accelerations.add(acceleration);
    column.motion->over_acceleration += acceleration > column.most_acceleration;
    is_hard[column.half] |= acceleration > column.most_acceleration;
  }
  ++frames_;
  for (size_t half = 0; half < kBodyHalves; ++half) {
    over_speed_[half] += is_fast[half];
    over_acceleration_[half] += is_hard[half];
  }
  const double turn_degps =
      std::abs(turn_deg(roots_before_[id].world_from_root, frame.roots[id].world_from_root)) /
      run.step_s;
  turns_.add(turn_degps);
  if (static_cast<double>(frame.speeds_mps[id]) < kStanding_mps) standing_turns_.add(turn_degps);
}

void JointSpeeds::frame(const RunInfo& run, const Frame& frame) {
  for (size_t id = 0; id < known_.size(); ++id) {
    if (columns_[run.model_of_avatar[id]].empty()) continue;
    if (!frame.present.empty() && frame.present[id] == 0) {
      known_[id] = 0;
      continue;
    }
    if (known_[id] > 0 &&
        (frame.roots[id].position_m - roots_before_[id].position_m).norm() > kJump_mps * run.step_s)
      known_[id] = 0;
    if (known_[id] > 0) take(run, frame, id);
    known_[id] = static_cast<uint8_t>(std::min(known_[id] + 1, 2));
  }
  std::swap(earlier_, before_);
  before_.assign(frame.postures.begin(), frame.postures.end());
  roots_before_.assign(frame.roots.begin(), frame.roots.end());
}

}  // namespace throng::realism
