// Borders between a body and those near it, a border a lane.
// How far a trunk turns and arms are drawn in for them is below.
// Included inside the namespace of the lanes F, after base/simd/angles-inl.h.

// Bodies sway and lean: they stay clear of their border by so much; arms, which are where they will
// be within a sixteenth of a cycle, by more.
inline constexpr float kMargin_m = 0.02f, kArmMargin_m = 0.04f;
// What is needed so soon is needed now; what is needed later than kYieldAhead_s is not yet.
inline constexpr float kSoon_s = 0.45f;

/// So much room in a direction, of which so much counts: a number of each border, and as many more
/// as a register has.
inline constexpr size_t kMostBorders = 4 * kMostNear + 2 * kMostNearWalls;
using BorderNumbers = float[kMostBorders + kAtOnce];
// Each of its arrays begins a cache line.
struct Borders {                   // NOLINT(clang-analyzer-optin.performance.Padding)
  alignas(64) BorderNumbers x, y;  ///< first where the other will be, then the direction
  alignas(64) BorderNumbers direction;
  alignas(64) BorderNumbers trunk_room_m, arm_room_m;  ///< at scale 1
  alignas(64) BorderNumbers weight;
  alignas(64) BorderNumbers ahead_s;
  const SeenBody* other[kMostBorders + kAtOnce];
  const Limbs* own[kMostBorders + kAtOnce];  ///< as they will swing then
  size_t count = 0;

  THRONG_LANES void copy(size_t from, size_t to) {
    for (float* numbers : {x, y, direction, trunk_room_m, arm_room_m, weight, ahead_s})
      numbers[to] = numbers[from];
    other[to] = other[from];
    own[to] = own[from];
  }
  /// Lanes beyond the last border get something that counts nothing.
  THRONG_LANES void fill(size_t last) {
    for (size_t i = last + 1; i % kAtOnce != 0; ++i) {
      copy(last, i);
      weight[i] = 0;
    }
  }
};

/// In turns of Reaches, from 0 to once around.
THRONG_LANES F direction_of(F angle) {
  constexpr float kAround = Reaches::kDirections;
  const F direction = angle * Reaches::kPerRadian;
  return max_of(direction - kAround * floor_of(direction * (1 / kAround)), 0.0f);
}

/// Each lane's octagon; of(lane) refers to it.
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

/// How far octagons reach to the side that y is on.
THRONG_LANES F across_of(const F (&reaches)[8], F y) {
  return select(y > 0.0f, reaches[2], reaches[6]);
}
/// How far they reach in the direction of a unit vector.
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

/// DrawnArm.
struct Drawn {
  F tucked, stilled;
};
THRONG_LANES Drawn drawn_by(F share) {
  const F u = max_of(share - DrawnArm::kTucked, 0.0f) * (1 / (1 - DrawnArm::kTucked));
  return {min_of(share * (1 / DrawnArm::kTucked), 1.0f), u * u * (2.0f - u)};
}
/// The least share at which an arm is this still.
THRONG_LANES F share_of(F stilled) {
  // The cubic's root: a guess not far above it, and Newton's step.
  const F guess = sqrt_of(stilled / (2.0f - sqrt_of(stilled)));
  const F less =
      (guess * guess * (2.0f - guess) - stilled) / (max_of(guess, 1e-12f) * (4.0f - 3.0f * guess));
  return DrawnArm::kTucked + (1 - DrawnArm::kTucked) * (guess - less);
}

/// How far an arm reaches in a direction, and what drawing it in wins.
struct ArmReach {
  F swung_m, tucking_m, stilling_m;
};
THRONG_LANES ArmReach arm_reach(const F (&swung)[8], const F (&drawn)[8], F x, F y) {
  const F swung_m = reach_in(swung, x, y);
  const F tucking_m = abs_of(y) * (across_of(swung, y) - across_of(drawn, y));
  return {swung_m, tucking_m, swung_m - reach_in(drawn, x, y) - tucking_m};
}

