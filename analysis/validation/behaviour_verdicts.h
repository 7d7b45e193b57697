// Verdicts on how people move, stand and meet: accelerations, queues, audiences, contacts.
// One rule: as judging.h, numbers in, readings and a verdict out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/encounter.h"
#include "analysis/validation/verdicts.h"

namespace throng::validation {

/// Accelerations over 0.1 s of the people of a scene.
struct SceneAccelerations {
  std::string where;
  double at_999_mps2 = 0;  ///< of 99.9 % at most
  uint64_t samples = 0;
};
/// Below 5 m/s2 in 99.9 % everywhere.
Judgement judge_accelerations(std::span<const SceneAccelerations> scenes);

/// Of the people who wait before a door: how far round they turned, in turns.
struct QueueTurning {
  std::string where;
  double net_turns = 0;  ///< there and back is nothing; of each person, whatever the direction
  double all_turns = 0;  ///< every turning, there and back
  double waited_s = 0;   ///< person-seconds
};
/// Net at most one turn a person and minute; less than 5 person-minutes of waiting say nothing.
Judgement judge_queues(std::span<const QueueTurning> queues);

/// Shares of an audience that face the stage within 20 degrees, moment by moment: at no moment less
/// than 95 %.
Judgement judge_audience(std::span<const double> facing_shares);

/// People who stand as close as a scene asks.
struct DenseStanding {
  double target_per_m2 = 0;
  double placed_per_m2 = 0;
  double max_overlap_m = 0;  ///< of two bodies, seen from above
};
/// As many as asked, to within one in a hundred, bodies less than a centimetre in each other.
Judgement judge_standing(std::span<const DenseStanding> crowds);

/// Two who met with nobody else near.
struct EncounterOutcome {
  EncounterKind kind = EncounterKind::kHeadOn;
  double nearest_m = 0;  ///< of their middles
  bool touched = false;
};
/// None of them touch.
Judgement judge_encounters(std::span<const EncounterOutcome> met);

/// Fewer pairs say nothing about a cell of spacing.
inline constexpr uint64_t kMinPairs = 500;
/// How near others are, by density, ahead and beside: 5 and 25 % within 0.08 m of the recording, 1
/// % within 0.12 m, in cells with enough pairs of both. Half of the recording's cells at least have
/// to be reached. Cells in the same order.
Judgement judge_spacing(std::span<const SpeedAndSpacing::Spacing> simulated,
                        std::span<const SpeedAndSpacing::Spacing> recorded);

/// People who walk in parties of two to four.
struct GroupCohesion {
  std::string where;
  uint64_t moments = 0;  ///< of a person with a companion who is there, too
  uint64_t close = 0;    ///< of these, with one within 3 m

  double share() const {
    return moments > 0 ? static_cast<double>(close) / static_cast<double>(moments) : 0;
  }
};
/// Parties that left by one of several exits all together, and those that did not.
struct GroupExits {
  int groups = 0;
  int by_one_exit = 0;
  int left_behind = 0;  ///< people
};
/// Near a companion 95 % of the time everywhere; 95 % of the parties leave by one exit, and
/// everybody leaves.
Judgement judge_social_groups(std::span<const GroupCohesion> places, const GroupExits& exits);

/// Contacts of two people at a level of density, as counted.
struct CountedContacts {
  uint64_t contacts = 0;
  double person_s = 0;

  double per_person_min() const;
  /// Standard error of that: counts are Poisson's.
  double error_per_person_min() const;
};
/// By level, as in recorded_contacts().
struct PlaceContacts {
  std::string name;
  std::vector<CountedContacts> levels;

  void add(const std::vector<CountedContacts>& more);
};
/// Fewer person-minutes say nothing about a level.
inline constexpr double kMinPersonMinutes = 30;
/// Judges the contacts per person-minute of all places together, by level: at the lowest level at
/// most 1, at the others at most 1.5 times as many as recorded people have or 0.5 more. Levels that
/// begin at `two_sided_from_per_m2` or above also have a lower bound: 0.5 times the recorded or 0.5
/// less (0 at the lowest level). No level may have fewer than the level below it, except by chance
/// (5 % of the time if both were equal). Three levels must be reached, at least one of them with a
/// lower bound: people who never touch and are never dense have shown nothing.
Judgement judge_contacts(std::span<const PlaceContacts> places, double two_sided_from_per_m2);

}  // namespace throng::validation
