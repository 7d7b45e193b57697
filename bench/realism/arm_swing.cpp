#include "bench/realism/arm_swing.h"

#include <algorithm>
#include <numbers>

namespace throng::realism {

double SwingAt::mean_deg() const { return swing_rad_s / time_s * 180 / std::numbers::pi; }

ArmSwing::ArmSwing(const Simulation& simulation) : simulation_(simulation) {}

void ArmSwing::Range::add(float value) {
  least = std::min(least, value);
  most = std::max(most, value);
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

/// The level of density is that at the end of the cycle.
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
  SwingAt& at = levels_[level];
  at.time_s += time_s;
  for (size_t side = 0; side < 2; ++side) {
    at.swing_rad_s += 0.5 * time_s * cycle.swing[side].width();
    at.own_rad_s += 0.5 * time_s * cycle.own[side].width();
  }
}

void ArmSwing::frame(const RunInfo& run, const Frame& frame) {
  const BodyStates& bodies = simulation_.bodies();
  is_placed_ = false;
  for (size_t id = 0; id < cycles_.size(); ++id) {
    const Kind& kind = kinds_[run.model_of_avatar[id]];
    const bool is_held = !bodies.held_rows.empty() && bodies.held_rows[id] != nullptr;
    if (kind.shoulders[0] < 0 || is_held) continue;
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
        cycle.own[side].begin(row_[column]);
      }
      cycle.swing[side].add(now[column]);
      cycle.own[side].add(row_[column]);
    }
    ++cycle.frames;
    cycle.last_phase = phase;
  }
}

}  // namespace throng::realism
