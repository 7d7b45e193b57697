// Legs, a time, a place or a rhythm a lane. Included inside the namespace of the lanes F.

// A foot steps over its ball at the end of stance: its ankle gets so far ahead.
inline constexpr float kRoll_m = 0.10f, kRollFrom = 0.75f;
// The knee is ahead of the middle between hip and ankle, and more so in swing.
inline constexpr float kBend_m = 0.055f, kSwingBend_m = 0.13f;

// A foot, seen from above, is what is near a line along it; from below the ankle (adult at
// scale 1).
inline constexpr float kHeel_m = -0.01f, kToe_m = 0.165f, kHalfWidth_m = 0.05f;
inline constexpr float kShin_m = 0.055f;

struct Spot {
  F x, y;
};
/// LegPlace, a lane each.
struct Leg {
  Spot foot, shin, knee;
};

THRONG_LANES F lack_squared(F distance2, float reach) {
  const F lack = max_of(reach - sqrt_of(distance2), 0.0f);
  return lack * lack;
}

THRONG_LANES F distance_squared(const Spot& from, const Spot& to) {
  const F dx = from.x - to.x, dy = from.y - to.y;
  return dx * dx + dy * dy;
}
THRONG_LANES Leg leg_at(const LegPlace& place) {
  return {{place.foot_m.x(), place.foot_m.y()},
          {place.shin_m.x(), place.shin_m.y()},
          {place.knee_m.x(), place.knee_m.y()}};
}
THRONG_LANES Leg load_leg(const LegPlaces& p, size_t i) {
  return {{load(p.foot_x + i), load(p.foot_y + i)},
          {load(p.shin_x + i), load(p.shin_y + i)},
          {load(p.knee_x + i), load(p.knee_y + i)}};
}

/// From points of the own foot to the line along the other, whichever is nearest: for feet that
/// point the same way or the opposite one, nearly.
THRONG_LANES F between_feet_squared(const Spot& foot, const LegOwner& own, const Spot& other,
                                    const LegOwner& whose) {
  const float ax = whose.ahead.x(), ay = whose.ahead.y();
  const F x = foot.x - other.x, y = foot.y - other.y;
  F least = 1e9f;
  for (const float along : {kHeel_m, 0.5f * (kHeel_m + kToe_m), kToe_m}) {
    const Eigen::Vector2f way = own.scale * along * own.ahead;
    const F dx = x + way.x(), dy = y + way.y();
    const F at = min_of(max_of(dx * ax + dy * ay, whose.scale * kHeel_m), whose.scale * kToe_m);
    const F rest_x = dx - at * ax, rest_y = dy - at * ay;
    least = min_of(least, rest_x * rest_x + rest_y * rest_y);
  }
  return least;
}

THRONG_LANES F nearness_of(const Leg& leg, const LegOwner& own, const Leg& other,
                           const LegOwner& whose, float clear_m) {
  const float scales = own.scale + whose.scale;
  const float reach = kShin_m * scales + clear_m;
  return lack_squared(between_feet_squared(leg.foot, own, other.foot, whose),
                      kHalfWidth_m * scales + clear_m) +
         lack_squared(distance_squared(leg.shin, other.shin), reach) +
         lack_squared(distance_squared(leg.knee, other.knee), reach);
}
THRONG_LANES F nearness_of(const Leg& leg, const LegOwner& own, const OtherLeg& other,
                           float clear_m) {
  return nearness_of(leg, own, leg_at(other.place), other.owner, clear_m);
}

THRONG_LANES void add_nearness_at(size_t i, const LegPlaces& places, const LegOwner& own,
                                  std::span<const OtherLeg> others, float clear_m, float* costs) {
  const Leg leg = load_leg(places, i);
  F cost = load(costs + i);
  for (const OtherLeg& other : others) cost = cost + nearness_of(leg, own, other, clear_m);
  store(cost, costs + i);
}

THRONG_LANES bool comes_near_at(size_t i, const LegPlaces& leg, const LegOwner& own,
                                const LegPlaces& other, const LegOwner& whose, float clear_m) {
  return any(nearness_of(load_leg(leg, i), own, load_leg(other, i), whose, clear_m) > 0.0f);
}

