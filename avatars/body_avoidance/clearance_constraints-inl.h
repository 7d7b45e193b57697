// Clearance constraints between a body and those near it, one constraint per lane, and the trunk
// rotation and arm tuck that satisfy them. Included inside the namespace of the lanes F, after
// base/simd/angles-inl.h.

// Distance to keep from a constraint, because bodies sway and lean. Arms keep more, because their
// position is known to a sixteenth of a cycle only.
inline constexpr float kMargin_m = 0.02f, kArmMargin_m = 0.04f;
// Constraints this soon count fully; their weight falls to zero at kAvoidanceHorizon_s.
inline constexpr float kImmediate_s = 0.45f;

inline constexpr size_t kMaxConstraints = 4 * kMaxAvoidedBodies + 2 * kMaxAvoidedWalls;
using ConstraintNumbers = float[kMaxConstraints + kLaneCount];
struct ClearanceConstraints {          // NOLINT(clang-analyzer-optin.performance.Padding)
  alignas(64) ConstraintNumbers x, y;  ///< first the other's predicted position, then the direction
  alignas(64) ConstraintNumbers direction;
  alignas(64) ConstraintNumbers trunk_clearance_m, arm_clearance_m;  ///< at scale 1
  alignas(64) ConstraintNumbers weight;
  alignas(64) ConstraintNumbers ahead_s;
  const BodyState2d* other[kMaxConstraints + kLaneCount];
  const LimbOutlines* own[kMaxConstraints + kLaneCount];  ///< at their predicted phase
  size_t count = 0;

  THRONG_LANES void copy(size_t from, size_t to) {
    for (float* numbers : {x, y, direction, trunk_clearance_m, arm_clearance_m, weight, ahead_s})
      numbers[to] = numbers[from];
    other[to] = other[from];
    own[to] = own[from];
  }
  /// Fills the lanes after the last constraint with constraints of weight 0.
  THRONG_LANES void fill(size_t last) {
    for (size_t i = last + 1; i % kLaneCount != 0; ++i) {
      copy(last, i);
      weight[i] = 0;
    }
  }
};

/// Converts an angle to directions of RadialProfile, from 0 to once around.
THRONG_LANES F direction_of(F angle) {
  constexpr float kFullCircle = RadialProfile::kDirections;
  const F direction = angle * RadialProfile::kPerRadian;
  return max_of(direction - kFullCircle * floor_of(direction * (1 / kFullCircle)), 0.0f);
}

template <typename Of>
THRONG_LANES void load_octagons(const Of& of, F (&reaches)[8]) {
  F four[4];
  for (size_t part = 0; part < 2; ++part) {
    load_rows([&](size_t lane) { return of(lane).reaches_m.data() + 4 * part; }, four);
    for (size_t i = 0; i < 4; ++i) reaches[4 * part + i] = four[i];
  }
}
THRONG_LANES void set_octagon(const Octagon& octagon, F (&reaches)[8]) {
  for (size_t i = 0; i < 8; ++i) reaches[i] = octagon.reaches_m[i];
}

THRONG_LANES F across_of(const F (&reaches)[8], F y) {
  return select(y > 0.0f, reaches[2], reaches[6]);
}
THRONG_LANES F reach_in(const F (&reaches)[8], F x, F y) {
  constexpr float kDiagonal = 1.41421356f;
  const F ahead = abs_of(x), aside = abs_of(y);
  const M is_ahead = x > 0.0f, is_left = y > 0.0f;
  const F oblique = select(is_ahead, select(is_left, reaches[1], reaches[7]),
                           select(is_left, reaches[3], reaches[5]));
  const F nearest =
      select(ahead > aside, select(is_ahead, reaches[0], reaches[4]), across_of(reaches, y));
  return abs_of(ahead - aside) * nearest + kDiagonal * min_of(ahead, aside) * oblique;
}

