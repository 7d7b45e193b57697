#include "avatars/yielding/footfall.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace throng {
namespace {

using Eigen::Vector2f;

// Slower feet stay where they are.
constexpr float kSlowest_hz = 0.1f;
// Nobody looks farther ahead for a landing place, as Stepping has it; and going sideways, the
// trailing foot lands so far towards the leading one at most.
constexpr float kLongestLook_s = 0.9f;
constexpr float kMostClosing_m = 0.03f;
// A foot steps over its ball at the end of stance: its ankle gets so far ahead.
constexpr float kRoll_m = 0.10f, kRollFrom = 0.75f;
// The knee is ahead of the middle between hip and ankle, and more so in swing.
constexpr float kBend_m = 0.055f, kSwingBend_m = 0.13f;

float wrapped(float phase) { return phase - std::floor(phase); }
float smooth(float u) { return u * u * (3 - 2 * u); }

float share_at(const SwingShares& shares, float u) {
  const float at = std::clamp(u, 0.0f, 1.0f) * static_cast<float>(shares.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), shares.size() - 2);
  return shares[i] + (at - static_cast<float>(i)) * (shares[i + 1] - shares[i]);
}

}  // namespace

LegPath::LegPath(const Steps& s, size_t side, float most_s)
    : root_m_(s.root_m),
      velocity_mps_(s.velocity_mps),
      ahead_(s.ahead),
      left_(-s.ahead.y(), s.ahead.x()),
      relative_mps_(Vector2f(velocity_mps_.dot(ahead_), velocity_mps_.dot(left_)) / s.scale),
      shift_m_(s.landing_m[2 * side], s.landing_m[2 * side + 1]),
      swing_(s.swing),
      own_(wrapped(s.phase + 0.5f * static_cast<float>(side))),
      stance_(s.track.stance),
      scale_(s.scale),
      cycles_ps_(s.cycles_ps),
      later_ps_(s.later_ps),
      later_s_(s.later_s),
      lands_x_m_(s.track.x_at(0)),
      lifts_x_m_(s.track.x_at(stance_)),
      passes_x_m_(s.track.x_at(0.5f * stance_)),
      side_m_(s.track.side_m[side]),
      kept_(1),
      is_right_(side == 0) {
  float x = s.track.x_at(own_);
  if (own_ >= stance_) {
    const float u = (own_ - stance_) / (1 - stance_);
    x = lifts_x_m_ + share_at(*swing_, u) * (lands_x_m_ - lifts_x_m_);
    kept_ = std::max(1 - smooth(u), 1e-3f);
  }
  const Vector2f off(s.shift_m[2 * side], s.shift_m[2 * side + 1]);
  cycles_[0].stands_m = root_m_ + world(x + off.x(), side_m_ + off.y());
  cycles_[0].off_m = off;
  if (cycles_ps_ < kSlowest_hz) return;
  last_ = std::min(static_cast<int>(own_ + cycles_in(most_s)), kMostCycles - 1);
  for (int cycle = 0; cycle <= last_; ++cycle) go_on_to(cycle);
}

/// Each cycle follows from the one before.
void LegPath::go_on_to(int index) {
  const auto number = static_cast<float>(index);
  Cycle& cycle = cycles_[static_cast<size_t>(index)];
  if (index > 0) {
    const float lands_s = time_of(number - own_);
    const Vector2f& goal = cycles_[static_cast<size_t>(index - 1)].goal_m;
    cycle.stands_m = root_in(lands_s) + world(lands_x_m_ + goal.x(), side_m_ + goal.y());
  }
  if (index > 0 || own_ < stance_) {
    const Vector2f lifts = cycle.stands_m - root_in(time_of(number + stance_ - own_));
    cycle.off_m = {ahead_.dot(lifts) / scale_ - lifts_x_m_, left_.dot(lifts) / scale_ - side_m_};
  }
  cycle.goal_m = goal_m(time_of(number + 1 - own_), index == 0);
}

Vector2f LegPath::world(float x, float y) const { return scale_ * (x * ahead_ + y * left_); }

float LegPath::cycles_in(float ahead_s) const {
  return ahead_s <= later_s_ ? cycles_ps_ * ahead_s
                             : cycles_ps_ * later_s_ + later_ps_ * (ahead_s - later_s_);
}

float LegPath::time_of(float cycles) const {
  const float first = cycles_ps_ * later_s_;
  return cycles <= first ? cycles / cycles_ps_ : later_s_ + (cycles - first) / later_ps_;
}

/// How far from where the gait has it a foot lands, so that the body passes over it as the gait
/// does: root frame, scale 1.
Vector2f LegPath::goal_m(float ahead_s, bool next) const {
  const float rate = ahead_s < later_s_ ? cycles_ps_ : later_ps_;
  const float look_s = std::min(0.5f * stance_ / rate, kLongestLook_s);
  const float aside = look_s * relative_mps_.y();
  Vector2f goal(look_s * relative_mps_.x() + passes_x_m_ - lands_x_m_,
                is_right_ ? std::min(aside, kMostClosing_m) : std::max(aside, -kMostClosing_m));
  if (next) goal += shift_m_;
  return goal;
}

float LegPath::lands_s() const {
  if (cycles_ps_ < kSlowest_hz || own_ < stance_ - 0.15f) return -1;
  return time_of(1 - own_);
}

LegPlace LegPath::at(float ahead_s) const {
  const Vector2f root = root_in(ahead_s);
  float bend = kBend_m, roll = 0;
  const float later =
      cycles_ps_ < kSlowest_hz ? std::min(own_, stance_ - 0.01f) : own_ + cycles_in(ahead_s);
  const int index = std::min(static_cast<int>(later), last_);
  const Cycle& cycle = cycles_[static_cast<size_t>(index)];
  const float phase = std::min(later - static_cast<float>(index), 1.0f);
  LegPlace place{cycle.stands_m, {}, {}, true, index == 1 ? 1.0f : 0.0f};
  if (phase < stance_) {
    const float end = std::max(phase / stance_ - kRollFrom, 0.0f) * (1 / (1 - kRollFrom));
    roll = kRoll_m * end * end;
  } else {
    const float u = (phase - stance_) / (1 - stance_);
    const float keep = (1 - smooth(u)) / (index == 0 ? kept_ : 1);
    const float x = lifts_x_m_ + share_at(*swing_, u) * (lands_x_m_ - lifts_x_m_);
    const Vector2f off = cycle.goal_m + keep * (cycle.off_m - cycle.goal_m);
    place.foot_m = root + world(x + off.x(), side_m_ + off.y());
    place.stays = u < 0.5f;
    place.share = index == 0 ? 1 - keep : 0;
    bend += 4 * u * (1 - u) * kSwingBend_m;
    roll = kRoll_m * std::max(1 - 2 * u, 0.0f);
  }
  const Vector2f ankle = place.foot_m + scale_ * roll * ahead_;
  const Vector2f hip = root + world(0, side_m_);
  place.knee_m = 0.5f * (hip + ankle) + scale_ * bend * ahead_;
  place.shin_m = 0.5f * (ankle + place.knee_m);
  return place;
}

}  // namespace throng
