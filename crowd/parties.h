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
#include "crowd/navigation/ways.h"
#include "crowd/spawn.h"

namespace throng {

struct SteeringState;

class Parties {
 public:
  /// Keeps a reference to `ways`.
  Parties(const Ways& ways, std::span<const Person> people);

  /// True if anybody has companions: otherwise all of this costs nothing.
  bool any() const { return !parties_.empty(); }
  bool has(uint32_t id) const { return any() && in_party_[id] != 0; }

  /// Everything that gather() may have changed and that the next one depends on.
  void archive(Archive& a);

  /// Members see how many strangers are near, and their companions are no neighbours where they
  /// walk beside each other; before gather().
  void look_around(SteeringState& state, std::span<const uint32_t> slots);

  /// Who decides when is fixed by this one of several ids: companions decide together.
  uint32_t first_of_party(uint32_t id) const {
    return has(id) ? parties_[in_party_[id] - 1].begin : id;
  }

  /// Of those whose first one's id leaves that remainder when divided by `parts`: what companions
  /// make of each other, before they decide. No allocation.
  void gather(uint32_t remainder, uint32_t parts, const Journeys& journeys,
              std::span<const Eigen::Vector2d> positions_m, double now_s, Workers& workers);

  /// The way that somebody of a party would go alone, of Journeys::direction().
  const Eigen::Vector2d& alone(uint32_t id) const { return wishes_[id].alone; }
  /// And the way with companions: a unit vector, or zero.
  Eigen::Vector2d way(uint32_t id) const;
  /// Of the free speed: below 1 ahead of the others, above it behind them.
  double pace(uint32_t id) const { return any() ? wishes_[id].pace : 1; }
  /// True if somebody who walks is slow or stands because a companion is behind.
  bool waits(uint32_t id) const { return any() && wishes_[id].pace < kWaits; }
  /// And true if it stands for that one, to whom it turns then: where that is.
  bool stands(uint32_t id) const { return any() && wishes_[id].pace < kStands; }
  const Eigen::Vector2d& waits_for_m(uint32_t id) const { return wishes_[id].behind_m; }
  bool are_companions(uint32_t a, uint32_t b) const {
    return in_party_[a] != 0 && in_party_[a] == in_party_[b];
  }

 private:
  double crowding_per_m2(const SteeringState& state, size_t slot) const;
  void overlook_companions(SteeringState& state, size_t slot) const;

  static constexpr double kWaits = 0.5, kStands = 0.05;

  struct Party {
    uint32_t begin = 0, end = 0;  ///< ids
  };
  struct Wish {
    Eigen::Vector2d alone = Eigen::Vector2d::Zero();
    Eigen::Vector2d aside = Eigen::Vector2d::Zero();    ///< added to the way
    Eigen::Vector2d towards = Eigen::Vector2d::Zero();  ///< instead of the way, unless it is zero
    Eigen::Vector2d behind_m = Eigen::Vector2d::Zero();
    double pace = 1;
  };
  /// Somebody of a party who is about something.
  struct Member {
    uint32_t id = 0;
    uint32_t visits = 0;
    Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d way = Eigen::Vector2d::Zero();
    const FlowField* field = nullptr;
    double to_go_m = 0;      ///< of those who are not all near each other
    bool is_awaited = true;  ///< gets on, or will
    bool is_on_way = false;  ///< walks, and is not at the goal yet
  };
  /// Those of a party who walk side by side, and the frame in which they do.
  struct Row;

  void gather(const Party& party, const Journeys& journeys,
              std::span<const Eigen::Vector2d> positions_m, double now_s);
  Member member(uint32_t id, const Journeys& journeys, const Eigen::Vector2d& at_m) const;
  void watch_progress(Member& m, bool waits, double now_s);
  void find_row(std::span<const Member> members, size_t who, Row& row) const;
  double room_m(const Row& row, const FlowField& field, double wanted_m) const;
  double keep_place(const Row& row, const Member& self, Wish& wish) const;
  void wait_for_others(std::span<const Member> members, size_t who, const Row& row, double length_m,
                       Wish& wish) const;

  const Ways& ways_;
  std::vector<Party> parties_;
  // By person; empty: there are no parties.
  std::vector<uint32_t> in_party_;  ///< its index and 1; 0: none
  std::vector<double> radii_m_;
  std::vector<double> strangers_per_m2_;
  std::vector<Wish> wishes_;
  // Of the latest progress: which goal it was on the way to, how far it was, and when.
  std::vector<uint32_t> visits_;
  std::vector<double> nearest_m_;
  std::vector<double> since_s_;
};

}  // namespace throng