/// How far bodies reach in a direction: trunk and drawn-in arms, thighs as well, and all as it is
/// now.
struct BodyReach {
  F trunk_m, firm_m, whole_m;
};
struct Stance {
  F scale, turn, turn_sin, turn_cos;
  Drawn arms[2];
};
THRONG_LANES Stance stance_of(F scale, F turn, F right, F left) {
  Stance stance = {scale, turn, {}, {}, {drawn_by(right), drawn_by(left)}};
  sin_cos_of(turn, stance.turn_sin, stance.turn_cos);
  return stance;
}
/// What each lane's body is like.
struct Shapes {
  const Outline* outline[kAtOnce];
  const Limbs* limbs[kAtOnce];
};
/// In the direction (x, y), at `angle`, from the bodies' ways.
THRONG_LANES BodyReach reach_of(const Stance& stance, const Shapes& shapes, const F (&drawn)[2][8],
                                F x, F y, F angle) {
  alignas(64) int32_t whole[kAtOnce];
  alignas(64) float low[kAtOnce], high[kAtOnce];
  const F direction = direction_of(angle - stance.turn);
  store_whole(direction, whole);
  for (size_t lane = 0; lane < kAtOnce; ++lane) {
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
    const ArmReach arm = arm_reach(octagon, drawn[side], ahead, left);
    const Drawn& in = stance.arms[side];
    all = max_of(all, arm.swung_m - in.tucked * arm.tucking_m - in.stilled * arm.stilling_m);
  }
  return {stance.scale * trunk, stance.scale * firm, stance.scale * all};
}

/// How far trunks will have swayed to the left.
THRONG_LANES F swayed_by(F sway_m, F phase, F cycles_ps, F ahead_s) {
  const F from = phase - static_cast<float>(GaitCurves::kSwayFrom);
  return sway_m * (sin_of_turns(from) - sin_of_turns(from + ahead_s * cycles_ps));
}

/// How far bodies reach at most.
THRONG_LANES F bulk_in(const F (&bulk)[4], F turn, F x, F y) {
  const F ahead = bulk[0], oblique = bulk[1], aside = bulk[2], most = bulk[3];
  const F octagon[8] = {ahead, oblique, aside, oblique, ahead, oblique, aside, oblique};
  return select(abs_of(turn) > 0.0f, most, reach_in(octagon, x, y));
}

/// Times at which somebody may be within reach: up to four of each, and as many more as a register
/// has.
struct Moments {
  static constexpr size_t kEach = 4;
  static constexpr size_t kMost = kEach * kMostNear + kAtOnce;
  using Numbers = float[kMost];
  alignas(64) Numbers ahead_s;
  const SeenBody* other[kMost];
  uint8_t first[kMost];  ///< the moment of the same body when it is nearest
  alignas(64) Numbers x, y, distance2_m2, weight;
  alignas(64) Numbers may_touch;  ///< 1: perhaps; 0: both are clear of each other
  size_t count = 0;

  void add(const SeenBody& body, float time_s, size_t nearest, bool counts) {
    ahead_s[count] = time_s;
    other[count] = &body;
    first[count] = static_cast<uint8_t>(nearest);
    count += counts ? 1 : 0;
  }
};

// Nobody looks so far ahead.
inline constexpr float kNever_s = kYieldAhead_s;
inline constexpr float kReach2_m2 = kYieldReach_m * kYieldReach_m;

