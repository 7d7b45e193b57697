// Triggers computes the times at which groups set out and doors move.
// Invariant: a known time never changes. It depends on the journeys of past decisions only.
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

  void archive(Archive& a);

  /// To be called once per period, after the journeys.
  void watch(const Journeys& journeys, double now_s);
  /// Time of a trigger (s); infinity while it is unknown.
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
