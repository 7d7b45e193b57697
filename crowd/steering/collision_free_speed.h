// The collision-free speed model: turn away from who is near, and never walk faster than the gap
// ahead allows (Tordeux, Chraibi & Seyfried, Traffic and Granular Flow '15, 2016).
// One rule: speed depends on the gap to who is ahead only, so that discs at rest never overlap.
#pragma once

#include "crowd/steering/steering.h"

namespace throng {

void decide_collision_free_speed(const SteeringView& people, std::span<const uint32_t> slots,
                                 float* next_x_mps, float* next_y_mps);

/// exp(-x) for x >= 0, by plain arithmetic: the same on every machine, off by less than 1e-4.
float decaying_exp(float x);

/// The share of the free speed that is walked at this density (Weidmann 1993), from 1 down to 0.
float weidmann_share(float people_per_m2);

/// Density in the half-disc before the i-th of those who decide, who looks along (direction_x,
/// direction_y), unit: half of the person, and who is there, over the part of its area that is
/// before no wall.
float density_ahead(const SteeringView& people, size_t i, uint32_t slot, float direction_x,
                    float direction_y);

}  // namespace throng