/// When others, as they go, will be nearest, now, half-way to that and a little later.
THRONG_LANES void find_moments(const SeenBody& own, std::span<const SeenBody* const> near,
                               Moments& moments) {
  constexpr float kHardly_s = 0.05f;
  // Trunks sway and arms swing: what is nearest now may be nearer a quarter of a cycle later, and
  // arms behind pass each other after the trunks.
  constexpr float kSway_s = 0.25f, kAfter_s = 0.15f;
  constexpr float kSwayedReach_m = kYieldReach_m + 0.2f;  // sways are less
  constexpr float kSwayedReach2_m2 = kSwayedReach_m * kSwayedReach_m;
  using OfEach = float[kMostNear + kAtOnce];
  alignas(64) OfEach ahead_s[Moments::kEach], distance2_m2[Moments::kEach];
  for (size_t i = 0; i < near.size(); i += kAtOnce) {
    F place[4];
    load_rows([&](size_t lane) { return &near[std::min(i + lane, near.size() - 1)]->x_m; }, place);
    const F dx = place[0] - own.x_m, dy = place[1] - own.y_m;
    const F vx = place[2] - own.vx_mps, vy = place[3] - own.vy_mps;
    const F closing = 0.0f - (dx * vx + dy * vy), speed2 = max_of(vx * vx + vy * vy, 1e-4f);
    const F nearest_s = min_of(max_of(closing / speed2, 0.0f), kYieldAhead_s);
    const M is_now = nearest_s < kHardly_s;
    const F times[Moments::kEach] = {select(is_now, 0.0f, nearest_s), select(is_now, kSway_s, 0.0f),
                                     select(is_now, kNever_s, 0.5f * nearest_s),
                                     select(is_now, kNever_s, nearest_s + kAfter_s)};
    for (size_t k = 0; k < Moments::kEach; ++k) {
      const F x = dx + times[k] * vx, y = dy + times[k] * vy;
      store(times[k], ahead_s[k] + i);
      store(x * x + y * y, distance2_m2[k] + i);
    }
  }
  // Whoever is never within reach when nearest is not looked at any further.
  for (size_t n = 0; n < near.size(); ++n) {
    // Set above, register by register. NOLINTNEXTLINE(clang-analyzer-core.*)
    const bool comes = distance2_m2[0][n] <= kSwayedReach2_m2;
    const size_t nearest = moments.count;
    moments.add(*near[n], ahead_s[0][n], nearest, comes);
    for (size_t k = 1; k < Moments::kEach; ++k)
      moments.add(*near[n], ahead_s[k][n], nearest,
                  comes && ahead_s[k][n] < kNever_s && distance2_m2[k][n] <= kSwayedReach2_m2);
  }
  for (size_t i = moments.count; i % kAtOnce != 0; ++i) {
    moments.ahead_s[i] = kNever_s;
    moments.other[i] = near.front();
  }
}

/// Where others will be, from the i-th moment on.
THRONG_LANES void look_ahead(const SeenBody& own, size_t i, Moments& moments) {
  // What lacks room by arms' margins, see draw_for(), and rounding.
  constexpr float kClear_m = 2 * kArmMargin_m + 0.001f;
  const SeenBody* const* other = moments.other + i;
  F place[4], way[4], motion[4];
  load_rows([&](size_t lane) { return &other[lane]->x_m; }, place);
  load_rows([&](size_t lane) { return &other[lane]->cos; }, way);
  load_rows([&](size_t lane) { return &other[lane]->turn_rad; }, motion);
  const F scale = motion[3];
  const F ahead_s = load(moments.ahead_s + i);
  alignas(64) float discs[kAtOnce], sways[kAtOnce];
  for (size_t lane = 0; lane < kAtOnce; ++lane) {
    discs[lane] = other[lane]->disc_m;
    sways[lane] = other[lane]->sway_m;
  }
  const F mine = swayed_by(own.sway_m, own.phase, own.cycles_ps, ahead_s);
  const F theirs = swayed_by(load(sways), way[2], way[3], ahead_s);
  const F x =
      place[0] - own.x_m + ahead_s * (place[2] - own.vx_mps) - theirs * way[1] + mine * own.sin;
  const F y =
      place[1] - own.y_m + ahead_s * (place[3] - own.vy_mps) + theirs * way[0] - mine * own.cos;
  const F distance2 = x * x + y * y;
  const F left = (kYieldAhead_s - ahead_s) * (1 / (kYieldAhead_s - kSoon_s));
  store(x, moments.x + i);
  store(y, moments.y + i);
  store(distance2, moments.distance2_m2 + i);
  store(min_of(left, 1.0f), moments.weight + i);

  static constexpr Bulk kDisc;
  F bulk[4], own_bulk[4];
  const auto bulk_of = [](const SeenBody& body) {
    return &(body.swung != nullptr ? body.swung->bulk() : kDisc).ahead_m;
  };
  load_rows([&](size_t lane) { return bulk_of(*other[lane]); }, bulk);
  for (size_t n = 0; n < 4; ++n) own_bulk[n] = bulk_of(own)[n];
  const F apart = sqrt_of(distance2);
  const F away_x = x / max_of(apart, 1e-6f), away_y = y / max_of(apart, 1e-6f);
  const F own_reach =
      own.scale * bulk_in(own_bulk, own.turn_rad, own.cos * away_x + own.sin * away_y,
                          own.cos * away_y - own.sin * away_x);
  const F reach = scale * bulk_in(bulk, motion[0], way[0] * away_x + way[1] * away_y,
                                  way[0] * away_y - way[1] * away_x);
  const M is_clear = apart >= own_reach + reach + load(discs) + kClear_m * own.scale;
  store(select(is_clear, 0.0f, 1.0f), moments.may_touch + i);
}

