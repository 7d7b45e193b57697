#include "crowd/overlap_relaxation.h"

#include <algorithm>
#include <cmath>

#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

constexpr uint8_t kMoved = 1;
constexpr uint8_t kOverlapping = 2;

}  // namespace

void OverlapRelaxation::relax(SteeringCounters& counters) {
  counters.max_overlap_m = state_.max_over_blocks([this](SteeringState::Slots slots, size_t block) {
    return find_overlap_candidates(slots, block);
  });
  counters.sweeps = 0;
  double deepest_m = tuning::kSlop_m;
  while (deepest_m >= tuning::kSlop_m && counters.sweeps < tuning::kSweeps) {
    deepest_m =
        state_.max_over_blocks([this](SteeringState::Slots, size_t block) { return sweep(block); });
    decisions_.expected_x_m.swap(decisions_.swept_x_m);
    decisions_.expected_y_m.swap(decisions_.swept_y_m);
    decisions_.touched.swap(decisions_.swept_touched);
    ++counters.sweeps;
  }
  counters.all_sweeps += static_cast<uint64_t>(counters.sweeps);
  counters.max_sweeps = std::max(counters.max_sweeps, counters.sweeps);
  state_.for_deciders([this](SteeringState::Slots slots, size_t, int) { set_drift(slots); });
}

/// Expected position of an agent after one period.
Eigen::Vector2f OverlapRelaxation::expected_m(size_t slot) const {
  if (decisions_.phase[slot] == state_.phase)
    return {decisions_.expected_x_m[slot], decisions_.expected_y_m[slot]};
  return {state_.agents.published[slot].ahead_x_m, state_.agents.published[slot].ahead_y_m};
}

/// Moves neighbours that may overlap at the end of the period to the front. Returns the deepest
/// overlap of current positions.
double OverlapRelaxation::find_overlap_candidates(SteeringState::Slots slots, size_t block) {
  float deepest_m = 0;
  const auto moved_m = static_cast<float>(2 * state_.period_s * tuning::kMaxSpeedFactor *
                                          state_.max_desired_speed_mps);
  uint32_t crowded = 0;
  const uint32_t first = static_cast<uint32_t>(slots.data() - state_.deciders().data());
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    state_.prefetch_neighbours(state_.later_decider(slots, i));
    uint32_t* near = decisions_.neighbours.data() + SteeringState::kMaxNeighbours * slot;
    const auto margin_m = static_cast<float>(tuning::kSweepMargin_m);
    const NeighbourState& own = state_.agents.published[slot];
    const float reach_m = own.radius_m + state_.max_radius_m + margin_m + moved_m;
    const Eigen::Vector2f expected = expected_m(slot);
    size_t close = 0;
    for (size_t k = 0; k < decisions_.neighbour_counts[slot]; ++k) {
      const uint32_t other = near[k];
      const float dx = state_.agents.published[other].x_m - own.x_m;
      const float dy = state_.agents.published[other].y_m - own.y_m;
      const float square = dx * dx + dy * dy;
      if (square > reach_m * reach_m) break;  // neighbours are sorted by distance
      const Eigen::Vector2f to = expected_m(other) - expected;
      const float radius_m = apart_m(slot, other);
      const float close_m = radius_m + margin_m;
      if (square < radius_m * radius_m)
        deepest_m = std::max(deepest_m, radius_m - std::sqrt(square));
      if (to.x() * to.x() + to.y() * to.y() < close_m * close_m) std::swap(near[close++], near[k]);
    }
    decisions_.close_counts[slot] = static_cast<uint8_t>(close);
    decisions_.swept_x_m[slot] = expected.x();
    decisions_.swept_y_m[slot] = expected.y();
    // The first sweep processes all of them.
    decisions_.touched[slot] = decisions_.swept_touched[slot] = close > 0 ? kMoved : 0;
    if (close > 0) decisions_.crowded[first + crowded++] = slot;
  }
  decisions_.crowded_counts[block] = crowded;
  return static_cast<double>(deepest_m);
}

double OverlapRelaxation::sweep(size_t block) {
  double deepest_m = 0;
  const uint32_t* crowded = decisions_.crowded.data() + block * kAgentsPerBlock;
  const uint32_t* end_of_crowded = crowded + decisions_.crowded_counts[block];
  for (; crowded != end_of_crowded; ++crowded) {
    if (is_settled(*crowded))
      decisions_.swept_touched[*crowded] = 0;
    else
      deepest_m = std::max(deepest_m, relax_disc(*crowded));
  }
  return deepest_m;
}

/// Without an overlap in the previous sweep, and without movement nearby since, a sweep changes
/// nothing. The buffer still holds its earlier result.
bool OverlapRelaxation::is_settled(size_t slot) const {
  if (decisions_.touched[slot] != 0) return false;
  const uint32_t* near = decisions_.neighbours.data() + SteeringState::kMaxNeighbours * slot;
  for (size_t k = 0; k < decisions_.close_counts[slot]; ++k)
    if (decisions_.phase[near[k]] == state_.phase && (decisions_.touched[near[k]] & kMoved) != 0)
      return false;
  return true;
}

