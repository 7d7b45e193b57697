// CrowdChange adds or removes agents between two steps, or gives them another goal or speed.
// Invariant: a change is checked completely before any agent changes; equal changes before equal
// frames give equal results.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/files/archive.h"
#include "crowd/crowd.h"
#include "scenes/file/scene.h"

namespace throng {

class ExternalAvatars;

/// Maximum length of the text of a goal, which fits into a message.
inline constexpr size_t kMaxGoalBytes = 40'000;

struct CrowdChange {
  enum class Kind : uint8_t { kAdd, kRemove, kSetGoal, kSetDesiredSpeed };

  Kind kind = Kind::kAdd;
  std::string group{};               ///< kAdd: name of the group
  std::vector<uint32_t> ids{};       ///< agents; kAdd: those that were added
  std::vector<AgentEntry> entries{}; ///< kAdd: one per agent
  std::vector<double> desired_mps{}; ///< kSetDesiredSpeed: one per agent
  std::string goal{};                ///< kSetGoal: a goal as in a scene file

  void archive(Archive& a);
};

/// Applies a change to the agents of a scene. Sets the ids of agents that are added. Throws
/// InputError without effect if the group has too few spare agents. Also throws for a position off
/// the ground or in a wall, an agent that is not in the scene, or an invalid goal or speed.
void apply(CrowdChange& change, const Scene& scene, Crowd& crowd, ExternalAvatars& external);

}  // namespace throng
