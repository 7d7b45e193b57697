// Agents as lanes: orca.cpp, operation for operation.
#include <cstddef>
#include <cstdint>

#include "base/simd/dispatch.h"
#include "crowd/steering/orca.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd/steering/orca_simd.cpp"
#include <hwy/foreach_target.h>

#include "crowd/steering/half_planes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace {

/// avoidance_plane() for the neighbours, after the walls.
HWY_INLINE void add_people(const SteeringView& p, const AgentLanes& people,
                           const NeighbourLanes& own, PlaneLanes& planes) {
  const D d;
  const NeighbourSlots near(p, people);
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5f), side = hn::Set(d, 1e-6f);
  Encounters e;
  e.own_x = own.vx_mps;
  e.own_y = own.vy_mps;
  e.step_rate = hn::Set(d, 1 / p.period_s);
  e.horizon_rate = hn::Set(d, 1) / own.horizon_s;
  for (size_t k = 0; k < near.count; ++k) {
    const NeighbourLanes other(p, near.of(k));
    e.offset_x = other.x_m - own.x_m;
    e.offset_y = other.y_m - own.y_m;
    const M same = hn::And(e.offset_x == zero, e.offset_y == zero);
    const V apart = hn::IfThenElse(near.is_before(k, people), side, hn::Neg(side));
    e.offset_x = hn::IfThenElse(same, apart, e.offset_x);
    e.other_x = other.vx_mps;
    e.other_y = other.vy_mps;
    e.radius_m = own.radius_m + other.radius_m;
    e.share = half + half * (other.impatience - own.impatience);
    add_avoiding(e, near.has(k), planes);
  }
}

}  // namespace

void decide_all(const SteeringView& p, std::span<const uint32_t> slots, float* next_x_mps,
                float* next_y_mps) {
  const D d;
  for (size_t first = 0; first < slots.size(); first += kLanes) {
    const AgentLanes people(slots, first);
    const NeighbourLanes own(p, people.slots);
    PlaneLanes planes;
    add_walls(WallLanes(p, people), hn::Zero(d), p.wall_horizon_s, planes);
    add_people(p, people, own, planes);
    V x, y;
    choose_velocities(planes, hn::FirstN(d, people.count), own.preferred_x_mps, own.preferred_y_mps,
                      own.max_speed_mps, x, y);
    people.store(x, next_x_mps);
    people.store(y, next_y_mps);
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
