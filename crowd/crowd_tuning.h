// Steering constants shared by several parts of a crowd, each with unit and reason. Constants of
// one behaviour are in its header, those of a steering model with the model.
#pragma once

#include <algorithm>

namespace throng::tuning {

/// Linear ramp: 0 up to `from`, 1 from `to` on.
inline double ramp(double from, double to, double x) {
  return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

/// Ten decisions per second: people do not react faster, and motion in between is smooth.
inline constexpr double kPeriod_s = 0.1;
/// Two people at 1.34 m/s head-on meet from 5.4 m within the horizon.
inline constexpr double kReach_m = 5.0;
/// People speed up a little to pass.
inline constexpr double kMaxSpeedFactor = 1.2;
/// Preferred speeds below this count as zero. Larger than the symmetry-breaking noise, smaller than
/// any preferred speed in dense crowds.
inline constexpr double kMinPreferred_mps = 0.01;
/// Minimum distance of centres to walls, enforced on positions; steering keeps a disc's radius.
inline constexpr double kWallGap_m = 0.1;
/// Agents slow down over this distance before a closed door or the end of a queue. Below this share
/// of their speed they stand instead.
inline constexpr double kBrakingDistance_m = 1.6;
inline constexpr double kMinSpeedFactor = 0.08;
/// After this time without progress an agent tries another path for about a second.
inline constexpr double kStuck_s = 1.5;
/// Share of the preferred velocity in the velocity that a stuck agent shows to others.
inline constexpr double kPublishedPreferredShare = 0.85;

}  // namespace throng::tuning