/// The borders of those within reach. False: nothing is lacking, whatever they are.
THRONG_LANES bool find_borders(const SeenBody& own, std::span<const SeenBody* const> near,
                               Borders& borders) {
  Moments moments;
  find_moments(own, near, moments);
  for (size_t i = 0; i < moments.count; i += kAtOnce) look_ahead(own, i, moments);
  float may_touch = 0;
  for (size_t i = 0; i < moments.count; ++i) {
    const bool counts = moments.weight[i] > 0 && moments.distance2_m2[i] <= kReach2_m2 &&
                        moments.distance2_m2[moments.first[i]] <= kReach2_m2;
    borders.x[borders.count] = moments.x[i];
    borders.y[borders.count] = moments.y[i];
    borders.ahead_s[borders.count] = moments.ahead_s[i];
    borders.weight[borders.count] = moments.weight[i];
    borders.other[borders.count] = moments.other[i];
    borders.count += counts ? 1 : 0;
    may_touch = std::max(may_touch, counts ? moments.may_touch[i] : 0);
  }
  return may_touch > 0;
}

/// The borders from the i-th on, in the middle of what would be between two as they are now.
THRONG_LANES void set_rooms(const SeenBody& own, const Stance& stance, size_t i, Borders& borders) {
  const SeenBody* const* other = borders.other + i;
  const F world_x = load(borders.x + i), world_y = load(borders.y + i);
  const F apart = sqrt_of(world_x * world_x + world_y * world_y);
  const F per_apart = 1.0f / max_of(apart, 1e-6f);
  const F away_x = per_apart * world_x, away_y = per_apart * world_y;
  const F x = own.cos * away_x + own.sin * away_y, y = own.cos * away_y - own.sin * away_x;
  F way[4], motion[4];
  load_rows([&](size_t lane) { return &other[lane]->cos; }, way);
  load_rows([&](size_t lane) { return &other[lane]->turn_rad; }, motion);
  alignas(64) float discs[kAtOnce];
  for (size_t lane = 0; lane < kAtOnce; ++lane) discs[lane] = other[lane]->disc_m;
  const F their_x = 0.0f - (way[0] * away_x + way[1] * away_y),
          their_y = way[1] * away_x - way[0] * away_y;
  const Way ways[2] = {{y, x}, {their_y, their_x}};
  F angles[2];
  angles_of(ways, angles);

  const F ahead_s = load(borders.ahead_s + i);
  alignas(64) int32_t own_phase[kAtOnce], their_phase[kAtOnce];
  store_whole((own.phase + ahead_s * own.cycles_ps) * float{Swings::kPhases} + 0.5f, own_phase);
  store_whole((way[2] + ahead_s * way[3]) * float{Swings::kPhases} + 0.5f, their_phase);
  Shapes shapes;
  for (size_t lane = 0; lane < kAtOnce; ++lane) {
    shapes.outline[lane] = &own.swung->outline();
    shapes.limbs[lane] = borders.own[i + lane] = &own.swung->at(own_phase[lane]);
  }
  F drawn[2][8];
  for (size_t side = 0; side < 2; ++side)
    set_octagon(own.swung->outline().drawn[side], drawn[side]);
  const BodyReach mine = reach_of(stance, shapes, drawn, x, y, angles[0]);
  for (size_t lane = 0; lane < kAtOnce; ++lane) {
    const Swings& swung = other[lane]->swung != nullptr ? *other[lane]->swung : *own.swung;
    shapes.outline[lane] = &swung.outline();
    shapes.limbs[lane] = &swung.at(their_phase[lane]);
  }
  for (size_t side = 0; side < 2; ++side)
    load_octagons([&](size_t lane) -> const Octagon& { return shapes.outline[lane]->drawn[side]; },
                  drawn[side]);
  const BodyReach theirs = reach_of(stance_of(motion[3], motion[0], motion[1], motion[2]), shapes,
                                    drawn, their_x, their_y, angles[1]);

  const F disc = load(discs), per_scale = 1.0f / own.scale;
  const F of_disc = apart - disc;
  const M is_disc = disc > 0.0f;
  // What cannot be drawn in is given way to by the other's arm alone.
  const F arm_room = min_of(0.5f * (apart + mine.whole_m - theirs.whole_m), apart - theirs.firm_m);
  const F trunk_room = 0.5f * (apart + mine.trunk_m - theirs.trunk_m);
  store(x, borders.x + i);
  store(y, borders.y + i);
  store(direction_of(angles[0]), borders.direction + i);
  store(per_scale * select(is_disc, of_disc, trunk_room), borders.trunk_room_m + i);
  store(per_scale * select(is_disc, of_disc, arm_room), borders.arm_room_m + i);
}