struct Tuck {
  F tuck, swing_damping;
};
THRONG_LANES Tuck tuck_of(F share) {
  const F u = max_of(share - ArmTuck::kTuckShare, 0.0f) * (1 / (1 - ArmTuck::kTuckShare));
  return {min_of(share * (1 / ArmTuck::kTuckShare), 1.0f), u * u * (2.0f - u)};
}
THRONG_LANES F share_of(F swing_damping) {
  // Root of the cubic: a guess slightly above it, and one Newton step.
  const F guess = sqrt_of(swing_damping / (2.0f - sqrt_of(swing_damping)));
  const F less = (guess * guess * (2.0f - guess) - swing_damping) /
                 (max_of(guess, 1e-12f) * (4.0f - 3.0f * guess));
  return ArmTuck::kTuckShare + (1 - ArmTuck::kTuckShare) * (guess - less);
}

/// Reach of an arm in a direction, and how much tucking and damping reduce it.
struct ArmReach {
  F swing_m, tuck_gain_m, damping_gain_m;
};
THRONG_LANES ArmReach arm_reach(const F (&sweep)[8], const F (&tucked)[8], F x, F y) {
  const F swing_m = reach_in(sweep, x, y);
  const F tuck_gain_m = abs_of(y) * (across_of(sweep, y) - across_of(tucked, y));
  return {swing_m, tuck_gain_m, swing_m - reach_in(tucked, x, y) - tuck_gain_m};
}

/// Reach in a direction: trunk with tucked arms; these and the thighs; all in the current posture.
struct BodyReach {
  F trunk_m, firm_m, whole_m;
};
struct Stance {
  F scale, turn, turn_sin, turn_cos;
  Tuck arms[2];
};
THRONG_LANES Stance stance_of(F scale, F turn, F right, F left) {
  Stance stance = {scale, turn, {}, {}, {tuck_of(right), tuck_of(left)}};
  sin_cos_of(turn, stance.turn_sin, stance.turn_cos);
  return stance;
}
struct Shapes {
  const Outline* outline[kLaneCount];
  const LimbOutlines* limbs[kLaneCount];
};
THRONG_LANES BodyReach reach_of(const Stance& stance, const Shapes& shapes, const F (&tucked)[2][8],
                                F x, F y, F angle) {
  alignas(64) int32_t whole[kLaneCount];
  alignas(64) float low[kLaneCount], high[kLaneCount];
  const F direction = direction_of(angle - stance.turn);
  store_whole(direction, whole);
  for (size_t lane = 0; lane < kLaneCount; ++lane) {
    const float* reach_m = shapes.outline[lane]->upper.from(whole[lane]);
    low[lane] = reach_m[0];
    high[lane] = reach_m[1];
  }
  F octagon[8];
  const F trunk = load(low) + (direction - floor_of(direction)) * (load(high) - load(low));
  F firm = trunk;
  for (size_t side = 0; side < 2; ++side) {
    load_octagons([&](size_t lane) -> const Octagon& { return shapes.limbs[lane]->thighs[side]; },
                  octagon);
    firm = max_of(firm, reach_in(octagon, x, y));
  }
  const F ahead = stance.turn_cos * x + stance.turn_sin * y,
          left = stance.turn_cos * y - stance.turn_sin * x;
  F all = firm;
  for (size_t side = 0; side < 2; ++side) {
    load_octagons([&](size_t lane) -> const Octagon& { return shapes.limbs[lane]->arms[side]; },
                  octagon);
    const ArmReach arm = arm_reach(octagon, tucked[side], ahead, left);
    const Tuck& in = stance.arms[side];
    all = max_of(all,
                 arm.swing_m - in.tuck * arm.tuck_gain_m - in.swing_damping * arm.damping_gain_m);
  }
  return {stance.scale * trunk, stance.scale * firm, stance.scale * all};
}

/// Sway of trunks to the left, from now to `ahead_s`.
THRONG_LANES F sway_offset(F sway_m, F phase, F cadence_hz, F ahead_s) {
  const F from = phase - static_cast<float>(GaitCurves::kSwayPhase);
  return sway_m * (sin_of_turns(from) - sin_of_turns(from + ahead_s * cadence_hz));
}

