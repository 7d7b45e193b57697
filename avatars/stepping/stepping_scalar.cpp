// Scalar reference for stepping_simd.cpp, and functions for single people.
#include <array>
#include <cstddef>
#include <cstdint>

#include "avatars/stepping/stepping_kernels.h"
#include "base/portable_math.h"
#include "base/simd/scalar_lanes.h"

namespace throng {
namespace scalar_lanes {
namespace {

// Order matters: each header uses those before it.
#include "base/simd/angles-inl.h"
//
#include "avatars/stepping/stepping_legs-inl.h"
//
#include "avatars/stepping/stepping_feet-inl.h"

}  // namespace
}  // namespace scalar_lanes

void walk_scalar(const SteppingTables& tables, WalkBatch& batch) {
  for (size_t lane = 0; lane < batch.count; ++lane) scalar_lanes::walk_feet(tables, batch, lane);
  for (size_t lane = 0; lane < batch.count; ++lane) scalar_lanes::walk_legs(tables, batch, lane);
}

bool reach_with(const SteppingTables& tables, WalkBatch& batch, size_t lane, int sides,
                float share) {
  using scalar_lanes::F;
  scalar_lanes::Feet feet = scalar_lanes::load_feet(batch, lane);
  for (size_t side = 0; side < 2; ++side) {
    if ((sides >> side & 1) == 0) continue;
    for (F* number : {&feet.x[side], &feet.y[side], &feet.turn[side], &feet.lift[side]})
      *number = *number * share;
  }
  scalar_lanes::Track track;
  scalar_lanes::Place at;
  scalar_lanes::load_step(batch, lane, track, at);
  F posture[16], packed_bounds[2];
  const scalar_lanes::Standing standing = {share * batch.shift_m[lane], share * batch.breath[lane]};
  const scalar_lanes::PelvisDrop before = {batch.gait_rates[WalkBatch::kPelvisDrop][lane],
                                           batch.gait_rates[WalkBatch::kPelvisDropSpeed][lane]};
  scalar_lanes::PelvisDrop now;
  if (scalar_lanes::legs_of(tables, &batch.tables[lane], feet, standing, before, batch.step_s, at,
                            track, posture, packed_bounds, now)
          .v != 0)
    return false;
  for (size_t side = 0; side < 2; ++side)
    feet.lift[side] = batch.lift_m[side][lane];  // restored, because another share may follow
  scalar_lanes::store_feet(feet, batch, lane);
  scalar_lanes::store_posture(posture, packed_bounds, batch, lane);
  scalar_lanes::store_pelvis_drop(now, batch, lane);
  return true;
}

float grains_between(const SteppingTables& tables, float low_m, float high_m) {
  return scalar_lanes::grains_of(tables, low_m, high_m).v;
}

}  // namespace throng
