// A recorded way without its noise, and without the sway of the head.
// One rule: each instant is fitted from what lies around it in time, before and after alike, so
// that nothing is late.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "recordings/recording.h"

namespace throng {

/// A line fitted through positions: where it is at an instant, and how fast.
struct WayPoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity_mps = Eigen::Vector2d::Zero();
};

/// Where the body goes, by straight lines fitted within `reach_s` of each sample: what sways to and
/// fro within that time is not in it.
std::vector<WayPoint> way_of(std::span<const Sample> track, double reach_s);

/// Positions by parabolas fitted within `reach_s` of each sample, which keep what a head does in a
/// step; none is moved by more than `most_m`.
std::vector<Eigen::Vector2d> without_noise(std::span<const Sample> track, double reach_s,
                                           double most_m);

}  // namespace throng
