#include "bench/realism/joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/portable_math.h"

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
  history_frames_.assign(run.model_of_avatar.size(), 0);
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
    column.motion->over_speed += speed > column.max_speed;
    is_fast[column.half] |= speed > column.max_speed;
    if (history_frames_[id] < 2) continue;
    const double earlier = static_cast<double>(earlier_[first + i]);
    const double acceleration =
        column.unit * std::abs(now - 2 * before + earlier) / (run.step_s * run.step_s);
    column.motion->accelerations.add(acceleration);
    column.motion->over_acceleration += acceleration > column.max_acceleration;
    is_hard[column.half] |= acceleration > column.max_acceleration;
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
  for (size_t id = 0; id < history_frames_.size(); ++id) {
    if (columns_[run.model_of_avatar[id]].empty()) continue;
    if (!frame.present.empty() && frame.present[id] == 0) {
      history_frames_[id] = 0;
      continue;
    }
    if (history_frames_[id] > 0 &&
        (frame.roots[id].position_m - roots_before_[id].position_m).norm() > kJump_mps * run.step_s)
      history_frames_[id] = 0;
    if (history_frames_[id] > 0) take(run, frame, id);
    history_frames_[id] = static_cast<uint8_t>(std::min(history_frames_[id] + 1, 2));
  }
  std::swap(earlier_, before_);
  before_.assign(frame.postures.begin(), frame.postures.end());
  roots_before_.assign(frame.roots.begin(), frame.roots.end());
}

// Limits of the upper body: deliberate motion without haste. They lie a little above those of
// walking at 1.9 m/s (shoulder 218 degrees/s, elbow 374, thorax 148 in the tables of all styles).
// The head's limit is that of a large gaze shift (Guitton and Volle 1987).
//
// Limits of the legs: the maxima of plain walking at 0.5 to 1.9 m/s in any style, rounded up
// (`realism joints` without FILE).
// The measured cycle of the adult (OpenSim, 1.45 m/s; interpolated by its harmonics) has 212, 366
// and 286 degrees/s at hip, knee and ankle, at the cadence of 1.9 m/s 243, 419 and 327.
// Joint speeds grow with walking speed (Mentiplay et al. 2018).
// The tables reach 441, 798 and 624 in all styles, where legs reach for a planted foot.
// Accelerations of the smooth cycle are 3000, 7000 and 8700 degrees/s2. Between two frames of
// 1/60 s the tables have 4 to 9 times that, at heel strike and toe-off.
const std::vector<JointLimit>& joint_limits() {
  constexpr BodyHalf kLegs = BodyHalf::kLegs, kUpper = BodyHalf::kUpper;
  static const std::vector<JointLimit> limits = {
      {"pelvis_lateral", kLegs, 0.4, 6},         {"pelvis_forward", kLegs, 0.4, 6},
      {"pelvis_vertical", kLegs, 0.4, 8},        {"pelvis_yaw", kLegs, 120, 2000},
      {"pelvis_pitch", kLegs, 100, 2000},        {"pelvis_roll", kLegs, 100, 2000},
      {"hip_flexion", kLegs, 500, 26000},        {"hip_adduction", kLegs, 250, 10000},
      {"hip_rotation", kLegs, 300, 10000},       {"knee_flexion", kLegs, 800, 70000},
      {"ankle_flexion", kLegs, 650, 40000},      {"thorax_yaw", kUpper, 200, 2000},
      {"head_yaw", kUpper, 300, 5000},           {"shoulder_flexion", kUpper, 400, 4000},
      {"shoulder_abduction", kUpper, 300, 4000}, {"elbow_flexion", kUpper, 500, 6000},
      {"wrist_flexion", kUpper, 500, 6000},
  };
  return limits;
}

const JointLimit* limit_of(const std::string& joint) {
  for (const JointLimit& limit : joint_limits())
    if (joint == limit.joint) return &limit;
  return nullptr;
}

double SwingSums::mean_deg() const { return swing_rad_s / time_s * 180 / std::numbers::pi; }

ArmSwing::ArmSwing(const Simulation& simulation) : simulation_(simulation) {}

