// Which exit people take where a goal has several: the one where they expect to be through first,
// by the way to it and the queue there.
// One rule: people choose one after another in the order of their ids, each knowing what those
// before have chosen, so that they do not run in a herd and threads do not matter. Companions leave
// by one exit: the first of them who has to choose chooses for all, and the first of the party
// looks again.
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

/// Of several exits people take the one where they expect to be through first, and look again once
/// a second, some at each decision. They change to another if it is better by this share of the
/// time and by their own patience besides: what they see of a queue is rough, and an exit that
/// seems a little better now is not in a second.
inline constexpr uint32_t kReconsiderPeriods = 10;
inline constexpr double kMinImprovement = 0.15;
inline constexpr double kMinPatience_s = 2;
inline constexpr double kMaxPatience_s = 20;
/// What people take a metre of an exit to let through a second, before they have seen: what doors
/// do in experiments.
inline constexpr double kExitFlow_per_ms = 1.9;
/// Where that many queue, what came through lately is what the exit lets through, over about so
/// long; the first guess counts as so many seconds of it. Nothing is taken for shut for good.
inline constexpr uint32_t kMinQueuing = 5;
inline constexpr double kFlowWindow_s = 20;
inline constexpr double kFlowPrior_s = 3;
inline constexpr double kMinFlow_per_s = 0.1;

}  // namespace tuning

/// How many of those who head for an exit have how far to go.
class DistanceHistogram {
 public:
  void clear() { sums_.fill(0); }
  void add(float distance_m, int32_t people);
  /// How many have a shorter way; of those with about the same one, half.
  double ahead_of(float distance_m) const;

 private:
  /// Half a metre near the exit, where people stand close, and 4 m beyond 64 m; the last has all
  /// who are farther.
  static constexpr uint32_t kBins = 256;
  static uint32_t bin_of(float distance_m);
  int32_t below(uint32_t bin) const;

  std::array<int32_t, kBins + 1> sums_{};  ///< Fenwick tree (Fenwick 1994), its first unused
};

class Exits {
 public:
  /// Keeps a reference to `map`.
  Exits(const NavigationMap& map, std::span<const AgentSpec> people, uint64_t seed);

  /// False where every goal has one area: otherwise none of this is needed.
  bool has_any() const { return !states_.empty(); }

  /// Everything that choose() may have changed.
  void archive(Archive& a);

  /// Once a decision, the `decision`th, when everybody has followed their journeys and people have
  /// come and gone: whose exit is open chooses, and a part of the others looks again. `order` and
  /// `queuing` say who has been queuing, by slot. No allocation.
  void choose(uint64_t decision, std::span<const Eigen::Vector2d> positions_m,
              std::span<const uint32_t> order, std::span<const uint8_t> queuing, Journeys& journeys,
              Workers& workers);

  /// What an exit is taken to let through, people a second.
  double flow_per_s(uint32_t exit) const { return states_[exit].flow_per_s; }

 private:
  struct State {
    double flow_per_s = 0;
    uint32_t arrived = 0;     ///< since flow_per_s was last looked at
    uint32_t queuing = 0;     ///< now
    uint32_t observed_s = 0;  ///< how often a queue showed what comes through
    bool has_flowed = false;
    void archive(Archive& a) { a(flow_per_s, arrived, observed_s, has_flowed); }
  };

  void count(const Journeys& journeys);
  void watch(const Journeys& journeys, std::span<const uint32_t> order,
             std::span<const uint8_t> queuing);
  void choose_exit(uint32_t id, std::span<const float> distances_m,
                   std::span<const Eigen::Vector2d> positions_m, Journeys& journeys);
  void assign(uint32_t id, uint32_t exit, float distance_m, Journeys& journeys);
  /// That of companions who walk to the same goal and have chosen; else their own.
  uint32_t exit_of_group(uint32_t id, const Journeys& journeys) const;
  /// Companions who walk to the same goal go where the first of the party now goes.
  void redirect_group(uint32_t first, std::span<const Eigen::Vector2d> positions_m,
                      Journeys& journeys);
  double expected_s(uint32_t exit, uint32_t id, float distance_m) const;
  double patience_s(uint32_t id) const;

  const NavigationMap& map_;
  uint64_t seed_;
  size_t max_exits_ = 0;  ///< of a goal
  // By person.
  std::vector<float> desired_speeds_mps_;
  std::vector<uint32_t> last_exits_;  ///< the exit last time, see Journeys::exit()
  std::vector<float> distances_m_;    ///< to that exit, when last looked at
  // By exit.
  std::vector<State> states_;
  std::vector<DistanceHistogram> histograms_;
  // Those who look now.
  std::vector<uint32_t> choosers_;
  std::vector<float> exit_distances_m_;  ///< to each exit of the goal, max_exits_ a looker
};

}  // namespace throng
