// Exits assigns each agent the exit with the least expected walking plus queueing time.
// Invariant: agents choose sequentially in id order and see earlier choices. This prevents herding
// and makes the result independent of the thread count.
// Members of a social group leave by one exit: the first to choose decides for all, and the member
// with the least id reconsiders.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/journeys.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng {
namespace tuning {

/// Agents reconsider once per second, a part of them in each period. They change to an exit that is
/// better by this share of the time plus an individual patience. Estimates of queues are rough, and
/// small advantages do not last.
inline constexpr uint32_t kReconsiderPeriods = 10;
inline constexpr double kMinImprovement = 0.15;
inline constexpr double kMinPatience_s = 2;
inline constexpr double kMaxPatience_s = 20;
/// Initial flow estimate per metre of width: measured flow through doors.
inline constexpr double kExitFlow_per_ms = 1.9;
/// An exit with this many queuing agents shows its capacity, averaged over the window. The initial
/// estimate has the weight of this many seconds. No exit is taken as shut for good.
inline constexpr uint32_t kMinQueuing = 5;
inline constexpr double kFlowWindow_s = 20;
inline constexpr double kFlowPrior_s = 3;
inline constexpr double kMinFlow_per_s = 0.1;

}  // namespace tuning

/// Distances of the agents that walk to an exit.
class DistanceHistogram {
 public:
  void clear() { sums_.fill(0); }
  void add(float distance_m, int32_t people);
  /// Returns how many have a shorter path; of those in the same bin, half.
  double ahead_of(float distance_m) const;

 private:
  /// Bins of half a metre near the exit and of 4 m beyond 64 m; the last holds all farther agents.
  static constexpr uint32_t kBins = 256;
  static uint32_t bin_of(float distance_m);
  int32_t below(uint32_t bin) const;

  std::array<int32_t, kBins + 1> sums_{};  ///< Fenwick tree (Fenwick 1994), its first entry unused
};

class Exits {
 public:
  /// Keeps a reference to `map`.
  Exits(const NavigationMap& map, std::span<const AgentSpec> people, uint64_t seed);

  /// Returns false if every goal has one area: no other call is then needed.
  bool has_any() const { return !states_.empty(); }

  void archive(Archive& a);

  /// Assigns exits to agents without one and lets a part of the others reconsider. To be called
  /// once per period with its number `decision`, after journeys and population were updated.
  /// `order` and `queuing` state by slot which agents queue. Allocates nothing.
  void choose(uint64_t decision, std::span<const Eigen::Vector2d> positions_m,
              std::span<const uint32_t> order, std::span<const uint8_t> queuing, Journeys& journeys,
              Workers& workers);

  /// Forgets the exit of an agent that is removed or gets another goal: it does not pass it.
  void forget(uint32_t id) {
    if (has_any()) last_exits_[id] = Journeys::kNoExit;
  }
  void set_desired_speed(uint32_t id, double mps) {
    if (has_any()) desired_speeds_mps_[id] = static_cast<float>(mps);
  }

  /// Returns the estimated flow through an exit (agents per second).
  double flow_per_s(uint32_t exit) const { return states_[exit].flow_per_s; }

 private:
  struct State {
    double flow_per_s = 0;
    uint32_t arrived = 0;     ///< since the latest update of flow_per_s
    uint32_t queuing = 0;     ///< now
    uint32_t observed_s = 0;  ///< seconds in which a queue showed the capacity
    bool has_flowed = false;
    void archive(Archive& a) { a(flow_per_s, arrived, observed_s, has_flowed); }
  };

  void count(const Journeys& journeys);
  void watch(const Journeys& journeys, std::span<const uint32_t> order,
             std::span<const uint8_t> queuing);
  void choose_exit(uint32_t id, std::span<const float> distances_m,
                   std::span<const Eigen::Vector2d> positions_m, Journeys& journeys);
  void assign(uint32_t id, uint32_t exit, float distance_m, Journeys& journeys);
  /// Returns the exit of members with the same goal that have chosen; otherwise the agent's own.
  uint32_t exit_of_group(uint32_t id, const Journeys& journeys) const;
  /// Sends members with the same goal to the exit that the first member has now.
  void redirect_group(uint32_t first, std::span<const Eigen::Vector2d> positions_m,
                      Journeys& journeys);
  double expected_s(uint32_t exit, uint32_t id, float distance_m) const;
  double patience_s(uint32_t id) const;

  const NavigationMap& map_;
  uint64_t seed_;
  size_t max_exits_ = 0;  ///< per goal
  // By id.
  std::vector<float> desired_speeds_mps_;
  std::vector<uint32_t> last_exits_;  ///< the previous exit, see Journeys::exit()
  std::vector<float> distances_m_;    ///< distance to that exit at the latest choice
  // By exit.
  std::vector<State> states_;
  std::vector<DistanceHistogram> histograms_;
  std::vector<uint32_t> choosers_;
  /// distances to all exits of the goal, max_exits_ per chooser
  std::vector<float> exit_distances_m_;
};

}  // namespace throng
