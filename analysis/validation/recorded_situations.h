// Situations beside the set-ups of speed and density: doors, overtaking, ways that are wide.
// One rule: nothing is set for one of them but its geometry, its people and, where the criterion
// names them, their free speeds.
#pragma once

#include <vector>

#include "analysis/validation/judging.h"
#include "analysis/validation/set_ups.h"

namespace throng::validation {

/// A room of 6 m x 16 m, a neck of 2.8 m behind it.
Plan door_plan(double width_m, int people, SteeringKind model, uint64_t seed);
DoorFlow pass_a_door(double width_m, int people, SteeringKind model, uint64_t seed,
                     Outcome& outcome);

/// Corridors of 3 m side by side, in each somebody with 1.5 m/s behind somebody with 0.6 m/s.
Plan overtaking_plan(int lanes, SteeringKind model, uint64_t seed);
std::vector<Overtaking> overtake(int lanes, SteeringKind model, uint64_t seed, Outcome& outcome);

/// A way 3 m wide that closes in an oval, with 2 people per m2, half of them each way.
Plan two_way_plan(SteeringKind model, uint64_t seed);
/// Flow per m and s, both ways together, minute by minute.
std::vector<double> walk_two_ways(int minutes, SteeringKind model, uint64_t seed, Outcome& outcome);

/// A ring 3 m wide around 7 m, 80 people.
Plan ring_plan(SteeringKind model, uint64_t seed);
/// A corridor 4 m wide that turns after 30 m, 200 people.
Plan corner_plan(SteeringKind model, uint64_t seed);
/// A hall of 30 m x 20 m with two exits in a long side, 600 people in the half with one of them.
Plan two_exits_plan(SteeringKind model, uint64_t seed);

}  // namespace throng::validation
