// Judgements of the standards' tests that need more than a glance at a number: speed by density.
// As in judging.h numbers go in, readings and a verdict come out.
#pragma once

#include <span>
#include <string>

#include "scenes/validation/judging.h"

namespace throng::validation {

/// Mean density and speed of people in a corridor who walk one way.
struct OneWaySpeed {
  double asked_per_m2 = 0;
  double density_per_m2 = 0;
  double speed_mps = 0;
};
/// Greatest density that RiMEA 4 is judged at; denser ones are readings alone.
inline constexpr double kMostJudged_per_m2 = 3;
/// Each between the slowest and the fastest tenth recorded at its density (recorded_one_way_at());
/// a density at which nobody was recorded is not met. The summary names what near_bounds() finds.
Judgement judge_one_way(std::span<const OneWaySpeed> points);

/// Names every judged reading that is outside its bounds, or within 10 % of a bound, with that
/// bound: "0.46 m/s at 2 per m2 (at least 0.43)". Empty if there is none.
std::string near_bounds(std::span<const Reading> readings);

}  // namespace throng::validation
