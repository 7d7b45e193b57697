// Feet in one step, one person per lane. Included after stepping_legs-inl.h, inside the namespace
// of the lanes F.

// A step is due when a planted foot is off by a 17 degree turn or a foot's width.
inline constexpr float kComfort_rad = 0.3f;
inline constexpr float kComfortShare = 0.12f;  // of the leg length
inline constexpr float kBeforeLift_s = 0.25f;
// Cycles per second of such steps: minimum, maximum, and of a step that has begun and must end.
inline constexpr float kMinSteppingRate_hz = 1.2f;
inline constexpr float kMaxSteppingRate_hz = 1.6f;
inline constexpr float kFinishingRate_hz = 0.9f;
// A step that is hardly due is slower, but not delayed for long.
inline constexpr float kMinStepUrgency = 0.3f, kStepUrgencyGain = 15;
// Below this speed steps end earlier than the distance walked implies: no one stands on one leg.
inline constexpr float kSlow_mps = 0.2f;
inline constexpr float kBrisk_mps = 0.8f;
// Maximum turn of a foot against the body: the hip's limit of 40 degrees, less the outward angle of
// the toes. At landing the pelvis takes a part.
inline constexpr float kMaxTurn_rad = 0.58f;
inline constexpr float kMaxLandingTurnOut_rad = 0.42f;
// Maximum body turn over a foot in stance; faster turns need more frequent steps.
inline constexpr float kMaxStanceTurn_rad = 0.87f;
// A foot at the hip's limit turns about its contact, which advances by this much in a cycle.
inline constexpr float kContactTravel_m = 0.25f;
// Maximum offset of a foot, in leg lengths. Landing points are nearer, to avoid clipping and to
// leave a reserve for body avoidance.
inline constexpr float kMaxShiftShare = 0.4f;
inline constexpr float kMaxLandingShare = 0.38f, kMaxTargetShare = 0.3f;
// Lift on the spot, relative to the step and at most; for 4 cm a straight knee bends by 33 degrees.
inline constexpr float kLiftShare = 0.4f;
inline constexpr float kMaxLift_m = 0.04f;
inline constexpr float kLift_mps = 0.16f;  // per second in the air
// Time constant of the gait speed: the swing of the legs fades with the steps.
inline constexpr float kEasing_s = 0.25f;
inline constexpr float kMinEasing_mps2 = 0.2f;  // reaches the target in finite time
// Time in which the phase catches up with a foot left behind by a slowing body.
inline constexpr float kCatchUp_s = 0.12f;
inline constexpr float kMaxCatchUp_hz = 0.35f;
// Maximum change of cadence, in cycles per second per second: hips and knees follow it.
inline constexpr float kCadenceChange_hz_ps = 14;
// Maximum cadence, even if a body with short strides is moved fast.
inline constexpr float kMaxCadence_hz = 1.9f;
// Limits on speed and acceleration of a foot in the air, which is at rest when it lands. They take
// precedence over the landing place. For a leg of 0.9 m they mean 2500 degrees/s2, for a hip 206
// degrees/s and 3400 degrees/s2. That is two thirds and a third of the limits of `realism joints`;
// the gait needs the rest.
inline constexpr float kFoot_mps2 = 40, kFootTurn_radps = 3.6f, kFootTurn_radps2 = 60;
// Sideways limit: 165 degrees/s; less while turning, which also moves the knee sideways.
inline constexpr float kFootAside_mps = 2.6f, kAsidePerTurn_m = 0.28f;
inline constexpr float kJump_m = 1;

THRONG_LANES F smooth(F u) { return u * u * (3.0f - 2.0f * u); }
THRONG_LANES F length(F x, F y) { return sqrt_of(x * x + y * y); }
/// Wraps phases that have advanced by less than a cycle to [0, 1).
THRONG_LANES F wrapped(F phase) {
  const F rest = phase - floor_of(phase);
  return select(rest < 1.0f, rest, 0.0f);
}
THRONG_LANES F own_phase(F phase, size_t side) { return side == 0 ? phase : wrapped(phase + 0.5f); }

