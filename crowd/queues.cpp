#include "crowd/queues.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

/// An agent this close to the end of a queue, and with a free line of sight, joins it.
constexpr double kJoins_m = 1.5;
/// A walking agent has left an area at this distance: no step back leads into it again.
constexpr double kOut_m = 0.3;
/// Within this distance agents that see the end of a queue walk straight to it.
constexpr double kSees_m = 12;
constexpr double kSample_m = 0.4;
/// Distance within which an obstacle blocks a straight path.
constexpr double kPathClearance_m = 0.2;
/// Look-ahead along the line, round its corners.
constexpr double kAhead_m = 0.5;
/// In spacings: an agent farther back than the threshold steps forward. It keeps the minimum to the
/// previous agent, which may not stand in its position.
constexpr double kStepThreshold = 0.4, kMinSpacing = 0.75;

}  // namespace

Queues::Queues(const NavigationMap& map, std::span<const AgentSpec> people) : map_(map) {
  if (map.queues().empty()) return;
  for (uint32_t id = 0; id < people.size(); ++id) {
    if (people[id].is_external) continue;  // without a route
    const std::vector<Stop>& route = map.route(people[id].group);
    if (std::any_of(route.begin(), route.end(), [](const Stop& stop) { return stop.queue; }))
      queuers_.push_back(id);
  }
  for (const QueueFields& each : map.queues()) {
    Queue& queue = queues_.emplace_back();
    queue.capacity = queuers_.size();
    queue.waiting.reserve(queue.capacity);
    queue.served.reserve(queue.capacity);
    queue.served_counts.assign(each.plan.areas.size(), 0);
    queue.is_taken.assign(each.plan.overflow_positions_m.size(), 0);
  }
  candidates_.reserve(queuers_.size());
  along_m_.assign(people.size(), 0);
  steps_.assign(people.size(), 0);
  overflow_.assign(people.size(), kNoOverflow);
  facings_.assign(people.size(), Eigen::Vector2d::Zero());
}

void Queues::archive(Archive& a, const Journeys& journeys) {
  if (!any()) return;
  for (Queue& queue : queues_) {
    a.resized(queue.waiting, queue.capacity);
    a.resized(queue.served, queue.capacity);
  }
  a(along_m_, steps_, overflow_, facings_);
  if (!a.is_reading()) return;
  check_read(a, journeys);
  for (Queue& queue : queues_) {
    std::fill(queue.served_counts.begin(), queue.served_counts.end(), 0);
    for (const ServedAgent& agent : queue.served) ++queue.served_counts[agent.area];
  }
  occupy_overflow();
}

/// Comparisons are negated to reject NaN as well.
void Queues::check_read(Archive& a, const Journeys& journeys) const {
  std::vector<uint8_t> is_known(along_m_.size(), 0);
  const auto take = [&](uint32_t id) {
    if (id >= is_known.size() || is_known[id] != 0 ||
        !std::binary_search(queuers_.begin(), queuers_.end(), id))
      a.reject("each queuing agent in one place", "an agent in two places");
    is_known[id] = 1;
  };
  for (uint32_t q = 0; q < queues_.size(); ++q)
    for (const uint32_t id : queues_[q].waiting) {
      take(id);
      if (journeys.state(id) != JourneyState::kQueuing || journeys.stop(id).queue != q)
        a.reject("queuing agents only in a queue", "an agent that does not queue");
      const size_t overflow_count = queues_[q].is_taken.size();
      if (!(along_m_[id] >= 0) || !(along_m_[id] <= map_.queues()[q].plan.line.length_m()) ||
          (overflow_[id] != kNoOverflow && overflow_[id] >= overflow_count))
        a.reject("a position in the queue", "another value");
    }
  for (const uint32_t id : queuers_)
    if (journeys.state(id) == JourneyState::kQueuing && is_known[id] == 0)
      a.reject("each queuing agent in a queue", "one in no queue");
  for (const Eigen::Vector2d& facing : facings_)
    if (!(facing.norm() <= 1.001)) a.reject("a direction of length up to 1", "another vector");
  // An agent that waits again may still be on its way out.
  for (uint32_t q = 0; q < queues_.size(); ++q) {
    std::fill(is_known.begin(), is_known.end(), uint8_t{0});
    for (const ServedAgent& agent : queues_[q].served) {
      take(agent.id);
      if (agent.area >= queues_[q].served_counts.size())
        a.reject("an area of the goal", "another area");
    }
  }
}

