// Queues assigns waiting agents to positions, and admits them to goals with limited capacity.
// Invariant: first come, first served. An agent keeps its place before all that join later; only
// the first is admitted, and only when a served agent has left.
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

class Queues {
 public:
  /// Keeps a reference to `map`.
  Queues(const NavigationMap& map, std::span<const AgentSpec> people);

  /// Returns false without queues: no other call is then needed.
  bool any() const { return !queues_.empty(); }

  /// Saves or restores all state that follow() may change and the next call depends on. When
  /// reading, the journeys must have been read.
  void archive(Archive& a, const Journeys& journeys);

  /// To be called once per period, after journeys and population: agents join, are admitted, or are
  /// guided along the queue. Allocates nothing.
  void follow(std::span<const uint8_t> present, std::span<const Eigen::Vector2d> positions_m,
              Journeys& journeys, Workers& workers);

  /// Takes an agent out of all queues; `is_waiting`: it may wait in one.
  void remove(uint32_t id, bool is_waiting);

  /// Unit vector that an agent in a queue, or a served one, faces; zero for others.
  const Eigen::Vector2d& facing(uint32_t id) const { return facings_[id]; }

  /// Returns whether a position ahead of an agent has become free and the agent is not there yet.
  bool is_awaited(uint32_t id) const { return any() && steps_[id] == kAwaited; }

  /// Returns where an agent ends that steps from one point to another: not inside a goal for which
  /// it has to wait. Thread-safe.
  Eigen::Vector2d keep_out(uint32_t id, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                           const Journeys& journeys) const;

  /// Ids of waiting agents, first in line first; `queue` as in NavigationMap::queues().
  std::span<const uint32_t> waiting(size_t queue) const { return queues_[queue].waiting; }
  /// Number of agents in an area of the goal, on their way in or on their way out.
  size_t inside(size_t queue) const { return queues_[queue].served.size(); }

 private:
  static constexpr uint32_t kNoOverflow = UINT32_MAX;
  /// kAwaited: steps forward, and is more than one position behind its own.
  enum : uint8_t { kStands, kSteps, kAwaited };

  /// An admitted agent, until it is out again.
  struct ServedAgent {
    uint32_t id = 0, area = 0;
    uint32_t visits = 0;  ///< value of Journeys::visits() on admission
    void archive(Archive& a) { a(id, area, visits); }
  };
  struct Queue {
    std::vector<uint32_t> waiting;
    std::vector<ServedAgent> served;
    std::vector<uint32_t> served_counts;  ///< per area
    std::vector<uint8_t> is_taken;        ///< per overflow position
    size_t capacity = 0;                  ///< maximum number of agents in it
  };
  /// An agent near enough to the end of a queue to join it.
  struct QueueCandidate {
    uint32_t queue = 0;
    double away_m = 0;
    uint32_t id = 0;
    bool goes_in = false;  ///< directly, because no agent waits
  };
  /// Target of an agent in a queue and the path to it.
  struct QueueMove {
    Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
    double along_m = 0;  ///< on the line; off it, the line's end
    double left_m = 0;   ///< remaining distance; 0: stays
  };

  void release_served(uint32_t queue, std::span<const uint8_t> present,
                      std::span<const Eigen::Vector2d> positions_m, const Journeys& journeys);
  void find_joiners(std::span<const Eigen::Vector2d> positions_m, const Journeys& journeys);
  void add(const QueueCandidate& candidate, const Eigen::Vector2d& position_m, Journeys& journeys);
  void admit(uint32_t queue, std::span<const Eigen::Vector2d> positions_m, Journeys& journeys);
  void line_up(uint32_t queue, std::span<const Eigen::Vector2d> positions_m, Journeys& journeys);
  QueueMove next_move(uint32_t queue, size_t place, const Eigen::Vector2d& position_m);
  void face(uint32_t queue, size_t place, std::span<const Eigen::Vector2d> positions_m);
  void guide_to_tail(uint32_t id, const Eigen::Vector2d& position_m, Journeys& journeys);
  bool has_free_area(uint32_t queue) const { return free_places(queue) > 0; }
  size_t free_places(uint32_t queue) const;
  uint32_t first_free_overflow(uint32_t queue) const;
  Eigen::Vector2d tail_m(uint32_t queue) const;
  bool sees(uint32_t queue, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) const;
  void check_read(Archive& a, const Journeys& journeys) const;
  void occupy_overflow();

  const NavigationMap& map_;
  std::vector<Queue> queues_;
  std::vector<uint32_t> queuers_;  ///< ids of agents that may queue
  std::vector<QueueCandidate> candidates_;
  // By id; empty without queues.
  std::vector<double> along_m_;     ///< distance back along the line
  std::vector<uint8_t> steps_;      ///< kStands, kSteps or kAwaited
  std::vector<uint32_t> overflow_;  ///< position off the line, if the line is too short
  std::vector<Eigen::Vector2d> facings_;
};

}  // namespace throng