/// Motion of a root in its previous axes, in metres of the world.
struct Motion {
  F forward, left;
  F turn, turn_sin, turn_cos;
  F scale, per_scale;
  float step_s;
};

THRONG_LANES Motion motion_of(const WalkBatch& c, size_t i) {
  const F w = load(c.w_before + i), z = load(c.z_before + i);
  const F w_after = load(c.w_after + i), z_after = load(c.z_after + i);
  const F cos = w * w - z * z, sin = 2.0f * (w * z);
  const F x = load(c.displacement_x_m + i), y = load(c.displacement_y_m + i);
  F half_cos = w * w_after + z * z_after, half_sin = w * z_after - z * w_after;
  half_sin = select(half_cos < 0.0f, 0.0f - half_sin, half_sin);
  half_cos = abs_of(half_cos);
  Motion m;
  m.forward = cos * x + sin * y;
  m.left = cos * y - sin * x;
  const Direction half[1] = {{half_sin, half_cos}};
  F half_turn[1];
  angles_of(half, half_turn);
  m.turn = 2.0f * half_turn[0];
  m.turn_cos = half_cos * half_cos - half_sin * half_sin;
  m.turn_sin = 2.0f * (half_sin * half_cos);
  m.scale = load(c.scales + i);
  m.per_scale = inverse_of(m.scale);
  m.step_s = c.step_s;
  return m;
}

/// Returns the gait speed, which follows the root's forward speed with a delay.
THRONG_LANES F eased(F gait_mps, F speed_mps, float step_s) {
  const F change = max_of(speed_mps, 0.0f) - gait_mps;
  const F size = abs_of(change);
  const F by = max_of(step_s / (kEasing_s + step_s) * size, min_of(size, kMinEasing_mps2 * step_s));
  return select(change > 0.0f, gait_mps + by, gait_mps - by);
}

THRONG_LANES F rate_of(const SteppingTables& t, const Motion& m, F stride_m, F phase,
                       const Track& track, const Feet& feet) {
  const float per_s = 1 / m.step_s, per_comfort_m = 1 / (kComfortShare * t.leg_length_m);
  const F speed = max_of(m.forward, 0.0f) * per_s;
  const F per_stride = inverse_of(stride_m);
  const F finishing_rate = kFinishingRate_hz * max_of(1.0f - speed * (1 / kSlow_mps), 0.0f);
  F turn_need = 0.0f, offset_square = 0.0f, finishing = 0.0f, behind = 0.0f;
  for (size_t side = 0; side < 2; ++side) {
    const F own = own_phase(phase, side);
    const M is_swinging = own >= track.stance;
    finishing = select(is_swinging, finishing_rate, finishing);
    const F x = feet.x[side], y = feet.y[side], turned = feet.turn[side];
    // Grows over stance to keep the rate continuous.
    const F late = clamped(3.0f * own - 0.6f * track.stance, 0.0f, track.stance);
    behind = max_of(behind, select(is_swinging, 0.0f, 0.0f - x * late * inverse_of(track.stance)));
    // Offset by the time the foot can be lifted. A foot landed turned into the curve is in place.
    const F turn_now = abs_of(turned - kBeforeLift_s * per_s * m.turn) * (1 / kComfort_rad);
    const M lags = (!is_swinging) & (turned * m.turn <= 0.0f),
            trails = (!is_swinging) & (x * m.forward + y * m.left <= 0.0f);
    turn_need = max_of(turn_need, select(lags, turn_now, 0.0f));
    offset_square = max_of(offset_square, select(trails, x * x + y * y, 0.0f));
  }
  const F need = max_of(turn_need, sqrt_of(offset_square) * per_comfort_m);
  // In stance a foot moves through its whole comfort range.
  const F aside = abs_of(m.left) + max_of(0.0f - m.forward, 0.0f);
  const F travel = max_of(abs_of(m.turn) * (1 / kComfort_rad), aside * m.per_scale * per_comfort_m);
  const F stepping =
      clamped(0.5f * track.stance * travel * per_s, kMinSteppingRate_hz, kMaxSteppingRate_hz);
  const F due = 2.0f * need - 1.0f;
  const F urgency =
      clamped(max_of(due, min_of(kStepUrgencyGain * due, kMinStepUrgency)), 0.0f, 1.0f);
  const F slow = max_of(1.0f - speed * (1 / kBrisk_mps), 0.0f);
  const F catching_up = select(
      speed > 0.0f, min_of(behind * m.scale * per_stride * (1 / kCatchUp_s), kMaxCatchUp_hz), 0.0f);
  const F turning =
      min_of(track.stance * abs_of(m.turn) * (per_s / kMaxStanceTurn_rad), kMaxSteppingRate_hz) *
      min_of(speed * (1 / kSlow_mps), 1.0f);
  return max_of(max_of(max_of(speed * per_stride + catching_up, finishing), turning),
                slow * stepping * urgency);
}

