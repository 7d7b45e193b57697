#include "avatars/yielding/yielding.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace throng {
namespace {
// The trunk's turns that are compared: as many to either side, a direction of Reaches apart.
constexpr int kTurnsAside = 9;
constexpr int kTurns = 2 * kTurnsAside + 1;
constexpr float kTurn_rad = 1 / Reaches::kPerRadian;
// Bodies sway and lean: they stay clear of their border by so much; arms, which are where they will
// be within a sixteenth of a cycle, by more.
constexpr float kMargin_m = 0.03f, kArmMargin_m = 0.05f;
// What is needed so soon is needed now; what is needed later than kYieldAhead_s is not yet.
constexpr float kSoon_s = 0.45f;
// Half a metre of turned trunk is worth a tenth of a millimetre of room squared ...
constexpr float kEffort = 1e-4f;
// ... and turning the other way round is worth five centimetres.
constexpr float kTurnBack = 2.5e-3f;
constexpr float kTurned_rad = 0.1f;
// Room once made is kept for a while: others sway. What is given up a second, with somebody near
// and without.
constexpr float kReleaseNear_rps = 0.3f, kRelease_rps = 1.2f;
constexpr float kReleaseAhead_s = 1.0f / 9;  // as eased_towards() has it
// An arm stays drawn in by so much of what its swing would lack at the worst time of a cycle.
constexpr float kHeld = 0.7f;

/// In turns of Reaches, from 0 to less than twice around.
float direction_of(float angle_rad) {
  constexpr float kAround = Reaches::kDirections;
  constexpr int kTurnsBack = 8;  // of any angle here: what is cut to a whole number is above 0
  const float direction = angle_rad * Reaches::kPerRadian;
  const int around = static_cast<int>(direction * (1 / kAround) + kTurnsBack) - kTurnsBack;
  return std::max(direction - kAround * static_cast<float>(around), 0.0f);
}

/// So much room in a direction, of which so much counts.
struct Border {
  float x, y;  ///< the direction
  float direction;
  float trunk_room_m, arm_room_m;  ///< at scale 1
  float weight;
  const std::array<Octagon, 2>* arms;  ///< as they will swing then
  bool is_now;
};

/// How far an arm reaches in a direction, and what drawing it in wins.
struct ArmReach {
  float swung_m, tucking_m, stilling_m;

  ArmReach(const Octagon& swung, const Octagon& drawn, float x, float y)
      : swung_m(swung.reach_m(x, y)) {
    const float won_m = swung_m - drawn.reach_m(x, y);
    tucking_m = std::abs(y) * (swung.across_m(y) - drawn.across_m(y));
    stilling_m = won_m - tucking_m;
  }
  float at_m(const DrawnArm& drawn) const {
    return swung_m - drawn.tucked * tucking_m - drawn.stilled * stilling_m;
  }
};

/// A body as it stands now.
struct Stance {
  const Yielder& body;
  Rhythm rhythm;
  FloatSinCos turn;
  std::array<DrawnArm, 2> arms;

  Stance(const Yielder& body_in, const Rhythm& rhythm_in)
      : body(body_in),
        rhythm(rhythm_in),
        turn(float_sin_cos(body.motion.turn_rad)),
        arms{DrawnArm(body.motion.arms[0]), DrawnArm(body.motion.arms[1])} {}

  const Limbs& limbs_in(float ahead_s) const {
    return body.swung->at(rhythm.phase + ahead_s * rhythm.cycles_ps);
  }
};

/// How far a body reaches in a direction: trunk and drawn-in arms, thighs as well, and all as it
/// is now.
struct Reach {
  float trunk_m, firm_m, whole_m;
};
Reach reach_of(const Stance& stance, const Limbs& limbs, float x, float y, float angle_rad) {
  const Yielder& body = stance.body;
  const FloatSinCos& turn = stance.turn;
  const float trunk_m = body.outline->upper.at(direction_of(angle_rad - body.motion.turn_rad));
  const float ahead = turn.cos * x + turn.sin * y, left = turn.cos * y - turn.sin * x;
  float firm_m = trunk_m;
  for (const Octagon& thigh : limbs.thighs) firm_m = std::max(firm_m, thigh.reach_m(x, y));
  float whole_m = firm_m;
  for (size_t side = 0; side < 2; ++side) {
    const ArmReach arm(limbs.arms[side], body.outline->drawn[side], ahead, left);
    whole_m = std::max(whole_m, arm.at_m(stance.arms[side]));
  }
  return {body.scale * trunk_m, body.scale * firm_m, body.scale * whole_m};
}

/// What a body with its arms drawn in lacks, by turn of the trunk.
struct TurnCosts {
  std::array<float, kTurns> cost{};  // from the farthest to the right

