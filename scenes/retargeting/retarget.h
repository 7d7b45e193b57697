// From recorded positions to the way of a body: where it is at any time, how it is turned, how fast
// it walks and, where that can be seen, in which phase of its gait.
// One rule: every recorded position is kept. What it is the position of (a head, the middle of a
// body) is for the world to reckon with.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "recordings/recording.h"

namespace throng {

class Gait;
class HeadOffset;

/// A recorded instant of somebody, as it is kept in the track file: 48 bytes.
struct TrackSample {
  double time_s = 0;
  double x_m = 0, y_m = 0;
  float heading_rad = 0;  ///< without turns: neighbours differ by less than half of one
  float ahead_mps = 0;    ///< along the heading; below 0: backwards
  float phase = 0;        ///< of the gait; NaN: as the distance walked has it
  float next_x_mps = 0, next_y_mps = 0;  ///< see BodyStates::next_mps
  enum class Next : uint32_t { kMove, kJump, kAbsent };
  Next next = Next::kMove;  ///< until the next knot: moves there, stays and jumps, or is not there
};
static_assert(sizeof(TrackSample) == 48);

/// What dressing needs to know of the body.
struct RetargetBody {
  TrackedPoint tracked = TrackedPoint::kCentre;
  const Gait* gait = nullptr;
  const HeadOffset* head = nullptr;
  float scale = 1;
};

/// What is between two samples for longer than this, and longer than 1.5 of a track's usual
/// intervals, is an absence.
inline constexpr double kMaxTrackGap_s = 1.0;
/// Times that were rounded apart by less are the same.
inline constexpr double kTimeTolerance_s = 1e-7;
/// Nobody runs faster: what does has jumped.
inline constexpr double kMaxRunSpeed_mps = 12;

/// The knots of one person, one a sample. `track` in ascending order of time, at least one.
std::vector<TrackSample> retarget(std::span<const Sample> track, const RetargetBody& body);

/// Where a way is at a time between two knots, by a curve through all that never leaves the
/// rectangle of two neighbours. `knots`: the one before `from`, `from`, the next, and the one after
/// that; the outer ones may be null.
Eigen::Vector2d position_between(const TrackSample* before, const TrackSample& from,
                                 const TrackSample& to, const TrackSample* after, double time_s);

}  // namespace throng
