// People as lanes: orca.cpp, operation for operation. Where somebody has fewer planes than others,
// planes that every velocity meets fill up. Whose planes contradict each other goes on alone, with
// planes as lanes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/simd/dispatch.h"
#include "scenes/crowd/steering/orca.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scenes/crowd/steering/orca_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace {

using D = Lanes;
using DU = LaneBits;
using DI = hn::RebindToSigned<D>;
constexpr float kNever_mps = -1e30f;
constexpr size_t kRoom = kMostPlanes + 16;

struct Planes {
  HWY_ALIGN float x[kRoom];
  HWY_ALIGN float y[kRoom];
  HWY_ALIGN float offset[kRoom];
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
  const float room = max_speed * max_speed - offset * offset;
  if (room < 0) return false;
  const Point foot{offset * nx, offset * ny};
  const Point along{-ny, nx};
  float high = std::sqrt(room);
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

/// As far along a direction as the planes allow; how many planes are met, in their order.
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
    // What comes after this plane is looked at again, with the new velocity.
    at += static_cast<size_t>(first);
    if (!solve_on_border(planes, at, direction, max_speed, v)) return at;
    ++at;
  }
  return planes.count;
}

void relax(const Planes& planes, size_t hard, size_t failed, float max_speed, Point& v) {
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

/// As many people as there are lanes: their slots, the first again in lanes beyond.
struct LanesOfPeople {
  HWY_ALIGN int32_t slots[kLanes];
  size_t first;  ///< of those who decide, which one the first of them is
  size_t count;

  HWY_INLINE LanesOfPeople(std::span<const uint32_t> all, size_t from)
      : first(from), count(std::min(kLanes, all.size() - from)) {
    for (size_t i = 0; i < kLanes; ++i)
      slots[i] = static_cast<int32_t>(all[from + (i < count ? i : 0)]);
  }
  HWY_INLINE V of(const float* values) const {
    return hn::GatherIndex(D(), values, hn::Load(DI(), slots));
  }
};

/// The planes of as many people as there are lanes: plane k of lane i stands at [k * kLanes + i].
struct LanesOfPlanes {
  HWY_ALIGN float x[kMostPlanes * kLanes];
  HWY_ALIGN float y[kMostPlanes * kLanes];
  HWY_ALIGN float offset[kMostPlanes * kLanes];
  size_t walls = 0;  ///< of who has most
  size_t count = 0;

  HWY_INLINE void store(size_t plane, V nx, V ny, V offset_mps) {
    const D d;
    hn::Store(nx, d, x + plane * kLanes);
    hn::Store(ny, d, y + plane * kLanes);
    hn::Store(offset_mps, d, offset + plane * kLanes);
  }
};

/// keep_off() of the walls of people.
HWY_INLINE void add_walls(const SteeringView& p, const LanesOfPeople& people,
                          LanesOfPlanes& planes) {
  const D d;
  const uint32_t* starts = p.wall_starts + people.first;
  planes.walls = 0;
  for (size_t i = 0; i < people.count; ++i)
    planes.walls = std::max<size_t>(planes.walls, starts[i + 1] - starts[i]);
  for (size_t w = 0; w < planes.walls; ++w)
    planes.store(w, hn::Zero(d), hn::Zero(d), hn::Set(d, kNever_mps));
  for (size_t i = 0; i < people.count; ++i)
    for (uint32_t w = starts[i]; w < starts[i + 1]; ++w) {
      const size_t at = (w - starts[i]) * kLanes + i;
      planes.x[at] = p.wall_x[w];
      planes.y[at] = p.wall_y[w];
      planes.offset[at] =
          -(p.wall_clearance_m[w] > 0 ? p.wall_clearance_m[w] : 0.0f) / p.wall_horizon_s;
    }
}

/// avoid() of the neighbours of people, behind the walls.
HWY_INLINE void add_people(const SteeringView& p, const LanesOfPeople& people,
                           LanesOfPlanes& planes) {
  const D d;
  const DU du;
  const DI di;
  HWY_ALIGN uint32_t counts[kLanes] = {};
  HWY_ALIGN int32_t others[NeighbourGrid::kMost * kLanes];
  std::fill(std::begin(others), std::end(others), people.slots[0]);
  size_t most = 0;
  for (size_t i = 0; i < people.count; ++i) {
    const auto slot = static_cast<size_t>(people.slots[i]);
    const uint32_t* near = p.neighbours + NeighbourGrid::kMost * slot;
    counts[i] = p.neighbour_counts[slot];
    most = std::max<size_t>(most, counts[i]);
    for (size_t k = 0; k < counts[i]; ++k) others[k * kLanes + i] = static_cast<int32_t>(near[k]);
  }
  const auto self = hn::BitCast(du, hn::Load(di, people.slots));
  const V x = people.of(p.x_m), y = people.of(p.y_m);
  const V own_x = people.of(p.vx_mps), own_y = people.of(p.vy_mps);
  const V own_radius = people.of(p.radius_m), own_urge = people.of(p.urge);
  const V half = hn::Set(d, 0.5f), zero = hn::Zero(d), tiny = hn::Set(d, kTiny_mps);
  const V step_rate = hn::Set(d, 1 / p.period_s);
  const V horizon_rate = hn::Div(hn::Set(d, 1), people.of(p.horizon_s));
  const V side = hn::Set(d, 1e-6f);
  for (size_t k = 0; k < most; ++k) {
    const auto has = hn::Gt(hn::Load(du, counts), hn::Set(du, static_cast<uint32_t>(k)));
    const auto other = hn::Load(di, others + k * kLanes);
    const auto of = [&](const float* values) HWY_ATTR { return hn::GatherIndex(d, values, other); };
    V ox = hn::Sub(of(p.x_m), x);
    const V oy = hn::Sub(of(p.y_m), y);
    const M same = hn::And(hn::Eq(ox, zero), hn::Eq(oy, zero));
    const M below = hn::RebindMask(d, hn::Lt(self, hn::BitCast(du, other)));
    ox = hn::IfThenElse(same, hn::IfThenElse(below, side, hn::Neg(side)), ox);
    const V vx = hn::Sub(own_x, of(p.vx_mps)), vy = hn::Sub(own_y, of(p.vy_mps));
    const V r = hn::Add(own_radius, of(p.radius_m));
    const V gap_square = hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy));
    const V radius_square = hn::Mul(r, r);
    const M overlaps = hn::Le(gap_square, radius_square);
    const V rate = hn::IfThenElse(overlaps, step_rate, horizon_rate);
    const V wx = hn::Sub(vx, hn::Mul(ox, rate)), wy = hn::Sub(vy, hn::Mul(oy, rate));
    const V w_square = hn::Add(hn::Mul(wx, wx), hn::Mul(wy, wy));
    const V w_along = hn::Add(hn::Mul(wx, ox), hn::Mul(wy, oy));
    const M circle = hn::Or(
        overlaps, hn::And(hn::Lt(w_along, zero),
                          hn::Gt(hn::Mul(w_along, w_along), hn::Mul(radius_square, w_square))));
    // The circle's normal.
    const V w_length = hn::Sqrt(w_square);
    const M known = hn::Gt(w_length, tiny);
    V cx = hn::Div(wx, w_length), cy = hn::Div(wy, w_length);
    if (!hn::AllTrue(d, known)) {
      const V gap = hn::Sqrt(gap_square);
      cx = hn::IfThenElse(known, cx, hn::Div(hn::Neg(ox), gap));
      cy = hn::IfThenElse(known, cy, hn::Div(hn::Neg(oy), gap));
    }
    const V circle_change = hn::Sub(hn::Mul(r, rate), w_length);
    // The leg's.
    const V leg = hn::Sqrt(hn::Max(hn::Sub(gap_square, radius_square), zero));
    const M left = hn::Gt(hn::Sub(hn::Mul(ox, wy), hn::Mul(oy, wx)), zero);
    const V side_leg = hn::IfThenElse(left, leg, hn::Neg(leg));
    const V lx = hn::Div(hn::Neg(hn::Add(hn::Mul(side_leg, oy), hn::Mul(r, ox))), gap_square);
    const V ly = hn::Div(hn::Sub(hn::Mul(side_leg, ox), hn::Mul(r, oy)), gap_square);
    const V leg_change = hn::Neg(hn::Add(hn::Mul(lx, vx), hn::Mul(ly, vy)));

    const V nx = hn::IfThenElse(circle, cx, lx), ny = hn::IfThenElse(circle, cy, ly);
    const V change = hn::IfThenElse(circle, circle_change, leg_change);
    const V burden = hn::Add(half, hn::Mul(half, hn::Sub(of(p.urge), own_urge)));
    const V share = hn::IfThenElse(hn::Gt(change, zero), burden, half);
    const V offset =
        hn::Add(hn::Add(hn::Mul(nx, own_x), hn::Mul(ny, own_y)), hn::Mul(share, change));
    const M in = hn::RebindMask(d, has);
    planes.store(planes.walls + k, hn::IfThenElseZero(in, nx), hn::IfThenElseZero(in, ny),
                 hn::IfThenElse(in, offset, hn::Set(d, kNever_mps)));
  }
  planes.count = planes.walls + most;
}