/// Upper bound on the reach of bodies in a direction.
THRONG_LANES F max_extent_in(const F (&max_extent)[4], F turn, F x, F y) {
  const F ahead = max_extent[0], oblique = max_extent[1], aside = max_extent[2],
          maximum = max_extent[3];
  const F octagon[8] = {ahead, oblique, aside, oblique, ahead, oblique, aside, oblique};
  return select(abs_of(turn) > 0.0f, maximum, reach_in(octagon, x, y));
}

/// Times at which a neighbour may be within reach: up to four per neighbour, plus one register.
struct Approaches {
  static constexpr size_t kPerBody = 4;
  static constexpr size_t kMax = kPerBody * kMaxAvoidedBodies + kLaneCount;
  using Numbers = float[kMax];
  alignas(64) Numbers ahead_s;
  const BodyState2d* other[kMax];
  uint8_t first[kMax];  ///< index of the same body's time of closest approach
  alignas(64) Numbers x, y, distance2_m2, weight;
  alignas(64) Numbers may_touch;  ///< 1: perhaps; 0: both are certainly clear of each other
  size_t count = 0;

  void add(const BodyState2d& body, float time_s, size_t nearest, bool counts) {
    ahead_s[count] = time_s;
    other[count] = &body;
    first[count] = static_cast<uint8_t>(nearest);
    count += counts ? 1 : 0;
  }
};

inline constexpr float kIgnoredTime_s = kAvoidanceHorizon_s;
inline constexpr float kReach2_m2 = kAvoidanceReach_m * kAvoidanceReach_m;

/// Finds the times to check for each neighbour: closest approach, now, halfway and shortly after.
THRONG_LANES void find_approaches(const BodyState2d& own,
                                  std::span<const BodyState2d* const> neighbours,
                                  Approaches& approaches) {
  constexpr float kNegligible_s = 0.05f;
  // Trunks sway and arms swing. Bodies may be nearer a quarter of a cycle after the closest
  // approach, and arms behind them pass each other after the trunks.
  constexpr float kSway_s = 0.25f, kAfter_s = 0.15f;
  constexpr float kSwayReach_m = kAvoidanceReach_m + 0.2f;  // sway is smaller than this addition
  constexpr float kSwayReach2_m2 = kSwayReach_m * kSwayReach_m;
  using OfEach = float[kMaxAvoidedBodies + kLaneCount];
  alignas(64) OfEach ahead_s[Approaches::kPerBody], distance2_m2[Approaches::kPerBody];
  for (size_t i = 0; i < neighbours.size(); i += kLaneCount) {
    F place[4];
    load_rows(
        [&](size_t lane) { return &neighbours[std::min(i + lane, neighbours.size() - 1)]->x_m; },
        place);
    const F dx = place[0] - own.x_m, dy = place[1] - own.y_m;
    const F vx = place[2] - own.vx_mps, vy = place[3] - own.vy_mps;
    const F closing = 0.0f - (dx * vx + dy * vy), speed2 = max_of(vx * vx + vy * vy, 1e-4f);
    const F nearest_s = min_of(max_of(closing / speed2, 0.0f), kAvoidanceHorizon_s);
    const M is_now = nearest_s < kNegligible_s;
    const F times[Approaches::kPerBody] = {select(is_now, 0.0f, nearest_s),
                                           select(is_now, kSway_s, 0.0f),
                                           select(is_now, kIgnoredTime_s, 0.5f * nearest_s),
                                           select(is_now, kIgnoredTime_s, nearest_s + kAfter_s)};
    for (size_t k = 0; k < Approaches::kPerBody; ++k) {
      const F x = dx + times[k] * vx, y = dy + times[k] * vy;
      store(times[k], ahead_s[k] + i);
      store(x * x + y * y, distance2_m2[k] + i);
    }
  }
  // Neighbours that are out of reach at their closest approach are dropped.
  for (size_t n = 0; n < neighbours.size(); ++n) {
    // Set above, register by register. NOLINTNEXTLINE(clang-analyzer-core.*)
    const bool is_close = distance2_m2[0][n] <= kSwayReach2_m2;
    const size_t nearest = approaches.count;
    approaches.add(*neighbours[n], ahead_s[0][n], nearest, is_close);
    for (size_t k = 1; k < Approaches::kPerBody; ++k)
      approaches.add(
          *neighbours[n], ahead_s[k][n], nearest,
          is_close && ahead_s[k][n] < kIgnoredTime_s && distance2_m2[k][n] <= kSwayReach2_m2);
  }
  for (size_t i = approaches.count; i % kLaneCount != 0; ++i) {
    approaches.ahead_s[i] = kIgnoredTime_s;
    approaches.other[i] = neighbours.front();
  }
}

