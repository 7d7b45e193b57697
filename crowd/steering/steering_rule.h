// How the people of a scene steer: which model, and whether density slows them.
// One rule: a choice of the scene's, part of its content; the models are in steering.h.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// One row each in the table of steering.cpp, in the same order.
enum class SteeringKind {
  kOrca,                ///< optimal reciprocal collision avoidance (van den Berg et al. 2011)
  kCollisionFreeSpeed,  ///< collision-free speed (Tordeux, Chraibi & Seyfried 2016)
  kHeuristic,           ///< behavioural heuristics (after Moussaid, Helbing & Theraulaz 2011)
};

std::vector<SteeringKind> all_steering_kinds();

/// What scene files, options, content hashes and run ids call it: "orca", "speed".
std::string_view name_of(SteeringKind kind);
std::optional<SteeringKind> steering_kind_of(std::string_view name);
std::vector<std::string> steering_names();
/// The names for a line of help: "orca or speed".
std::string steering_choices();

struct SteeringRule {
  SteeringKind model = SteeringKind::kHeuristic;
  /// Slower where it is dense ahead, as observed (Weidmann 1993); without it people push on.
  bool density_dependent_speed = false;
};

}  // namespace throng