struct Rhythm {
  F soon_ps, later_ps, per_soon, per_later;
  F cycles_soon;  ///< until lead_s
  float lead_s;
};

/// When so many cycles have passed.
THRONG_LANES F time_of(const Rhythm& r, F cycles) {
  return select(cycles <= r.cycles_soon, cycles * r.per_soon,
                r.lead_s + (cycles - r.cycles_soon) * r.per_later);
}

/// How far from where the gait has it a foot lands, so that the body passes over it as the gait
/// does.
THRONG_LANES Spot goal_of(const Rhythm& r, const LegNow& leg, F ahead_s, M is_next) {
  const F cycle_s = select(ahead_s < r.lead_s, r.per_soon, r.per_later);
  const F look_s = min_of(0.5f * leg.stance * cycle_s, LandingLimits::kMaxAhead_s);
  const F aside = look_s * leg.velocity_mps.y();
  return {look_s * leg.velocity_mps.x() + (leg.passes_x_m - leg.lands_x_m) +
              select(is_next, leg.landing_m.x(), 0.0f),
          (leg.is_right ? min_of(aside, LandingLimits::kMaxClosing_m)
                        : max_of(aside, -LandingLimits::kMaxClosing_m)) +
              select(is_next, leg.landing_m.y(), 0.0f)};
}

/// A leg at some time, in the frame of LegNow.
struct LegThen {
  Leg leg;
  F stays, share;
};

/// Each cycle goes from one landing to the next, and where a foot stands follows from when it
/// landed; but in the first it is where it is.
THRONG_LANES LegThen leg_in(const Rhythm& r, const LegNow& now, F ahead_s) {
  const float vx = now.velocity_mps.x(), vy = now.velocity_mps.y();
  const F soon_s = min_of(ahead_s, r.lead_s);
  const F later = now.phase + r.soon_ps * soon_s + r.later_ps * (ahead_s - soon_s);
  const F cycle = floor_of(later), phase = later - cycle;
  const M is_first = cycle <= 0.0f, is_second = (cycle <= 1.0f) & !is_first;
  const F landed_s = time_of(r, cycle - now.phase),
          lifts_s = time_of(r, cycle + (now.stance - now.phase)),
          lands_s = time_of(r, cycle + (1 - now.phase));
  const Spot before = goal_of(r, now, landed_s, is_second),
             goal = goal_of(r, now, lands_s, is_first);
  const Spot stands = {select(is_first, now.foot_m.x(), landed_s * vx + now.lands_x_m + before.x),
                       select(is_first, now.foot_m.y(), landed_s * vy + now.side_m + before.y)};
  Spot off = {stands.x - lifts_s * vx - now.lifts_x_m, stands.y - lifts_s * vy - now.side_m};
  if (now.phase >= now.stance) {
    off.x = select(is_first, now.off_m.x(), off.x);
    off.y = select(is_first, now.off_m.y(), off.y);
  }
  const M swings = phase >= now.stance;
  const F u = max_of(phase - now.stance, 0.0f) * (1 / (1 - now.stance));
  const F keep = (1.0f - u * u * (3.0f - 2.0f * u)) * select(is_first, 1 / now.kept, 1.0f);
  const auto& bulge = now.swing.bulge;
  const F done = u + u * (1.0f - u) * (bulge[0] + u * (bulge[1] + u * (bulge[2] + u * bulge[3])));
  const F root_x = ahead_s * vx, root_y = ahead_s * vy + now.side_m;
  const F end = max_of(phase * (1 / now.stance) - kRollFrom, 0.0f) * (1 / (1 - kRollFrom));
  const F roll = kRoll_m * select(swings, max_of(1.0f - 2.0f * u, 0.0f), end * end);
  const F bend = kBend_m + 4 * kSwingBend_m * (u * (1.0f - u));
  LegThen then;
  Leg& leg = then.leg;
  leg.foot.x = select(swings,
                      root_x + now.lifts_x_m + done * (now.lands_x_m - now.lifts_x_m) + goal.x +
                          keep * (off.x - goal.x),
                      stands.x);
  leg.foot.y = select(swings, root_y + goal.y + keep * (off.y - goal.y), stands.y);
  const F ankle_x = leg.foot.x + roll;
  leg.knee = {0.5f * (root_x + ankle_x) + bend, 0.5f * (root_y + leg.foot.y)};
  leg.shin = {0.5f * (ankle_x + leg.knee.x), 0.5f * (leg.foot.y + leg.knee.y)};
  then.stays = select(u < 0.5f, 1.0f, 0.0f);
  then.share = select(is_first, select(swings, 1.0f - keep, 0.0f), select(is_second, 1.0f, 0.0f));
  return then;
}

