// The constants of steering that several parts of a crowd know, each with its unit and reason.
// Constants of one behaviour stand in its header, of a steering model with the model.
#pragma once

#include <algorithm>

namespace throng::tuning {

/// What grows between two of these numbers: 0 up to `from`, 1 from `to` on.
inline double ramp(double from, double to, double x) {
  return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

/// Decisions ten times a second: people do not react faster, and between them motion is smooth.
inline constexpr double kPeriod_s = 0.1;
/// Two people at 1.34 m/s head on meet from 5.4 m within the horizon.
inline constexpr double kReach_m = 5.0;
/// People speed up a little to pass.
inline constexpr double kMaxSpeedFactor = 1.2;
/// Whoever wants less than this wants nowhere: what breaks symmetry is below it. In the densest
/// throng people still want this much.
inline constexpr double kMinPreferred_mps = 0.01;
/// Centres stay this far from walls whatever happens; steering itself keeps a disc's radius.
inline constexpr double kWallGap_m = 0.1;
/// People who wait before a closed door, or go up to the end of a queue, slow down over the first,
/// and stand rather than walk slower than the second's share of their speed.
inline constexpr double kBrakingDistance_m = 1.6;
inline constexpr double kMinSpeedFactor = 0.08;
/// Whoever made no progress for so long tries another way past, each time for about a second.
inline constexpr double kStuck_s = 1.5;
/// How far the velocity that somebody stuck shows to others goes over to the one wanted.
inline constexpr double kPublishedPreferredShare = 0.85;

}  // namespace throng::tuning
