// behaviour measures motion, standing, encounters and cohesion of people in simulated scenes.
#pragma once

#include <string>
#include <vector>

#include "analysis/validation/behaviour_verdicts.h"
#include "analysis/validation/plan.h"
#include "analysis/validation/trial.h"

namespace throng::validation {

/// A bundled scene. Trial does not check moves against its walls.
Plan bundled_plan(const std::string& name, const Conditions& conditions);

SceneAccelerations accelerations_of(const std::string& where, const Plan& plan, double seconds,
                                    Outcome& outcome);
/// Turning of people who wait in an area: slower than 0.2 m/s and not at their last goal.
QueueTurning measure_queue(const std::string& where, const Plan& plan, const Rectangle& area,
                           double seconds, Outcome& outcome);
/// Shares of standing people that face the point of their group, 10 times per second. Groups
/// without such a point do not count.
std::vector<double> facing_shares(const Plan& plan, double seconds, Outcome& outcome);
/// Measures a crowd that stands in the middle of a hall.
DenseStanding place_dense_crowd(double per_m2, const Conditions& conditions, Outcome& outcome);

/// Simulates `count` encounters of one seed, with bodies.
std::vector<EncounterOutcome> simulate_encounters(uint64_t count, const Conditions& conditions);
/// Contacts by density level, between people present for at least kExpected_s.
std::vector<CountedContacts> contacts_of(const Plan& plan, double seconds);

// Social groups: through a crossing crowd, through a door, out of a hall with two exits. Each is a
// separate group of the scene, which identifies its members.

/// Adds `groups` social groups with 2, 3 and 4 members in turn, walking from one area to others.
void add_social_groups(Plan& plan, int groups, const Rectangle& from,
                       const std::vector<Rectangle>& to);

/// Two streams of social groups that cross at right angles.
Plan crossing_groups_plan(SteeringKind model, uint64_t seed);
/// A room, a door of 1 m, and 20 m of ground behind it.
Plan groups_at_a_door_plan(SteeringKind model, uint64_t seed);
/// A hall of 30 m x 20 m with two exits in a long side; groups start in the half with one of them.
Plan groups_with_two_exits_plan(SteeringKind model, uint64_t seed);

/// Cohesion, sampled 10 times per second over people whose group has other members present.
GroupCohesion measure_cohesion(const std::string& where, const Plan& plan, double seconds,
                               Outcome& outcome);
GroupExits measure_group_exits(const Plan& plan, double seconds, Outcome& outcome);

}  // namespace throng::validation