/// Turn at landing for a body that turns by 2 `turn` over the foot; symmetric within the limits.
THRONG_LANES F turn_at_landing(F turn, size_t side) {
  constexpr float kUsed_rad = 0.95f * kMaxTurn_rad;
  const float left = side == 0 ? kUsed_rad : kMaxLandingTurnOut_rad,
              right = side == 0 ? kMaxLandingTurnOut_rad : kUsed_rad;
  return clamped(select(turn > 0.0f, max_of(turn, 2.0f * turn - kUsed_rad),
                        min_of(turn, 2.0f * turn + kUsed_rad)),
                 -right, left);
}

/// Landing points that the body passes in the middle of stance, if the root's motion continues.
struct Landing {
  F x[2], y[2], turn[2];
};
THRONG_LANES Landing landing_of(const Motion& m, F rate, const Track& track) {
  const F ahead_s =
      min_of(0.5f * track.stance * inverse_of(max_of(rate, 1e-3f)), LandingLimits::kMaxAhead_s);
  const float per_s = 1 / m.step_s;
  const F turn = clamped(m.turn * per_s * ahead_s, -kMaxTurn_rad, kMaxTurn_rad);
  F sin, cos;
  sin_cos_of(0.5f * turn, sin, cos);
  const F whole_cos = cos * cos - sin * sin, whole_sin = 2.0f * (sin * cos);
  // The chord of an arc is shorter than the arc: sin(a/2) / (a/2).
  const F chord = ahead_s * per_s * m.per_scale * (1.0f - turn * turn * (1.0f / 24));
  const F forward = chord * m.forward, sideways = chord * m.left;
  const F lands_x = track.x_at(0.0f), passes_x = track.x_at(0.5f * track.stance);
  Landing to;
  for (size_t side = 0; side < 2; ++side) {
    const F left = side == 0 ? min_of(sideways, LandingLimits::kMaxClosing_m)
                             : max_of(sideways, -LandingLimits::kMaxClosing_m);
    const F y = track.side[side];
    to.x[side] = cos * forward - sin * left + (whole_cos * passes_x - whole_sin * y) - lands_x;
    to.y[side] = sin * forward + cos * left + (whole_sin * passes_x + whole_cos * y) - y;
    to.turn[side] = turn_at_landing(turn, side);
  }
  return to;
}

THRONG_LANES void shorten(float max_m, F& x, F& y) {
  const F square = x * x + y * y;
  if (!any(square > max_m * max_m)) return;
  const F share = min_of(max_m * inverse_sqrt_of(max_of(square, 1e-12f)), 1.0f);
  x = x * share;
  y = y * share;
}

