// The behavioural heuristic lets agents walk where the free path is longest, as fast as the gap
// ahead allows. After Moussaid, Helbing & Theraulaz (PNAS 108, 2011); speed by headway after
// Tordeux, Chraibi & Seyfried (Traffic and Granular Flow '15, 2016).
// Invariant: one set of constants for all scenes, fitted to recordings, see docs/validation.md.
#pragma once

#include "crowd/steering/orca.h"

namespace throng {

/// Bodies turn and make room: centres come closer to each other than discs allow.
inline constexpr SteeringTraits kHeuristicTraits{.has_time_gap = true,
                                                 .smooths_velocity = true,
                                                 .uses_random_sidesteps = false,
                                                 .uses_lateral_offset = true,
                                                 .core_radius_scale = 0.65f};

/// The definition.
void decide_heuristic_scalar(const SteeringView& people, std::span<const uint32_t> slots,
                             float* next_x_mps, float* next_y_mps);
/// Agents as lanes: results are bitwise equal.
SteeringFunction heuristic_on(SimdTarget target);

}  // namespace throng