/// As it is now and as it will be soon.
THRONG_LANES void add_wall(const SeenBody& own, const NearWall& wall, Borders& borders) {
  alignas(64) float direction[kAtOnce];
  store(direction_of(float_arc_tan2(wall.y, wall.x)), direction);
  for (const float ahead_s : {0.0f, kSoon_s}) {
    const size_t i = borders.count++;
    borders.x[i] = wall.x;
    borders.y[i] = wall.y;
    borders.direction[i] = direction[0];
    borders.trunk_room_m[i] = borders.arm_room_m[i] =
        (wall.distance_m - ahead_s * wall.approach_mps) / own.scale;
    borders.weight[i] = 1;
    borders.ahead_s[i] = ahead_s;
    borders.other[i] = nullptr;
    borders.own[i] = &own.swung->at(Swings::sixteenth_of(own.phase + ahead_s * own.cycles_ps));
  }
}

// How far a trunk turns and arms are drawn in for what is near: the borders' answer.

// The trunk's turns that are compared: as many to either side, a direction of Reaches apart.
inline constexpr int kTurnsAside = 9;
inline constexpr size_t kTurns = 2 * kTurnsAside + 1;
inline constexpr float kTurn_rad = 1 / Reaches::kPerRadian;
// Half a metre of turned trunk is worth a tenth of a millimetre of room squared.
inline constexpr float kEffort = 1e-4f;
// A turn comes about at such a speed, and something of it at once.
inline constexpr float kTurning_rps = 1.5f, kPromptly_s = 0.2f;
// A turn that lacks so much more (squared) than another is left quickly.
inline constexpr float kPressing_m2 = 1e-4f;
// An arm stays drawn in by so much of what its swing would lack at the worst time of a cycle.
inline constexpr float kHeld = 0.5f;

/// What a trunk with its arms drawn in lacks to a border, by its turn: the one farthest to the left
/// is 0, for seen by a trunk that is turned to the left, what is near lies farther to the right. A
/// trunk that does not get to a turn until then lacks what it does where it gets.
class TrunkLack {
 public:
  /// `now`: as it is turned, of kTurns.
  TrunkLack(const Reaches& upper, const Borders& borders, size_t i, float now)
      : room_m_(borders.trunk_room_m[i] - kMargin_m), weight_(borders.weight[i]) {
    float from = borders.direction[i] - kTurnsAside;
    if (from < 0) from += Reaches::kDirections;
    const auto whole = static_cast<int>(from);
    reach_m_ = upper.from(whole);
    share_ = from - static_cast<float>(whole);
    const float far =
        kTurning_rps * Reaches::kPerRadian * std::max(borders.ahead_s[i], kPromptly_s);
    first_ = std::max(now - far, 0.0f);
    last_ = std::min(now + far, static_cast<float>(kTurns - 1));
    first_m_ = at(first_);
    last_m_ = at(last_);
  }

