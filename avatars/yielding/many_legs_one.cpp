#include "avatars/yielding/many_legs_kernel.h"
#include "base/simd/one_lane.h"

namespace throng {
namespace one_lane {
namespace {

#define THRONG_LANES inline
#include "avatars/yielding/many_legs-inl.h"

}  // namespace
}  // namespace one_lane

float nearness(const LegPlace& place, const LegOwner& own, const OtherLeg& other, float clear_m) {
  const one_lane::Leg leg = {{place.foot_m.x(), place.foot_m.y()},
                             {place.shin_m.x(), place.shin_m.y()},
                             {place.knee_m.x(), place.knee_m.y()}};
  return one_lane::nearness_of(leg, own, other, clear_m).v;
}

void foresee_one_by_one(const LegNow& leg, const PlaceNumbers& ahead_s, size_t count,
                        ForeseenLeg& foreseen) {
  for (size_t i = 0; i < count; ++i) one_lane::foresee_at(i, leg, ahead_s, foreseen);
}

void add_nearness_one_by_one(const LegPlaces& places, const LegOwner& own,
                             std::span<const OtherLeg> others, float clear_m, PlaceNumbers& costs) {
  for (size_t i = 0; i < kPlaces; ++i)
    one_lane::add_nearness_at(i, places, own, others, clear_m, costs);
}

void add_nearness_in_one_by_one(const Rhythms& rhythms, const std::array<LegNow, 2>& own,
                                std::span<const LegsThen> others, float clear_m,
                                PlaceNumbers& costs) {
  for (size_t i = 0; i < kPlaces; ++i)
    one_lane::add_nearness_in_at(i, rhythms, own, others, clear_m, costs);
}

}  // namespace throng
