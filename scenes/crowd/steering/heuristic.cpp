// One way after the other: the definition.
#include "scenes/crowd/steering/heuristic.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"
#include "base/simd/one_lane.h"

namespace throng {
namespace one_lane {
namespace {

#include "scenes/crowd/steering/heuristic-inl.h"

}  // namespace
}  // namespace one_lane

void decide_heuristic_scalar(const SteeringView& people, std::span<const uint32_t> slots,
                             float* next_x_mps, float* next_y_mps) {
  one_lane::decide_each(people, slots, next_x_mps, next_y_mps);
}

}  // namespace throng
