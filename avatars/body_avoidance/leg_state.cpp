#include "avatars/body_avoidance/leg_state.h"

#include <algorithm>

#include "base/portable_math.h"

namespace throng {
namespace {

using Eigen::Vector2f;

float smooth(float u) { return u * u * (3 - 2 * u); }

/// Returns the components of `v` along `ahead` and to the left of it.
Vector2f along(const Vector2f& ahead, const Vector2f& v) {
  return {ahead.dot(v), ahead.x() * v.y() - ahead.y() * v.x()};
}

}  // namespace

WalkState WalkState::in_frame_of(const WalkState& other) const {
  WalkState seen = *this;
  seen.root_m = along(other.ahead, root_m - other.root_m) / other.scale;
  seen.velocity_mps = along(other.ahead, velocity_mps) / other.scale;
  seen.ahead = along(other.ahead, ahead);
  seen.scale = scale / other.scale;
  return seen;
}

LegState::LegState(const WalkState& s, size_t side)
    : velocity_mps(along(s.ahead, s.velocity_mps) / s.scale),
      off_m(s.shift_m[2 * side], s.shift_m[2 * side + 1]),
      landing_m(s.landing_m[2 * side], s.landing_m[2 * side + 1]),
      swing(*s.swing),
      phase(phase_of(s.phase + 0.5f * static_cast<float>(side))),
      cadence_hz(s.cadence_hz),
      stance(s.track.stance),
      lands_x_m(s.track.x_at(0)),
      lifts_x_m(s.track.x_at(stance)),
      passes_x_m(s.track.x_at(0.5f * stance)),
      side_m(s.track.side_m[side]),
      offset_share(1),
      is_right(side == 0),
      root_m(s.root_m),
      ahead_m(s.scale * s.ahead) {
  float x = s.track.x_at(phase);
  if (phase >= stance) {
    const float u = (phase - stance) / (1 - stance);
    x = lifts_x_m + swing.at(u) * (lands_x_m - lifts_x_m);
    offset_share = std::max(1 - smooth(u), 1e-3f);
  }
  foot_m = {x + off_m.x(), side_m + off_m.y()};
  if (cadence_hz >= kMinCadence_hz) return;
  // A foot in the air stays there: it never lands.
  constexpr float kNegligible_hz = 1e-6f;
  phase = std::min(phase, stance - 0.01f);
  cadence_hz = kNegligible_hz;
}

float LegState::lands_s() const {
  if (cadence_hz < kMinCadence_hz || phase < stance - 0.15f) return -1;
  return (1 - phase) / cadence_hz;
}

}  // namespace throng
