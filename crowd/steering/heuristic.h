// Behavioural heuristics: people look along the ways they could go, take the one that brings them
// farthest before somebody is in it, and walk on it as fast as the room ahead allows (after
// Moussaid, Helbing & Theraulaz, PNAS 108, 2011; speed by headway after Tordeux, Chraibi &
// Seyfried, Traffic and Granular Flow '15, 2016).
// One rule: one set of constants for every scene, fitted to recorded people: see
// docs/validation.md.
#pragma once

#include "crowd/steering/orca.h"

namespace throng {

/// Bodies turn and give way: centres come nearer to each other than discs allow.
inline constexpr SteeringTraits kHeuristicTraits{.has_time_gap = true,
                                                 .smooths_velocity = true,
                                                 .uses_random_sidesteps = false,
                                                 .uses_lateral_offset = true,
                                                 .core_radius_scale = 0.65f};

/// The definition.
void decide_heuristic_scalar(const SteeringView& people, std::span<const uint32_t> slots,
                             float* next_x_mps, float* next_y_mps);
/// With people as lanes: the same bits.
SteeringFunction heuristic_on(SimdTarget target);

}  // namespace throng