void ArmSwing::Range::add(float value) {
  min = std::min(min, value);
  max = std::max(max, value);
}

void ArmSwing::begin(const RunInfo& run) {
  const BodyStates& bodies = simulation_.bodies();
  for (const std::shared_ptr<const Model>& model : run.models) {
    Kind& kind = kinds_.emplace_back();
    kind.columns = static_cast<size_t>(model->kinematics.column_count());
    kind.gaits.resize(kGaitStyleCount);
    if (!model->is_person) continue;
    kind.shoulders = {model->kinematics.column_of("right_shoulder_flexion"),
                      model->kinematics.column_of("left_shoulder_flexion")};
  }
  cycles_.resize(run.model_of_avatar.size());
  positions_m_.resize(cycles_.size());
  for (size_t id = 0; id < cycles_.size(); ++id) {
    const size_t model = run.model_of_avatar[id];
    const size_t style = bodies.styles.empty() ? 0 : static_cast<size_t>(bodies.styles[id]);
    std::unique_ptr<Gait>& gait = kinds_[model].gaits[style];
    if (gait == nullptr && kinds_[model].shoulders[0] >= 0)
      gait = std::make_unique<Gait>(*run.models[model], static_cast<GaitStyle>(style));
  }
  density_ = std::make_unique<LocalDensity>(*run.scene);
}

/// Adds a finished cycle at the density level of its end.
void ArmSwing::finish(const RunInfo& run, const Frame& frame, size_t id) {
  if (!is_placed_) {
    for (size_t i = 0; i < positions_m_.size(); ++i)
      positions_m_[i] = frame.roots[i].position_m.head<2>();
    density_->place(positions_m_, frame.present);
    is_placed_ = true;
  }
  const double density_per_m2 = density_->around(positions_m_[id]);
  const auto level = static_cast<size_t>(
      std::upper_bound(kBounds_per_m2.begin(), kBounds_per_m2.end(), density_per_m2) -
      kBounds_per_m2.begin());
  const Cycle& cycle = cycles_[id];
  const double time_s = cycle.frames * run.step_s;
  SwingSums& at = levels_[level];
  at.time_s += time_s;
  for (size_t side = 0; side < 2; ++side) {
    at.swing_rad_s += 0.5 * time_s * cycle.swing[side].width();
    at.reference_rad_s += 0.5 * time_s * cycle.reference[side].width();
  }
}

void ArmSwing::frame(const RunInfo& run, const Frame& frame) {
  const BodyStates& bodies = simulation_.bodies();
  is_placed_ = false;
  for (size_t id = 0; id < cycles_.size(); ++id) {
    const Kind& kind = kinds_[run.model_of_avatar[id]];
    const bool is_external = !bodies.external_rows.empty() && bodies.external_rows[id] != nullptr;
    if (kind.shoulders[0] < 0 || is_external) continue;
    Cycle& cycle = cycles_[id];
    const float phase = bodies.phases[id], speed_mps = bodies.gait_mps[id];
    const bool is_there = frame.present.empty() || frame.present[id] != 0;
    if (!is_there || speed_mps < kWalking_mps) {
      cycle = {};
      continue;
    }
    row_.resize(kind.columns);
    const size_t style = bodies.styles.empty() ? 0 : static_cast<size_t>(bodies.styles[id]);
    kind.gaits[style]->postures({&phase, 1}, {&speed_mps, 1}, {&bodies.scales[id], 1}, row_);
    const bool wraps = cycle.last_phase >= 0 && phase < cycle.last_phase - 0.5f;
    if (wraps && cycle.is_whole) finish(run, frame, id);
    if (wraps) {
      cycle.is_whole = true;
      cycle.frames = 0;
    }
    const float* const now = frame.postures.data() + frame.posture_offsets[id];
    for (size_t side = 0; side < 2; ++side) {
      const auto column = static_cast<size_t>(kind.shoulders[side]);
      if (cycle.frames == 0) {
        cycle.swing[side].begin(now[column]);
        cycle.reference[side].begin(row_[column]);
      }
      cycle.swing[side].add(now[column]);
      cycle.reference[side].add(row_[column]);
    }
    ++cycle.frames;
    cycle.last_phase = phase;
  }
}

