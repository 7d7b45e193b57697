// Leg prediction: one time, place or cadence per lane. Included in the namespace of the lanes F.

// At the end of stance the foot rolls over its ball, and the ankle moves ahead by kRoll_m.
inline constexpr float kRoll_m = 0.10f, kRollFrom = 0.75f;
// The knee is ahead of the middle between hip and ankle by this, and by more in swing.
inline constexpr float kBend_m = 0.055f, kSwingBend_m = 0.13f;

// A foot seen from above: all points within kHalfWidth_m of a line along it. Measured from below
// the ankle, adult at scale 1.
inline constexpr float kHeel_m = -0.01f, kToe_m = 0.165f, kHalfWidth_m = 0.05f;
inline constexpr float kShin_m = 0.055f;

struct Vec2 {
  F x, y;
};
struct LegLanes {
  Vec2 foot, shin, knee;
};

THRONG_LANES F deficit_squared(F distance2, float reach) {
  const F deficit = max_of(reach - sqrt_of(distance2), 0.0f);
  return deficit * deficit;
}

THRONG_LANES F distance_squared(const Vec2& from, const Vec2& to) {
  const F dx = from.x - to.x, dy = from.y - to.y;
  return dx * dx + dy * dy;
}
THRONG_LANES LegLanes leg_at(const LegPlace& place) {
  return {{place.foot_m.x(), place.foot_m.y()},
          {place.shin_m.x(), place.shin_m.y()},
          {place.knee_m.x(), place.knee_m.y()}};
}
THRONG_LANES LegLanes load_leg(const LegPlaces& p, size_t i) {
  return {{load(p.foot_x + i), load(p.foot_y + i)},
          {load(p.shin_x + i), load(p.shin_y + i)},
          {load(p.knee_x + i), load(p.knee_y + i)}};
}

/// Squared distance from points of the own foot to the line along the other, whichever is nearest.
/// Exact only for nearly parallel feet.
THRONG_LANES F between_feet_squared(const Vec2& foot, const LegOwner& own, const Vec2& other,
                                    const LegOwner& other_owner) {
  const float ax = other_owner.ahead.x(), ay = other_owner.ahead.y();
  const F x = foot.x - other.x, y = foot.y - other.y;
  F min_distance2 = 1e9f;
  for (const float along : {kHeel_m, 0.5f * (kHeel_m + kToe_m), kToe_m}) {
    const Eigen::Vector2f along_foot = own.scale * along * own.ahead;
    const F dx = x + along_foot.x(), dy = y + along_foot.y();
    const F at =
        min_of(max_of(dx * ax + dy * ay, other_owner.scale * kHeel_m), other_owner.scale * kToe_m);
    const F rest_x = dx - at * ax, rest_y = dy - at * ay;
    min_distance2 = min_of(min_distance2, rest_x * rest_x + rest_y * rest_y);
  }
  return min_distance2;
}

THRONG_LANES F clearance_cost(const LegLanes& leg, const LegOwner& own, const LegLanes& other,
                              const LegOwner& other_owner, float clearance_m) {
  const float scales = own.scale + other_owner.scale;
  const float reach = kShin_m * scales + clearance_m;
  return deficit_squared(between_feet_squared(leg.foot, own, other.foot, other_owner),
                         kHalfWidth_m * scales + clearance_m) +
         deficit_squared(distance_squared(leg.shin, other.shin), reach) +
         deficit_squared(distance_squared(leg.knee, other.knee), reach);
}
THRONG_LANES F clearance_cost(const LegLanes& leg, const LegOwner& own, const OtherLeg& other,
                              float clearance_m) {
  return clearance_cost(leg, own, leg_at(other.place), other.owner, clearance_m);
}

THRONG_LANES void add_clearance_cost_at(size_t i, const LegPlaces& places, const LegOwner& own,
                                        std::span<const OtherLeg> others, float clearance_m,
                                        float* costs) {
  const LegLanes leg = load_leg(places, i);
  F cost = load(costs + i);
  for (const OtherLeg& other : others) cost = cost + clearance_cost(leg, own, other, clearance_m);
  store(cost, costs + i);
}

