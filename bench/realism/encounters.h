// run_encounters() runs encounters of two people as a recording and measures their contacts.
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

// Encounters lie next to each other on one ground, too far apart to interact.
// Invariant: an encounter's position depends on its number only, and the ground is always the same.
// Run alone it gives the same result to the bit.

using validation::Encounter;
using validation::EncounterKind;
using validation::EncounterPerson;
using validation::kEncounterKinds;

/// People decide in turns by their ids: the turn repeats after this many encounters.
inline constexpr uint64_t kTurns = 6;

/// Encounter i has the people 2 i and 2 i + 1. The first number must be a multiple of kTurns.
Scene encounter_scene(std::span<const Encounter> encounters);

/// Returns their motion source: recorded people with the height, style and phase of each encounter.
MotionFactory encounter_motion(std::span<const Encounter> encounters);

/// Returns the position of an encounter's middle on the ground.
Eigen::Vector2d middle_of(const Encounter& encounter);

// Every frame is evaluated. An encounter whose roots come closer than the discs is rejected and
// counted, never measured.

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
  std::vector<EncounterResult> results;  ///< encounters whose discs kept apart
  uint64_t redrawn = 0;                  ///< draws whose paths would have broken a bound
  std::vector<uint64_t> rejected;        ///< numbers of those whose discs met after retargeting
  uint64_t foreign_contacts = 0;  ///< contacts between people of different encounters; expected 0
};

struct EncounterOptions {
  uint64_t seed = 1;
  uint64_t first = 0;
  uint64_t count = 1000;
  int threads = 1;
  uint64_t worst = 10;  ///< maximum number of listed encounters
};

/// `listener` also receives the frames of the run; may be null.
EncounterRuns run_encounters(const EncounterOptions& options, Sink* listener = nullptr,
                             const std::function<void(uint64_t done)>& progress = {});

/// Returns the table of `realism encounters`.
std::string encounter_report(const EncounterRuns& runs, const EncounterOptions& options);

}  // namespace throng::realism