namespace {

std::string quantiles(const Histogram& histogram, int digits) {
  std::string text;
  for (const double share : {0.5, 0.95, 0.999, 1.0})
    text += histogram.count() == 0 ? fmt::format("{:>9}", "-")
                                   : fmt::format("{:>9.{}f}", histogram.quantile(share), digits);
  return text;
}

std::string over(uint64_t count, uint64_t all) {
  return all == 0
             ? fmt::format("{:>9}", "-")
             : fmt::format("{:>9.4f}", 100 * static_cast<double>(count) / static_cast<double>(all));
}

std::string joint_lines(const JointSpeeds& speeds, bool accelerations) {
  std::string text = fmt::format("  {:<21}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
                                 accelerations ? "accelerations, /s2" : "speeds, /s", "50 %",
                                 "95 %", "99.9 %", "max", "limit", "% over");
  for (const auto& [name, motion] : speeds.joints()) {
    const Histogram& all = accelerations ? motion.accelerations : motion.speeds;
    const JointLimit* const limit = limit_of(name);
    text += fmt::format(
        "  {:<21}{}{}{}\n", name + (motion.is_prismatic ? ", m" : ""),
        quantiles(all, motion.is_prismatic ? (accelerations ? 2 : 3) : 0),
        limit == nullptr ? fmt::format("{:>9}", "-")
                         : fmt::format("{:>9g}", accelerations ? limit->acceleration_per_s2
                                                               : limit->speed_per_s),
        over(accelerations ? motion.over_acceleration : motion.over_speed, all.count()));
  }
  return text;
}

std::string swing_lines(const ArmSwing& swing) {
  std::string text = fmt::format("  {:<21}{:>9}{:>9}{:>9}\n", "arm swing, per m2", "person s",
                                 "mean deg", "% of own");
  const auto& bounds = ArmSwing::kBounds_per_m2;
  for (size_t i = 0; i < ArmSwing::kLevels; ++i) {
    const SwingSums& at = swing.levels()[i];
    if (!(at.time_s > 0)) continue;
    text += fmt::format("  {:<21}{:>9.0f}{:>9.1f}{:>9.2f}\n",
                        range_text(i == 0 ? 0 : bounds[i - 1],
                                   i < bounds.size() ? std::optional(bounds[i]) : std::nullopt),
                        at.time_s, at.mean_deg(), 100 * at.share());
  }
  return text;
}

}  // namespace

std::string joint_report(const std::string& name, const JointSpeeds& speeds,
                         const ArmSwing& swing) {
  std::string text = fmt::format("{}: {} frames of people; in degrees, or metres where stated\n",
                                 name, speeds.frames());
  text += joint_lines(speeds, false) + joint_lines(speeds, true);
  text += fmt::format("  {:<21}{:>9}{:>15}\n", "frames above, %", "speed", "acceleration");
  for (const auto& [what, half] :
       {std::pair("legs and pelvis", BodyHalf::kLegs), std::pair("upper body", BodyHalf::kUpper)})
    text += fmt::format("  {:<21}{}{:>15}\n", what,
                        over(speeds.frames_over_speed(half), speeds.frames()),
                        over(speeds.frames_over_acceleration(half), speeds.frames()));
  text += swing_lines(swing);
  text += fmt::format("  {:<21}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "turns of roots, deg/s", "frames",
                      "50 %", "95 %", "99 %", "max");
  for (const auto& [what, turns] :
       {std::pair("standing", &speeds.standing_turns()), std::pair("all", &speeds.turns())}) {
    text += fmt::format("  {:<21}{:>9}", what, turns->count());
    for (const double share : {0.5, 0.95, 0.99, 1.0})
      text += turns->count() == 0 ? fmt::format("{:>9}", "-")
                                  : fmt::format("{:>9.1f}", turns->quantile(share));
    text += "\n";
  }
  return text;
}

}  // namespace throng::realism
