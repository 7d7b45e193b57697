// The planes of one person as lanes: orca.cpp, operation for operation. A lane without a plane
// holds one that every velocity meets.
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "scenes/orca.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scenes/orca_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr size_t kLanes = hn::MaxLanes(D());
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

HWY_INLINE bool solve_on_border(const Planes& planes, size_t index, const Point& wish,
                                bool is_direction, float max_speed, Point& v) {
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
  const float wanted = along.x * wish.x + along.y * wish.y;
  const float t = is_direction ? (wanted > 0 ? high : low)
                               : (wanted < low ? low : (high < wanted ? high : wanted));
  v = {foot.x + t * along.x, foot.y + t * along.y};
  return true;
}

size_t solve(const Planes& planes, const Point& wish, bool is_direction, float max_speed,
             Point& v) {
  const D d;
  if (is_direction) {
    v = {max_speed * wish.x, max_speed * wish.y};
  } else {
    const float length = std::sqrt(wish.x * wish.x + wish.y * wish.y);
    v = wish;
    if (length > max_speed) {
      const float scale = max_speed / length;
      v = {v.x * scale, v.y * scale};
    }
  }
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
    if (!solve_on_border(planes, at, wish, is_direction, max_speed, v)) return at;
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
    if (solve(others, {planes.x[i], planes.y[i]}, true, max_speed, candidate) == others.count)
      v = candidate;
    const float now = violation(i);
    worst = worst < now ? now : worst;
  }
}

/// avoid() of the people from neighbour k on, appended to the planes.
HWY_INLINE void add_people(const SteeringView& p, size_t slot, Planes& planes) {
  const D d;
  const size_t count = p.neighbour_counts[slot];
  HWY_ALIGN float px[16], py[16], ux[16], uy[16], radius[16], urge[16];
  const uint32_t* near = p.neighbours + NeighbourGrid::kMost * slot;
  for (size_t k = 0; k < count; ++k) {
    const uint32_t other = near[k];
    px[k] = p.x_m[other] - p.x_m[slot];
    py[k] = p.y_m[other] - p.y_m[slot];
    if (px[k] == 0 && py[k] == 0) px[k] = slot < other ? 1e-6f : -1e-6f;
    ux[k] = p.vx_mps[other];
    uy[k] = p.vy_mps[other];
    radius[k] = p.radius_m[other];
    urge[k] = p.urge[other];
  }
  for (size_t k = count; k < 16; ++k) {
    px[k] = py[k] = 1;
    ux[k] = uy[k] = radius[k] = urge[k] = 0;
  }
  const V own_x = hn::Set(d, p.vx_mps[slot]), own_y = hn::Set(d, p.vy_mps[slot]);
  const V own_radius = hn::Set(d, p.radius_m[slot]);
  const V half = hn::Set(d, 0.5f), zero = hn::Zero(d);
  const V step_rate = hn::Set(d, 1 / p.period_s), horizon_rate = hn::Set(d, 1 / p.horizon_s[slot]);
  const V tiny = hn::Set(d, kTiny_mps);
  for (size_t k = 0; k < count; k += kLanes) {
    const V ox = hn::Load(d, px + k), oy = hn::Load(d, py + k);
    const V vx = hn::Sub(own_x, hn::Load(d, ux + k)), vy = hn::Sub(own_y, hn::Load(d, uy + k));
    const V r = hn::Add(own_radius, hn::Load(d, radius + k));
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
    const V gap = hn::Sqrt(gap_square);
    const M known = hn::Gt(w_length, tiny);
    const V cx = hn::IfThenElse(known, hn::Div(wx, w_length), hn::Div(hn::Neg(ox), gap));
    const V cy = hn::IfThenElse(known, hn::Div(wy, w_length), hn::Div(hn::Neg(oy), gap));
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
    const V burden =
        hn::Add(half, hn::Mul(half, hn::Sub(hn::Load(d, urge + k), hn::Set(d, p.urge[slot]))));
    const V share = hn::IfThenElse(hn::Gt(change, zero), burden, half);
    const V offset =
        hn::Add(hn::Add(hn::Mul(nx, own_x), hn::Mul(ny, own_y)), hn::Mul(share, change));
    hn::StoreU(nx, d, planes.x + planes.count + k);
    hn::StoreU(ny, d, planes.y + planes.count + k);
    hn::StoreU(offset, d, planes.offset + planes.count + k);
  }
  planes.count += count;
}

}  // namespace

void decide_all(const SteeringView& p, size_t begin, size_t end, float* next_x_mps,
                float* next_y_mps) {
  Planes planes;
  for (size_t slot = begin; slot < end; ++slot) {
    planes.count = 0;
    const size_t in_block = slot - p.first_slot;
    for (uint32_t w = p.wall_starts[in_block]; w < p.wall_starts[in_block + 1]; ++w) {
      const float clearance = p.wall_clearance_m[w] > 0 ? p.wall_clearance_m[w] : 0.0f;
      planes.add(p.wall_x[w], p.wall_y[w], -clearance / p.wall_horizon_s);
    }
    const size_t hard = planes.count;
    add_people(p, slot, planes);
    planes.pad();
    Point v{0, 0};
    const size_t failed = solve(planes, {p.wanted_x_mps[slot], p.wanted_y_mps[slot]}, false,
                                p.max_speed_mps[slot], v);
    if (failed < hard)
      v = {0, 0};
    else if (failed < planes.count)
      relax(planes, hard, failed, p.max_speed_mps[slot], v);
    next_x_mps[slot] = v.x;
    next_y_mps[slot] = v.y;
  }
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

void decide_orca_sse4(const SteeringView& p, size_t begin, size_t end, float* x, float* y) {
#if HWY_TARGETS & HWY_SSE4
  N_SSE4::decide_all(p, begin, end, x, y);
#else
  decide_orca_scalar(p, begin, end, x, y);
#endif
}
void decide_orca_avx2(const SteeringView& p, size_t begin, size_t end, float* x, float* y) {
#if HWY_TARGETS & HWY_AVX2
  N_AVX2::decide_all(p, begin, end, x, y);
#else
  decide_orca_scalar(p, begin, end, x, y);
#endif
}
void decide_orca_avx512(const SteeringView& p, size_t begin, size_t end, float* x, float* y) {
#if HWY_TARGETS & HWY_AVX3
  N_AVX3::decide_all(p, begin, end, x, y);
#else
  decide_orca_scalar(p, begin, end, x, y);
#endif
}

}  // namespace throng
#endif