  /// Of a register of turns from the given one on, squared and by how much the border counts.
  THRONG_LANES F from(size_t turn) const {
    static constexpr auto kNumbers = [] {
      std::array<float, kLanesOfTurns> numbers{};
      for (size_t i = 0; i < kLanesOfTurns; ++i) numbers[i] = static_cast<float>(i);
      return numbers;
    }();
    const F reach = load(reach_m_ + turn), next = load(reach_m_ + turn + 1);
    const F there = max_of(reach + share_ * (next - reach) - room_m_, 0.0f);
    const F number = load(kNumbers.data() + turn);
    const F lack = select(number < first_, F(first_m_), select(number > last_, F(last_m_), there));
    return weight_ * lack * lack;
  }

  /// The lanes of kTurns, whole registers.
  static constexpr size_t kLanesOfTurns = (kTurns + kAtOnce - 1) / kAtOnce * kAtOnce;

 private:
  float at(float turn) const {
    const float direction = share_ + turn;
    const auto whole = static_cast<int>(direction);
    const float* const reach_m = reach_m_ + whole;
    const float reach =
        reach_m[0] + (direction - static_cast<float>(whole)) * (reach_m[1] - reach_m[0]);
    return std::max(reach - room_m_, 0.0f);
  }

  const float* reach_m_;
  float share_, room_m_, weight_;
  float first_, last_;  ///< the turns that it gets to until then, and what it lacks there
  float first_m_, last_m_;
};

/// Turns the trunk to where the squares of what a body with its arms drawn in lacks are least.
THRONG_LANES void turn_trunk(const SeenBody& own, const Borders& borders, YieldMotion& wanted) {
  const Outline& outline = own.swung->outline();
  const auto of_turn = [](float rad) { return kTurnsAside - rad * Reaches::kPerRadian; };
  const float now = std::clamp(of_turn(own.turn_rad), 0.0f, static_cast<float>(kTurns - 1));
  alignas(64) float costs[TrunkLack::kLanesOfTurns] = {};
  for (size_t i = 0; i < borders.count; ++i) {
    if (borders.trunk_room_m[i] - kMargin_m >= outline.upper.most_m()) continue;
    const TrunkLack lack(outline.upper, borders, i, now);
    for (size_t turn = 0; turn < TrunkLack::kLanesOfTurns; turn += kAtOnce)
      store(load(costs + turn) + lack.from(turn), costs + turn);
  }
  const float after_half = now + 0.5f;  // rounds faster than lround()
  const float cost_now = costs[static_cast<size_t>(after_half)];
  const auto turn_of = [](size_t i) { return kTurn_rad * (kTurnsAside - static_cast<float>(i)); };
  const auto effort_of = [&](size_t i) { return kEffort * turn_of(i) * turn_of(i); };
  size_t best = kTurnsAside;
  for (size_t i = 0; i < kTurns; ++i) costs[i] += effort_of(i);
  for (size_t i = kTurns; i-- > 0;)
    if (costs[i] < costs[best]) best = i;
  wanted.is_pressed = cost_now > costs[best] - effort_of(best) + kPressing_m2;
  float turn_rad = turn_of(best);
  if (best > 0 && best < kTurns - 1)
    turn_rad += kTurn_rad * lowest_between(costs[best + 1], costs[best], costs[best - 1]);
  constexpr float kWaist = 1 / (1 - kHipsShare);
  constexpr float kGaitTurn_rad = 0.1f;  // the waist turns by so much in walking
  const YieldColumns& columns = outline.columns;
  wanted.turn_rad = std::clamp(turn_rad, kWaist * (columns.least_trunk_rad + kGaitTurn_rad),
                               kWaist * (columns.most_trunk_rad - kGaitTurn_rad));
}