/// Predicts positions of neighbours, from the i-th time on.
THRONG_LANES void look_ahead(const BodyState2d& own, size_t i, Approaches& approaches) {
  // The margins of two arms, see tuck_for(), and rounding.
  constexpr float kClear_m = 2 * kArmMargin_m + 0.001f;
  const BodyState2d* const* other = approaches.other + i;
  F place[4], heading[4], motion[4];
  load_rows([&](size_t lane) { return &other[lane]->x_m; }, place);
  load_rows([&](size_t lane) { return &other[lane]->cos; }, heading);
  load_rows([&](size_t lane) { return &other[lane]->turn_rad; }, motion);
  const F scale = motion[3];
  const F ahead_s = load(approaches.ahead_s + i);
  alignas(64) float discs[kLaneCount], sways[kLaneCount];
  for (size_t lane = 0; lane < kLaneCount; ++lane) {
    discs[lane] = other[lane]->disc_m;
    sways[lane] = other[lane]->sway_m;
  }
  const F own_sway = sway_offset(own.sway_m, own.phase, own.cadence_hz, ahead_s);
  const F other_sway = sway_offset(load(sways), heading[2], heading[3], ahead_s);
  const F x = place[0] - own.x_m + ahead_s * (place[2] - own.vx_mps) - other_sway * heading[1] +
              own_sway * own.sin;
  const F y = place[1] - own.y_m + ahead_s * (place[3] - own.vy_mps) + other_sway * heading[0] -
              own_sway * own.cos;
  const F distance2 = x * x + y * y;
  const F left = (kAvoidanceHorizon_s - ahead_s) * (1 / (kAvoidanceHorizon_s - kImmediate_s));
  store(x, approaches.x + i);
  store(y, approaches.y + i);
  store(distance2, approaches.distance2_m2 + i);
  store(min_of(left, 1.0f), approaches.weight + i);

  static constexpr MaxExtent kDisc;
  F max_extent[4], own_max_extent[4];
  const auto max_extent_of = [](const BodyState2d& body) {
    return &(body.sweep != nullptr ? body.sweep->max_extent() : kDisc).ahead_m;
  };
  load_rows([&](size_t lane) { return max_extent_of(*other[lane]); }, max_extent);
  for (size_t n = 0; n < 4; ++n) own_max_extent[n] = max_extent_of(own)[n];
  const F apart = sqrt_of(distance2);
  const F away_x = x / max_of(apart, 1e-6f), away_y = y / max_of(apart, 1e-6f);
  const F own_reach =
      own.scale * max_extent_in(own_max_extent, own.turn_rad, own.cos * away_x + own.sin * away_y,
                                own.cos * away_y - own.sin * away_x);
  const F reach =
      scale * max_extent_in(max_extent, motion[0], heading[0] * away_x + heading[1] * away_y,
                            heading[0] * away_y - heading[1] * away_x);
  const M is_clear = apart >= own_reach + reach + load(discs) + kClear_m * own.scale;
  store(select(is_clear, 0.0f, 1.0f), approaches.may_touch + i);
}

