// The gait's phase as the sway of a recorded head tells it.
// One rule: a phase is given only where a sway is seen; elsewhere the body walks by the distance.
//
// A head sways to the side of the foot that carries, once a stride. Its deviation from the way is
// compared with a wave of the stride's expected frequency, in a window of some strides: what they
// have in common is amplitude and phase of the sway (a Gabor transform).
#pragma once

#include <span>
#include <vector>

namespace throng {

/// At one instant of a track.
struct SwaySample {
  double time_s = 0;
  double left_m = 0;      ///< how far the head is to the left of its way
  double strides_hz = 0;  ///< as the gait has them at this speed; 0: stands
};

/// Since the head was last farthest to the left, in strides, [0, 1); NaN where no sway is seen.
/// `track` in ascending order of time.
std::vector<float> strides_since_left(std::span<const SwaySample> track);

}  // namespace throng