void Queues::occupy_overflow() {
  for (Queue& queue : queues_) {
    std::fill(queue.is_taken.begin(), queue.is_taken.end(), uint8_t{0});
    for (const uint32_t id : queue.waiting)
      if (overflow_[id] != kNoOverflow) queue.is_taken[overflow_[id]] = 1;
  }
}

void Queues::follow(std::span<const uint8_t> present, std::span<const Eigen::Vector2d> positions_m,
                    Journeys& journeys, Workers& workers) {
  for (uint32_t queue = 0; queue < queues_.size(); ++queue)
    release_served(queue, present, positions_m, journeys);
  find_joiners(positions_m, journeys);
  for (const QueueCandidate& candidate : candidates_)
    add(candidate, positions_m[candidate.id], journeys);
  for (uint32_t queue = 0; queue < queues_.size(); ++queue) {
    admit(queue, positions_m, journeys);
    line_up(queue, positions_m, journeys);
  }
  constexpr size_t kBlockSize = 64;
  workers.for_blocks(static_cast<int>((queuers_.size() + kBlockSize - 1) / kBlockSize),
                     [&](int block, int) {
                       const size_t begin = static_cast<size_t>(block) * kBlockSize;
                       const size_t end = std::min(begin + kBlockSize, queuers_.size());
                       for (size_t i = begin; i < end; ++i)
                         if (journeys.seeks_queue(queuers_[i]))
                           guide_to_tail(queuers_[i], positions_m[queuers_[i]], journeys);
                     });
}

void Queues::remove(uint32_t id, bool is_waiting) {
  if (!any()) return;
  for (Queue& queue : queues_) {
    if (is_waiting && std::erase(queue.waiting, id) > 0 && overflow_[id] != kNoOverflow)
      queue.is_taken[overflow_[id]] = 0;
    std::erase_if(queue.served, [&](const ServedAgent& agent) {
      if (agent.id != id) return false;
      --queue.served_counts[agent.area];
      return true;
    });
  }
  overflow_[id] = kNoOverflow;
  steps_[id] = kStands;
  facings_[id].setZero();
}

/// Releases agents that have been served and have cleared the area for the next.
void Queues::release_served(uint32_t queue, std::span<const uint8_t> present,
                            std::span<const Eigen::Vector2d> positions_m,
                            const Journeys& journeys) {
  const std::vector<Area>& areas = map_.queues()[queue].plan.areas;
  Queue& q = queues_[queue];
  std::erase_if(q.served, [&](const ServedAgent& agent) {
    const uint32_t id = agent.id;
    const JourneyState state = journeys.state(id);
    const bool stands = state == JourneyState::kWaiting || state == JourneyState::kStaying;
    const bool is_served = stands && journeys.visits(id) == agent.visits + 1;
    const bool goes_in = journeys.is_admitted(id) && journeys.stop(id).queue == queue;
    if (is_served) facings_[id] = map_.queues()[queue].plan.fronts[agent.area];
    const bool is_around = areas[agent.area].contains(positions_m[id], stands ? 0 : kOut_m);
    if (present[id] != 0 && (goes_in || is_served || is_around)) return false;
    --q.served_counts[agent.area];
    facings_[id].setZero();
    return true;
  });
}