/// Finds constraints of neighbours within reach; false if none has a deficit in any posture.
THRONG_LANES bool find_constraints(const BodyState2d& own,
                                   std::span<const BodyState2d* const> neighbours,
                                   ClearanceConstraints& constraints) {
  Approaches approaches;
  find_approaches(own, neighbours, approaches);
  for (size_t i = 0; i < approaches.count; i += kLaneCount) look_ahead(own, i, approaches);
  float may_touch = 0;
  for (size_t i = 0; i < approaches.count; ++i) {
    const bool counts = approaches.weight[i] > 0 && approaches.distance2_m2[i] <= kReach2_m2 &&
                        approaches.distance2_m2[approaches.first[i]] <= kReach2_m2;
    constraints.x[constraints.count] = approaches.x[i];
    constraints.y[constraints.count] = approaches.y[i];
    constraints.ahead_s[constraints.count] = approaches.ahead_s[i];
    constraints.weight[constraints.count] = approaches.weight[i];
    constraints.other[constraints.count] = approaches.other[i];
    constraints.count += counts ? 1 : 0;
    may_touch = std::max(may_touch, counts ? approaches.may_touch[i] : 0);
  }
  return may_touch > 0;
}

/// Places the constraints from the i-th on in the middle of the gap between two bodies.
THRONG_LANES void set_clearances(const BodyState2d& own, const Stance& stance, size_t i,
                                 ClearanceConstraints& constraints) {
  const BodyState2d* const* other = constraints.other + i;
  const F world_x = load(constraints.x + i), world_y = load(constraints.y + i);
  const F apart = sqrt_of(world_x * world_x + world_y * world_y);
  const F per_apart = 1.0f / max_of(apart, 1e-6f);
  const F away_x = per_apart * world_x, away_y = per_apart * world_y;
  const F x = own.cos * away_x + own.sin * away_y, y = own.cos * away_y - own.sin * away_x;
  F heading[4], motion[4];
  load_rows([&](size_t lane) { return &other[lane]->cos; }, heading);
  load_rows([&](size_t lane) { return &other[lane]->turn_rad; }, motion);
  alignas(64) float discs[kLaneCount];
  for (size_t lane = 0; lane < kLaneCount; ++lane) discs[lane] = other[lane]->disc_m;
  const F other_x = 0.0f - (heading[0] * away_x + heading[1] * away_y),
          other_y = heading[1] * away_x - heading[0] * away_y;
  const Direction directions[2] = {{y, x}, {other_y, other_x}};
  F angles[2];
  angles_of(directions, angles);

  const F ahead_s = load(constraints.ahead_s + i);
  alignas(64) int32_t own_phase[kLaneCount], other_phase[kLaneCount];
  store_whole((own.phase + ahead_s * own.cadence_hz) * float{LimbSweep::kPhases} + 0.5f, own_phase);
  store_whole((heading[2] + ahead_s * heading[3]) * float{LimbSweep::kPhases} + 0.5f, other_phase);
  Shapes shapes;
  for (size_t lane = 0; lane < kLaneCount; ++lane) {
    shapes.outline[lane] = &own.sweep->outline();
    shapes.limbs[lane] = constraints.own[i + lane] = &own.sweep->at(own_phase[lane]);
  }
  F tucked[2][8];
  for (size_t side = 0; side < 2; ++side)
    set_octagon(own.sweep->outline().tucked[side], tucked[side]);
  const BodyReach own_reach = reach_of(stance, shapes, tucked, x, y, angles[0]);
  for (size_t lane = 0; lane < kLaneCount; ++lane) {
    const LimbSweep& sweep = other[lane]->sweep != nullptr ? *other[lane]->sweep : *own.sweep;
    shapes.outline[lane] = &sweep.outline();
    shapes.limbs[lane] = &sweep.at(other_phase[lane]);
  }
  for (size_t side = 0; side < 2; ++side)
    load_octagons([&](size_t lane) -> const Octagon& { return shapes.outline[lane]->tucked[side]; },
                  tucked[side]);
  const BodyReach other_reach = reach_of(stance_of(motion[3], motion[0], motion[1], motion[2]),
                                         shapes, tucked, other_x, other_y, angles[1]);

  const F disc = load(discs), per_scale = 1.0f / own.scale;
  const F of_disc = apart - disc;
  const M is_disc = disc > 0.0f;
  // The other's arm alone makes room for parts that cannot be tucked.
  const F arm_clearance =
      min_of(0.5f * (apart + own_reach.whole_m - other_reach.whole_m), apart - other_reach.firm_m);
  const F trunk_clearance = 0.5f * (apart + own_reach.trunk_m - other_reach.trunk_m);
  store(x, constraints.x + i);
  store(y, constraints.y + i);
  store(direction_of(angles[0]), constraints.direction + i);
  store(per_scale * select(is_disc, of_disc, trunk_clearance), constraints.trunk_clearance_m + i);
  store(per_scale * select(is_disc, of_disc, arm_clearance), constraints.arm_clearance_m + i);
}