/// Limits the foot to legs and bounds: beyond them it is dragged along.
THRONG_LANES void keep_in_reach(const SteppingTables& t, F natural_x, F natural_y, F contact_m,
                                F& x, F& y, F& turn) {
  const F allowed = clamped(turn, -kMaxTurn_rad, kMaxTurn_rad), forced = allowed - turn;
  x = x + contact_m * forced * allowed;
  y = y - contact_m * forced;
  turn = allowed;
  shorten(kMaxShiftShare * t.leg_length_m, x, y);
  const F at_x = natural_x + x, at_y = natural_y + y;
  const F away = at_x * at_x + at_y * at_y;
  // For a foot that has rolled on to its toes this point is behind it.
  const float farthest_m = 1.2f * t.upright_m;
  const M beyond = away > farthest_m * farthest_m;
  if (!any(beyond)) return;
  const F share = farthest_m * inverse_sqrt_of(max_of(away, 1e-12f));
  x = select(beyond, share * at_x - natural_x, x);
  y = select(beyond, share * at_y - natural_y, y);
}

/// Rates of feet in the air towards their landing, indexed as WalkBatch::gait_rates.
struct GaitRates {
  F swing[WalkBatch::kFeetNumbers];
  F cadence;
};

struct Swinging {
  F left;    ///< fraction of the swing that remains before this step
  F left_s;  ///< its duration
  F share;   ///< share of it in this step
  float step_s;
};

/// Advances a number of a swinging foot to rest at `goal`. For a constant goal a cubic: smooth().
THRONG_LANES void swing_to(const Swinging& s, F goal, F max_speed_ps, float max_acceleration_ps2,
                           F& number, F& speed) {
  const F start_rate = speed * s.left, u = s.share;
  const F max_acceleration = max_acceleration_ps2 * (s.left_s * s.left_s);
  const F pull = clamped(6.0f * (goal - number) - 4.0f * start_rate, 0.0f - max_acceleration,
                         max_acceleration);
  const F end_rate = start_rate + pull;
  const F target = start_rate + u * (pull - u * end_rate);
  // Maximum speed from which it can still come to rest.
  const F until_s = s.left_s * (1.0f - u) + s.step_s;
  const F max_speed = min_of(max_speed_ps, max_acceleration_ps2 * until_s) * s.left_s;
  const F new_rate = clamped(target, 0.0f - max_speed, max_speed);
  const F clamped_rate = clamped(start_rate, 0.0f - max_speed, max_speed);
  number = number + u * select(abs_of(target) > max_speed, 0.5f * (clamped_rate + new_rate),
                               start_rate + u * (0.5f * pull - u * (1.0f / 3) * end_rate));
  speed = new_rate * inverse_of(max_of(s.left, 1e-6f));
}

/// Advances the three numbers of a foot and their speeds; a standing foot has speed 0.
THRONG_LANES void swing_foot(const Swinging& s, const F (&goals)[3], M stands, F (&numbers)[3],
                             F* speeds) {
  constexpr float kUnlimitedSpeed_mps = 100;
  swing_to(s, goals[0], kUnlimitedSpeed_mps, kFoot_mps2, numbers[0], speeds[0]);
  swing_to(s, goals[2], kFootTurn_radps, kFootTurn_radps2, numbers[2], speeds[2]);
  const F turn_radps = speeds[2] * s.left * inverse_of(max_of(s.left_s, 1e-6f));
  const F aside_mps = kFootAside_mps - kAsidePerTurn_m * abs_of(turn_radps);
  swing_to(s, goals[1], aside_mps, kFoot_mps2, numbers[1], speeds[1]);
  for (size_t n = 0; n < 3; ++n) speeds[n] = select(stands, 0.0f, speeds[n]);
}

/// Lift at the share v of a step, of which 1 / per_left remains before the offset is zero.
THRONG_LANES F lift_of(F off_x, F off_y, F off_turn, F per_left, F swing_s, F v) {
  constexpr float kArm_m = 0.2f;  // lever arm: half a foot, nearly
  const F step_m = (length(off_x, off_y) + kArm_m * abs_of(off_turn)) * min_of(per_left, 100.0f);
  const F arch = 4.0f * v * (1.0f - v);
  return min_of(kLiftShare * step_m, min_of(kLift_mps * swing_s, kMaxLift_m)) * arch * arch;
}

