// The two ways of walking a chunk on. Internal to the folder.
// One rule: both give the same bits.
#pragma once

#include "avatars/stepping/stepping.h"

namespace throng {

/// A lane after the other: the reference.
void walk_one_by_one(const SteppingTables& tables, WalkChunk& chunk);
/// `target` is one that this machine has, not kBest.
void walk_simd(const SteppingTables& tables, WalkChunk& chunk, SimdTarget target);
/// The legs of one lane with the shift of the feet in `sides` (1 right, 2 left, 3 both) taken times
/// `share`, which stays if both legs reach; returns whether they do.
bool reach_with(const SteppingTables& tables, WalkChunk& chunk, size_t lane, int sides,
                float share);

/// A side of a box as WalkRoom has it; see grains_of() of stepping_legs-inl.h.
float grains_between(const SteppingTables& tables, float low_m, float high_m);

}  // namespace throng
