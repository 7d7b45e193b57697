// How far a trunk turns and arms are drawn in for what is near: the borders' answer.
// Included after borders-inl.h.

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
