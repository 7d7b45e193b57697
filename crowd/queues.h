// Queues: who waits for a goal that takes few at a time, in the order in which they came, and who
// is in it.
// One rule: first come, first served. Whoever has joined keeps the place before all who join later;
// nobody is let in but the first, and only when somebody else is out.
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

  /// True if there are queues: otherwise all of this costs nothing.
  bool any() const { return !queues_.empty(); }

  /// Everything that follow() may have changed and that the next one depends on. When reading, the
  /// journeys have been read.
  void archive(Archive& a, const Journeys& journeys);

  /// Once a decision, when everybody has followed their journeys and people have come and gone:
  /// people join, are let in, and are told where to go until then. No allocation.
  void follow(std::span<const uint8_t> present, std::span<const Eigen::Vector2d> positions_m,
              Journeys& journeys, Workers& workers);

  /// Where somebody looks who stands in a queue, or is served: a unit vector. Zero for others.
  const Eigen::Vector2d& facing(uint32_t id) const { return facings_[id]; }

  /// True of somebody in a queue whose place in the line has come free ahead of others, and who is
  /// not there yet.
  bool is_awaited(uint32_t id) const { return any() && steps_[id] == kAwaited; }

  /// Where somebody ends who would step from one place to another: not inside a goal for which they
  /// have to wait. Any thread may ask.
  Eigen::Vector2d keep_out(uint32_t id, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                           const Journeys& journeys) const;

  /// Ids by NavigationMap::queues(), the first of them first.
  std::span<const uint32_t> waiting(size_t queue) const { return queues_[queue].waiting; }
  /// In an area of the goal, on the way into it, or on the way out.
  size_t inside(size_t queue) const { return queues_[queue].served.size(); }

 private:
  static constexpr uint32_t kNoOverflow = UINT32_MAX;
  /// kAwaited: steps forward, and is farther than a place from where to stand.
  enum : uint8_t { kStands, kSteps, kAwaited };

  /// Somebody who has been let in, until out again.
  struct ServedAgent {
    uint32_t id = 0, area = 0;
    uint32_t visits = 0;  ///< of Journeys, before
    void archive(Archive& a) { a(id, area, visits); }
  };
  struct Queue {
    std::vector<uint32_t> waiting;
    std::vector<ServedAgent> served;
    std::vector<uint32_t> served_counts;  ///< by area
    std::vector<uint8_t> is_taken;        ///< by spot
    size_t capacity = 0;                  ///< people who may ever be in it
  };
  /// Somebody near enough to the end of a queue to join it.
  struct QueueCandidate {
    uint32_t queue = 0;
    double away_m = 0;
    uint32_t id = 0;
    bool goes_in = false;  ///< straight, as nobody waits
  };
  /// What somebody wants who stands in a queue: to be there, and to go that way for it.
  struct QueueMove {
    Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
    double along_m = 0;  ///< the line, where that is; off it, its end
    double left_m = 0;   ///< to go in all; 0: stays
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
  std::vector<uint32_t> queuers_;  ///< ids of those who may ever queue
  std::vector<QueueCandidate> candidates_;
  // By person; empty: there are no queues.
  std::vector<double> along_m_;     ///< how far back on the line they are
  std::vector<uint8_t> steps_;      ///< kStands, kSteps or kAwaited
  std::vector<uint32_t> overflow_;  ///< off the line, for which it is too short
  std::vector<Eigen::Vector2d> facings_;
};

}  // namespace throng
