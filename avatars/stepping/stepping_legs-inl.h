// Legs, one person per lane: closed-form inverse kinematics of two links for given feet, and the
// resulting box. Included by stepping_scalar.cpp and stepping_simd.cpp, inside the namespace of
// their lanes F.

struct Feet {
  F x[2], y[2], turn[2], lift[2];
};

struct Standing {
  F shift, breath;
};

THRONG_LANES F inverse_sqrt_of(F a) { return 1.0f / sqrt_of(a); }
THRONG_LANES F clamped(F x, F low, F high) { return min_of(max_of(x, low), high); }

/// Returns the direction with this sine, clamped to [-1, 1], and a cosine of at least 0.
THRONG_LANES Direction direction_of_sine(F sine) {
  const F s = clamped(sine, -1.0f, 1.0f);
  return {s, sqrt_of(max_of(1.0f - s * s, 0.0f))};
}

struct Point {
  F x, y, z;
};
THRONG_LANES Point operator+(const Point& a, const Point& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
THRONG_LANES Point operator-(const Point& a, const Point& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
THRONG_LANES Point operator*(F s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
THRONG_LANES F dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

struct Turn {
  Point x, y, z;  ///< columns
};
THRONG_LANES Point operator*(const Turn& t, const std::array<float, 3>& p) {
  return F(p[0]) * t.x + F(p[1]) * t.y + F(p[2]) * t.z;
}
THRONG_LANES Point operator*(const Turn& t, const SignedAxis& axis) {
  return F(axis.sign) * (axis.index == 0 ? t.x : axis.index == 1 ? t.y : t.z);
}
/// Applies a turn about the zero posture's y axis before `frame`.
THRONG_LANES Turn turned_y(const Turn& frame, F sin, F cos) {
  return {cos * frame.x - sin * frame.z, frame.y, sin * frame.x + cos * frame.z};
}

THRONG_LANES Turn turn_of(F x, F y, F z) {
  const F w = sqrt_of(max_of(1.0f - (x * x + y * y + z * z), 0.0f));
  const F x2 = x + x, y2 = y + y, z2 = z + z;
  const F xx = x * x2, xy = x * y2, xz = x * z2, yy = y * y2, yz = y * z2, zz = z * z2;
  const F wx = w * x2, wy = w * y2, wz = w * z2;
  return {{1.0f - (yy + zz), xy + wz, xz - wy},
          {xy - wz, 1.0f - (xx + zz), yz + wx},
          {xz + wy, yz - wx, 1.0f - (xx + yy)}};
}

struct LegReach {
  Point hip;
  Turn frame;   ///< forward, the knee's axis, and up in the plane in which the leg bends
  Point ankle;  ///< relative to the hip
  F along, up;  ///< the ankle in that plane
};

/// The foot leans with its leg about the point where it stands: hip, knee and foot share a plane.
/// The fixed lateral offset of the foot's middle from the hip determines the tilt.
THRONG_LANES void reach_for(const LegParameters& leg, const Point& ground, F height, F forward_x,
                            F forward_y, LegReach& r) {
  const Point d = ground - r.hip;
  const F y = d.y * forward_x - d.x * forward_y;
  const F inverse = inverse_sqrt_of(max_of(y * y + d.z * d.z, 1e-6f));
  const F cos = clamped(leg.ankle_side_m * inverse, -1.0f, 1.0f);
  const F sin = sqrt_of(max_of(1.0f - cos * cos, 0.0f));
  const F tilt_cos = (y * cos - d.z * sin) * inverse;
  const F tilt_sin = (d.z * cos + y * sin) * inverse;
  r.frame.x = {forward_x, forward_y, 0.0f};
  r.frame.y = {0.0f - tilt_cos * forward_y, tilt_cos * forward_x, tilt_sin};
  r.frame.z = {tilt_sin * forward_y, 0.0f - tilt_sin * forward_x, tilt_cos};
  // On the sole's edge; sin (1 + sin^2 / 2) approximates the tangent.
  const F lean = abs_of(tilt_sin) * (1.0f + 0.5f * (tilt_sin * tilt_sin));
  const F over = height + leg.sole_half_width_m * lean;
  r.ankle = d + over * r.frame.z;
  r.along = d.x * forward_x + d.y * forward_y;
  r.up = dot(d, r.frame.z) + over;
}

/// Returns the drop of a hip at which its leg is long enough.
THRONG_LANES F drop_for(const LegParameters& leg, const LegReach& r) {
  const F aside = r.ankle.x * r.ankle.x + r.ankle.y * r.ankle.y;
  return 0.0f - r.ankle.z - sqrt_of(max_of(leg.max_reach2_m2 - aside, 0.0f));
}

// Lead with which the pelvis sinks before a leg is too short; smaller near the gait's own place.
inline constexpr float kDropLead_m = 0.04f;
// Limits below the pelvis's rates in plain walking (`realism joints`).
inline constexpr float kMaxDropSpeed_mps = 0.12f, kMaxDropAcceleration_mps2 = 1.5f;

/// Maximum of two numbers, rounded off where they differ by less than `round`.
THRONG_LANES F smooth_max(F a, F b, F round) {
  const F overlap = max_of(round - abs_of(a - b), 0.0f);
  return max_of(a, b) + overlap * overlap * 0.25f / max_of(round, 1e-6f);
}

/// Returns the approximate offset of a foot from its place in the gait: a turn counts at the toes.
THRONG_LANES F displacement_of(const Feet& feet, size_t side, const Standing& standing) {
  constexpr float kToes_m = 0.2f;
  return abs_of(feet.x[side]) + abs_of(feet.y[side]) + abs_of(feet.lift[side]) +
         abs_of(feet.turn[side]) * kToes_m + abs_of(standing.shift);
}

struct PelvisDrop {
  F drop, speed_mps;
};
THRONG_LANES PelvisDrop follow_drop(const PelvisDrop& before, F target, float step_s) {
  const F left = target - before.drop, size = abs_of(left);
  // The highest speed from which it can still stop at the target.
  const F max_speed =
      min_of(min_of(size * (1 / step_s), sqrt_of(1.4f * kMaxDropAcceleration_mps2 * size)),
             kMaxDropSpeed_mps);
  const F change = select(left < 0.0f, 0.0f - max_speed, max_speed) - before.speed_mps;
  const F speed_mps = before.speed_mps + clamped(change, -kMaxDropAcceleration_mps2 * step_s,
                                                 kMaxDropAcceleration_mps2 * step_s);
  // Comes to rest, or is there at once for an avatar that has just entered.
  const M is_there = (before.drop < 0.0f) | ((size < 1e-5f) & (abs_of(before.speed_mps) < 1e-2f));
  return {select(is_there, target, max_of(before.drop + step_s * speed_mps, 0.0f)),
          select(is_there, 0.0f, speed_mps)};
}

/// A foot of the gait: its contact with the ground, the ankle's height above it, its pitch.
struct Stand {
  Point ground;
  F height, pitch;
};

struct Rolled {
  F ahead, height;
};

THRONG_LANES Rolled rolled(const LegParameters& leg, F pitch) {
  const F at =
      max_of((pitch - LegParameters::kMinPitch_rad) * LegParameters::kRollsPerRadian, 0.0f);
  const F node = min_of(floor_of(at), static_cast<float>(LegParameters::kRolls - 1));
  int32_t nodes[kLaneCount];
  store_whole(node, nodes);
  F roll[4];
  load_rows([&](size_t lane) { return &leg.rolls[static_cast<size_t>(nodes[lane])].ahead_m; },
            roll);
  const F share = at - node;
  return {roll[0] + share * roll[2], roll[1] + share * roll[3]};
}

// A foot behind the body rolls over its toes by up to this angle before the pelvis sinks.
inline constexpr float kMaxHeelRaise_rad = 0.4f;
// Initial slope of reach; the secant step that follows is nearly exact.
inline constexpr float kRaisePerMetre_rad = 6;

/// Pitches a foot down by this angle, without sliding.
THRONG_LANES Stand tipped(const LegParameters& leg, F forward_x, F forward_y, const Stand& stand,
                          const Rolled& before, F by) {
  const Rolled after = rolled(leg, stand.pitch - by);
  const F ahead = after.ahead - before.ahead;
  return {{stand.ground.x + ahead * forward_x, stand.ground.y + ahead * forward_y, stand.ground.z},
          stand.height + (after.height - before.height),
          stand.pitch - by};
}

// A heel strikes ahead of the body. Nearer than this the foot lands flatter, and behind the body
// flat: raised toes would obstruct a heel that has to rise.
inline constexpr float kFlatter_m = 0.08f;

/// Lowers the toes of a foot that is `moved_m` ahead of its place in the gait.
THRONG_LANES void lower_toes(const LegParameters& leg, F forward_x, F forward_y, F moved_m,
                             Stand& stand, LegReach& r) {
  const F unmoved = clamped(r.along - moved_m, 1e-3f, kFlatter_m);
  const F share = clamped(r.along * inverse_of(unmoved), 0.0f, 1.0f);
  const F lowers = (1.0f - share) * max_of(stand.pitch, 0.0f);
  const M is_lower = lowers > 1e-4f;
  if (!any(is_lower)) return;
  const F by = select(is_lower, lowers, 0.0f);
  stand = tipped(leg, forward_x, forward_y, stand, rolled(leg, stand.pitch), by);
  reach_for(leg, stand.ground, stand.height, forward_x, forward_y, r);
}

/// Raises the heel of a foot far behind the body until the leg is long enough.
THRONG_LANES void raise_heel(const LegParameters& leg, F forward_x, F forward_y, Stand& stand,
                             LegReach& r) {
  const auto too_long = [&leg](const LegReach& reach) {
    return sqrt_of(dot(reach.ankle, reach.ankle)) - leg.max_reach_m;
  };
  const F deficit_m = too_long(r);
  const M behind = (deficit_m > 0.0f) & (r.along < 0.0f);
  if (!any(behind)) return;
  const Rolled before = rolled(leg, stand.pitch);
  const F first = select(behind, min_of(deficit_m * kRaisePerMetre_rad, kMaxHeelRaise_rad), 0.0f);
  const Stand tried = tipped(leg, forward_x, forward_y, stand, before, first);
  LegReach reach = r;
  reach_for(leg, tried.ground, tried.height, forward_x, forward_y, reach);
  const F gain_m = max_of(deficit_m - too_long(reach), 1e-4f);
  const F raise = select(
      behind, clamped(first * deficit_m * inverse_of(gain_m), 0.0f, kMaxHeelRaise_rad), 0.0f);
  stand = tipped(leg, forward_x, forward_y, stand, before, raise);
  reach_for(leg, stand.ground, stand.height, forward_x, forward_y, r);
}

struct Bounds {
  F low_x, low_y, high_x, high_y;
  void extend(const Point& middle, F half_x, F half_y) {
    low_x = min_of(low_x, middle.x - half_x);
    low_y = min_of(low_y, middle.y - half_y);
    high_x = max_of(high_x, middle.x + half_x);
    high_y = max_of(high_y, middle.y + half_y);
  }
  void extend(const Point& middle, F radius) { extend(middle, radius, radius); }
};

// Ten times the measured error: single precision, arcs good to 2e-6, and nodes blended as positions
// instead of angles.
inline constexpr float kLegRoundingMargin_m = 1e-3f;

/// Whether sphere and cylinder contain a ball; both are convex: two balls bound a limb.
THRONG_LANES M holds(const SteppingTables& t, const Point& p, float radius) {
  const F across = p.x * p.x + p.y * p.y, up = p.z - t.sphere_z_m;
  const float upright = t.upright_m - radius - kLegRoundingMargin_m,
              ball = t.sphere_m - radius - kLegRoundingMargin_m;
  return (across <= upright * upright) & (across + up * up <= ball * ball);
}

/// Returns whether they contain a foot, by the box corner farthest along each of their axes.
THRONG_LANES M holds_foot(const SteppingTables& t, const LegParameters& leg, const Point& p,
                          const Turn& foot) {
  const std::array<float, 3>& half = leg.foot_half_m;
  const float square = half[0] * half[0] + half[1] * half[1] + half[2] * half[2];
  const auto flat = [&p](const Point& axis) { return abs_of(p.x * axis.x + p.y * axis.y); };
  const Point q = {p.x, p.y, p.z - t.sphere_z_m};
  const auto full = [&q](const Point& axis) { return abs_of(dot(q, axis)); };
  const F across =
      p.x * p.x + p.y * p.y + square +
      2.0f * (half[0] * flat(foot.x) + half[1] * flat(foot.y) + half[2] * flat(foot.z));
  const F away = dot(q, q) + square +
                 2.0f * (half[0] * full(foot.x) + half[1] * full(foot.y) + half[2] * full(foot.z));
  const float upright = t.upright_m - kLegRoundingMargin_m,
              ball = t.sphere_m - kLegRoundingMargin_m;
  return (across <= upright * upright) & (away <= ball * ball);
}

/// Bends a leg to reach its ankle; writes hip, knee and ankle angles to `angles`. At the knee's
/// limits the ankle is as near as possible; at the ankle's, the foot tilts. Returns whether joints
/// and the bounds of all postures allow it.
THRONG_LANES M bend(const SteppingTables& t, const LegParameters& leg, const LegReach& r,
                    const Turn& pelvis, F pitch, F* angles, Bounds& bounds) {
  // Cosine rule for links that need not be in line in the zero posture.
  const F target = (r.along * r.along + r.up * r.up - leg.square_sum_m2) * leg.per_twice_product;
  const F bend_cos = clamped(target, leg.max_bend_cos, leg.min_bend_cos);
  const F bend_sin = sqrt_of(max_of(1.0f - bend_cos * bend_cos, 0.0f));
  const F knee_sin = leg.straight_sin * bend_cos + leg.straight_cos * bend_sin;
  const F knee_cos = leg.straight_cos * bend_cos - leg.straight_sin * bend_sin;
  const F chain_x = leg.thigh_m[0] + (knee_cos * leg.shank_m[0] + knee_sin * leg.shank_m[1]);
  const F chain_z = leg.thigh_m[1] + (knee_cos * leg.shank_m[1] - knee_sin * leg.shank_m[0]);
  const F across = chain_z * r.along - chain_x * r.up, along = chain_x * r.along + chain_z * r.up;
  const F inverse = inverse_sqrt_of(max_of(across * across + along * along, 1e-12f));
  const F sin = across * inverse, cos = along * inverse;
  const auto in_plane = [&r](F x, F z, float side) {
    return r.hip + x * r.frame.x + F(side) * r.frame.y + z * r.frame.z;
  };
  const Point knee_at = in_plane(cos * leg.thigh_m[0] + sin * leg.thigh_m[1],
                                 cos * leg.thigh_m[1] - sin * leg.thigh_m[0], leg.knee_side_m);
  const Point ankle_at =
      in_plane(cos * chain_x + sin * chain_z, cos * chain_z - sin * chain_x, leg.ankle_side_m);
  // pelvis^T thigh = turn(a1, q1) turn(a2, q2) turn(a3, q3) over perpendicular axes.
  const Turn thigh = turned_y(r.frame, sin, cos);
  const Point end = thigh * leg.axis3, p1 = pelvis * leg.axis1;
  const Direction directions[5] = {{dot(pelvis * leg.axis13, end), dot(pelvis * leg.axis3, end)},
                                   direction_of_sine(leg.hand * dot(p1, end)),
                                   {dot(p1, thigh * leg.axis13), dot(p1, thigh * leg.axis1)},
                                   {bend_sin, bend_cos},
                                   {sin, cos}};
  F turns[5];
  angles_of(directions, turns);
  const F knee = leg.straight_rad + turns[3], shank = turns[4] + knee;
  const F ankle =
      clamped((0.0f - pitch - shank) * leg.ankle_sign, leg.lower_rad[4], leg.upper_rad[4]);
  for (size_t i = 0; i < 3; ++i) angles[i] = turns[i];
  angles[3] = knee * leg.knee_sign;
  angles[4] = ankle;

  F tilt_sin, tilt_cos;
  sin_cos_of(shank + ankle * leg.ankle_sign, tilt_sin, tilt_cos);
  const Turn foot = turned_y(r.frame, tilt_sin, tilt_cos);
  const Point middle = ankle_at + foot * leg.foot_middle_m;
  bounds.extend(r.hip, leg.thigh_radius_m);
  bounds.extend(knee_at, leg.knee_radius_m);
  bounds.extend(ankle_at, leg.shank_radius_m);
  const std::array<float, 3>& half = leg.foot_half_m;
  const auto extent = [&half](F x, F y, F z) {
    return half[0] * abs_of(x) + half[1] * abs_of(y) + half[2] * abs_of(z);
  };
  bounds.extend(middle, extent(foot.x.x, foot.y.x, foot.z.x), extent(foot.x.y, foot.y.y, foot.z.y));

  M allowed = holds(t, knee_at, leg.knee_radius_m) & holds(t, ankle_at, leg.shank_radius_m) &
              holds_foot(t, leg, middle, foot);
  for (size_t i = 0; i < 3; ++i)
    allowed = allowed & (angles[i] >= leg.lower_rad[i]) & (angles[i] <= leg.upper_rad[i]);
  return allowed;
}

THRONG_LANES F sqrt_speed_of(const SteppingTables& t, F speed_mps, F per_scale) {
  return min_of(sqrt_of(max_of(speed_mps, 0.0f) * per_scale * t.per_leg_length), t.max_sqrt_speed);
}

THRONG_LANES F whole_of(F x, int last) { return min_of(floor_of(x), static_cast<float>(last)); }

struct Track {
  F stance, shift, side[2], stride, toes_out_sin, toes_out_cos, standing;
  F x_at(F own_phase) const { return stride * (0.5f * stance - own_phase) + shift; }
};

/// Rows of the tables around a lane's speed.
struct Speeds {
  F row;
  F slow[8], fast[8];
};

THRONG_LANES Speeds speeds_around(const SteppingTables& t, const float* const* tables,
                                  F sqrt_speed) {
  Speeds s;
  s.row = whole_of(sqrt_speed * t.cells_per_sqrt_speed, t.speeds - 2);
  int32_t cell[kLaneCount];
  store_whole(s.row, cell);
  for (size_t quad = 0; quad < 8; quad += 4) {
    F slow[4], fast[4];
    load_rows([&](size_t lane) { return tables[lane] + t.track(cell[lane]) + quad; }, slow);
    load_rows([&](size_t lane) { return tables[lane] + t.track(cell[lane] + 1) + quad; }, fast);
    for (size_t i = 0; i < 4; ++i) {
      s.slow[quad + i] = slow[i];
      s.fast[quad + i] = fast[i];
    }
  }
  return s;
}

/// Extrapolates for speeds slightly outside the two rows.
THRONG_LANES Track track_of(const SteppingTables& t, const Speeds& s, F sqrt_speed) {
  const F v = sqrt_speed * t.cells_per_sqrt_speed - s.row;
  const auto blend = [&](size_t i) { return s.slow[i] + v * (s.fast[i] - s.slow[i]); };
  return {blend(0), blend(1), {blend(2), blend(3)}, blend(4), blend(5), blend(6), blend(7)};
}

struct Place {
  F node, cell;  ///< indices
  F u, v;        ///< fractions towards the next phase and the next speed
};

THRONG_LANES Place place_of(const SteppingTables& t, const Speeds& s, F phase, F sqrt_speed) {
  const F x = phase * static_cast<float>(t.phases), column = whole_of(x, t.phases - 1);
  return {s.row * static_cast<float>(t.phases + 1) + column,
          s.row * static_cast<float>(t.phases) + column, x - column,
          sqrt_speed * t.cells_per_sqrt_speed - s.row};
}

/// Packs two numbers of grains: the low one rounded down, the high one rounded up.
THRONG_LANES F grains_of(const SteppingTables& t, F low_m, F high_m) {
  constexpr auto kMax = static_cast<float>(SteppingTables::kGrains - 1);
  const F low = floor_of((low_m - kLegRoundingMargin_m - t.corner_m) * t.per_grain);
  const F high = floor_of((high_m + kLegRoundingMargin_m - t.corner_m) * t.per_grain) + 1.0f;
  return max_of(low, 0.0f) * static_cast<float>(SteppingTables::kGrains) + min_of(high, kMax);
}

/// Computes WalkPosture and WalkBounds. Returns the feet that joints or bounds do not allow, as in
/// WalkBatch::out_of_reach.
THRONG_LANES F legs_of(const SteppingTables& t, const float* const* tables, const Feet& feet,
                       const Standing& standing, const PelvisDrop& before, float step_s,
                       const Place& at, const Track& track, F (&posture)[16], F (&packed_bounds)[2],
                       PelvisDrop& now) {
  int32_t nodes[kLaneCount], cells[kLaneCount];
  store_whole(at.node, nodes);
  store_whole(at.cell, cells);
  F node[SteppingTables::kNodeFloats];
  blend_rows([&](size_t lane) { return tables[lane] + t.node(nodes[lane]); }, t.speed_node_stride(),
             at.u, at.v, node);
  const Turn pelvis = turn_of(node[10], node[11], node[12]);
  const Point middle = {node[13], node[14] + standing.shift, node[15]};
  Stand stands[2];
  F forward_x[2], forward_y[2];
  LegReach reach[2];
  F drop = 0.0f;
  for (size_t side = 0; side < 2; ++side) {
    const LegParameters& leg = t.legs[side];
    const F* foot = node + 5 * side;
    F sin, cos;
    sin_cos_of(feet.turn[side], sin, cos);
    const F toes_sin = side == 0 ? 0.0f - track.toes_out_sin : track.toes_out_sin;
    forward_x[side] = cos * track.toes_out_cos - sin * toes_sin;
    forward_y[side] = sin * track.toes_out_cos + cos * toes_sin;
    reach[side].hip = middle + pelvis * leg.hip_m;
    // A foot turns about its landing point, not about its rolled contact.
    stands[side] = {
        {foot[0] + feet.x[side] + foot[3] * forward_x[side],
         track.side[side] + feet.y[side] + foot[3] * forward_y[side], foot[1] + feet.lift[side]},
        foot[2],
        foot[4]};
    reach_for(leg, stands[side].ground, foot[2], forward_x[side], forward_y[side], reach[side]);
    lower_toes(leg, forward_x[side], forward_y[side],
               feet.x[side] * forward_x[side] + feet.y[side] * forward_y[side], stands[side],
               reach[side]);
    raise_heel(leg, forward_x[side], forward_y[side], stands[side], reach[side]);
    drop = smooth_max(drop, drop_for(leg, reach[side]),
                      min_of(displacement_of(feet, side, standing), kDropLead_m));
  }
  now = follow_drop(before, min_of(drop, t.max_drop_m), step_s);
  now.drop = drop = min_of(now.drop, t.max_drop_m);
  if (any(drop > 0.0f))
    for (size_t side = 0; side < 2; ++side) {
      reach[side].hip.z = reach[side].hip.z - drop;
      reach_for(t.legs[side], stands[side].ground, stands[side].height, forward_x[side],
                forward_y[side], reach[side]);
    }
  F rest[4];
  load_rows([&](size_t lane) { return tables[lane] + t.box(cells[lane]); }, rest);
  // Parts that do not hang from the hips move along; a breath moves none of them farther than `by`.
  const F by = standing.breath * t.max_breath_m;
  Bounds bounds = {rest[0] - by, rest[1] + standing.shift - by, rest[2] + by,
                   rest[3] + standing.shift + by};
  F out_of_reach = 0.0f;
  for (size_t side = 0; side < 2; ++side) {
    const M allowed =
        bend(t, t.legs[side], reach[side], pelvis, stands[side].pitch, posture + 5 * side, bounds);
    out_of_reach = out_of_reach + select(allowed, 0.0f, static_cast<float>(side + 1));
  }
  posture[WalkPosture::kDrop] = drop;
  posture[WalkPosture::kNode] = at.node;
  posture[WalkPosture::kU] = at.u;
  posture[WalkPosture::kV] = at.v;
  posture[WalkPosture::kShift] = standing.shift;
  posture[WalkPosture::kBreath] = standing.breath;
  packed_bounds[0] = grains_of(t, bounds.low_x, bounds.high_x);
  packed_bounds[1] = grains_of(t, bounds.low_y, bounds.high_y);
  return out_of_reach;
}
