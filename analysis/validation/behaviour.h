// How people move, stand, meet and keep together: what is measured of each in bundled scenes, as
// they are but for seed and model, and of people in parties.
#pragma once

#include <string>
#include <vector>

#include "analysis/validation/behaviour_verdicts.h"
#include "analysis/validation/plan.h"
#include "analysis/validation/trial.h"

namespace throng::validation {

/// A bundled scene; its walls are not checked against moves.
Plan bundled_plan(const std::string& name, const Conditions& conditions);

SceneAccelerations accelerations_of(const std::string& where, const Plan& plan, double seconds,
                                    Outcome& outcome);
/// People who wait in an area: slower than 0.2 m/s, on their way.
QueueTurning measure_queue(const std::string& where, const Plan& plan, const Rectangle& area,
                           double seconds, Outcome& outcome);
/// Shares that face what their group faces, ten times a second, of those who stand; those whose
/// group faces nothing do not count.
std::vector<double> facing_shares(const Plan& plan, double seconds, Outcome& outcome);
/// A crowd that stands in the middle of a hall.
DenseStanding place_dense_crowd(double per_m2, const Conditions& conditions, Outcome& outcome);

/// Encounters, steered from where they begin, with bodies; so many of one seed.
std::vector<EncounterOutcome> simulate_encounters(uint64_t count, const Conditions& conditions);
/// By level of density, of bodies; not of those who have been there for less than kExpected_s.
std::vector<CountedContacts> contacts_of(const Plan& plan, double seconds);

// People in parties: through a crossing crowd, through a door, out of a hall with two exits.
// Every party is a group of its own, so that a run tells who belongs to whom.

/// So many parties, in turn of two, three and four, from an area to others.
void add_social_groups(Plan& plan, int groups, const Rectangle& from,
                       const std::vector<Rectangle>& to);

/// Two streams of parties that cross at right angles.
Plan crossing_groups_plan(SteeringKind model, uint64_t seed);
/// A room, a door of 1 m, and 20 m more to go.
Plan groups_at_a_door_plan(SteeringKind model, uint64_t seed);
/// A hall of 30 m x 20 m with two exits in a long side; parties begin in the half with one of them.
Plan groups_with_two_exits_plan(SteeringKind model, uint64_t seed);

/// Ten times a second, of whoever has a companion there.
GroupCohesion measure_cohesion(const std::string& where, const Plan& plan, double seconds,
                               Outcome& outcome);
GroupExits measure_group_exits(const Plan& plan, double seconds, Outcome& outcome);

}  // namespace throng::validation
