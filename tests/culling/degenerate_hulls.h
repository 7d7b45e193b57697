// check_degenerate_hulls() makes hulls of random and degenerate clouds of points, and judges their
// corners, gaps and depths by all of the points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace throng::test {

struct DegenerateHullsTally {
  uint64_t clouds = 0, pairs = 0, points = 0;
  uint64_t incomplete = 0;    ///< clouds whose tests ran out
  double max_tests = 0;       ///< per point
  double max_faces = 0;       ///< per point; may be 2
  double worst_beyond = 0;    ///< a point beyond the corners, over what the distances allow
  double worst_gap_m = 0;     ///< a proven gap that is not there
  double worst_depth_m = 0;   ///< a depth that does not part the points, or a proof beyond it
  double widest_depth_m = 0;  ///< from the proven depth to the one returned
  double longest_start_s = 0, longest_per_point_us = 0;
  double longest_pair_s = 0;
  uint64_t wrong = 0;
  std::string first_wrong;  ///< names the seed; empty: none

  void add(const DegenerateHullsTally& other);
};

/// `clouds` clouds of up to `max_points` points (most of them smaller), each from a seed of its
/// own: `seed` and the number of the cloud. Every cloud meets the one before it.
DegenerateHullsTally check_degenerate_hulls(uint64_t clouds, int max_points, uint64_t seed);

void print_degenerate_hulls(const DegenerateHullsTally& tally);

}  // namespace throng::test
