// When what groups and doors wait for comes.
// One rule: what has come stays; a time depends on the journeys of the decisions so far, and on
// nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "crowd/journeys.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng {

class Triggers {
 public:
  /// Keeps a reference to `map`.
  Triggers(const NavigationMap& map, std::span<const AgentSpec> people);

  /// Everything that watch() may have changed.
  void archive(Archive& a);

  /// Once a decision, when everybody has followed their journeys.
  void watch(const Journeys& journeys, double now_s);
  /// When it comes, or came; infinity while nobody can know.
  double time_s(uint32_t trigger) const { return times_s_[trigger]; }

 private:
  struct Range {
    uint32_t begin = 0, end = 0;
  };
  const NavigationMap& map_;
  std::vector<Range> members_;  ///< ids, by group
  std::vector<double> times_s_;
};

}  // namespace throng
