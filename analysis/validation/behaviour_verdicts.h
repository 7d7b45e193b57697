// Verdicts on accelerations, queues, audiences, encounters, spacing, social groups and contacts.
// As in verdicts.h, they depend on measured numbers only.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "analysis/measures/speed_and_spacing.h"
#include "analysis/validation/encounter.h"
#include "analysis/validation/verdicts.h"

namespace throng::validation {

/// Accelerations of the people of a scene over 0.1 s.
struct SceneAccelerations {
  std::string where;
  double at_999_mps2 = 0;  ///< 99.9 % quantile
  uint64_t samples = 0;
};
/// Passes if the 99.9 % quantile is below 5 m/s2 in all scenes.
Judgement judge_accelerations(std::span<const SceneAccelerations> scenes);

/// Turning of people who wait at a door, in turns.
struct QueueTurning {
  std::string where;
  double net_turns = 0;  ///< sum over people of the absolute net turn
  double all_turns = 0;  ///< sum of all turning in both directions
  double waited_s = 0;   ///< person-seconds
};
/// Passes with at most one net turn per person and minute; queues below 5 person-minutes do not
/// count.
Judgement judge_queues(std::span<const QueueTurning> queues);

/// `facing_shares`: by moment, the share of an audience that faces the stage within 20 degrees.
/// Passes if none is below 95 %.
Judgement judge_audience(std::span<const double> facing_shares);

/// Density of people who stand, as requested by a scene and as placed.
struct DenseStanding {
  double target_per_m2 = 0;
  double placed_per_m2 = 0;
  double max_overlap_m = 0;  ///< maximum overlap of two bodies, seen from above
};
/// Passes if densities are within 1 % and overlaps below 1 cm.
Judgement judge_standing(std::span<const DenseStanding> crowds);

/// Result of an encounter of two people.
struct EncounterOutcome {
  EncounterKind kind = EncounterKind::kHeadOn;
  double nearest_m = 0;  ///< minimum distance between their centres
  bool touched = false;
};
/// Passes if no pair touches.
Judgement judge_encounters(std::span<const EncounterOutcome> met);

/// Minimum number of pairs for a cell of spacing to count.
inline constexpr uint64_t kMinPairs = 500;
/// Judges distances to others by density, ahead and beside. Passes if the 5 % and 25 % quantiles
/// are within 0.08 m of the recording and the 1 % quantile within 0.12 m, in all cells with enough
/// pairs of both. At least half of the recording's cells must be reached. Both spans have the same
/// order of cells.
Judgement judge_spacing(std::span<const SpeedAndSpacing::Spacing> simulated,
                        std::span<const SpeedAndSpacing::Spacing> recorded);

/// Cohesion of social groups of 2 to 4 members.
struct GroupCohesion {
  std::string where;
  uint64_t moments = 0;  ///< samples of people with another member present
  uint64_t close = 0;    ///< samples with another member within 3 m

  double share() const {
    return moments > 0 ? static_cast<double>(close) / static_cast<double>(moments) : 0;
  }
};
/// Exits taken by social groups.
struct GroupExits {
  int groups = 0;       ///< number of groups
  int by_one_exit = 0;  ///< groups whose leaving members took one exit
  int left_behind = 0;  ///< people who did not leave
};
/// Passes if members are close at least 95 % of the time in all places, 95 % of the groups leave by
/// one exit, and all people leave.
Judgement judge_social_groups(std::span<const GroupCohesion> places, const GroupExits& exits);

/// Counted contacts of two people at a density level.
struct CountedContacts {
  uint64_t contacts = 0;
  double person_s = 0;

  double per_person_min() const;
  /// Standard error of that rate, from Poisson statistics.
  double error_per_person_min() const;
};
/// Contacts of a place by level, as in recorded_contacts().
struct PlaceContacts {
  std::string name;
  std::vector<CountedContacts> levels;

  void add(const std::vector<CountedContacts>& more);
};
/// Minimum person-minutes for a level to count.
inline constexpr double kMinPersonMinutes = 30;
/// Judges contacts per person-minute over all places together, by density level. Bounds: at most 1
/// at the lowest level, elsewhere at most 1.5 times the recorded rate or 0.5 more. Levels that
/// begin at `two_sided_from_per_m2` or above also have a lower bound: 0.5 times the recorded rate
/// or 0.5 less (0 at the lowest level). No level may have fewer contacts than the level below it,
/// except by chance (5 % if both were equal). Three levels must be reached, at least one with a
/// lower bound: an empty crowd without contacts proves nothing.
Judgement judge_contacts(std::span<const PlaceContacts> places, double two_sided_from_per_m2);

}  // namespace throng::validation
