// check_degenerate_hulls() builds hulls of random and degenerate point clouds and compares their
// corners, gaps and depths with all points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace throng::test {

struct DegenerateHullsTally {
  uint64_t clouds = 0, pairs = 0, points = 0;
  uint64_t incomplete = 0;  ///< number of clouds that reached the maximum number of tests
  double max_tests = 0;     ///< per point
  double max_faces = 0;     ///< per point; at most 2
  double worst_beyond = 0;  ///< distance of a point beyond the corners over the allowed one
  double worst_gap_m = 0;   ///< error of a proven gap
  /// depth that does not separate the points, or error of its proven bound
  double worst_depth_m = 0;
  double widest_depth_m = 0;  ///< maximum difference of the returned depth and its proven bound
  double longest_start_s = 0, longest_per_point_us = 0;
  double longest_pair_s = 0;
  uint64_t wrong = 0;
  std::string first_wrong;  ///< contains the seed; empty: none

  void add(const DegenerateHullsTally& other);
};

/// Tests `clouds` clouds of up to `max_points` points (most are smaller). Each has its own seed,
/// from `seed` and its number. Every cloud is also paired with the previous one.
DegenerateHullsTally check_degenerate_hulls(uint64_t clouds, int max_points, uint64_t seed);

void print_degenerate_hulls(const DegenerateHullsTally& tally);

}  // namespace throng::test