/// Adds the wall's constraints for now and for kImmediate_s.
THRONG_LANES void add_wall(const BodyState2d& own, const WallState2d& wall,
                           ClearanceConstraints& constraints) {
  alignas(64) float direction[kLaneCount];
  store(direction_of(float_arc_tan2(wall.y, wall.x)), direction);
  for (const float ahead_s : {0.0f, kImmediate_s}) {
    const size_t i = constraints.count++;
    constraints.x[i] = wall.x;
    constraints.y[i] = wall.y;
    constraints.direction[i] = direction[0];
    constraints.trunk_clearance_m[i] = constraints.arm_clearance_m[i] =
        (wall.distance_m - ahead_s * wall.approach_mps) / own.scale;
    constraints.weight[i] = 1;
    constraints.ahead_s[i] = ahead_s;
    constraints.other[i] = nullptr;
    constraints.own[i] =
        &own.sweep->at(LimbSweep::phase_index(own.phase + ahead_s * own.cadence_hz));
  }
}

inline constexpr int kTurnsPerSide = 9;
inline constexpr size_t kTurns = 2 * kTurnsPerSide + 1;
inline constexpr float kTurn_rad = 1 / RadialProfile::kPerRadian;
// Half a metre of turned trunk costs as much as a deficit of 0.1 mm, squared.
inline constexpr float kEffort = 1e-4f;
// Assumed rate of a trunk rotation. Part of it takes effect at once.
inline constexpr float kTurnRate_rps = 1.5f, kMinTurnTime_s = 0.2f;
// A rotation with this much more deficit (squared) than another is left quickly.
inline constexpr float kUrgentDeficit_m2 = 1e-4f;
// An arm stays tucked by this share of the deficit at the worst time of its swing.
inline constexpr float kHoldShare = 0.5f;

/// Deficit of a trunk with tucked arms at one constraint, by trunk rotation. Index 0 is the
/// leftmost rotation: seen from a trunk turned to the left, a neighbour lies farther to the right.
/// Rotations that cannot be reached in time get the deficit of the reachable one.
class TrunkDeficit {
 public:
  /// `now`: current rotation as an index into kTurns.
  TrunkDeficit(const RadialProfile& upper, const ClearanceConstraints& constraints, size_t i,
               float now)
      : clearance_m_(constraints.trunk_clearance_m[i] - kMargin_m), weight_(constraints.weight[i]) {
    float from = constraints.direction[i] - kTurnsPerSide;
    if (from < 0) from += RadialProfile::kDirections;
    const auto whole = static_cast<int>(from);
    reach_m_ = upper.from(whole);
    share_ = from - static_cast<float>(whole);
    const float far = kTurnRate_rps * RadialProfile::kPerRadian *
                      std::max(constraints.ahead_s[i], kMinTurnTime_s);
    first_ = std::max(now - far, 0.0f);
    last_ = std::min(now + far, static_cast<float>(kTurns - 1));
    first_m_ = at(first_);
    last_m_ = at(last_);
  }

