// What everybody is about: which goal they walk to, waiting, staying, gone.
// One rule: what a person does depends on where that person stands and on the time only, so that
// persons can be asked in any order.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/archive.h"
#include "base/memory.h"
#include "crowd/crowd_counters.h"
#include "crowd/detours.h"
#include "crowd/navigation/navigation_map.h"
#include "crowd/spawn.h"

namespace throng {
namespace tuning {

/// A target counts as reached within this; after so long in the goal's area, anyhow.
inline constexpr double kArrival_m = 0.7;
inline constexpr double kPatience_s = 3.0;
/// Round a goal with no side longer than the first agents hinder each other or walk in circles (the
/// heuristic does round a square of 0.6 m, and hits one of 0.8 m): its area then is all within the
/// second of it.
inline constexpr double kSmallGoal_m = 0.7;
inline constexpr double kAroundSmall_m = 1.0;

/// The shortest way is the same for all, and round a corner all would walk in one file along its
/// inner edge. Each keeps to a side of their own, as far off the shortest way as the next wall is
/// farther away than the first, and than the second's share of the way left. Not so in a queue,
/// where it would lead into a door's frame: all of it from the fourth's share of the free speed
/// on, nothing below the third's. So fast they go over to it: feet can follow.
inline constexpr double kLateralOffsetFrom_m = 0.45;
inline constexpr double kLateralOffsetShare = 0.2;
inline constexpr double kLateralOffsetSlow = 0.2, kLateralOffsetFast = 0.5;
inline constexpr double kLateralOffsetRate_mps = 0.2;

}  // namespace tuning

enum class JourneyState : uint8_t {
  kOutside,  ///< has not entered yet
  kWaiting,  ///< stands still until a time: before setting out, or at a goal
  kWalking,
  kQueuing,   ///< has a place in the queue for a goal
  kStaying,   ///< at the last goal, for good
  kStranded,  ///< no way leads from here to the goal
  kLeaving,   ///< at the last goal; to be taken out of the scene
  kGone,
};

/// Why an agent that walks does not get on, as the crowd around it shows.
enum class StallCause : uint8_t {
  kNone,
  kStuck,          ///< no progress for tuning::kPatience_s, queuing not counted
  kBehindStaying,  ///< an agent ahead stays for good before the same goal, or in a narrow one
};

/// How somebody keeps off the shortest way.
struct LateralOffset {
  double offset_m = 0;  ///< less than nothing: to the right
  Eigen::Vector2d last_direction =
      Eigen::Vector2d::Zero();  ///< unit, the way they went; zero: not known

  /// Where somebody walks whose shortest way is theirs.
  Eigen::Vector2d beside_m(const Eigen::Vector2d& position_m,
                           const Eigen::Vector2d& path_direction) const {
    return position_m + offset_m * Eigen::Vector2d(path_direction.y(), -path_direction.x());
  }
};

class Journeys {
 public:
  /// Keeps references to `map` and `detours`. Those with an entrance are outside until enter();
  /// the others begin at time 0.
  Journeys(const NavigationMap& map, const Detours& detours, std::span<const AgentSpec> people,
           uint64_t seed);

  /// Everything that follow() may have changed.
  void archive(Archive& a);

  /// Somebody comes in at a place.
  void enter(uint32_t id, const Eigen::Vector2d& position_m, double now_s);
  /// Somebody who is led is there, or is not.
  void set_present(uint32_t id, bool is_there) {
    journeys_[id].state = is_there ? JourneyState::kStaying : JourneyState::kOutside;
  }
  /// Somebody who is leaving has left.
  void leave(uint32_t id) { journeys_[id].state = JourneyState::kGone; }

  /// The members of a group may set out from then on; those of a group that waits for a moment
  /// (NavigationMap::after()) stand until then.
  void allow_departure(size_t group, double time_s) { departures_s_[group] = time_s; }
  /// True if somebody has been at so many goals, and of those who cannot get on.
  bool has_visited(uint32_t id, uint32_t goals) const {
    return visits_[id] >= goals || journeys_[id].state == JourneyState::kStranded;
  }

  /// Once a decision: arrives, waits, goes on. Touches nobody else's state.
  void follow(uint32_t id, const Eigen::Vector2d& position_m, double now_s, StallCause stall_cause);

  /// Unit vector of the way from here; zero for who has none, or stands still on purpose.
  /// Whoever keeps to the left of the shortest way walks as somebody does who is so far to their
  /// right. With walls at `clearance_m`, crowds bend the way less.
  Eigen::Vector2d direction(uint32_t id, const Eigen::Vector2d& position_m,
                            const LateralOffset& side = {}, double clearance_m = 1e9) const;

  /// The way that somebody who waits will go from here. Zero for those who have none.
  Eigen::Vector2d facing(uint32_t id, const Eigen::Vector2d& position_m) const;

  /// The other prefetch() of the same is asked for soon, or anything else of them.
  THRONG_PREFETCH void prefetch(uint32_t id) const { __builtin_prefetch(&journeys_[id]); }
  /// direction() of the same is asked for soon.
  void prefetch(uint32_t id, const Eigen::Vector2d& position_m,
                const LateralOffset& side = {}) const;