  void add(const Reaches& upper, const Border& border) {
    if (border.trunk_room_m >= upper.most_m() + kMargin_m) return;
    // Seen by a trunk that is turned to the left, what is near lies farther to the right.
    float from = border.direction - kTurnsAside;
    if (from < 0) from += Reaches::kDirections;
    const auto whole = static_cast<int>(from);
    const float share = from - static_cast<float>(whole);
    const float* reach = upper.from(whole);
    const float room_m = border.trunk_room_m - kMargin_m, weight = border.weight;
    std::array<float, kTurns> lacks;  // first all, then turned round: whole vectors at a time
    for (size_t i = 0; i < kTurns; ++i) {
      const float reach_m = reach[i] + share * (reach[i + 1] - reach[i]);
      const float lack_m = std::max(reach_m - room_m, 0.0f);
      lacks[i] = weight * lack_m * lack_m;
    }
    for (size_t i = 0; i < kTurns; ++i) cost[i] += lacks[kTurns - 1 - i];
  }

  float best_turn(const YieldColumns& columns, float now_rad) {
    int best = kTurnsAside;
    for (int i = 0; i < kTurns; ++i) {
      const float turn = static_cast<float>(i - kTurnsAside) * kTurn_rad;
      cost[static_cast<size_t>(i)] += kEffort * turn * turn;
      if (std::abs(now_rad) > kTurned_rad && turn * now_rad < 0)
        cost[static_cast<size_t>(i)] += kTurnBack;
    }
    for (int i = 0; i < kTurns; ++i)
      if (cost[static_cast<size_t>(i)] < cost[static_cast<size_t>(best)]) best = i;
    // Between its neighbours where the parabola through the three is lowest.
    float turn = static_cast<float>(best - kTurnsAside);
    if (best > 0 && best < kTurns - 1) {
      const auto middle = static_cast<size_t>(best);
      const float before = cost[middle - 1], here = cost[middle], after = cost[middle + 1];
      const float bend = before - 2 * here + after;
      if (bend > 0) turn += std::clamp(0.5f * (before - after) / bend, -0.5f, 0.5f);
    }
    constexpr float kWaist = 1 / (1 - kHipsShare);
    constexpr float kGaitTurn_rad = 0.1f;  // the waist turns by so much in walking
    return std::clamp(turn * kTurn_rad, kWaist * (columns.least_trunk_rad + kGaitTurn_rad),
                      kWaist * (columns.most_trunk_rad - kGaitTurn_rad));
  }
};

constexpr size_t kMostBorders = 64;

struct Borders {
  std::array<Border, kMostBorders> all;
  size_t count = 0;
  void add(const Border& border) {
    if (count < kMostBorders) all[count++] = border;
  }
};

float weight_at(float ahead_s) {
  return std::clamp((kYieldAhead_s - ahead_s) / (kYieldAhead_s - kSoon_s), 0.0f, 1.0f);
}

/// The border towards somebody as both will stand in a while: in the middle of what would be
/// between them as they are now.
void add_border(const Stance& own, const NearBody& near, const Stance& other, float ahead_s,
                Borders& borders) {
  const float weight = weight_at(ahead_s);
  float x = near.x_m + ahead_s * near.vx_mps, y = near.y_m + ahead_s * near.vy_mps;
  const float square = x * x + y * y;
  if (weight <= 0 || square > kYieldReach_m * kYieldReach_m) return;
  const float apart_m = std::sqrt(square), per_apart = 1 / std::max(apart_m, 1e-6f);
  x *= per_apart;
  y *= per_apart;
  const float angle = float_arc_tan2(y, x), per_scale = 1 / own.body.scale;
  const Limbs& limbs = own.limbs_in(ahead_s);
  Border border{x, y, direction_of(angle), 0, 0, weight, &limbs.arms, ahead_s == 0};
  if (near.yielder == nullptr) {
    border.trunk_room_m = border.arm_room_m = (apart_m - near.radius_m) * per_scale;
  } else {
    const Reach mine = reach_of(own, limbs, x, y, angle);
    const float cos = near.heading_cos, sin = near.heading_sin;
    const Reach theirs = reach_of(other, other.limbs_in(ahead_s), -(cos * x + sin * y),
                                  sin * x - cos * y, angle - near.heading_rad + 3.14159265f);
    border.trunk_room_m = 0.5f * (apart_m + mine.trunk_m - theirs.trunk_m) * per_scale;
    // What cannot be drawn in is given way to by the other's arm alone.
    border.arm_room_m =
        std::min(0.5f * (apart_m + mine.whole_m - theirs.whole_m), apart_m - theirs.firm_m) *
        per_scale;
  }
  borders.add(border);
}

void add_borders(const Stance& own, const NearBody& near, Borders& borders) {
  const float square = near.vx_mps * near.vx_mps + near.vy_mps * near.vy_mps;
  const float nearest_s =
      std::clamp(-(near.x_m * near.vx_mps + near.y_m * near.vy_mps) / std::max(square, 1e-4f), 0.0f,
                 kYieldAhead_s);
  const float x = near.x_m + nearest_s * near.vx_mps, y = near.y_m + nearest_s * near.vy_mps;
  if (x * x + y * y > kYieldReach_m * kYieldReach_m) return;
  const Stance other(near.yielder != nullptr ? *near.yielder : own.body, near.rhythm);
  add_border(own, near, other, 0, borders);
  if (nearest_s < 0.05f) return;
  add_border(own, near, other, nearest_s, borders);
  add_border(own, near, other, 0.5f * nearest_s, borders);
}

/// As it is now and as it will be soon.
void add_wall(const Stance& own, const NearWall& wall, Borders& borders) {
  const float direction = direction_of(float_arc_tan2(wall.y, wall.x));
  for (const float ahead_s : {0.0f, kSoon_s}) {
    const float room_m = (wall.distance_m - ahead_s * wall.approach_mps) / own.body.scale;
    borders.add(
        {wall.x, wall.y, direction, room_m, room_m, 1, &own.limbs_in(ahead_s).arms, ahead_s == 0});
  }
}

/// How far an arm has to be drawn in to stay within a border.
float draw_for(const ArmReach& arm, float room_m) {
  constexpr float kWorthIt_m = 0.01f;  // elsewhere it makes no difference
  const float lack_m = arm.swung_m + kArmMargin_m - room_m;
  if (lack_m <= 0) return 0;
  if (lack_m > arm.tucking_m && arm.stilling_m > kWorthIt_m)
    return DrawnArm::share_of(std::clamp((lack_m - arm.tucking_m) / arm.stilling_m, 0.0f, 1.0f));
  return DrawnArm::kTucked * std::min(lack_m / std::max(arm.tucking_m, 1e-4f), 1.0f);
}

/// How far an arm has to be drawn in to swing within all borders.
float wanted_draw(const Yielder& own, size_t side, const FloatSinCos& turn,
                  std::span<const Border> borders) {
  const Octagon &drawn = own.outline->drawn[side], &ever = own.swung->ever().arms[side];
  const float now = own.motion.arms[side];
  float wanted = 0;
  for (const Border& border : borders) {
    const float ahead = turn.cos * border.x + turn.sin * border.y;
    const float left = turn.cos * border.y - turn.sin * border.x;
    const float room_m = border.arm_room_m;
    const float draw = draw_for({(*border.arms)[side], drawn, ahead, left}, room_m);
    wanted = std::max(wanted, border.weight * draw);
    // Not let out only to be drawn in again by the same swing.
    if (border.is_now && now > wanted)
      wanted =
          std::max(wanted, std::min(now, kHeld * draw_for({ever, drawn, ahead, left}, room_m)));
  }
  return wanted;
}

float eased_towards(float wanted, float most_speed, float most_acceleration, float step_s,
                    float& value, float& speed) {
  // As fast as one can be and still stop there; near it slower, so that it is reached smoothly.
  constexpr float kPerSecond = 9;
  const float left = wanted - value, size = std::abs(left);
  const float fastest =
      std::min({most_speed, std::sqrt(1.4f * most_acceleration * size), kPerSecond * size});
  const float change = std::copysign(fastest, left) - speed;
  const float most_change = most_acceleration * step_s;
  speed += std::clamp(change, -most_change, most_change);
  value += speed * step_s;
  return value;
}

/// What is wanted, but no more than `most` nearer to nothing than now.
float held(float wanted, float now, float most) {
  if (std::abs(now) <= most) return wanted;
  return now > 0 ? std::max(wanted, now - most) : std::min(wanted, now + most);
}

}  // namespace

