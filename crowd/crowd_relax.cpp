// What is left of overlaps between discs after those of a phase have chosen: they are pushed apart,
// sweep by sweep, until none is deeper than kSlop_m. Others go on as they have decided.
#include <algorithm>
#include <cmath>

#include "crowd/crowd.h"
#include "crowd/crowd_blocks.h"
#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

// What a sweep found of a person.
constexpr uint8_t kMoved = 1;
constexpr uint8_t kOverlapping = 2;

}  // namespace

void Crowd::relax_discs() {
  counters_.deepest_overlap_m =
      largest([this](Slots slots, size_t block) { return find_close(slots, block); });
  counters_.sweeps = 0;
  double deepest_m = tuning::kSlop_m;
  while (deepest_m >= tuning::kSlop_m && counters_.sweeps < tuning::kSweeps) {
    deepest_m = largest([this](Slots, size_t block) { return sweep(block); });
    slots_.expected_x_m.swap(slots_.swept_x_m);
    slots_.expected_y_m.swap(slots_.swept_y_m);
    slots_.touched.swap(slots_.swept_touched);
    ++counters_.sweeps;
  }
  counters_.all_sweeps += static_cast<uint64_t>(counters_.sweeps);
  counters_.max_sweeps = std::max(counters_.max_sweeps, counters_.sweeps);
  for_deciders([this](Slots slots, size_t, int) { set_drift(slots); });
}

/// Where somebody will stand after a period, as far as is known by now.
Eigen::Vector2f Crowd::expected_m(size_t slot) const {
  if (slots_.phase[slot] == phase_) return {slots_.expected_x_m[slot], slots_.expected_y_m[slot]};
  return {walkers_.seen[slot].ahead_x_m, walkers_.seen[slot].ahead_y_m};
}

/// Brings those neighbours to the front who may overlap at the end of the period. Returns the
/// deepest overlap of those who stand now.
double Crowd::find_close(Slots slots, size_t block) {
  float deepest_m = 0;
  const auto moved_m = static_cast<float>(2 * period_s_ * tuning::kHaste * fastest_mps_);
  uint32_t crowded = 0;
  const uint32_t first = static_cast<uint32_t>(slots.data() - deciders().data());
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    prefetch_neighbours(later_decider(slots, i));
    uint32_t* near = slots_.neighbours.data() + kMaxNeighbours * slot;
    const auto margin_m = static_cast<float>(tuning::kSweepMargin_m);
    const Seen& own = walkers_.seen[slot];
    const float reach_m = own.radius_m + widest_m_ + margin_m + moved_m;
    const Eigen::Vector2f expected = expected_m(slot);
    size_t close = 0;
    for (size_t k = 0; k < slots_.neighbour_counts[slot]; ++k) {
      const uint32_t other = near[k];
      const float dx = walkers_.seen[other].x_m - own.x_m;
      const float dy = walkers_.seen[other].y_m - own.y_m;
      const float square = dx * dx + dy * dy;
      if (square > reach_m * reach_m) break;  // they come nearest first
      const Eigen::Vector2f to = expected_m(other) - expected;
      const float radius_m = apart_m(slot, other);
      const float close_m = radius_m + margin_m;
      if (square < radius_m * radius_m)
        deepest_m = std::max(deepest_m, radius_m - std::sqrt(square));
      if (to.x() * to.x() + to.y() * to.y() < close_m * close_m) std::swap(near[close++], near[k]);
    }
    slots_.close_counts[slot] = static_cast<uint8_t>(close);
    slots_.swept_x_m[slot] = expected.x();
    slots_.swept_y_m[slot] = expected.y();
    // The first sweep looks at all of them.
    slots_.touched[slot] = slots_.swept_touched[slot] = close > 0 ? kMoved : 0;
    if (close > 0) slots_.crowded[first + crowded++] = slot;
  }
  slots_.crowded_counts[block] = crowded;
  return static_cast<double>(deepest_m);
}

