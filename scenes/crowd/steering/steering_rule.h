// How the people of a scene steer: which model, and whether density slows them.
// One rule: a choice of the scene's, part of its content; the models are in steering.h.
#pragma once

#include <optional>
#include <string_view>

namespace throng {

enum class SteeringKind {
  kOrca,   ///< optimal reciprocal collision avoidance (van den Berg et al. 2011)
  kSpeed,  ///< collision-free speed (Tordeux, Chraibi & Seyfried 2016)
};

inline constexpr SteeringKind kAllSteeringKinds[] = {SteeringKind::kOrca, SteeringKind::kSpeed};

/// "orca", "speed".
std::string_view name_of(SteeringKind kind);
std::optional<SteeringKind> steering_kind_of(std::string_view name);

struct SteeringRule {
  SteeringKind model = SteeringKind::kOrca;
  /// Slower where it is dense ahead, as observed (Weidmann 1993); without it people push on.
  bool density_speed = false;
};

}  // namespace throng
