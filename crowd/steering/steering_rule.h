// SteeringRule selects the steering model of a scene, and whether density slows agents.
// Invariant: part of the scene's content; the models are in steering.h.
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

/// Name in scene files, options, content hashes and run ids: "orca", "collision_free_speed".
std::string_view name_of(SteeringKind kind);
std::optional<SteeringKind> steering_kind_of(std::string_view name);
std::vector<std::string> steering_names();
/// The names as text for help: "orca or heuristic".
std::string steering_choices();

struct SteeringRule {
  SteeringKind model = SteeringKind::kHeuristic;
  /// Limits speeds by the density ahead (Weidmann 1993); otherwise agents keep pushing.
  bool density_dependent_speed = false;
};

}  // namespace throng