double Crowd::sweep(size_t block) {
  double deepest_m = 0;
  const uint32_t* crowded = slots_.crowded.data() + block * kPeopleABlock;
  const uint32_t* end_of_crowded = crowded + slots_.crowded_counts[block];
  for (; crowded != end_of_crowded; ++crowded) {
    if (is_settled(*crowded))
      slots_.swept_touched[*crowded] = 0;
    else
      deepest_m = std::max(deepest_m, relax_disc(*crowded));
  }
  return deepest_m;
}

/// Overlapping nobody at the sweep before, and neither this one nor anybody near moved since: the
/// sweep would change nothing. What it would write stands there from the sweep before.
bool Crowd::is_settled(size_t slot) const {
  if (slots_.touched[slot] != 0) return false;
  const uint32_t* near = slots_.neighbours.data() + kMaxNeighbours * slot;
  for (size_t k = 0; k < slots_.close_counts[slot]; ++k)
    if (slots_.phase[near[k]] == phase_ && (slots_.touched[near[k]] & kMoved) != 0) return false;
  return true;
}

/// Those behind push nobody forward, beyond where one's own step would have led: a person who is
/// in the way of others walks no faster for it. Whoever wants nowhere makes room to any side.
void Crowd::hold_back(size_t slot, float& to_x, float& to_y) const {
  const float ahead_x = walkers_.seen[slot].way_x, ahead_y = walkers_.seen[slot].way_y;
  if (ahead_x == 0 && ahead_y == 0) return;
  const float x = grid_.x()[slot], y = grid_.y()[slot];
  const float planned_x = slots_.chosen_x_m[slot] - x, planned_y = slots_.chosen_y_m[slot] - y;
  const float planned_m = std::max(0.0f, planned_x * ahead_x + planned_y * ahead_y);
  const float excess_m = (to_x - x) * ahead_x + (to_y - y) * ahead_y - planned_m;
  if (excess_m <= 0) return;
  to_x -= excess_m * ahead_x;
  to_y -= excess_m * ahead_y;
}

double Crowd::relax_disc(size_t slot) {
  const float x = slots_.expected_x_m[slot], y = slots_.expected_y_m[slot];
  float push_x = 0, push_y = 0, deepest_m = 0;
  for (size_t k = 0; k < slots_.close_counts[slot]; ++k) {
    const uint32_t other = slots_.neighbours[kMaxNeighbours * slot + k];
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
  if (deepest_m > 0) hold_back(slot, to_x, to_y);
  if (deepest_m > 0 && walkers_[slot].clearance_m < 2 * walkers_[slot].radius_m + 1) {
    const Eigen::Vector2d to = Eigen::Vector2f(to_x, to_y).cast<double>() + grid_.middle_m();
    const Eigen::Vector2f slid =
        (ways_.walkable().slide(walkers_[slot].position_m, to, tuning::kWallGap_m) -
         grid_.middle_m())
            .cast<float>();
    to_x = slid.x();
    to_y = slid.y();
  }
  slots_.swept_x_m[slot] = to_x;
  slots_.swept_y_m[slot] = to_y;
  const bool moved = to_x != x || to_y != y;
  slots_.swept_touched[slot] =
      static_cast<uint8_t>((moved ? kMoved : 0) | (deepest_m > 0 ? kOverlapping : 0));
  return static_cast<double>(deepest_m);
}

/// The correction is spread over the period, so that nobody jumps.
void Crowd::set_drift(Slots slots) {
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    walkers_.prefetch(later_decider(slots, i), offsetof(AgentState, smooth_mps));
    Eigen::Vector2d& drift = walkers_[slot].drift_mps;
    drift.setZero();
    if (slots_.close_counts[slot] != 0) {
      drift = {static_cast<double>(slots_.expected_x_m[slot] - slots_.chosen_x_m[slot]),
               static_cast<double>(slots_.expected_y_m[slot] - slots_.chosen_y_m[slot])};
      drift /= period_s_;
      const double length = drift.norm();
      if (length > tuning::kMaxDrift_mps) drift *= tuning::kMaxDrift_mps / length;
    }
    look_ahead(slot);
  }
}

}  // namespace throng