THRONG_LANES Rhythm rhythm_of(F soon_ps, F later_ps, float lead_s) {
  return {soon_ps, later_ps, 1.0f / soon_ps, 1.0f / later_ps, soon_ps * lead_s, lead_s};
}

THRONG_LANES Spot in_steps(const LegNow& now, const Spot& s) {
  return {now.root_m.x() + s.x * now.ahead_m.x() - s.y * now.ahead_m.y(),
          now.root_m.y() + s.x * now.ahead_m.y() + s.y * now.ahead_m.x()};
}

/// From some place that all share.
THRONG_LANES LegThen leg_then(const LegNow& now, F ahead_s) {
  LegThen then = leg_in(rhythm_of(now.cycles_ps, now.cycles_ps, 0), now, ahead_s);
  for (Spot* spot : {&then.leg.foot, &then.leg.shin, &then.leg.knee}) *spot = in_steps(now, *spot);
  return then;
}

THRONG_LANES void store_leg(const Leg& leg, LegPlaces& to, size_t i) {
  store(leg.foot.x, to.foot_x + i);
  store(leg.foot.y, to.foot_y + i);
  store(leg.shin.x, to.shin_x + i);
  store(leg.shin.y, to.shin_y + i);
  store(leg.knee.x, to.knee_x + i);
  store(leg.knee.y, to.knee_y + i);
}

THRONG_LANES void foresee_at(size_t i, const LegNow& now, const float* ahead_s, ForeseenLeg& to) {
  const LegThen then = leg_then(now, load(ahead_s + i));
  store_leg(then.leg, to.places, i);
  store(then.stays, to.stays + i);
  store(then.share, to.share + i);
}

THRONG_LANES bool foresee_near_at(size_t i, const LegNow& now, const float* ahead_s,
                                  const LegPlaces& own, const WhatIsNear& near, NearLeg& to) {
  const LegThen then = leg_then(now, load(ahead_s + i));
  const Leg mine = load_leg(own, i);
  const M is_near =
      (distance_squared(then.leg.foot, mine.foot) <= near.far_m * near.far_m) & (then.stays > 0.0f);
  if (!any(is_near)) return false;
  store_leg(then.leg, to.places, i);
  store(select(is_near, 1.0f, 0.0f), to.is_near + i);
  store(select(is_near, nearness_of(mine, near.own, then.leg, near.other, near.clear_m), 0.0f),
        to.nearness + i);
  return true;
}

THRONG_LANES void add_nearness_in_at(size_t i, const Rhythms& rhythms,
                                     const std::array<LegNow, 2>& own,
                                     std::span<const LegsThen> others, float clear_m,
                                     float* costs) {
  const LegOwner owner = {Eigen::Vector2f::UnitX(), 1};
  const Rhythm r = rhythm_of(load(rhythms.soon_ps + i), load(rhythms.later_ps + i), rhythms.lead_s);
  F cost = load(costs + i);
  for (const LegsThen& then : others)
    for (const LegNow& side : own) {
      const Leg leg = leg_in(r, side, then.ahead_s).leg;
      for (size_t k = 0; k < then.count; ++k)
        cost = cost + then.weight * nearness_of(leg, owner, then.legs[k], clear_m);
    }
  store(cost, costs + i);
}