void Queues::find_joiners(std::span<const Eigen::Vector2d> positions_m, const Journeys& journeys) {
  candidates_.clear();
  for (const uint32_t id : queuers_) {
    if (!journeys.seeks_queue(id)) continue;
    const uint32_t queue = *journeys.stop(id).queue;
    const Eigen::Vector2d& at_m = positions_m[id];
    const Eigen::Vector2d end = tail_m(queue);
    double away_m = (end - at_m).norm();
    bool joins = away_m < kJoins_m && sees(queue, at_m, end), goes_in = false;
    if (!joins && queues_[queue].waiting.empty() && has_free_area(queue)) {
      const Area& area = journeys.stop(id).nearest_area(at_m);
      const Eigen::Vector2d rim = area.nearest_m(at_m);
      away_m = (rim - at_m).norm();
      joins = goes_in = away_m < kJoins_m && sees(queue, at_m, rim);
    }
    if (joins) candidates_.push_back({queue, away_m, id, goes_in});
  }
  std::sort(candidates_.begin(), candidates_.end(),
            [](const QueueCandidate& a, const QueueCandidate& b) {
              return std::tie(a.queue, a.away_m, a.id) < std::tie(b.queue, b.away_m, b.id);
            });
}

void Queues::add(const QueueCandidate& candidate, const Eigen::Vector2d& position_m,
                 Journeys& journeys) {
  Queue& q = queues_[candidate.queue];
  const QueuePlan& plan = map_.queues()[candidate.queue].plan;
  const uint32_t id = candidate.id;
  if (candidate.goes_in && q.waiting.size() >= free_places(candidate.queue)) return;
  journeys.join_queue(id);
  const double place_m = plan.along_m(q.waiting.size());
  overflow_[id] =
      q.waiting.size() < plan.places ? kNoOverflow : first_free_overflow(candidate.queue);
  if (overflow_[id] != kNoOverflow) q.is_taken[overflow_[id]] = 1;
  along_m_[id] =
      plan.line.nearest_m(position_m, place_m - 0.5 * plan.spacing_m, place_m + kJoins_m);
  steps_[id] = kSteps;
  q.waiting.push_back(id);
}

void Queues::admit(uint32_t queue, std::span<const Eigen::Vector2d> positions_m,
                   Journeys& journeys) {
  const QueuePlan& plan = map_.queues()[queue].plan;
  Queue& q = queues_[queue];
  size_t admitted = 0;
  for (; admitted < q.waiting.size() && has_free_area(queue); ++admitted) {
    const uint32_t id = q.waiting[admitted];
    const auto away_m2 = [&](size_t area) {
      return (plan.areas[area].middle_m() - positions_m[id]).squaredNorm();
    };
    size_t nearest = plan.areas.size();
    for (size_t area = 0; area < plan.areas.size(); ++area)
      if (q.served_counts[area] < plan.max_inside &&
          (nearest == plan.areas.size() || away_m2(area) < away_m2(nearest)))
        nearest = area;
    const auto area = static_cast<uint32_t>(nearest);
    journeys.admit(id, area, positions_m[id]);
    facings_[id].setZero();
    steps_[id] = kStands;
    if (overflow_[id] != kNoOverflow) q.is_taken[overflow_[id]] = 0;
    overflow_[id] = kNoOverflow;
    ++q.served_counts[area];
    // An agent that comes again before it is out is still the same served agent.
    std::erase_if(q.served, [&](const ServedAgent& agent) {
      if (agent.id != id) return false;
      --q.served_counts[agent.area];
      return true;
    });
    q.served.push_back({id, area, journeys.visits(id)});
  }
  q.waiting.erase(q.waiting.begin(), q.waiting.begin() + static_cast<ptrdiff_t>(admitted));
}

