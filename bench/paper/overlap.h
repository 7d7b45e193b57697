// How much room two objects have in which a volume says that they collide: what orders the volumes,
// whatever box the objects fly in and however fast.
// One rule: every method judges the same random attitudes and places, so that differences between
// methods are not chance.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/paper/methods.h"

namespace throng::paper {

/// The volume of all places of one object's origin at which it overlaps another, mean over pairs of
/// different objects in random attitudes: of two convex volumes that is the volume of their
/// Minkowski sum, and what the chance to collide is proportional to.
struct OverlapVolume {
  double litres = 0;
  double error_l = 0;               ///< standard error over independent batches of attitudes
  std::vector<double> by_object_l;  ///< mean over its partners
};

using OverlapTable = std::array<OverlapVolume, kMethods.size()>;

/// Monte Carlo with `attitudes` pairs of attitudes a pair of objects (at least 10), 100 places
/// each.
OverlapTable measure_overlap(const std::vector<Object>& objects, int attitudes, uint64_t seed);

/// Longest over shortest side of the box around an object's points in its own frame.
double elongation(const Object& object);

}  // namespace throng::paper