/// Moves the feet with the root and returns the next phase.
THRONG_LANES F step_feet(const SteppingTables& t, const Motion& m, const Track& before,
                         const Track& after, F stride_scale, const F (&landing)[4], F phase,
                         Feet& feet, GaitRates& gait_rates) {
  const F stride_m = max_of(after.stride, t.min_stride_m) * m.scale * stride_scale;
  const F target = min_of(rate_of(t, m, stride_m, phase, before, feet), kMaxCadence_hz);
  const F cadence = gait_rates.cadence;
  const float change = kCadenceChange_hz_ps * m.step_s;
  const F rate =
      select(cadence < 0.0f, target, clamped(target, cadence - change, cadence + change));
  gait_rates.cadence = rate;
  const F next = wrapped(phase + rate * m.step_s);
  Landing goal = landing_of(m, rate, after);
  for (size_t side = 0; side < 2; ++side) {
    shorten(kMaxTargetShare * t.leg_length_m, goal.x[side], goal.y[side]);
    goal.x[side] = goal.x[side] + landing[2 * side];
    goal.y[side] = goal.y[side] + landing[2 * side + 1];
    shorten(kMaxLandingShare * t.leg_length_m, goal.x[side], goal.y[side]);
  }
  const F forward = m.forward * m.per_scale, left = m.left * m.per_scale;
  const F per_swing = inverse_of(1.0f - after.stance);
  const F swing_s = inverse_of(max_of(rate * per_swing, 1e-3f));
  const F lifting = max_of(1.0f - after.stride * t.per_leg_length, 0.0f);
  for (size_t side = 0; side < 2; ++side) {
    const F own = own_phase(phase, side), own_next = own_phase(next, side);
    const F natural_x = after.x_at(own_next), natural_y = after.side[side];
    const F x = feet.x[side], y = feet.y[side], turned = feet.turn[side];
    // In stance the ground and the foot move back under the body.
    const F old_x = before.x_at(own) + x - forward, old_y = before.side[side] + y - left;
    const M stood = own < before.stance;
    F stance_x = select(stood, m.turn_cos * old_x + m.turn_sin * old_y - natural_x, x);
    F stance_y = select(stood, m.turn_cos * old_y - m.turn_sin * old_x - natural_y, y);
    F stance_turn = select(stood, turned - m.turn, turned);
    keep_in_reach(t, natural_x, natural_y, kContactTravel_m * own_next, stance_x, stance_y,
                  stance_turn);
    const F u = (max_of(own, after.stance) - after.stance) * per_swing;
    const F v = (own_next - after.stance) * per_swing;
    const F left_before = 1.0f - smooth(min_of(u, 1.0f));
    const F per_left = inverse_of(max_of(left_before, 1e-6f));
    const F left_share = 1.0f - min_of(u, 1.0f);
    const Swinging swinging = {left_share, left_share * swing_s,
                               clamped((v - u) * inverse_of(max_of(left_share, 1e-6f)), 0.0f, 1.0f),
                               m.step_s};
    F in_air[3] = {x, y, turned};
    const M stands = own_next < after.stance;
    swing_foot(swinging, {goal.x[side], goal.y[side], goal.turn[side]}, stands, in_air,
               gait_rates.swing + 3 * side);
    const F off_x = x - goal.x[side], off_y = y - goal.y[side], off_turn = turned - goal.turn[side];
    feet.x[side] = select(stands, stance_x, in_air[0]);
    feet.y[side] = select(stands, stance_y, in_air[1]);
    feet.turn[side] = select(stands, stance_turn, in_air[2]);
    feet.lift[side] =
        select(stands, 0.0f, lift_of(off_x, off_y, off_turn, per_left, swing_s, v) * lifting);
  }
  return next;
}

