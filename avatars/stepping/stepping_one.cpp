// One person at a time: the reference for stepping_simd.cpp, and what is asked of single people.
#include <array>
#include <cstddef>
#include <cstdint>

#include "avatars/stepping/stepping_kernels.h"
#include "base/elementary.h"
#include "base/simd/one_lane.h"

namespace throng {
namespace one_lane {
namespace {

// Each shares what the ones before it can do.
#include "base/simd/angles-inl.h"
//
#include "avatars/stepping/stepping_legs-inl.h"
//
#include "avatars/stepping/stepping_feet-inl.h"

}  // namespace
}  // namespace one_lane

void walk_one_by_one(const SteppingTables& tables, WalkChunk& chunk) {
  for (size_t lane = 0; lane < chunk.count; ++lane) one_lane::walk_feet(tables, chunk, lane);
  for (size_t lane = 0; lane < chunk.count; ++lane) one_lane::walk_legs(tables, chunk, lane);
}

bool reach_with(const SteppingTables& tables, WalkChunk& chunk, size_t lane, int sides,
                float share) {
  using one_lane::F;
  one_lane::Feet feet = one_lane::load_feet(chunk, lane);
  for (size_t side = 0; side < 2; ++side) {
    if ((sides >> side & 1) == 0) continue;
    for (F* number : {&feet.x[side], &feet.y[side], &feet.turn[side], &feet.lift[side]})
      *number = *number * share;
  }
  one_lane::Track track;
  one_lane::Place at;
  one_lane::load_step(chunk, lane, track, at);
  F posture[16], room[2];
  const one_lane::Standing standing = {share * chunk.shift_m[lane], share * chunk.breath[lane]};
  const one_lane::Sinking before = {chunk.momentum[WalkChunk::kSunk][lane],
                                    chunk.momentum[WalkChunk::kSinking][lane]};
  one_lane::Sinking now;
  if (one_lane::legs_of(tables, &chunk.tables[lane], feet, standing, before, chunk.step_s, at,
                        track, posture, room, now)
          .v != 0)
    return false;
  for (size_t side = 0; side < 2; ++side)
    feet.lift[side] = chunk.lift_m[side][lane];  // as it was: another share may follow
  one_lane::store_feet(feet, chunk, lane);
  one_lane::store_posture(posture, room, chunk, lane);
  one_lane::store_sinking(now, chunk, lane);
  return true;
}

float grains_between(const SteppingTables& tables, float low_m, float high_m) {
  return one_lane::grains_of(tables, low_m, high_m).v;
}

}  // namespace throng
