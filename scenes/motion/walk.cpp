#include "scenes/motion/walk.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "avatars/stepping/standing.h"
#include "base/portable_math.h"

namespace throng {

Eigen::Quaternionf rotation_by(float angle_rad) {
  const FloatSinCos half = float_sin_cos(0.5f * angle_rad);
  return Eigen::Quaternionf(half.cos, 0, 0, half.sin);
}

namespace {

/// Updates the sway of standing people: breathing and weight shifts.
void stand(std::span<const WalkInput> avatars, uint32_t first, BodyStates& bodies,
           WalkBatch& batch) {
  const float still_m = kStanding_mps * batch.step_s;
  for (size_t i = 0; i < avatars.size(); ++i) {
    const uint32_t id = first + static_cast<uint32_t>(i);
    const float x = batch.displacement_x_m[i], y = batch.displacement_y_m[i];
    const bool stands = avatars[i].is_present && x * x + y * y < still_m * still_m;
    if (!stands && bodies.standing_time_s[id] == 0) continue;
    bodies.standing_time_s[id] =
        advance_standing_time(bodies.standing_time_s[id], stands, batch.step_s);
    const float share = standing_share(bodies.standing_time_s[id]);
    if (share == 0) continue;
    const QuietStanding adds = quiet_standing(*bodies.standing_seed, id, bodies.now_s);
    if (avatars[i].shifts_weight) batch.shift_m[i] = share * adds.shift_m;
    batch.breath[i] = share * adds.breath;
  }
}

}  // namespace

void advance_walk(const Posing& posing, std::span<const WalkInput> avatars, double step_s,
                  uint32_t first, SimdTarget target, BodyStates& bodies) {
  assert(avatars.size() <= WalkBatch::kCapacity);
  WalkBatch batch;
  batch.count = avatars.size();
  batch.step_s = static_cast<float>(step_s);
  for (size_t i = 0; i < avatars.size(); ++i) {
    const RootPose &before = avatars[i].before, &after = bodies.roots[first + i];
    batch.displacement_x_m[i] = static_cast<float>(after.position_m.x() - before.position_m.x());
    batch.displacement_y_m[i] = static_cast<float>(after.position_m.y() - before.position_m.y());
    batch.w_before[i] = before.world_from_root.w();
    batch.z_before[i] = before.world_from_root.z();
    batch.w_after[i] = after.world_from_root.w();
    batch.z_after[i] = after.world_from_root.z();
    batch.ahead_mps[i] = avatars[i].ahead_mps;
    batch.gaits[i] = &posing.gait_of(first + static_cast<uint32_t>(i));
    batch.present[i] = avatars[i].is_present ? 1 : 0;
    batch.stride_scale[i] = avatars[i].stride_scale;
    for (size_t n = 0; n < 4; ++n)
      batch.landing[n][i] = bodies.avoidance.empty() ? 0 : bodies.avoidance[first + i].landing_m[n];
  }
  const auto bring = [&](const std::vector<float>& from, WalkBatch::Numbers& to) {
    std::copy_n(from.data() + first, batch.count, to);
  };
  const auto keep = [&](const WalkBatch::Numbers& from, std::vector<float>& to) {
    std::copy_n(from, batch.count, to.data() + first);
  };
  bring(bodies.scales, batch.scales);
  bring(bodies.gait_mps, batch.gait_mps);
  bring(bodies.phases, batch.phases);
  for (size_t i = 0; i < WalkBatch::kFeetNumbers; ++i) bring(bodies.feet[i], batch.feet[i]);
  for (size_t i = 0; i < WalkBatch::kGaitRateCount; ++i)
    bring(bodies.gait_rates[i], batch.gait_rates[i]);
  if (bodies.standing_seed) stand(avatars, first, bodies, batch);
  std::array<WalkPosture, WalkBatch::kCapacity> scratch;
  const bool fills_registers = batch.count % WalkBatch::kMaxLanes == 0;
  batch.postures = fills_registers ? bodies.postures.data() + first : scratch.data();
  Gait::walk(batch, target);
  keep(batch.gait_mps, bodies.gait_mps);
  keep(batch.phases, bodies.phases);
  for (size_t i = 0; i < WalkBatch::kFeetNumbers; ++i) keep(batch.feet[i], bodies.feet[i]);
  if (!batch.gaits[0]->has_legs()) return;
  for (size_t i = 0; i < WalkBatch::kGaitRateCount; ++i)
    keep(batch.gait_rates[i], bodies.gait_rates[i]);
  keep(batch.bounds_x, bodies.bounds_x);
  keep(batch.bounds_y, bodies.bounds_y);
  if (!fills_registers) std::copy_n(scratch.data(), batch.count, bodies.postures.data() + first);
}

void advance_phase(const Posing& posing, float speed_mps, double walked_m, uint32_t id,
                   BodyStates& bodies) {
  bodies.gait_mps[id] = speed_mps;
  if (walked_m == 0) return;
  const double stride_m =
      static_cast<double>(posing.gait_of(id).stride_length_m(speed_mps, bodies.scales[id]));
  bodies.phases[id] = phase_of(static_cast<double>(bodies.phases[id]) + walked_m / stride_m);
}

}  // namespace throng