/// How far arms have to be drawn in to stay within borders.
THRONG_LANES F draw_for(const ArmReach& arm, F room_m) {
  constexpr float kWorthIt_m = 0.01f;  // elsewhere it makes no difference
  const F lack = arm.swung_m + kArmMargin_m - room_m;
  const M is_more = (lack > arm.tucking_m) & (arm.stilling_m > kWorthIt_m);
  const F stilled =
      min_of(max_of((lack - arm.tucking_m) / max_of(arm.stilling_m, kWorthIt_m), 0.0f), 1.0f);
  const F tucked = min_of(lack / max_of(arm.tucking_m, 1e-4f), 1.0f);
  const F draw = select(is_more, share_of(stilled), DrawnArm::kTucked * tucked);
  return select(lack > 0.0f, draw, 0.0f);
}

/// Their directions as the trunk has them then, while it turns so far.
THRONG_LANES void turn_to_trunk(const SeenBody& own, float turn_rad, Borders& borders) {
  const F to_go_rad = turn_rad - own.turn_rad;
  for (size_t i = 0; i < borders.count; i += kAtOnce) {
    const F x = load(borders.x + i), y = load(borders.y + i);
    const F most = kTurning_rps * load(borders.ahead_s + i);
    F sin, cos;
    sin_cos_of(own.turn_rad + max_of(min_of(to_go_rad, most), 0.0f - most), sin, cos);
    store(cos * x + sin * y, borders.x + i);
    store(cos * y - sin * x, borders.y + i);
  }
}

/// How far an arm has to be drawn in to swing within all borders, whose directions are the trunk's.
THRONG_LANES float wanted_draw(const SeenBody& own, size_t side, const Borders& borders) {
  F drawn[8], ever[8], swung[8];
  set_octagon(own.swung->outline().drawn[side], drawn);
  set_octagon(own.swung->ever().arms[side], ever);
  const float now = own.arms[side];
  F wanted = 0.0f;
  for (size_t i = 0; i < borders.count; i += kAtOnce) {
    const F ahead = load(borders.x + i), left = load(borders.y + i);
    const F room = load(borders.arm_room_m + i), weight = load(borders.weight + i);
    load_octagons([&](size_t lane) -> const Octagon& { return borders.own[i + lane]->arms[side]; },
                  swung);
    wanted = max_of(wanted, weight * draw_for(arm_reach(swung, drawn, ahead, left), room));
    if (now <= 0) continue;
    // Not let out only to be drawn in again by the same swing.
    const F held = min_of(now, kHeld * draw_for(arm_reach(ever, drawn, ahead, left), room));
    const M is_now = (load(borders.ahead_s + i) <= 0.0f) & (weight > 0.0f);
    wanted = max_of(wanted, select(is_now, held, 0.0f));
  }
  alignas(64) float most[kAtOnce];
  store(wanted, most);
  return *std::max_element(most, most + kAtOnce);
}

THRONG_LANES YieldMotion wanted_by(const SeenBody& own, std::span<const SeenBody* const> near,
                                   std::span<const NearWall> walls) {
  YieldMotion wanted;
  Borders borders;
  const bool may_touch = find_borders(own, near, borders);
  wanted.is_near = borders.count > 0 || !walls.empty();
  if (!wanted.is_near || (!may_touch && own.is_at_rest() && walls.empty())) return wanted;
  if (borders.count > 0) borders.fill(borders.count - 1);
  const Stance stance = stance_of(own.scale, own.turn_rad, own.arms[0], own.arms[1]);
  for (size_t i = 0; i < borders.count; i += kAtOnce) set_rooms(own, stance, i, borders);
  for (const NearWall& wall : walls) add_wall(own, wall, borders);
  borders.fill(borders.count - 1);
  turn_trunk(own, borders, wanted);
  turn_to_trunk(own, wanted.turn_rad, borders);
  for (size_t side = 0; side < 2; ++side) wanted.arms[side] = wanted_draw(own, side, borders);
  return wanted;
}