  JourneyState state(uint32_t id) const { return journeys_[id].state; }
  /// The least id of the party; of somebody without companions, the own.
  uint32_t first_member(uint32_t id) const { return first_members_[id]; }
  /// Returns whether an agent at this place has reached the goal it walks to, see has_reached(). It
  /// may still look for a place there. The areas of a goal with a queue are told apart.
  bool is_at_goal(uint32_t id, const Eigen::Vector2d& position_m) const;
  /// Returns whether an agent walks to its last goal, without a queue, to stay there.
  bool walks_to_stay(uint32_t id) const;
  /// Returns whether an agent is at its last goal for good.
  bool is_staying(uint32_t id) const {
    return journeys_[id].state == JourneyState::kStaying ||
           (journeys_[id].state == JourneyState::kWaiting &&
            journeys_[id].next == JourneyState::kStaying);
  }
  /// How many goals somebody has been at.
  uint32_t visits(uint32_t id) const { return visits_[id]; }
  bool is_present(uint32_t id) const {
    return journeys_[id].state != JourneyState::kOutside &&
           journeys_[id].state != JourneyState::kGone;
  }
  /// The goal, being walked to or stood at.
  const Stop& stop(uint32_t id) const {
    return map_.route(journeys_[id].group)[journeys_[id].stop];
  }

  /// Of people who walk to a goal of several exits: which of NavigationMap::exits(), or kOpen while
  /// that is open. Of others kNoExit.
  uint32_t exit(uint32_t id) const { return journeys_[id].exit; }
  static constexpr uint32_t kNoExit = UINT32_MAX;
  static constexpr uint32_t kOpen = UINT32_MAX - 1;
  /// From now on somebody who has to choose, or has chosen, walks to that one.
  void take_exit(uint32_t id, uint32_t exit) { journeys_[id].exit = exit; }
  /// True of somebody who walks to a goal with a queue and has no place in it yet.
  bool seeks_queue(uint32_t id) const {
    return journeys_[id].state == JourneyState::kWalking && !areas_.empty() && !is_admitted(id) &&
           stop(id).queue;
  }
  /// True of somebody who may go into a goal with a queue, until they have been there; and into
  /// which area.
  bool is_admitted(uint32_t id) const { return !areas_.empty() && areas_[id] != kNoArea; }
  uint32_t area(uint32_t id) const { return areas_[id]; }
  /// Of somebody who seeks a queue: from now on they have a place in it.
  void join_queue(uint32_t id) { journeys_[id].state = JourneyState::kQueuing; }
  /// From now on somebody in a queue walks to that area of the goal.
  void admit(uint32_t id, uint32_t area, const Eigen::Vector2d& position_m);
  static constexpr uint32_t kNoCorner = UINT32_MAX;
  /// Where somebody goes who seeks a queue, or stands in one, in this period: a direction, no
  /// longer than 1, and the corner of its line whose field leads there; none: that of the goal.
  void guide(uint32_t id, const Eigen::Vector2d& path_direction, uint32_t corner) {
    guides_[id] = {path_direction, corner};
  }

  /// The way that somebody follows. As long as the exit is open, the one to the nearest.
  const FlowField& field(uint32_t id) const {
    if (journeys_[id].exit < kOpen) return *map_.exits()[journeys_[id].exit].field;
    if (!areas_.empty() && stop(id).queue) return queue_field(id);
    return *stop(id).field;
  }

  /// Everybody who is stranded now, by group and stop. One caller at a time.
  std::vector<Stranding> strandings(std::span<const Eigen::Vector2d> positions_m) const;

 private:
  void set_out(uint32_t id, const Eigen::Vector2d& position_m);
  void arrive(uint32_t id, const Eigen::Vector2d& position_m, double now_s);
  std::span<const Rectangle> areas_of_goal(uint32_t id) const;
  bool is_round_small_goal(uint32_t id, const Eigen::Vector2d& position_m) const;
  bool is_beside_goal(uint32_t id, const Eigen::Vector2d& position_m) const;
  bool is_last_stop(uint32_t id) const {
    return journeys_[id].stop + 1 == map_.route(journeys_[id].group).size();
  }
  double draw_wait_s(uint32_t id) const;
  const FlowField& queue_field(uint32_t id) const;
  std::optional<size_t> detour_number(uint32_t id) const;
  Eigen::Vector2d detoured_direction(uint32_t id, const Eigen::Vector2d& position_m,
                                     const Eigen::Vector2d& along) const;
  void choose_target(uint32_t id, const Eigen::Vector2d& position_m);

  const NavigationMap& map_;
  const Detours& detours_;
  uint64_t seed_;
  /// What directions follow from: a quarter of a line of the cache.
  struct Journey {
    uint32_t group = 0;       ///< for good
    uint32_t stop = 0;        ///< index into the route
    uint32_t exit = kNoExit;  ///< see exit()
    JourneyState state = JourneyState::kOutside;
    JourneyState next = JourneyState::kWalking;  ///< after waiting
    void archive(Archive& a) { a(stop, exit, state, next); }
  };
  // By person.
  std::vector<Journey> journeys_;
  std::vector<double> delays_s_;
  std::vector<double> radii_m_;  ///< of the discs
  std::vector<uint32_t>
      first_members_;  ///< of the party, beside whose places theirs are; or themselves
  std::vector<double>
      until_s_;  ///< end of waiting; of walking inside a goal: when to take any place
  std::vector<uint32_t> visits_;  ///< goals reached so far: what choosing a place draws by
  std::vector<Eigen::Vector2d> targets_m_;  ///< the place inside the goal
  static constexpr uint32_t kNoArea = UINT32_MAX;
  /// Of a period: where to, for those whom Queues guide.
  struct Guide {
    Eigen::Vector2d path_direction = Eigen::Vector2d::Zero();
    uint32_t corner = kNoCorner;
    void archive(Archive& a) { a(path_direction, corner); }
  };
  // Empty where there are no queues.
  std::vector<uint32_t> areas_;  ///< of the goal, that they have been let into
  std::vector<Guide> guides_;
  std::vector<double> departures_s_;  ///< by group: infinity until its moment is known
};

/// A line for the user: who cannot reach what from where, and what is in the way.
std::string describe(const Stranding& stranding, const CrowdPlan& plan);

}  // namespace throng
