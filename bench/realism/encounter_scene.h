// Encounters as a recording: side by side on one ground, too far apart to see each other.
// One rule: where an encounter lies follows from its number alone, on a ground that is always the
// same, so that it is the same to the bit when it is run by itself.
#pragma once

#include <span>

#include "analysis/validation/encounter.h"
#include "scenes/file/scene.h"
#include "scenes/motion/world.h"

namespace throng::realism {

using validation::Encounter;
using validation::EncounterKind;
using validation::kEncounterKinds;
using validation::Passer;

/// People decide in turns, by their ids: so many encounters until it is the same one's turn again.
inline constexpr uint64_t kTurns = 6;

/// People of encounter i are 2 i and 2 i + 1; the first number is to be a multiple of kTurns.
Scene encounter_scene(std::span<const Encounter> encounters);

/// Their world: recorded people with the height, style and phase that each encounter gives them.
WorldFactory encounter_world(std::span<const Encounter> encounters);

/// Where the middle of an encounter is on the ground.
Eigen::Vector2d middle_of(const Encounter& encounter);

}  // namespace throng::realism
