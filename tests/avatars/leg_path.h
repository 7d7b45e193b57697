// LegPath computes a leg step by step: the slow reference for predict().
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "avatars/body_avoidance/leg_state.h"

namespace throng::test {

class LegPath {
 public:
  /// Changes to another cadence from `delay_s` on.
  LegPath(const WalkState& steps, size_t side, float later_ps, float delay_s)
      : s_(steps),
        side_(side),
        own_(steps.phase + 0.5f * static_cast<float>(side)),
        later_ps_(later_ps),
        later_s_(delay_s) {
    own_ -= std::floor(own_);
    stands_ = s_.cadence_hz < kMinCadence_hz;
    const Eigen::Vector2f off(s_.shift_m[2 * side], s_.shift_m[2 * side + 1]);
    const float x = own_ < stance() ? s_.track.x_at(own_) : swing_x(swing_share(own_));
    Cycle first;
    first.stands_m = s_.root_m + world({x + off.x(), lane() + off.y()});
    first.off_m = off;
    cycles_.push_back(first);
    if (stands_) return;
    if (own_ < stance()) cycles_[0].off_m = off_at_lift(0);
    cycles_[0].goal_m =
        goal_m(1 - own_) + Eigen::Vector2f(s_.landing_m[2 * side], s_.landing_m[2 * side + 1]);
  }

  LegPlace at(float ahead_s) {
    const float later = stands_ ? std::min(own_, stance() - 0.01f) : own_ + cycles_in(ahead_s);
    const auto index = static_cast<size_t>(later);
    while (cycles_.size() <= index) go_on();
    const Cycle& cycle = cycles_[index];
    const float phase = later - static_cast<float>(index);
    const Eigen::Vector2f root = s_.root_m + ahead_s * s_.velocity_mps;
    Eigen::Vector2f foot = cycle.stands_m;
    float roll = std::max(phase / stance() - 0.75f, 0.0f) / 0.25f, bend = 0.055f;
    roll = 0.1f * roll * roll;
    if (phase >= stance()) {
      const float u = swing_share(phase);
      float keep = 1 - smooth(u);
      if (index == 0 && own_ >= stance()) keep /= std::max(1 - smooth(swing_share(own_)), 1e-3f);
      const Eigen::Vector2f off = cycle.goal_m + keep * (cycle.off_m - cycle.goal_m);
      foot = root + world({swing_x(u) + off.x(), lane() + off.y()});
      roll = 0.1f * std::max(1 - 2 * u, 0.0f);
      bend += 4 * u * (1 - u) * 0.13f;
    }
    const Eigen::Vector2f ankle = foot + world({roll, 0}), hip = root + world({0, lane()});
    const Eigen::Vector2f knee = 0.5f * (hip + ankle) + world({bend, 0});
    return {foot, 0.5f * (ankle + knee), knee};
  }

 private:
  struct Cycle {
    Eigen::Vector2f stands_m, off_m = Eigen::Vector2f::Zero(), goal_m = Eigen::Vector2f::Zero();
  };

  static float smooth(float u) { return u * u * (3 - 2 * u); }
  float stance() const { return s_.track.stance; }
  float lane() const { return s_.track.side_m[side_]; }
  float swing_share(float phase) const { return (phase - stance()) / (1 - stance()); }
  float swing_x(float u) const {
    const float lifts = s_.track.x_at(stance());
    return lifts + s_.swing->at(u) * (s_.track.x_at(0) - lifts);
  }
  Eigen::Vector2f world(const Eigen::Vector2f& v) const {
    return s_.scale * (v.x() * s_.ahead + v.y() * Eigen::Vector2f(-s_.ahead.y(), s_.ahead.x()));
  }
  Eigen::Vector2f in_root(const Eigen::Vector2f& v) const {
    return Eigen::Vector2f(s_.ahead.dot(v), s_.ahead.x() * v.y() - s_.ahead.y() * v.x()) / s_.scale;
  }
  float cycles_in(float ahead_s) const {
    return s_.cadence_hz * std::min(ahead_s, later_s_) +
           later_ps_ * std::max(ahead_s - later_s_, 0.0f);
  }
  float time_of(float cycles) const {
    const float soon = s_.cadence_hz * later_s_;
    return cycles <= soon ? cycles / s_.cadence_hz : later_s_ + (cycles - soon) / later_ps_;
  }
  /// Offset from the place in the gait at which the foot lands after `cycles` cycles.
  Eigen::Vector2f goal_m(float cycles) const {
    const float rate = time_of(cycles) < later_s_ ? s_.cadence_hz : later_ps_;
    const float horizon_s = std::min(0.5f * stance() / rate, 0.9f);
    const Eigen::Vector2f offset = horizon_s * in_root(s_.velocity_mps);
    return {offset.x() + s_.track.x_at(0.5f * stance()) - s_.track.x_at(0),
            side_ == 0 ? std::min(offset.y(), 0.03f) : std::max(offset.y(), -0.03f)};
  }
  Eigen::Vector2f off_at_lift(size_t index) const {
    const float lifts_s = time_of(static_cast<float>(index) + stance() - own_);
    const Eigen::Vector2f root = s_.root_m + lifts_s * s_.velocity_mps;
    return in_root(cycles_[index].stands_m - root) -
           Eigen::Vector2f(s_.track.x_at(stance()), lane());
  }
  void go_on() {
    const size_t index = cycles_.size();
    const float lands_s = time_of(static_cast<float>(index) - own_);
    Cycle next;
    next.stands_m = s_.root_m + lands_s * s_.velocity_mps +
                    world(Eigen::Vector2f(s_.track.x_at(0), lane()) + cycles_.back().goal_m);
    next.goal_m = goal_m(static_cast<float>(index) + 1 - own_);
    cycles_.push_back(next);
    cycles_.back().off_m = off_at_lift(index);
  }

  WalkState s_;
  size_t side_;
  float own_, later_ps_, later_s_;
  bool stands_;
  std::vector<Cycle> cycles_;
};

}  // namespace throng::test
