// retarget() converts a recorded track to the motion of a body: position, heading, speed and, if
// visible, gait phase.
// Invariant: every recorded position is kept, whether it is that of a head or of a body centre.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "recordings/recording.h"

namespace throng {

class Gait;
class HeadOffset;

/// Sample of a retargeted track in the track file, 48 bytes.
struct TrackSample {
  double time_s = 0;
  double x_m = 0, y_m = 0;
  float heading_rad = 0;  ///< unwrapped: neighbours differ by less than half a turn
  float ahead_mps = 0;    ///< along the heading; below 0: backwards
  float phase = 0;        ///< gait phase; NaN: not visible, follows from the distance walked
  float next_x_mps = 0, next_y_mps = 0;
  enum class Next : uint32_t { kMove, kJump, kAbsent };
  Next next = Next::kMove;  ///< until the next sample: moves, stays and then jumps, or is absent
};
static_assert(sizeof(TrackSample) == 48);

struct RetargetBody {
  TrackedPoint tracked = TrackedPoint::kCentre;
  const Gait* gait = nullptr;
  const HeadOffset* head = nullptr;
  float scale = 1;
};

/// Gaps in a track longer than this and than 1.5 usual intervals are absences.
inline constexpr double kMaxTrackGap_s = 1.0;
/// Times that differ by less, due to rounding, are equal.
inline constexpr double kTimeTolerance_s = 1e-7;
/// Maximum speed of a runner; faster displacements are jumps.
inline constexpr double kMaxRunSpeed_mps = 12;

/// Retargets the samples of one person. `track` is in ascending order of time and not empty.
std::vector<TrackSample> retarget(std::span<const Sample> track, const RetargetBody& body);

/// Interpolates a position between `from` and `to` by a monotone cubic. It stays within the
/// rectangle of the two. `before` and `after`: adjacent samples, or null.
Eigen::Vector2d position_between(const TrackSample* before, const TrackSample& from,
                                 const TrackSample& to, const TrackSample* after, double time_s);

}  // namespace throng