  /// Weighted squared deficits of a register of rotations, from the given one on.
  THRONG_LANES F from(size_t turn) const {
    static constexpr auto kNumbers = [] {
      std::array<float, kLanesOfTurns> numbers{};
      for (size_t i = 0; i < kLanesOfTurns; ++i) numbers[i] = static_cast<float>(i);
      return numbers;
    }();
    const F reach = load(reach_m_ + turn), next = load(reach_m_ + turn + 1);
    const F there = max_of(reach + share_ * (next - reach) - clearance_m_, 0.0f);
    const F number = load(kNumbers.data() + turn);
    const F deficit =
        select(number < first_, F(first_m_), select(number > last_, F(last_m_), there));
    return weight_ * deficit * deficit;
  }

  static constexpr size_t kLanesOfTurns = (kTurns + kLaneCount - 1) / kLaneCount * kLaneCount;

 private:
  float at(float turn) const {
    const float direction = share_ + turn;
    const auto whole = static_cast<int>(direction);
    const float* const reach_m = reach_m_ + whole;
    const float reach =
        reach_m[0] + (direction - static_cast<float>(whole)) * (reach_m[1] - reach_m[0]);
    return std::max(reach - clearance_m_, 0.0f);
  }

  const float* reach_m_;
  float share_, clearance_m_, weight_;
  float first_, last_;  ///< reachable rotations; the deficit at each is below
  float first_m_, last_m_;
};

/// Turns the trunk to the least sum of squared deficits with tucked arms.
THRONG_LANES void turn_trunk(const BodyState2d& own, const ClearanceConstraints& constraints,
                             AvoidanceMotion& target) {
  const Outline& outline = own.sweep->outline();
  const auto of_turn = [](float rad) { return kTurnsPerSide - rad * RadialProfile::kPerRadian; };
  const float now = std::clamp(of_turn(own.turn_rad), 0.0f, static_cast<float>(kTurns - 1));
  alignas(64) float costs[TrunkDeficit::kLanesOfTurns] = {};
  for (size_t i = 0; i < constraints.count; ++i) {
    if (constraints.trunk_clearance_m[i] - kMargin_m >= outline.upper.max_m()) continue;
    const TrunkDeficit deficit(outline.upper, constraints, i, now);
    for (size_t turn = 0; turn < TrunkDeficit::kLanesOfTurns; turn += kLaneCount)
      store(load(costs + turn) + deficit.from(turn), costs + turn);
  }
  const float after_half = now + 0.5f;  // rounds faster than lround()
  const float cost_now = costs[static_cast<size_t>(after_half)];
  const auto turn_of = [](size_t i) { return kTurn_rad * (kTurnsPerSide - static_cast<float>(i)); };
  const auto effort_of = [&](size_t i) { return kEffort * turn_of(i) * turn_of(i); };
  size_t best = kTurnsPerSide;
  for (size_t i = 0; i < kTurns; ++i) costs[i] += effort_of(i);
  for (size_t i = kTurns; i-- > 0;)
    if (costs[i] < costs[best]) best = i;
  target.is_urgent = cost_now > costs[best] - effort_of(best) + kUrgentDeficit_m2;
  float turn_rad = turn_of(best);
  if (best > 0 && best < kTurns - 1)
    turn_rad += kTurn_rad * parabola_minimum(costs[best + 1], costs[best], costs[best - 1]);
  constexpr float kWaist = 1 / (1 - kHipsShare);
  constexpr float kGaitTurn_rad = 0.1f;  // rotation of the waist in walking
  const AvoidanceColumns& columns = outline.columns;
  target.turn_rad = std::clamp(turn_rad, kWaist * (columns.min_trunk_rad + kGaitTurn_rad),
                               kWaist * (columns.max_trunk_rad - kGaitTurn_rad));
}

