// Progress detects stuck, queuing and blocking agents and publishes their impatience.
#pragma once

#include <cstddef>

#include "crowd/journeys.h"
#include "crowd/queues.h"
#include "crowd/social_groups.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// An agent that moved less than this makes no progress.
inline constexpr double kStall_m = 0.3;
/// Neighbours start to yield to an agent stuck for `from`, and yield fully after `to`.
inline constexpr double kImpatienceFrom_s = 0.5;
inline constexpr double kImpatienceTo_s = 3.5;
/// Catch-up: starts after `from` seconds of delay, is full after `to`, fades over `for` seconds of
/// walking. No single headway fits both single file and doors, which carry 60 % more.
inline constexpr double kCatchUpFrom_s = 2.0;
inline constexpr double kCatchUpTo_s = 5.0;
inline constexpr double kCatchUpFor_s = 25.0;
/// An agent below this share of its desired speed queues behind one at this gap or less.
inline constexpr double kQueueSpeed = 0.4;
inline constexpr double kQueueGap_m = 0.4;

}  // namespace tuning

class Progress {
 public:
  /// Keeps references to all.
  Progress(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
           const Queues& queues)
      : state_(state), journeys_(journeys), social_groups_(groups), queues_(queues) {}

  /// To be called once per decision, after the neighbour search. Returns how long an agent has been
  /// stuck (s), without time in queues.
  double watch(size_t slot);

 private:
  void publish_state(size_t slot);
  StallCause stall_cause(size_t slot, double stuck_s) const;
  bool is_queuing(size_t slot) const;
  bool is_slow(size_t slot) const;
  template <typename Blocks>
  bool is_behind_any(size_t slot, const Blocks& blocks) const;

  SteeringState& state_;
  const Journeys& journeys_;
  const SocialGroups& social_groups_;
  const Queues& queues_;
};

}  // namespace throng
