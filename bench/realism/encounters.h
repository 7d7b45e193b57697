// Encounters of two people as a recording, run, and judged by who touched with what and how deep.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "analysis/part_names.h"
#include "analysis/validation/encounter.h"
#include "scenes/file/scene.h"
#include "scenes/motion/motion_source.h"
#include "scenes/run/sink.h"

namespace throng::realism {

// Encounters as a recording: side by side on one ground, too far apart to see each other.
// Where an encounter lies follows from its number alone, on a ground that is always the
// same, so that it is the same to the bit when it is run by itself.

using validation::Encounter;
using validation::EncounterKind;
using validation::EncounterPerson;
using validation::kEncounterKinds;

/// People decide in turns, by their ids: so many encounters until it is the same one's turn again.
inline constexpr uint64_t kTurns = 6;

/// People of encounter i are 2 i and 2 i + 1; the first number is to be a multiple of kTurns.
Scene encounter_scene(std::span<const Encounter> encounters);

/// Their world: recorded people with the height, style and phase that each encounter gives them.
MotionFactory encounter_motion(std::span<const Encounter> encounters);

/// Where the middle of an encounter is on the ground.
Eigen::Vector2d middle_of(const Encounter& encounter);

// Encounters run as dressed recordings: who touched, with what, how deep.
// Every frame is looked at, and an encounter whose roots came nearer than the discs at
// any of them is put away and counted, never judged.

using validation::Encounter;
using validation::EncounterKind;
using validation::kEncounterKinds;

struct EncounterResult {
  uint64_t number = 0;
  EncounterKind kind = EncounterKind::kHeadOn;
  double min_root_distance_m = std::numeric_limits<double>::infinity();
  double min_distance_s = 0;
  int touching_frames = 0;
  double first_touch_s = 0;
  double max_depth_m = 0;
  double max_depth_s = 0;
  std::string max_depth_parts;  ///< "leftHand and upperRightLeg"
  std::array<bool, kGroupPairs> groups{};
  std::array<double, kGroupPairs> max_depth_by_group_m{};

  bool touches() const { return touching_frames > 0; }
  bool is_sound() const { return min_root_distance_m >= Encounter::kDisc_m; }
};

struct EncounterRuns {
  std::vector<EncounterResult> results;  ///< of those whose discs kept apart
  uint64_t redrawn = 0;                  ///< draws whose ways would have broken a bound
  std::vector<uint64_t> rejected;  ///< numbers of those whose discs met once they were dressed
  uint64_t foreign_contacts = 0;   ///< contacts of people of two encounters: expected 0
};

struct EncounterOptions {
  uint64_t seed = 1;
  uint64_t first = 0;  ///< number of the first
  uint64_t count = 1000;
  int threads = 1;
  uint64_t worst = 10;  ///< so many are listed
};

/// `listener` sees the run, too; null: nobody does.
EncounterRuns run_encounters(const EncounterOptions& options, Sink* listener = nullptr,
                             const std::function<void(uint64_t done)>& progress = {});

/// The table of `realism encounters`.
std::string encounter_report(const EncounterRuns& runs, const EncounterOptions& options);

}  // namespace throng::realism