DrawnArm::DrawnArm(float share) {
  tucked = std::min(share / kTucked, 1.0f);
  const float u = std::max(share - kTucked, 0.0f) / (1 - kTucked);
  stilled = u * u * (2 - u);  // begins at rest
}

float DrawnArm::share_of(float stilled) {
  // The cubic's root: a guess not far above it, and Newton's step.
  float u = std::sqrt(stilled / (2 - std::sqrt(stilled)));
  if (u > 0) u -= (u * u * (2 - u) - stilled) / (u * (4 - 3 * u));
  return kTucked + (1 - kTucked) * u;
}

YieldMotion wanted_yield(const Yielder& own, const Rhythm& rhythm, std::span<const NearBody> near,
                         std::span<const NearWall> walls) {
  YieldMotion wanted;
  if (near.empty() && walls.empty()) return wanted;
  const Stance stance(own, rhythm);
  Borders borders;
  for (const NearBody& body : near) add_borders(stance, body, borders);
  for (const NearWall& wall : walls) add_wall(stance, wall, borders);
  wanted.is_near = borders.count > 0;
  if (!wanted.is_near) return wanted;
  const std::span<const Border> all(borders.all.data(), borders.count);
  TurnCosts costs;
  for (const Border& border : all) costs.add(own.outline->upper, border);
  wanted.turn_rad = costs.best_turn(own.outline->columns, own.motion.turn_rad);
  const FloatSinCos turn = float_sin_cos(wanted.turn_rad);
  for (size_t side = 0; side < 2; ++side) wanted.arms[side] = wanted_draw(own, side, turn, all);
  return wanted;
}