/// choose_velocity() without giving way where planes contradict each other: `failed` tells the
/// first plane of each lane that could not be met, or planes.count.
HWY_INLINE void solve_lanes(const LanesOfPlanes& planes, M in, V wish_x, V wish_y, V max_speed,
                            V& v_x, V& v_y, uint32_t* failed) {
  const D d;
  const DU du;
  const V tiny = hn::Set(d, kTiny_mps), zero = hn::Zero(d);
  const V length = hn::Sqrt(hn::Add(hn::Mul(wish_x, wish_x), hn::Mul(wish_y, wish_y)));
  const V scale =
      hn::IfThenElse(hn::Gt(length, max_speed), hn::Div(max_speed, length), hn::Set(d, 1));
  V x = hn::Mul(wish_x, scale), y = hn::Mul(wish_y, scale);
  const V max_square = hn::Mul(max_speed, max_speed);
  auto first_failed = hn::Set(du, static_cast<uint32_t>(planes.count));
  for (size_t i = 0; i < planes.count; ++i) {
    const V nx = hn::Load(d, planes.x + i * kLanes);
    const V ny = hn::Load(d, planes.y + i * kLanes);
    const V offset = hn::Load(d, planes.offset + i * kLanes);
    const V violation = hn::Sub(offset, hn::Add(hn::Mul(nx, x), hn::Mul(ny, y)));
    const M bad = hn::And(in, hn::Gt(violation, tiny));
    if (hn::AllFalse(d, bad)) continue;
    const V room = hn::Sub(max_square, hn::Mul(offset, offset));
    const V foot_x = hn::Mul(offset, nx), foot_y = hn::Mul(offset, ny);
    const V along_x = hn::Neg(ny), along_y = nx;
    M none = hn::Lt(room, zero);
    V high = hn::Sqrt(room);
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
    const V wanted = hn::Add(hn::Mul(along_x, wish_x), hn::Mul(along_y, wish_y));
    const V t = hn::IfThenElse(hn::Lt(wanted, low), low,
                               hn::IfThenElse(hn::Lt(high, wanted), high, wanted));
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

/// What is left for one lane whose plane `failed` cannot be met.
void give_way(const LanesOfPlanes& lanes, size_t lane, size_t walls, size_t people, size_t failed,
              float max_speed, Point& v) {
  if (failed < lanes.walls) {
    v = {0, 0};
    return;
  }
  Planes own;
  const auto add = [&](size_t plane) {
    const size_t at = plane * kLanes + lane;
    own.add(lanes.x[at], lanes.y[at], lanes.offset[at]);
  };
  for (size_t w = 0; w < walls; ++w) add(w);
  for (size_t k = 0; k < people; ++k) add(lanes.walls + k);
  relax(own, walls, failed - lanes.walls + walls, max_speed, v);
}

}  // namespace

void decide_all(const SteeringView& p, std::span<const uint32_t> slots, float* next_x_mps,
                float* next_y_mps) {
  const D d;
  LanesOfPlanes planes;
  HWY_ALIGN uint32_t failed[kLanes];
  HWY_ALIGN float chosen_x[kLanes], chosen_y[kLanes];
  for (size_t first = 0; first < slots.size(); first += kLanes) {
    const LanesOfPeople people(slots, first);
    add_walls(p, people, planes);
    add_people(p, people, planes);
    V x, y;
    solve_lanes(planes, hn::FirstN(d, people.count), people.of(p.wanted_x_mps),
                people.of(p.wanted_y_mps), people.of(p.max_speed_mps), x, y, failed);
    hn::Store(x, d, chosen_x);
    hn::Store(y, d, chosen_y);
    const uint32_t* walls = p.wall_starts + first;
    for (size_t i = 0; i < people.count; ++i) {
      const uint32_t slot = slots[first + i];
      Point v{chosen_x[i], chosen_y[i]};
      if (failed[i] < planes.count)
        give_way(planes, i, walls[i + 1] - walls[i], p.neighbour_counts[slot], failed[i],
                 p.max_speed_mps[slot], v);
      next_x_mps[slot] = v.x;
      next_y_mps[slot] = v.y;
    }
  }
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

SteeringFunction orca_on(SimdTarget target) {
  return THRONG_CHOOSE(resolved(target), decide_all, decide_orca_scalar);
}

}  // namespace throng
#endif