THRONG_LANES bool violates_clearance_at(size_t i, const LegPlaces& leg, const LegOwner& own,
                                        const LegPlaces& other, const LegOwner& other_owner,
                                        float clearance_m) {
  return any(clearance_cost(load_leg(leg, i), own, load_leg(other, i), other_owner, clearance_m) >
             0.0f);
}

struct Cadence {
  F soon_ps, later_ps, per_soon, per_later;
  F cycles_soon;  ///< number of cycles until lead_s
  float lead_s;
};

THRONG_LANES F time_of(const Cadence& r, F cycles) {
  return select(cycles <= r.cycles_soon, cycles * r.per_soon,
                r.lead_s + (cycles - r.cycles_soon) * r.per_later);
}

/// Returns the offset of the landing point at which the body passes over the foot as in the gait.
THRONG_LANES Vec2 goal_of(const Cadence& r, const LegState& leg, F ahead_s, M is_next) {
  const F cycle_s = select(ahead_s < r.lead_s, r.per_soon, r.per_later);
  const F horizon_s = min_of(0.5f * leg.stance * cycle_s, LandingLimits::kMaxAhead_s);
  const F aside = horizon_s * leg.velocity_mps.y();
  return {horizon_s * leg.velocity_mps.x() + (leg.passes_x_m - leg.lands_x_m) +
              select(is_next, leg.landing_m.x(), 0.0f),
          (leg.is_right ? min_of(aside, LandingLimits::kMaxClosing_m)
                        : max_of(aside, -LandingLimits::kMaxClosing_m)) +
              select(is_next, leg.landing_m.y(), 0.0f)};
}

struct LegSample {
  LegLanes leg;
  F is_grounded, share;
};

/// Each cycle goes from one landing to the next; a standing foot's place follows from its landing
/// time. In the first cycle it is the current place.
THRONG_LANES LegSample leg_at_time(const Cadence& r, const LegState& now, F ahead_s) {
  const float vx = now.velocity_mps.x(), vy = now.velocity_mps.y();
  const F soon_s = min_of(ahead_s, r.lead_s);
  const F later = now.phase + r.soon_ps * soon_s + r.later_ps * (ahead_s - soon_s);
  const F cycle = floor_of(later), phase = later - cycle;
  const M is_first = cycle <= 0.0f, is_second = (cycle <= 1.0f) & !is_first;
  const F landed_s = time_of(r, cycle - now.phase),
          lifts_s = time_of(r, cycle + (now.stance - now.phase)),
          lands_s = time_of(r, cycle + (1 - now.phase));
  const Vec2 before = goal_of(r, now, landed_s, is_second),
             goal = goal_of(r, now, lands_s, is_first);
  const Vec2 stands = {select(is_first, now.foot_m.x(), landed_s * vx + now.lands_x_m + before.x),
                       select(is_first, now.foot_m.y(), landed_s * vy + now.side_m + before.y)};
  Vec2 off = {stands.x - lifts_s * vx - now.lifts_x_m, stands.y - lifts_s * vy - now.side_m};
  if (now.phase >= now.stance) {
    off.x = select(is_first, now.off_m.x(), off.x);
    off.y = select(is_first, now.off_m.y(), off.y);
  }
  const M is_swinging = phase >= now.stance;
  const F u = max_of(phase - now.stance, 0.0f) * (1 / (1 - now.stance));
  const F keep = (1.0f - u * u * (3.0f - 2.0f * u)) * select(is_first, 1 / now.offset_share, 1.0f);
  const auto& bulge = now.swing.bulge;
  const F done = u + u * (1.0f - u) * (bulge[0] + u * (bulge[1] + u * (bulge[2] + u * bulge[3])));
  const F root_x = ahead_s * vx, root_y = ahead_s * vy + now.side_m;
  const F end = max_of(phase * (1 / now.stance) - kRollFrom, 0.0f) * (1 / (1 - kRollFrom));
  const F roll = kRoll_m * select(is_swinging, max_of(1.0f - 2.0f * u, 0.0f), end * end);
  const F bend = kBend_m + 4 * kSwingBend_m * (u * (1.0f - u));
  LegSample sample;
  LegLanes& leg = sample.leg;
  leg.foot.x = select(is_swinging,
                      root_x + now.lifts_x_m + done * (now.lands_x_m - now.lifts_x_m) + goal.x +
                          keep * (off.x - goal.x),
                      stands.x);
  leg.foot.y = select(is_swinging, root_y + goal.y + keep * (off.y - goal.y), stands.y);
  const F ankle_x = leg.foot.x + roll;
  leg.knee = {0.5f * (root_x + ankle_x) + bend, 0.5f * (root_y + leg.foot.y)};
  leg.shin = {0.5f * (ankle_x + leg.knee.x), 0.5f * (leg.foot.y + leg.knee.y)};
  sample.is_grounded = select(u < 0.5f, 1.0f, 0.0f);
  sample.share =
      select(is_first, select(is_swinging, 1.0f - keep, 0.0f), select(is_second, 1.0f, 0.0f));
  return sample;
}