THRONG_LANES Feet load_feet(const WalkBatch& c, size_t i) {
  Feet feet;
  for (size_t side = 0; side < 2; ++side) {
    feet.x[side] = load(c.feet[3 * side] + i);
    feet.y[side] = load(c.feet[3 * side + 1] + i);
    feet.turn[side] = load(c.feet[3 * side + 2] + i);
    feet.lift[side] = load(c.lift_m[side] + i);
  }
  return feet;
}

THRONG_LANES void store_feet(const Feet& feet, WalkBatch& c, size_t i) {
  for (size_t side = 0; side < 2; ++side) {
    store(feet.x[side], c.feet[3 * side] + i);
    store(feet.y[side], c.feet[3 * side + 1] + i);
    store(feet.turn[side], c.feet[3 * side + 2] + i);
    store(feet.lift[side], c.lift_m[side] + i);
  }
}

THRONG_LANES void limit_standing(const SteppingTables& t, F share, WalkBatch& c, size_t i) {
  const F max_m = t.max_shift_m * share;
  store(clamped(load(c.shift_m + i), 0.0f - max_m, max_m), c.shift_m + i);
  store(clamped(load(c.breath + i), 0.0f, share), c.breath + i);
}

THRONG_LANES void store_posture(const F (&posture)[16], const F (&packed_bounds)[2], WalkBatch& c,
                                size_t i) {
  store(packed_bounds[0], c.bounds_x + i);
  store(packed_bounds[1], c.bounds_y + i);
  for (size_t quad = 0; quad < 4; ++quad) {
    const F four[4] = {posture[4 * quad], posture[4 * quad + 1], posture[4 * quad + 2],
                       posture[4 * quad + 3]};
    store_rows(four, [&](size_t lane) { return c.postures[i + lane].numbers + 4 * quad; });
  }
}

THRONG_LANES GaitRates load_gait_rates(const WalkBatch& c, size_t i) {
  GaitRates gait_rates;
  for (size_t n = 0; n < WalkBatch::kFeetNumbers; ++n)
    gait_rates.swing[n] = load(c.gait_rates[n] + i);
  gait_rates.cadence = load(c.gait_rates[WalkBatch::kCadence] + i);
  return gait_rates;
}

THRONG_LANES void store_pelvis_drop(const PelvisDrop& now, WalkBatch& c, size_t i) {
  store(now.drop, c.next_pelvis_drop[0] + i);
  store(now.speed_mps, c.next_pelvis_drop[1] + i);
}

THRONG_LANES void store_step(const Track& track, const Place& at, WalkBatch& c, size_t i) {
  const F tracks[4] = {track.side[0], track.side[1], track.toes_out_sin, track.toes_out_cos};
  const F places[4] = {at.node, at.cell, at.u, at.v};
  for (size_t n = 0; n < 4; ++n) {
    store(tracks[n], c.track[n] + i);
    store(places[n], c.place[n] + i);
  }
}

THRONG_LANES void load_step(const WalkBatch& c, size_t i, Track& track, Place& at) {
  track.side[0] = load(c.track[0] + i);
  track.side[1] = load(c.track[1] + i);
  track.toes_out_sin = load(c.track[2] + i);
  track.toes_out_cos = load(c.track[3] + i);
  at = {load(c.place[0] + i), load(c.place[1] + i), load(c.place[2] + i), load(c.place[3] + i)};
}

