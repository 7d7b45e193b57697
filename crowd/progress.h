// Progress watches how agents get on: who is stuck, who queues and who holds others up, and shows
// how impatient that makes them.
#pragma once

#include <cstddef>

#include "crowd/journeys.h"
#include "crowd/queues.h"
#include "crowd/social_groups.h"
#include "crowd/steering_state.h"

namespace throng {
namespace tuning {

/// Whoever has moved less than this is making no progress.
inline constexpr double kStall_m = 0.3;
/// Others begin to make way for who has been stuck so long, and do all the way after so long.
inline constexpr double kImpatienceFrom_s = 0.5;
inline constexpr double kImpatienceTo_s = 3.5;
/// Whoever was held up for so long begins to follow more closely those who walk off ahead, does so
/// wholly after so long, and no more once it has walked for the third. Doors carry 60 % more people
/// than a single file at its best: one headway for both there is not.
inline constexpr double kCatchUpFrom_s = 2.0;
inline constexpr double kCatchUpTo_s = 5.0;
inline constexpr double kCatchUpFor_s = 25.0;
/// Whoever walks slower than this share of the free speed, with somebody of the same way ahead at
/// this gap or less, queues.
inline constexpr double kQueueSpeed = 0.4;
inline constexpr double kQueueGap_m = 0.4;

}  // namespace tuning

class Progress {
 public:
  /// Keeps references to all.
  Progress(SteeringState& state, const Journeys& journeys, const SocialGroups& groups,
           const Queues& queues)
      : state_(state), journeys_(journeys), social_groups_(groups), queues_(queues) {}

  /// Once a decision, after the neighbours are known. Returns how long an agent has been stuck (s),
  /// the time of queuing taken off.
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