THRONG_LANES Cadence cadence_of(F soon_ps, F later_ps, float lead_s) {
  return {soon_ps, later_ps, 1.0f / soon_ps, 1.0f / later_ps, soon_ps * lead_s, lead_s};
}

THRONG_LANES Vec2 to_common_frame(const LegState& now, const Vec2& s) {
  return {now.root_m.x() + s.x * now.ahead_m.x() - s.y * now.ahead_m.y(),
          now.root_m.y() + s.x * now.ahead_m.y() + s.y * now.ahead_m.x()};
}

/// Samples a leg in the frame common to all legs.
THRONG_LANES LegSample sample_leg(const LegState& now, F ahead_s) {
  LegSample sample = leg_at_time(cadence_of(now.cadence_hz, now.cadence_hz, 0), now, ahead_s);
  for (Vec2* point : {&sample.leg.foot, &sample.leg.shin, &sample.leg.knee})
    *point = to_common_frame(now, *point);
  return sample;
}

THRONG_LANES void store_leg(const LegLanes& leg, LegPlaces& to, size_t i) {
  store(leg.foot.x, to.foot_x + i);
  store(leg.foot.y, to.foot_y + i);
  store(leg.shin.x, to.shin_x + i);
  store(leg.shin.y, to.shin_y + i);
  store(leg.knee.x, to.knee_x + i);
  store(leg.knee.y, to.knee_y + i);
}

THRONG_LANES void predict_at(size_t i, const LegState& now, const float* ahead_s,
                             PredictedLeg& to) {
  const LegSample sample = sample_leg(now, load(ahead_s + i));
  store_leg(sample.leg, to.places, i);
  store(sample.is_grounded, to.is_grounded + i);
  store(sample.share, to.share + i);
}

THRONG_LANES bool predict_clearance_at(size_t i, const LegState& now, const float* ahead_s,
                                       const LegPlaces& own, const LegQuery& query,
                                       LegClearance& to) {
  const LegSample sample = sample_leg(now, load(ahead_s + i));
  const LegLanes own_leg = load_leg(own, i);
  const M is_relevant = (distance_squared(sample.leg.foot, own_leg.foot) <=
                         query.max_distance_m * query.max_distance_m) &
                        (sample.is_grounded > 0.0f);
  if (!any(is_relevant)) return false;
  store_leg(sample.leg, to.places, i);
  store(select(is_relevant, 1.0f, 0.0f), to.is_relevant + i);
  store(
      select(is_relevant,
             clearance_cost(own_leg, query.own, sample.leg, query.other, query.clearance_m), 0.0f),
      to.cost + i);
  return true;
}

THRONG_LANES void add_cadence_cost_at(size_t i, const CadenceCandidates& cadences,
                                      const std::array<LegState, 2>& own,
                                      std::span<const PredictedLegs> others, float clearance_m,
                                      float* costs) {
  const LegOwner owner = {Eigen::Vector2f::UnitX(), 1};
  const Cadence r =
      cadence_of(load(cadences.soon_ps + i), load(cadences.later_ps + i), cadences.lead_s);
  F cost = load(costs + i);
  for (const PredictedLegs& predicted : others)
    for (const LegState& side : own) {
      const LegLanes leg = leg_at_time(r, side, predicted.ahead_s).leg;
      for (size_t k = 0; k < predicted.count; ++k)
        cost = cost + predicted.weight * clearance_cost(leg, owner, predicted.legs[k], clearance_m);
    }
  store(cost, costs + i);
}
