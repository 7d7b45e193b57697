// SocialGroups keeps members of social groups together: abreast where there is room, otherwise in a
// V or in file, and waiting for members behind.
// Invariant: social groups change only the direction and speed factor of a preferred velocity. Both
// depend on the members' positions and on the times of their latest progress.
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

  /// Returns false without social groups: no other call is then needed.
  bool any() const { return !social_groups_.empty(); }
  bool has(uint32_t id) const { return any() && group_numbers_[id] != 0; }

  void archive(Archive& a);

  /// Counts non-members nearby and removes members alongside from the neighbours; before update().
  void find_neighbours(SteeringState& state, std::span<const uint32_t> slots);

  /// Id that fixes when an agent decides: members of a social group decide together.
  uint32_t first_member(uint32_t id) const {
    return has(id) ? social_groups_[group_numbers_[id] - 1].begin : id;
  }

  /// Updates the groups whose first id has this remainder when divided by `parts`, before their
  /// members decide. Allocates nothing.
  void update(uint32_t remainder, uint32_t parts, const Journeys& journeys,
              std::span<const Eigen::Vector2d> positions_m, double now_s, Workers& workers);

  /// Forgets the progress of an agent that gets another goal.
  void forget_progress(uint32_t id) {
    if (any()) visits_[id] = UINT32_MAX;
  }

  /// Direction of a member without its group, from Journeys::direction().
  const Eigen::Vector2d& solo_direction(uint32_t id) const {
    return adjustments_[id].solo_direction;
  }
  /// Direction of a member with its group: a unit vector, or zero.
  Eigen::Vector2d group_direction(uint32_t id) const;
  /// Factor of the desired speed: below 1 ahead of the others, above 1 behind them.
  double speed_factor(uint32_t id) const { return any() ? adjustments_[id].speed_factor : 1; }
  /// Returns whether a walking agent is slow or stands because a member is behind.
  bool waits(uint32_t id) const { return any() && adjustments_[id].speed_factor < kWaits; }
  /// Returns whether it stands for that member, and faces waits_for_m().
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
    Eigen::Vector2d sideways = Eigen::Vector2d::Zero();  ///< added to the direction
    Eigen::Vector2d towards = Eigen::Vector2d::Zero();   ///< replaces the direction unless zero
    Eigen::Vector2d behind_m = Eigen::Vector2d::Zero();
    double speed_factor = 1;
  };
  /// A member that is present and not staying.
  struct Member {
    uint32_t id = 0;
    uint32_t visits = 0;
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    const FlowField* field = nullptr;
    double to_go_m = 0;       ///< only if the members are not all near each other
    bool is_awaited = true;   ///< makes progress, or will
    bool is_on_path = false;  ///< walks, and is not at the goal yet
  };
  /// Members that walk side by side, and the frame of their row.
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
  // By id; empty without social groups.
  std::vector<uint32_t> group_numbers_;  ///< index + 1; 0: none
  std::vector<double> radii_m_;
  std::vector<double> others_per_m2_;
  std::vector<Adjustment> adjustments_;
  // Latest progress: number of goals visited, distance to go, and time.
  std::vector<uint32_t> visits_;
  std::vector<double> min_distances_m_;
  std::vector<double> since_s_;
};

}  // namespace throng
