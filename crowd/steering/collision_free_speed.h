// The collision-free speed model turns agents away from neighbours and limits their speed by the
// gap ahead. Source: Tordeux, Chraibi & Seyfried, Traffic and Granular Flow '15, 2016.
// Invariant: the speed depends on the gap ahead only; discs at rest never overlap.
#pragma once

#include "crowd/steering/steering.h"

namespace throng {

void decide_collision_free_speed(const SteeringView& people, std::span<const uint32_t> slots,
                                 float* next_x_mps, float* next_y_mps);

/// exp(-x) for x >= 0 by plain arithmetic: the same on every machine, error below 1e-4.
float decaying_exp(float x);

/// Share of the desired speed walked at this density (Weidmann 1993), from 1 down to 0.
float weidmann_share(float people_per_m2);

/// Density in the half-disc ahead of the i-th deciding agent, which faces (direction_x,
/// direction_y), unit.
/// Counts half of the agent and all neighbours there, divided by the area in front of walls.
float density_ahead(const SteeringView& people, size_t i, uint32_t slot, float direction_x,
                    float direction_y);

}  // namespace throng