void follow(const YieldMotion& wanted, float step_s, YieldMotion& motion) {
  const YieldLimits& limits = kYieldLimits;
  const float turn_release = (wanted.is_near ? kReleaseNear_rps : kRelease_rps) * kReleaseAhead_s;
  const bool turns_back = wanted.turn_rad * motion.turn_rad < 0;
  const float turn_rad =
      turns_back ? wanted.turn_rad : held(wanted.turn_rad, motion.turn_rad, turn_release);
  eased_towards(turn_rad, limits.trunk_rps, limits.trunk_rps2, step_s, motion.turn_rad,
                motion.turn_rps);
  for (size_t side = 0; side < 2; ++side) {
    float& arm = motion.arms[side];
    eased_towards(wanted.arms[side], limits.arm_ps, limits.arm_ps2, step_s, arm,
                  motion.arms_ps[side]);
    if (arm >= 0 && arm <= 1) continue;
    arm = std::clamp(arm, 0.0f, 1.0f);
    motion.arms_ps[side] = 0;
  }
}

void put_yield(const YieldColumns& columns, const Yield& yield, std::span<float> row) {
  if (yield.is_none()) return;
  float& trunk = row[static_cast<size_t>(columns.trunk)];
  const float before = trunk;
  // The nearer to the joint's limit, the less of the gait's own turning: nothing is cut off.
  const float most_rad = yield.trunk_rad > 0 ? columns.most_trunk_rad : -columns.least_trunk_rad;
  const float turned = std::min(std::abs(yield.trunk_rad) / most_rad, 1.0f);
  trunk = std::clamp(yield.trunk_rad + (1 - turned * turned) * before, columns.least_trunk_rad,
                     columns.most_trunk_rad);
  if (columns.head >= 0) {
    float& head = row[static_cast<size_t>(columns.head)];
    head = std::clamp(head - (trunk - before), columns.least_head_rad, columns.most_head_rad);
  }
  for (size_t side = 0; side < 2; ++side) {
    const DrawnArm drawn(yield.arms[side]);
    for (size_t i = 0; i < YieldColumns::kArmJoints; ++i) {
      float& angle = row[static_cast<size_t>(columns.arms[side][i])];
      const float share = i == YieldColumns::kAbduction ? drawn.tucked : drawn.stilled;
      angle += share * (columns.drawn_rad[side][i] - angle);
    }
  }
}

}  // namespace throng
