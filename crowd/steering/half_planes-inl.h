// Half-planes of velocities with agents as lanes: orca.cpp, operation for operation. Agents with
// fewer planes than others get planes that every velocity satisfies.
// Agents with contradictory planes continue alone, with planes as lanes.
#if defined(THRONG_CROWD_HALF_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THRONG_CROWD_HALF_PLANES_INL_H_
#undef THRONG_CROWD_HALF_PLANES_INL_H_
#else
#define THRONG_CROWD_HALF_PLANES_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/simd/lanes-inl.h"
#include "crowd/steering/orca.h"

#if THRONG_HAS_LANES
HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
namespace {

using D = Lanes;
using DU = LaneBits;
using DI = hn::RebindToSigned<D>;
constexpr float kNever_mps = -1e30f;
constexpr size_t kCapacity = kMaxPlanes + 16;

struct Planes {
  HWY_ALIGN float x[kCapacity];
  HWY_ALIGN float y[kCapacity];
  HWY_ALIGN float offset[kCapacity];
  size_t count = 0;

  void add(float nx, float ny, float offset_mps) {
    x[count] = nx;
    y[count] = ny;
    offset[count++] = offset_mps;
  }
  void pad() {
    const D d;
    hn::StoreU(hn::Zero(d), d, x + count);
    hn::StoreU(hn::Zero(d), d, y + count);
    hn::StoreU(hn::Set(d, kNever_mps), d, offset + count);
  }
};

struct Point {
  float x, y;
};

/// violation_mps() of the planes from `at` on.
HWY_INLINE V violations(const Planes& planes, size_t at, V x, V y) {
  const D d;
  return hn::Sub(
      hn::LoadU(d, planes.offset + at),
      hn::Add(hn::Mul(hn::LoadU(d, planes.x + at), x), hn::Mul(hn::LoadU(d, planes.y + at), y)));
}

HWY_INLINE bool solve_on_border(const Planes& planes, size_t index, const Point& direction,
                                float max_speed, Point& v) {
  const D d;
  const float nx = planes.x[index], ny = planes.y[index], offset = planes.offset[index];
  const float discriminant = max_speed * max_speed - offset * offset;
  if (discriminant < 0) return false;
  const Point foot{offset * nx, offset * ny};
  const Point along{-ny, nx};
  float high = std::sqrt(discriminant);
  float low = -high;
  if (index > 0) {
    V lows = hn::Set(d, low), highs = hn::Set(d, high);
    M none = hn::FirstN(d, 0);
    const V tiny = hn::Set(d, kTiny_mps);
    const V ax = hn::Set(d, along.x), ay = hn::Set(d, along.y);
    const V fx = hn::Set(d, foot.x), fy = hn::Set(d, foot.y);
    for (size_t i = 0; i < index; i += kLanes) {
      const M in = hn::FirstN(d, index - i);
      const V slope =
          hn::Add(hn::Mul(hn::LoadU(d, planes.x + i), ax), hn::Mul(hn::LoadU(d, planes.y + i), ay));
      const V need = violations(planes, i, fx, fy);
      const M parallel = hn::Le(hn::Abs(slope), tiny);
      none = hn::Or(none, hn::And(in, hn::And(parallel, hn::Gt(need, tiny))));
      const M bounds = hn::AndNot(parallel, in);
      const V t = hn::Div(need, slope);
      const M rising = hn::Gt(slope, hn::Zero(d));
      lows = hn::IfThenElse(hn::And(bounds, rising), hn::Max(lows, t), lows);
      highs = hn::IfThenElse(hn::AndNot(rising, bounds), hn::Min(highs, t), highs);
    }
    if (!hn::AllFalse(d, none)) return false;
    low = hn::GetLane(hn::MaxOfLanes(d, lows));
    high = hn::GetLane(hn::MinOfLanes(d, highs));
    if (low > high) return false;
  }
  const float t = along.x * direction.x + along.y * direction.y > 0 ? high : low;
  v = {foot.x + t * along.x, foot.y + t * along.y};
  return true;
}

/// Maximises the velocity along a direction; returns the number of planes satisfied, in order.
size_t solve(const Planes& planes, const Point& direction, float max_speed, Point& v) {
  const D d;
  v = {max_speed * direction.x, max_speed * direction.y};
  const V tiny = hn::Set(d, kTiny_mps);
  for (size_t at = 0; at < planes.count;) {
    const M bad = hn::Gt(violations(planes, at, hn::Set(d, v.x), hn::Set(d, v.y)), tiny);
    const intptr_t first = hn::FindFirstTrue(d, bad);
    if (first < 0) {
      at += kLanes;
      continue;
    }
    // The planes after this one are tested again with the new velocity.
    at += static_cast<size_t>(first);
    if (!solve_on_border(planes, at, direction, max_speed, v)) return at;
    ++at;
  }
  return planes.count;
}

void minimise_violation(const Planes& planes, size_t hard, size_t failed, float max_speed,
                        Point& v) {
  const D d;
  Planes others;
  for (size_t i = 0; i < hard; ++i) others.add(planes.x[i], planes.y[i], planes.offset[i]);
  const V tiny = hn::Set(d, kTiny_mps);
  float worst = 0;
  const auto violation = [&](size_t i) {
    return planes.offset[i] - (planes.x[i] * v.x + planes.y[i] * v.y);
  };
  for (size_t i = failed > hard ? failed : hard; i < planes.count; ++i) {
    if (violation(i) <= worst + kTiny_mps) continue;
    const V nx = hn::Set(d, planes.x[i]), ny = hn::Set(d, planes.y[i]);
    const V offset = hn::Set(d, planes.offset[i]);
    others.count = hard + (i - hard);
    for (size_t j = hard; j < i; j += kLanes) {
      const V dx = hn::Sub(hn::LoadU(d, planes.x + j), nx);
      const V dy = hn::Sub(hn::LoadU(d, planes.y + j), ny);
      const V length = hn::Sqrt(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
      const M apart = hn::Gt(length, tiny);
      const V away = hn::Sub(hn::LoadU(d, planes.offset + j), offset);
      hn::StoreU(hn::IfThenElseZero(apart, hn::Div(dx, length)), d, others.x + j);
      hn::StoreU(hn::IfThenElseZero(apart, hn::Div(dy, length)), d, others.y + j);
      hn::StoreU(hn::IfThenElse(apart, hn::Div(away, length), hn::Set(d, kNever_mps)), d,
                 others.offset + j);
    }
    others.pad();
    Point candidate = v;
    if (solve(others, {planes.x[i], planes.y[i]}, max_speed, candidate) == others.count)
      v = candidate;
    const float now = violation(i);
    worst = worst < now ? now : worst;
  }
}

/// NeighbourState with one agent per lane.
struct NeighbourLanes {
  V x_m, y_m, vx_mps, vy_mps, preferred_x_mps, preferred_y_mps, direction_x, direction_y, radius_m,
      impatience, catch_up, max_speed_mps, horizon_s;

  /// `slots`: one per lane.
  HWY_INLINE NeighbourLanes(const SteeringView& p, const int32_t* slots) {
    const auto load = [&](size_t first, V(&fields)[4]) HWY_ATTR {
      load_rows(
          [&](size_t lane) HWY_ATTR {
            return reinterpret_cast<const float*>(p.published + slots[lane]) + first;
          },
          fields);
    };
    V fields[4];
    load(0, fields);
    x_m = fields[0], y_m = fields[1], vx_mps = fields[2], vy_mps = fields[3];
    load(4, fields);
    preferred_x_mps = fields[0], preferred_y_mps = fields[1], direction_x = fields[2],
    direction_y = fields[3];
    load(8, fields);
    radius_m = fields[0], impatience = fields[1], catch_up = fields[2], max_speed_mps = fields[3];
    load(12, fields);
    horizon_s = fields[0];
  }
  static_assert(offsetof(NeighbourState, preferred_x_mps) == 4 * sizeof(float) &&
                offsetof(NeighbourState, radius_m) == 8 * sizeof(float) &&
                offsetof(NeighbourState, horizon_s) == 12 * sizeof(float) &&
                sizeof(NeighbourState) == 16 * sizeof(float));
};

/// As many agents as there are lanes: their slots; surplus lanes repeat the first.
struct AgentLanes {
  HWY_ALIGN int32_t slots[kLanes];
  size_t first;  ///< index of the first one among the deciding agents
  size_t count;

  HWY_INLINE AgentLanes(std::span<const uint32_t> all, size_t from)
      : first(from), count(std::min(kLanes, all.size() - from)) {
    for (size_t i = 0; i < kLanes; ++i)
      slots[i] = static_cast<int32_t>(all[from + (i < count ? i : 0)]);
  }
  HWY_INLINE void store(V values, float* by_slot) const {
    HWY_ALIGN float lanes[kLanes];
    hn::Store(values, D(), lanes);
    for (size_t i = 0; i < count; ++i) by_slot[slots[i]] = lanes[i];
  }
};

/// The k-th neighbours of all lanes are consecutive: [k * kLanes + lane]. Lanes with fewer
/// neighbours are filled with the agent's own slot.
struct NeighbourSlots {
  HWY_ALIGN int32_t slots[NeighbourGrid::kMaxNeighbours * kLanes];
  HWY_ALIGN uint32_t counts[kLanes] = {};
  size_t count = 0;

  HWY_INLINE NeighbourSlots(const SteeringView& p, const AgentLanes& people) {
    for (size_t i = 0; i < people.count; ++i) {
      counts[i] = p.neighbour_counts[people.slots[i]];
      count = std::max<size_t>(count, counts[i]);
    }
    for (size_t k = 0; k < count; ++k)
      for (size_t i = 0; i < kLanes; ++i) {
        const auto own = static_cast<size_t>(people.slots[i]);
        slots[k * kLanes + i] = static_cast<int32_t>(
            k < counts[i] ? p.neighbours[NeighbourGrid::kMaxNeighbours * own + k] : own);
      }
  }
  HWY_INLINE M has(size_t k) const {
    return hn::RebindMask(D(),
                          hn::Gt(hn::Load(DU(), counts), hn::Set(DU(), static_cast<uint32_t>(k))));
  }
  HWY_INLINE const int32_t* of(size_t k) const { return slots + k * kLanes; }
  /// Lanes whose own slot comes before the k-th neighbour's.
  HWY_INLINE M is_before(size_t k, const AgentLanes& people) const {
    return hn::RebindMask(D(),
                          hn::Lt(hn::Load(DI(), people.slots), hn::Load(DI(), slots + k * kLanes)));
  }
};

/// The w-th walls of all lanes are consecutive. Missing walls are distant and without direction.
struct WallLanes {
  HWY_ALIGN float x[kMaxWalls * kLanes];
  HWY_ALIGN float y[kMaxWalls * kLanes];
  HWY_ALIGN float clearance_m[kMaxWalls * kLanes];
  size_t count = 0;

  HWY_INLINE WallLanes(const SteeringView& p, const AgentLanes& people) {
    const D d;
    constexpr float kAway_m = 1e15f;
    const uint32_t* starts = p.wall_starts + people.first;
    for (size_t i = 0; i < people.count; ++i)
      count = std::max<size_t>(count, starts[i + 1] - starts[i]);
    for (size_t at = 0; at < count * kLanes; at += kLanes) {
      hn::Store(hn::Zero(d), d, x + at);
      hn::Store(hn::Zero(d), d, y + at);
      hn::Store(hn::Set(d, kAway_m), d, clearance_m + at);
    }
    for (size_t i = 0; i < people.count; ++i)
      for (uint32_t w = starts[i]; w < starts[i + 1]; ++w) {
        const size_t at = (w - starts[i]) * kLanes + i;
        x[at] = p.wall_x[w];
        y[at] = p.wall_y[w];
        clearance_m[at] = p.wall_clearance_m[w];
      }
  }
};

/// Plane k of lane i is at [k * kLanes + i]. The hard planes come first.
struct PlaneLanes {
  HWY_ALIGN float x[kMaxPlanes * kLanes];
  HWY_ALIGN float y[kMaxPlanes * kLanes];
  HWY_ALIGN float offset[kMaxPlanes * kLanes];
  size_t hard = 0;
  size_t count = 0;

  /// Lanes outside `in` get a plane that every velocity satisfies.
  HWY_INLINE void add(M in, V nx, V ny, V offset_mps) {
    const D d;
    hn::Store(hn::IfThenElseZero(in, nx), d, x + count * kLanes);
    hn::Store(hn::IfThenElseZero(in, ny), d, y + count * kLanes);
    hn::Store(hn::IfThenElse(in, offset_mps, hn::Set(d, kNever_mps)), d, offset + count * kLanes);
    ++count;
  }
  HWY_INLINE void add_hard(M in, V nx, V ny, V offset_mps) {
    add(in, nx, ny, offset_mps);
    hard = count;
  }
};

/// wall_plane() for all walls; discs may come `slack_m` closer to them than their radii.
HWY_INLINE void add_walls(const WallLanes& walls, V slack_m, float horizon_s, PlaneLanes& planes) {
  const D d;
  for (size_t w = 0; w < walls.count; ++w) {
    const V x = hn::Load(d, walls.x + w * kLanes), y = hn::Load(d, walls.y + w * kLanes);
    const V clearance_m = hn::Load(d, walls.clearance_m + w * kLanes) + slack_m;
    const M is_there = hn::Not(hn::And(hn::Eq(x, hn::Zero(d)), hn::Eq(y, hn::Zero(d))));
    planes.add_hard(is_there, x, y,
                    hn::Neg(hn::Max(clearance_m, hn::Zero(d))) / hn::Set(d, horizon_s));
  }
}

struct Encounters {
  V offset_x, offset_y;
  V own_x, own_y;
  V other_x, other_y;
  V radius_m;
  V horizon_rate, step_rate;  ///< 1 / horizon_s, 1 / step_s
  V share;
};

/// avoidance_plane() for the lanes in `in`.
HWY_INLINE void add_avoiding(const Encounters& e, M in, PlaneLanes& planes) {
  const D d;
  const V zero = hn::Zero(d), tiny = hn::Set(d, kTiny_mps), half = hn::Set(d, 0.5f);
  const V ox = e.offset_x, oy = e.offset_y, r = e.radius_m;
  const V vx = e.own_x - e.other_x, vy = e.own_y - e.other_y;
  const V gap_square = ox * ox + oy * oy;
  const V radius_square = r * r;
  const M overlaps = gap_square <= radius_square;
  const V rate = hn::IfThenElse(overlaps, e.step_rate, e.horizon_rate);
  const V wx = vx - ox * rate, wy = vy - oy * rate;
  const V w_square = wx * wx + wy * wy;
  const V w_along = wx * ox + wy * oy;
  const M is_short = hn::Lt(w_along, zero);
  const M is_within = hn::Gt(w_along * w_along, radius_square * w_square);
  const M circle = hn::Or(overlaps, hn::And(is_short, is_within));
  // Normal of the circle.
  const V w_length = hn::Sqrt(w_square);
  const M known = w_length > tiny;
  V cx = wx / w_length, cy = wy / w_length;
  if (!hn::AllTrue(d, known)) {
    const V gap = hn::Sqrt(gap_square);
    cx = hn::IfThenElse(known, cx, hn::Neg(ox) / gap);
    cy = hn::IfThenElse(known, cy, hn::Neg(oy) / gap);
  }
  const V circle_change = r * rate - w_length;
  // Normal of the leg.
  const V leg = hn::Sqrt(hn::Max(gap_square - radius_square, zero));
  const M left = ox * wy - oy * wx > zero;
  const V side_leg = hn::IfThenElse(left, leg, hn::Neg(leg));
  const V lx = hn::Neg(side_leg * oy + r * ox) / gap_square;
  const V ly = (side_leg * ox - r * oy) / gap_square;
  const V leg_change = hn::Neg(lx * vx + ly * vy);

  const V nx = hn::IfThenElse(circle, cx, lx), ny = hn::IfThenElse(circle, cy, ly);
  const V change = hn::IfThenElse(circle, circle_change, leg_change);
  const V share = hn::IfThenElse(change > zero, e.share, half);
  planes.add(in, nx, ny, nx * e.own_x + ny * e.own_y + share * change);
}

/// solve() for the lanes in `in`. `failed`: first unsatisfiable plane per lane, or planes.count.
HWY_INLINE void solve_lanes(const PlaneLanes& planes, M in, V preferred_x, V preferred_y,
                            V max_speed, V& v_x, V& v_y, uint32_t* failed) {
  const D d;
  const DU du;
  const V tiny = hn::Set(d, kTiny_mps), zero = hn::Zero(d);
  const V length =
      hn::Sqrt(hn::Add(hn::Mul(preferred_x, preferred_x), hn::Mul(preferred_y, preferred_y)));
  const V scale =
      hn::IfThenElse(hn::Gt(length, max_speed), hn::Div(max_speed, length), hn::Set(d, 1));
  V x = hn::Mul(preferred_x, scale), y = hn::Mul(preferred_y, scale);
  const V max_square = hn::Mul(max_speed, max_speed);
  auto first_failed = hn::Set(du, static_cast<uint32_t>(planes.count));
  for (size_t i = 0; i < planes.count; ++i) {
    const V nx = hn::Load(d, planes.x + i * kLanes);
    const V ny = hn::Load(d, planes.y + i * kLanes);
    const V offset = hn::Load(d, planes.offset + i * kLanes);
    const V violation = hn::Sub(offset, hn::Add(hn::Mul(nx, x), hn::Mul(ny, y)));
    const M bad = hn::And(in, hn::Gt(violation, tiny));
    if (hn::AllFalse(d, bad)) continue;
    const V discriminant = hn::Sub(max_square, hn::Mul(offset, offset));
    const V foot_x = hn::Mul(offset, nx), foot_y = hn::Mul(offset, ny);
    const V along_x = hn::Neg(ny), along_y = nx;
    M none = hn::Lt(discriminant, zero);
    V high = hn::Sqrt(discriminant);
    V low = hn::Neg(high);
    for (size_t j = 0; j < i; ++j) {
      const V jx = hn::Load(d, planes.x + j * kLanes), jy = hn::Load(d, planes.y + j * kLanes);
      const V slope = hn::Add(hn::Mul(jx, along_x), hn::Mul(jy, along_y));
      const V need = hn::Sub(hn::Load(d, planes.offset + j * kLanes),
                             hn::Add(hn::Mul(jx, foot_x), hn::Mul(jy, foot_y)));
      const M parallel = hn::Le(hn::Abs(slope), tiny);
      const V t = hn::Div(need, slope);
      const M rising = hn::Gt(slope, tiny);
      none = hn::Or(none, hn::And(parallel, hn::Gt(need, tiny)));
      low = hn::IfThenElse(rising, hn::Max(low, t), low);
      high = hn::IfThenElse(hn::Or(rising, parallel), high, hn::Min(high, t));
    }
    none = hn::And(bad, hn::Or(none, hn::Gt(low, high)));
    const V preferred = hn::Add(hn::Mul(along_x, preferred_x), hn::Mul(along_y, preferred_y));
    const V t = hn::IfThenElse(hn::Lt(preferred, low), low,
                               hn::IfThenElse(hn::Lt(high, preferred), high, preferred));
    const M met = hn::AndNot(none, bad);
    x = hn::IfThenElse(met, hn::Add(foot_x, hn::Mul(t, along_x)), x);
    y = hn::IfThenElse(met, hn::Add(foot_y, hn::Mul(t, along_y)), y);
    first_failed = hn::IfThenElse(hn::RebindMask(du, none), hn::Set(du, static_cast<uint32_t>(i)),
                                  first_failed);
    in = hn::AndNot(none, in);
  }
  v_x = x;
  v_y = y;
  hn::Store(first_failed, du, failed);
}

/// Continues one lane whose plane `failed` cannot be satisfied.
inline void relax_lane(const PlaneLanes& lanes, size_t lane, size_t failed, float max_speed,
                       Point& v) {
  if (failed < lanes.hard) {  // only rounding makes them fail: all allow standing still
    v = {0, 0};
    return;
  }
  Planes own;
  size_t hard = 0, own_failed = 0;
  for (size_t plane = 0; plane < lanes.count; ++plane) {
    if (plane == lanes.hard) hard = own.count;
    if (plane == failed) own_failed = own.count;
    const size_t at = plane * kLanes + lane;
    if (lanes.offset[at] != kNever_mps) own.add(lanes.x[at], lanes.y[at], lanes.offset[at]);
  }
  minimise_violation(own, hard, own_failed, max_speed, v);
}

/// choose_velocity() for the lanes in `in`; results of other lanes are undefined.
HWY_INLINE void choose_velocities(const PlaneLanes& planes, M in, V preferred_x, V preferred_y,
                                  V max_speed, V& v_x, V& v_y) {
  const D d;
  HWY_ALIGN uint32_t failed[kLanes];
  solve_lanes(planes, in, preferred_x, preferred_y, max_speed, v_x, v_y, failed);
  const M failing = hn::RebindMask(
      d, hn::Lt(hn::Load(DU(), failed), hn::Set(DU(), static_cast<uint32_t>(planes.count))));
  if (hn::AllFalse(d, failing)) return;
  HWY_ALIGN float x[kLanes], y[kLanes], max_speeds[kLanes];
  hn::Store(v_x, d, x);
  hn::Store(v_y, d, y);
  hn::Store(max_speed, d, max_speeds);
  for (size_t i = 0; i < kLanes; ++i) {
    if (failed[i] == planes.count) continue;
    Point v{x[i], y[i]};
    relax_lane(planes, i, failed[i], max_speeds[i], v);
    x[i] = v.x;
    y[i] = v.y;
  }
  v_x = hn::Load(d, x);
  v_y = hn::Load(d, y);
}

}  // namespace
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif  // THRONG_HAS_LANES

#endif  // per-target include guard