/// From first to last, because no agent walks to where the previous one still is.
void Queues::line_up(uint32_t queue, std::span<const Eigen::Vector2d> positions_m,
                     Journeys& journeys) {
  const QueueFields& fields = map_.queues()[queue];
  Queue& q = queues_[queue];
  for (size_t place = 0; place < q.waiting.size(); ++place) {
    const uint32_t id = q.waiting[place];
    const Eigen::Vector2d& at_m = positions_m[id];
    if (place < fields.plan.places && overflow_[id] != kNoOverflow) {
      q.is_taken[overflow_[id]] = 0;
      overflow_[id] = kNoOverflow;
      along_m_[id] = fields.plan.line.length_m();
    }
    const QueueMove to = next_move(queue, place, at_m);
    // The path bends where others have pushed the agent round a corner.
    const size_t corner = fields.plan.line.nearest_corner(to.along_m);
    const double speed_factor = std::min(1.0, to.left_m / tuning::kBrakingDistance_m);
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    if (speed_factor > tuning::kMinSpeedFactor)
      direction = sees(queue, at_m, to.to_m) ? Eigen::Vector2d((to.to_m - at_m).normalized())
                                             : fields.to_corners[corner]->direction(at_m);
    journeys.guide(id, speed_factor * direction, static_cast<uint32_t>(corner));
    face(queue, place, positions_m);
  }
}

Queues::QueueMove Queues::next_move(uint32_t queue, size_t place,
                                    const Eigen::Vector2d& position_m) {
  const QueuePlan& plan = map_.queues()[queue].plan;
  const uint32_t id = queues_[queue].waiting[place];
  const double step_m = kStepThreshold * plan.spacing_m;
  QueueMove move;
  move.along_m = plan.line.length_m();
  if (place >= plan.places) {
    const bool has_overflow = overflow_[id] != kNoOverflow;
    move.to_m =
        has_overflow ? plan.overflow_positions_m[overflow_[id]] : plan.line.corners_m().back();
    move.left_m = (move.to_m - position_m).norm();
    // Without any free position agents stand where others let them.
    if (!has_overflow && move.left_m < 3 * plan.spacing_m) move.left_m = 0;
  } else {
    double& along_m = along_m_[id];
    along_m = plan.line.nearest_m(position_m, along_m - kJoins_m, along_m + kJoins_m);
    const double place_m = plan.along_m(place);
    double to_m = place_m;
    if (place > 0)
      to_m = std::max(to_m,
                      along_m_[queues_[queue].waiting[place - 1]] + kMinSpacing * plan.spacing_m);
    // The previous agent has to move on first.
    if (to_m > along_m && along_m >= place_m) to_m = along_m;
    move.along_m = std::max(to_m, along_m - kAhead_m);
    move.to_m = plan.line.at(move.along_m);
    move.left_m = std::max(along_m - to_m, (move.to_m - position_m).norm());
  }
  // Distances of a few centimetres are ignored.
  uint8_t& steps = steps_[id];
  if (move.left_m < tuning::kMinSpeedFactor * tuning::kBrakingDistance_m) steps = kStands;
  if (steps != kStands || move.left_m > step_m) steps = kSteps;
  if (steps == kStands) move.left_m = 0;
  if (place < plan.places && move.left_m > plan.spacing_m) steps = kAwaited;
  return move;
}

/// The first faces the goal, others the previous agent, those off the line its end.
void Queues::face(uint32_t queue, size_t place, std::span<const Eigen::Vector2d> positions_m) {
  const QueuePlan& plan = map_.queues()[queue].plan;
  const std::vector<uint32_t>& waiting = queues_[queue].waiting;
  const uint32_t id = waiting[place];
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
  if (overflow_[id] != kNoOverflow) {
    to_m = plan.line.corners_m().back();
  } else if (place > 0) {
    to_m = positions_m[waiting[place - 1]];
  } else {
    for (const Area& area : plan.areas)
      to_m += area.middle_m() / static_cast<double>(plan.areas.size());
  }
  const Eigen::Vector2d direction = to_m - positions_m[id];
  if (!direction.isZero()) facings_[id] = direction.normalized();
}