/// Returns the tuck that arms need to stay within constraints.
THRONG_LANES F tuck_for(const ArmReach& arm, F clearance_m) {
  constexpr float kMinDampingGain_m = 0.01f;  // smaller gains make no difference
  const F deficit = arm.swing_m + kArmMargin_m - clearance_m;
  const M is_more = (deficit > arm.tuck_gain_m) & (arm.damping_gain_m > kMinDampingGain_m);
  const F swing_damping = min_of(
      max_of((deficit - arm.tuck_gain_m) / max_of(arm.damping_gain_m, kMinDampingGain_m), 0.0f),
      1.0f);
  const F tuck = min_of(deficit / max_of(arm.tuck_gain_m, 1e-4f), 1.0f);
  const F share = select(is_more, share_of(swing_damping), ArmTuck::kTuckShare * tuck);
  return select(deficit > 0.0f, share, 0.0f);
}

/// Turns directions into the trunk's at each constraint's time, while it turns to turn_rad.
THRONG_LANES void turn_to_trunk(const BodyState2d& own, float turn_rad,
                                ClearanceConstraints& constraints) {
  const F to_go_rad = turn_rad - own.turn_rad;
  for (size_t i = 0; i < constraints.count; i += kLaneCount) {
    const F x = load(constraints.x + i), y = load(constraints.y + i);
    const F maximum = kTurnRate_rps * load(constraints.ahead_s + i);
    F sin, cos;
    sin_cos_of(own.turn_rad + max_of(min_of(to_go_rad, maximum), 0.0f - maximum), sin, cos);
    store(cos * x + sin * y, constraints.x + i);
    store(cos * y - sin * x, constraints.y + i);
  }
}

/// Returns the tuck with which an arm swings within all constraints (in trunk directions).
THRONG_LANES float target_tuck(const BodyState2d& own, size_t side,
                               const ClearanceConstraints& constraints) {
  F tucked[8], envelope[8], sweep[8];
  set_octagon(own.sweep->outline().tucked[side], tucked);
  set_octagon(own.sweep->envelope().arms[side], envelope);
  const float now = own.arms[side];
  F target = 0.0f;
  for (size_t i = 0; i < constraints.count; i += kLaneCount) {
    const F ahead = load(constraints.x + i), left = load(constraints.y + i);
    const F clearance = load(constraints.arm_clearance_m + i),
            weight = load(constraints.weight + i);
    load_octagons(
        [&](size_t lane) -> const Octagon& { return constraints.own[i + lane]->arms[side]; },
        sweep);
    target = max_of(target, weight * tuck_for(arm_reach(sweep, tucked, ahead, left), clearance));
    if (now <= 0) continue;
    // Keeps the arm tucked if the same swing would need it again.
    const F hold =
        min_of(now, kHoldShare * tuck_for(arm_reach(envelope, tucked, ahead, left), clearance));
    const M is_now = (load(constraints.ahead_s + i) <= 0.0f) & (weight > 0.0f);
    target = max_of(target, select(is_now, hold, 0.0f));
  }
  alignas(64) float maximum[kLaneCount];
  store(target, maximum);
  return *std::max_element(maximum, maximum + kLaneCount);
}

THRONG_LANES AvoidanceMotion compute_target(const BodyState2d& own,
                                            std::span<const BodyState2d* const> neighbours,
                                            std::span<const WallState2d> walls) {
  AvoidanceMotion target;
  ClearanceConstraints constraints;
  const bool may_touch = find_constraints(own, neighbours, constraints);
  target.has_constraints = constraints.count > 0 || !walls.empty();
  if (!target.has_constraints || (!may_touch && own.is_at_rest() && walls.empty())) return target;
  if (constraints.count > 0) constraints.fill(constraints.count - 1);
  const Stance stance = stance_of(own.scale, own.turn_rad, own.arms[0], own.arms[1]);
  for (size_t i = 0; i < constraints.count; i += kLaneCount)
    set_clearances(own, stance, i, constraints);
  for (const WallState2d& wall : walls) add_wall(own, wall, constraints);
  constraints.fill(constraints.count - 1);
  turn_trunk(own, constraints, target);
  turn_to_trunk(own, target.turn_rad, constraints);
  for (size_t side = 0; side < 2; ++side) target.arms[side] = target_tuck(own, side, constraints);
  return target;
}
