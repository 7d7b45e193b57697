// How people move, stand and meet in scenes that anybody may run: what is measured of each.
// One rule: bundled scenes are run as they are, but for seed and model.
#pragma once

#include <string>
#include <vector>

#include "analysis/validation/judging_behaviour.h"
#include "analysis/validation/plan.h"
#include "analysis/validation/trial.h"

namespace throng::validation {

/// A bundled scene; its walls are not checked against moves.
Plan bundled_plan(const std::string& name, const Conditions& conditions);

Accelerated accelerations_of(const std::string& where, const Plan& plan, double seconds,
                             Outcome& outcome);
/// People who wait in an area: slower than 0.2 m/s, on their way.
Queued queue_in(const std::string& where, const Plan& plan, const Rectangle& area, double seconds,
                Outcome& outcome);
/// Shares that face what their group faces, ten times a second, of those who stand; those whose
/// group faces nothing do not count.
std::vector<double> facing_shares(const Plan& plan, double seconds, Outcome& outcome);
/// A crowd that stands in the middle of a hall.
Standing stand_close(double per_m2, const Conditions& conditions, Outcome& outcome);

/// Encounters, steered from where they begin, with bodies; so many of one seed.
std::vector<MetTwo> meet(uint64_t count, const Conditions& conditions);
/// By level of density, of bodies; not of those who have been there for less than kExpected_s.
std::vector<CountedContacts> contacts_of(const Plan& plan, double seconds);

}  // namespace throng::validation
