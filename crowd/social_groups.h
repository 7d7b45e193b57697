// People who walk together: abreast where there is room, in a V or in file where there is less, and
// waiting for whoever of them is behind.
// One rule: only what somebody wishes follows from companions, its way and its share of the free
// speed; it depends on where they are, and on how long ago each got on.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/journeys.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng {

struct SteeringState;

class SocialGroups {
 public:
  /// Keeps a reference to `map`.
  SocialGroups(const NavigationMap& map, std::span<const AgentSpec> people);

  /// True if anybody has companions: otherwise all of this costs nothing.
  bool any() const { return !social_groups_.empty(); }
  bool has(uint32_t id) const { return any() && group_numbers_[id] != 0; }

  /// Everything that update() may have changed and that the next one depends on.
  void archive(Archive& a);

  /// Members see how many strangers are near, and their companions are no neighbours where they
  /// walk beside each other; before update().
  void find_neighbours(SteeringState& state, std::span<const uint32_t> slots);

  /// Who decides when is fixed by this one of several ids: companions decide together.
  uint32_t first_member(uint32_t id) const {
    return has(id) ? social_groups_[group_numbers_[id] - 1].begin : id;
  }

  /// Of those whose first one's id leaves that remainder when divided by `parts`: what companions
  /// make of each other, before they decide. No allocation.
  void update(uint32_t remainder, uint32_t parts, const Journeys& journeys,
              std::span<const Eigen::Vector2d> positions_m, double now_s, Workers& workers);

  /// The way that somebody of a party would go alone, of Journeys::direction().
  const Eigen::Vector2d& solo_direction(uint32_t id) const {
    return adjustments_[id].solo_direction;
  }
  /// And the way with companions: a unit vector, or zero.
  Eigen::Vector2d group_direction(uint32_t id) const;
  /// Of the free speed: below 1 ahead of the others, above it behind them.
  double speed_factor(uint32_t id) const { return any() ? adjustments_[id].speed_factor : 1; }
  /// True if somebody who walks is slow or stands because a companion is behind.
  bool waits(uint32_t id) const { return any() && adjustments_[id].speed_factor < kWaits; }
  /// And true if it stands for that one, to whom it turns then: where that is.
  bool stands(uint32_t id) const { return any() && adjustments_[id].speed_factor < kStands; }
  const Eigen::Vector2d& waits_for_m(uint32_t id) const { return adjustments_[id].behind_m; }
  bool are_in_one_group(uint32_t a, uint32_t b) const {
    return group_numbers_[a] != 0 && group_numbers_[a] == group_numbers_[b];
  }

 private:
  double others_per_m2(const SteeringState& state, size_t slot) const;
  void drop_group_members(SteeringState& state, size_t slot) const;

  static constexpr double kWaits = 0.5, kStands = 0.05;

  struct SocialGroup {
    uint32_t begin = 0, end = 0;  ///< ids
  };
  struct Adjustment {
    Eigen::Vector2d solo_direction = Eigen::Vector2d::Zero();
    Eigen::Vector2d sideways = Eigen::Vector2d::Zero();  ///< added to the way
    Eigen::Vector2d towards = Eigen::Vector2d::Zero();   ///< instead of the way, unless it is zero
    Eigen::Vector2d behind_m = Eigen::Vector2d::Zero();
    double speed_factor = 1;
  };
  /// Somebody of a party who is about something.
  struct Member {
    uint32_t id = 0;
    uint32_t visits = 0;
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    const FlowField* field = nullptr;
    double to_go_m = 0;      ///< of those who are not all near each other
    bool is_awaited = true;  ///< gets on, or will
    bool is_on_way = false;  ///< walks, and is not at the goal yet
  };
  /// Those of a party who walk side by side, and the frame in which they do.
  struct Formation;

  void update(const SocialGroup& social_group, const Journeys& journeys,
              std::span<const Eigen::Vector2d> positions_m, double now_s);
  Member member(uint32_t id, const Journeys& journeys, const Eigen::Vector2d& at_m) const;
  void watch_progress(Member& m, bool waits, double now_s);
  void find_formation(std::span<const Member> members, size_t index, Formation& formation) const;
  double lateral_clearance_m(const Formation& formation, const FlowField& field,
                             double target_m) const;
  double keep_in_formation(const Formation& formation, const Member& self,
                           Adjustment& adjustment) const;
  void wait_for_others(std::span<const Member> members, size_t index, const Formation& formation,
                       double length_m, Adjustment& adjustment) const;

  const NavigationMap& map_;
  std::vector<SocialGroup> social_groups_;
  // By person; empty: there are no parties.
  std::vector<uint32_t> group_numbers_;  ///< its index and 1; 0: none
  std::vector<double> radii_m_;
  std::vector<double> others_per_m2_;
  std::vector<Adjustment> adjustments_;
  // Of the latest progress: which goal it was on the way to, how far it was, and when.
  std::vector<uint32_t> visits_;
  std::vector<double> min_distances_m_;
  std::vector<double> since_s_;
};

}  // namespace throng