void Queues::guide_to_tail(uint32_t id, const Eigen::Vector2d& position_m, Journeys& journeys) {
  const uint32_t queue = *journeys.stop(id).queue;
  const QueueFields& fields = map_.queues()[queue];
  const FlowField* field = journeys.stop(id).field;
  uint32_t corner = Journeys::kNoCorner;
  Eigen::Vector2d to_m = journeys.stop(id).nearest_area(position_m).middle_m();
  bool goes_straight = false;
  if (!queues_[queue].waiting.empty() || !has_free_area(queue)) {
    to_m = tail_m(queue);
    const double tail_m =
        std::min(fields.plan.along_m(queues_[queue].waiting.size()), fields.plan.line.length_m());
    corner = static_cast<uint32_t>(fields.plan.line.nearest_corner(tail_m));
    field = fields.to_corners[corner].get();
    goes_straight =
        (to_m - position_m).squaredNorm() < kSees_m * kSees_m && sees(queue, position_m, to_m);
  }
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  if (!goes_straight) direction = field->direction(position_m);
  if (direction.isZero() && to_m != position_m) direction = (to_m - position_m).normalized();
  journeys.guide(id, direction, corner);
}

Eigen::Vector2d Queues::keep_out(uint32_t id, const Eigen::Vector2d& from_m,
                                 const Eigen::Vector2d& to_m, const Journeys& journeys) const {
  const bool is_admitted = journeys.is_admitted(id);
  if (journeys.state(id) != JourneyState::kQueuing && !journeys.seeks_queue(id) && !is_admitted)
    return to_m;
  Eigen::Vector2d tail_m = to_m;
  const std::vector<Area>& areas = journeys.stop(id).goal.areas;
  for (uint32_t i = 0; i < areas.size(); ++i) {
    const Area& area = areas[i];
    if (is_admitted && journeys.area(id) == i) continue;
    if (!area.contains(tail_m) || area.contains(from_m)) continue;
    if (!area.is_rectangle()) {
      tail_m = area.nearest_edge_m(tail_m);
      continue;
    }
    // Along the side that the agent comes from.
    const Rectangle& bounds = area.bounds();
    for (int axis = 0; axis < 2; ++axis)
      if (from_m[axis] < bounds.min_m[axis] || from_m[axis] > bounds.max_m[axis])
        tail_m[axis] = from_m[axis];
  }
  return tail_m;
}

size_t Queues::free_places(uint32_t queue) const {
  const size_t capacity = map_.queues()[queue].plan.max_inside;
  size_t free = 0;
  for (const uint32_t count : queues_[queue].served_counts) free += capacity - count;
  return free;
}

uint32_t Queues::first_free_overflow(uint32_t queue) const {
  const std::vector<uint8_t>& taken = queues_[queue].is_taken;
  const auto free = std::find(taken.begin(), taken.end(), uint8_t{0});
  return free == taken.end() ? kNoOverflow : static_cast<uint32_t>(free - taken.begin());
}

Eigen::Vector2d Queues::tail_m(uint32_t queue) const {
  const QueuePlan& plan = map_.queues()[queue].plan;
  const size_t count = queues_[queue].waiting.size();
  if (count < plan.places) return plan.line.at(plan.along_m(count));
  const uint32_t overflow = first_free_overflow(queue);
  return overflow == kNoOverflow ? plan.line.corners_m().back()
                                 : plan.overflow_positions_m[overflow];
}

/// Returns whether no obstacle and no served agent is on the straight path.
bool Queues::sees(uint32_t queue, const Eigen::Vector2d& from_m,
                  const Eigen::Vector2d& to_m) const {
  const int pieces = static_cast<int>(std::ceil((to_m - from_m).norm() / kSample_m));
  if (!map_.walkable().is_clear_between(from_m, to_m, kPathClearance_m, pieces)) return false;
  for (const Area& area : map_.queues()[queue].plan.areas)
    for (int i = 1; i < pieces; ++i)
      if (area.contains(from_m + (i / double(pieces)) * (to_m - from_m))) return false;
  return true;
}

}  // namespace throng