double OverlapRelaxation::relax_disc(size_t slot) {
  const float x = decisions_.expected_x_m[slot], y = decisions_.expected_y_m[slot];
  float push_x = 0, push_y = 0, deepest_m = 0;
  for (size_t k = 0; k < decisions_.close_counts[slot]; ++k) {
    const uint32_t other = decisions_.neighbours[SteeringState::kMaxNeighbours * slot + k];
    const Eigen::Vector2f there = expected_m(other);
    const float dx = x - there.x(), dy = y - there.y();
    const float radius_m = apart_m(slot, other);
    const float square = dx * dx + dy * dy;
    if (square >= radius_m * radius_m) continue;
    const float distance_m = std::sqrt(square);
    const float depth_m = radius_m - distance_m;
    const float push_m = static_cast<float>(tuning::kSweepShare) * depth_m;
    if (distance_m > 0) {
      push_x += push_m * (dx / distance_m);
      push_y += push_m * (dy / distance_m);
    } else {
      push_x += slot < other ? -push_m : push_m;
    }
    deepest_m = std::max(deepest_m, depth_m);
  }
  float to_x = x + push_x, to_y = y + push_y;
  if (deepest_m > 0) limit_forward_push(slot, to_x, to_y);
  if (deepest_m > 0 && state_.agents[slot].clearance_m < 2 * state_.agents[slot].radius_m + 1) {
    const Eigen::Vector2d to = Eigen::Vector2f(to_x, to_y).cast<double>() + state_.grid.middle_m();
    const Eigen::Vector2f slid =
        (walkable_.slide(state_.agents[slot].position_m, to, tuning::kWallGap_m) -
         state_.grid.middle_m())
            .cast<float>();
    to_x = slid.x();
    to_y = slid.y();
  }
  decisions_.swept_x_m[slot] = to_x;
  decisions_.swept_y_m[slot] = to_y;
  const bool moved = to_x != x || to_y != y;
  decisions_.swept_touched[slot] =
      static_cast<uint8_t>((moved ? kMoved : 0) | (deepest_m > 0 ? kOverlapping : 0));
  return static_cast<double>(deepest_m);
}

/// Agents behind push no agent beyond its own step: being in the way does not speed an agent up.
/// Agents with a preferred speed of zero move to any side.
void OverlapRelaxation::limit_forward_push(size_t slot, float& to_x, float& to_y) const {
  const float ahead_x = state_.agents.published[slot].direction_x,
              ahead_y = state_.agents.published[slot].direction_y;
  if (ahead_x == 0 && ahead_y == 0) return;
  const float x = state_.grid.x()[slot], y = state_.grid.y()[slot];
  const float planned_x = decisions_.chosen_x_m[slot] - x,
              planned_y = decisions_.chosen_y_m[slot] - y;
  const float planned_m = std::max(0.0f, planned_x * ahead_x + planned_y * ahead_y);
  const float excess_m = (to_x - x) * ahead_x + (to_y - y) * ahead_y - planned_m;
  if (excess_m <= 0) return;
  to_x -= excess_m * ahead_x;
  to_y -= excess_m * ahead_y;
}

/// The correction is spread over the period to avoid jumps.
void OverlapRelaxation::set_drift(SteeringState::Slots slots) {
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    state_.agents.prefetch(state_.later_decider(slots, i), offsetof(AgentState, smooth_mps));
    Eigen::Vector2d& drift = state_.agents[slot].drift_mps;
    drift.setZero();
    if (decisions_.close_counts[slot] != 0) {
      drift = {static_cast<double>(decisions_.expected_x_m[slot] - decisions_.chosen_x_m[slot]),
               static_cast<double>(decisions_.expected_y_m[slot] - decisions_.chosen_y_m[slot])};
      drift /= state_.period_s;
      const double length = drift.norm();
      if (length > tuning::kMaxDrift_mps) drift *= tuning::kMaxDrift_mps / length;
    }
    state_.predict_position(slot);
  }
}

/// Grows the discs of agents that were placed closer than their discs. Standing agents grow where
/// there is room, walking ones gradually in any case.
void OverlapRelaxation::grow(size_t slot, bool walks) {
  float& radius_scale = state_.agents[slot].radius_scale;
  if (radius_scale == 1) return;
  float max_scale = 1;
  const auto radius_m = static_cast<float>(state_.agents[slot].radius_m);
  for (const uint32_t other : walks ? SteeringState::Slots{} : state_.neighbours(slot)) {
    const float dx = state_.grid.x()[other] - state_.grid.x()[slot],
                dy = state_.grid.y()[other] - state_.grid.y()[slot];
    const float apart_m = radius_m + static_cast<float>(state_.agents[other].radius_m);
    max_scale = std::min(max_scale, std::sqrt(dx * dx + dy * dy) / apart_m);
  }
  radius_scale = std::max(
      radius_scale, std::min(max_scale, radius_scale + static_cast<float>(tuning::kRadiusGrowth)));
}

}  // namespace throng
