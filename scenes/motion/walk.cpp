#include "scenes/motion/walk.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "avatars/stepping/standing.h"
#include "base/elementary.h"

namespace throng {

Eigen::Quaternionf turned_by(float angle_rad) {
  const FloatSinCos half = float_sin_cos(0.5f * angle_rad);
  return Eigen::Quaternionf(half.cos, 0, 0, half.sin);
}

namespace {

/// Whoever stands breathes and shifts its weight.
void stand(std::span<const WalkNow> avatars, uint32_t first, BodyStates& bodies, WalkChunk& chunk) {
  const float still_m = kStanding_mps * chunk.step_s;
  for (size_t i = 0; i < avatars.size(); ++i) {
    const uint32_t id = first + static_cast<uint32_t>(i);
    const float x = chunk.way_x_m[i], y = chunk.way_y_m[i];
    const bool stands = avatars[i].is_present && x * x + y * y < still_m * still_m;
    if (!stands && bodies.stood_s[id] == 0) continue;
    bodies.stood_s[id] = stood_after(bodies.stood_s[id], stands, chunk.step_s);
    const float share = standing_share(bodies.stood_s[id]);
    if (share == 0) continue;
    const QuietStanding adds = quiet_standing(*bodies.standing_seed, id, bodies.now_s);
    if (avatars[i].shifts_weight) chunk.shift_m[i] = share * adds.shift_m;
    chunk.breath[i] = share * adds.breath;
  }
}

}  // namespace

void walk_on(const Posing& posing, std::span<const WalkNow> avatars, double step_s, uint32_t first,
             SimdTarget target, BodyStates& bodies) {
  assert(avatars.size() <= WalkChunk::kRoom);
  WalkChunk chunk;
  chunk.count = avatars.size();
  chunk.step_s = static_cast<float>(step_s);
  for (size_t i = 0; i < avatars.size(); ++i) {
    const RootPose &before = avatars[i].before, &after = bodies.roots[first + i];
    chunk.way_x_m[i] = static_cast<float>(after.position_m.x() - before.position_m.x());
    chunk.way_y_m[i] = static_cast<float>(after.position_m.y() - before.position_m.y());
    chunk.w_before[i] = before.world_from_root.w();
    chunk.z_before[i] = before.world_from_root.z();
    chunk.w_after[i] = after.world_from_root.w();
    chunk.z_after[i] = after.world_from_root.z();
    chunk.ahead_mps[i] = avatars[i].ahead_mps;
    chunk.gaits[i] = &posing.gait_of(first + static_cast<uint32_t>(i));
    chunk.present[i] = avatars[i].is_present ? 1 : 0;
    chunk.stretch[i] = avatars[i].stretch;
    for (size_t n = 0; n < 4; ++n)
      chunk.landing[n][i] = bodies.yields.empty() ? 0 : bodies.yields[first + i].landing_m[n];
  }
  const auto bring = [&](const std::vector<float>& from, WalkChunk::Numbers& to) {
    std::copy_n(from.data() + first, chunk.count, to);
  };
  const auto keep = [&](const WalkChunk::Numbers& from, std::vector<float>& to) {
    std::copy_n(from, chunk.count, to.data() + first);
  };
  bring(bodies.scales, chunk.scales);
  bring(bodies.gait_mps, chunk.gait_mps);
  bring(bodies.phases, chunk.phases);
  for (size_t i = 0; i < WalkChunk::kFeetNumbers; ++i) bring(bodies.feet[i], chunk.feet[i]);
  for (size_t i = 0; i < WalkChunk::kMomentumNumbers; ++i)
    bring(bodies.momentum[i], chunk.momentum[i]);
  if (bodies.standing_seed) stand(avatars, first, bodies, chunk);
  std::array<WalkPosture, WalkChunk::kRoom> scratch;
  const bool fills_registers = chunk.count % WalkChunk::kMostLanes == 0;
  chunk.postures = fills_registers ? bodies.postures.data() + first : scratch.data();
  Gait::walk(chunk, target);
  keep(chunk.gait_mps, bodies.gait_mps);
  keep(chunk.phases, bodies.phases);
  for (size_t i = 0; i < WalkChunk::kFeetNumbers; ++i) keep(chunk.feet[i], bodies.feet[i]);
  if (!chunk.gaits[0]->has_legs()) return;
  for (size_t i = 0; i < WalkChunk::kMomentumNumbers; ++i)
    keep(chunk.momentum[i], bodies.momentum[i]);
  keep(chunk.room_x, bodies.room_x);
  keep(chunk.room_y, bodies.room_y);
  if (!fills_registers) std::copy_n(scratch.data(), chunk.count, bodies.postures.data() + first);
}

void glide_on(const Posing& posing, float speed_mps, double walked_m, uint32_t id,
              BodyStates& bodies) {
  bodies.gait_mps[id] = speed_mps;
  if (walked_m == 0) return;
  const double stride_m =
      static_cast<double>(posing.gait_of(id).stride_length_m(speed_mps, bodies.scales[id]));
  bodies.phases[id] = phase_of(static_cast<double>(bodies.phases[id]) + walked_m / stride_m);
}

}  // namespace throng
