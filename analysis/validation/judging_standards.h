// Judgements of the standards' tests that need more than a glance at a number: speed by density and
// jams before openings. As in judging.h numbers go in, readings and a verdict come out.
#pragma once

#include <span>
#include <string>

#include "analysis/validation/judging.h"

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

/// People in the 2 m x 2 m before an opening, as means over 10 s.
struct Crowding {
  double most_per_m2 = 0;
  double queued = 0;  ///< share of the time with more than kQueue_per_m2
  double jammed = 0;  ///< share of the time with more than kJam_per_m2
};
/// Weidmann's flow is greatest at this density (Weidmann 1993): where people are denser, more
/// arrive than get on.
inline constexpr double kQueue_per_m2 = 1.75;
/// Congestion as IMO MSC.1/Circ.1533 (annex 3, paragraph 3) defines it for simulations: more people
/// than this, and significant if it lasts for more than this share of the time.
inline constexpr double kJam_per_m2 = 4;
inline constexpr double kJamLasts = 0.1;

/// People who pass a neck from one room into another and leave that by an exit.
struct PassedNeck {
  double width_m = 0;
  double flow_per_s = 0;  ///< into the neck
  bool all_through = false;
  Crowding before_neck;
  Crowding before_exit;
};
/// By ascending width; the neck as wide as the exit is judged by where people crowd. Fails if a
/// wider neck does not carry more, if anybody is left behind, if there is no jam before the neck or
/// if there is one before the exit. Differs if people only queue before the exit: RiMEA 12 expects
/// no congestion there, but excludes no model for it as long as nobody has measured whether one
/// arises.
Judgement judge_necks(std::span<const PassedNeck> necks, double exit_m);

}  // namespace throng::validation