/// Computes the feet of the lanes from i on. Prefetches the tables for their legs.
THRONG_LANES void walk_feet(const SteppingTables& t, WalkBatch& c, size_t i) {
  const M present = load(c.present + i) > 0.0f;
  const F gait_before = load(c.gait_mps + i), ahead = load(c.ahead_mps + i);
  const F phase = load(c.phases + i);
  const Motion motion = motion_of(c, i);
  const M fresh = (gait_before < 0.0f) |
                  (motion.forward * motion.forward + motion.left * motion.left > kJump_m * kJump_m);
  const F before = max_of(gait_before, 0.0f);
  const F after = select(fresh, max_of(ahead, 0.0f), eased(before, ahead, c.step_s));
  const Feet feet_before = load_feet(c, i);
  Feet feet = feet_before;
  const F gait_now = select(present, after, gait_before);
  const F sqrt_speed = sqrt_speed_of(t, gait_now, motion.per_scale);
  const Speeds speeds = speeds_around(t, c.tables.data() + i, sqrt_speed);
  const Track track = track_of(t, speeds, sqrt_speed);
  const Track track_before = track_of(t, speeds, sqrt_speed_of(t, before, motion.per_scale));
  const F landing[4] = {load(c.landing[0] + i), load(c.landing[1] + i), load(c.landing[2] + i),
                        load(c.landing[3] + i)};
  const GaitRates old_rates = load_gait_rates(c, i);
  GaitRates gait_rates = old_rates;
  const F next = step_feet(t, motion, track_before, track, load(c.stride_scale + i), landing, phase,
                           feet, gait_rates);
  const auto settled = [&](F value, F when_fresh, F when_away) {
    return select(present, select(fresh, when_fresh, value), when_away);
  };
  for (size_t side = 0; side < 2; ++side) {
    feet.x[side] = settled(feet.x[side], 0.0f, feet_before.x[side]);
    feet.y[side] = settled(feet.y[side], 0.0f, feet_before.y[side]);
    feet.turn[side] = settled(feet.turn[side], 0.0f, feet_before.turn[side]);
    feet.lift[side] = settled(feet.lift[side], 0.0f, 0.0f);
  }
  store_feet(feet, c, i);
  for (size_t n = 0; n < WalkBatch::kFeetNumbers; ++n)
    store(settled(gait_rates.swing[n], 0.0f, old_rates.swing[n]), c.gait_rates[n] + i);
  store(settled(gait_rates.cadence, -1.0f, old_rates.cadence),
        c.gait_rates[WalkBatch::kCadence] + i);
  store(select(fresh, -1.0f, load(c.gait_rates[WalkBatch::kPelvisDrop] + i)),
        c.gait_rates[WalkBatch::kPelvisDrop] + i);
  const F phase_now = settled(next, phase, phase);
  store(phase_now, c.phases + i);
  store(gait_now, c.gait_mps + i);
  const Place at = place_of(t, speeds, phase_now, sqrt_speed);
  store_step(track, at, c, i);
  limit_standing(t, clamped(track.standing, 0.0f, 1.0f), c, i);
  int32_t nodes[kLaneCount];
  store_whole(at.node, nodes);
  for (size_t lane = 0; lane < kLaneCount; ++lane) {
    const float* node = c.tables[i + lane] + t.node(nodes[lane]);
    for (const float* row : {node, node + t.speed_node_stride()}) {
      __builtin_prefetch(row);
      __builtin_prefetch(row + SteppingTables::kNodeFloats);
    }
  }
}

THRONG_LANES void walk_legs(const SteppingTables& t, WalkBatch& c, size_t i) {
  const Feet feet = load_feet(c, i);
  Track track;
  Place at;
  load_step(c, i, track, at);
  F posture[16], packed_bounds[2];
  const Standing standing = {load(c.shift_m + i), load(c.breath + i)};
  const PelvisDrop before = {load(c.gait_rates[WalkBatch::kPelvisDrop] + i),
                             load(c.gait_rates[WalkBatch::kPelvisDropSpeed] + i)};
  PelvisDrop now;
  store(legs_of(t, c.tables.data() + i, feet, standing, before, c.step_s, at, track, posture,
                packed_bounds, now),
        c.out_of_reach + i);
  store_pelvis_drop(now, c, i);
  store_posture(posture, packed_bounds, c, i);
}
