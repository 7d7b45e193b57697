// People in parties: through a crossing crowd, through a door, out of a hall with two exits.
// One rule: every party is a group of its own, so that a run tells who belongs to whom.
#pragma once

#include "analysis/validation/judging_behaviour.h"
#include "analysis/validation/plan.h"

namespace throng::validation {

/// So many parties, in turn of two, three and four, from an area to others.
void add_parties(Plan& plan, int parties, const Rectangle& from, const std::vector<Rectangle>& to);

/// Two streams of parties that cross at right angles.
Plan crossing_parties_plan(SteeringKind model, uint64_t seed);
/// A room, a door of 1 m, and 20 m more to go.
Plan parties_at_a_door_plan(SteeringKind model, uint64_t seed);
/// A hall of 30 m x 20 m with two exits in a long side; parties begin in the half with one of them.
Plan parties_with_two_exits_plan(SteeringKind model, uint64_t seed);

/// Ten times a second, of whoever has a companion there.
Together stay_together(const std::string& where, const Plan& plan, double seconds,
                       Outcome& outcome);
PartyExits leave_together(const Plan& plan, double seconds, Outcome& outcome);

}  // namespace throng::validation
