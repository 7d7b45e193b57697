#include "crowd/queues.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

/// Whoever is so near to the end of a queue, and sees it, joins it.
constexpr double kJoins_m = 1.5;
/// Whoever walks is out of an area so far from it: no step back leads into it again.
constexpr double kOut_m = 0.3;
/// People make for the end of a queue from so far, if they see it; others follow a field.
constexpr double kSees_m = 12;
constexpr double kSample_m = 0.4;
/// Nothing that stops people is nearer to the way.
constexpr double kClearWay_m = 0.2;
/// In a queue people look so far along the line, round its corners.
constexpr double kAhead_m = 0.5;
/// Of the spacing: whoever is farther back than this from where to stand steps forward, and up to
/// so near to the one before, who may not stand in place.
constexpr double kStepFrom = 0.4, kNearest = 0.75;

}  // namespace

Queues::Queues(const Ways& ways, std::span<const Person> people) : ways_(ways) {
  if (ways.queues().empty()) return;
  for (uint32_t id = 0; id < people.size(); ++id) {
    if (people[id].is_led) continue;  // without a route
    const std::vector<Stop>& route = ways.route(people[id].group);
    if (std::any_of(route.begin(), route.end(), [](const Stop& stop) { return stop.queue; }))
      queuers_.push_back(id);
  }
  for (const QueueWays& each : ways.queues()) {
    Queue& queue = queues_.emplace_back();
    queue.most = queuers_.size();
    queue.waiting.reserve(queue.most);
    queue.guests.reserve(queue.most);
    queue.guest_counts.assign(each.plan.areas.size(), 0);
    queue.is_taken.assign(each.plan.spots_m.size(), 0);
  }
  comers_.reserve(queuers_.size());
  along_m_.assign(people.size(), 0);
  steps_.assign(people.size(), 0);
  spots_.assign(people.size(), kNoSpot);
  facings_.assign(people.size(), Eigen::Vector2d::Zero());
}

void Queues::archive(Archive& a, const Journeys& journeys) {
  if (!any()) return;
  for (Queue& queue : queues_) {
    a.resized(queue.waiting, queue.most);
    a.resized(queue.guests, queue.most);
  }
  a(along_m_, steps_, spots_, facings_);
  if (!a.is_reading()) return;
  check_read(a, journeys);
  for (Queue& queue : queues_) {
    std::fill(queue.guest_counts.begin(), queue.guest_counts.end(), 0);
    for (const Guest& guest : queue.guests) ++queue.guest_counts[guest.area];
  }
  take_spots();
}

/// Comparisons are written so that NaN is refused, too.
void Queues::check_read(Archive& a, const Journeys& journeys) const {
  std::vector<uint8_t> is_known(along_m_.size(), 0);
  const auto take = [&](uint32_t id) {
    if (id >= is_known.size() || is_known[id] != 0 ||
        !std::binary_search(queuers_.begin(), queuers_.end(), id))
      a.refuse("people who queue, each in one place", "another");
    is_known[id] = 1;
  };
  for (uint32_t q = 0; q < queues_.size(); ++q)
    for (const uint32_t id : queues_[q].waiting) {
      take(id);
      if (journeys.doing(id) != Doing::kQueuing || journeys.stop(id).queue != q)
        a.refuse("somebody in a queue who queues", "somebody who does not");
      const size_t spots = queues_[q].is_taken.size();
      if (!(along_m_[id] >= 0) || !(along_m_[id] <= ways_.queues()[q].plan.line.length_m()) ||
          (spots_[id] != kNoSpot && spots_[id] >= spots))
        a.refuse("a place in the queue", "another");
    }
  for (const uint32_t id : queuers_)
    if (journeys.doing(id) == Doing::kQueuing && is_known[id] == 0)
      a.refuse("somebody who queues in a queue", "somebody in none");
  for (const Eigen::Vector2d& facing : facings_)
    if (!(facing.norm() <= 1.001)) a.refuse("a direction", "another");
  // Whoever waits again may still be on the way out.
  for (uint32_t q = 0; q < queues_.size(); ++q) {
    std::fill(is_known.begin(), is_known.end(), uint8_t{0});
    for (const Guest& guest : queues_[q].guests) {
      take(guest.id);
      if (guest.area >= queues_[q].guest_counts.size()) a.refuse("an area of the goal", "another");
    }
  }
}

void Queues::take_spots() {
  for (Queue& queue : queues_) {
    std::fill(queue.is_taken.begin(), queue.is_taken.end(), uint8_t{0});
    for (const uint32_t id : queue.waiting)
      if (spots_[id] != kNoSpot) queue.is_taken[spots_[id]] = 1;
  }
}

void Queues::follow(std::span<const uint8_t> present, std::span<const Eigen::Vector2d> positions_m,
                    Journeys& journeys, Workers& workers) {
  for (uint32_t queue = 0; queue < queues_.size(); ++queue)
    see_out(queue, present, positions_m, journeys);
  find_comers(positions_m, journeys);
  for (const Comer& comer : comers_) add(comer, positions_m[comer.id], journeys);
  for (uint32_t queue = 0; queue < queues_.size(); ++queue) {
    let_in(queue, positions_m, journeys);
    line_up(queue, positions_m, journeys);
  }
  constexpr size_t kAtOnce = 64;
  workers.for_blocks(static_cast<int>((queuers_.size() + kAtOnce - 1) / kAtOnce),
                     [&](int block, int) {
                       const size_t begin = static_cast<size_t>(block) * kAtOnce;
                       const size_t end = std::min(begin + kAtOnce, queuers_.size());
                       for (size_t i = begin; i < end; ++i)
                         if (journeys.seeks_queue(queuers_[i]))
                           lead_to_end(queuers_[i], positions_m[queuers_[i]], journeys);
                     });
}

/// Those who have been served, and are out of the way of the next.
void Queues::see_out(uint32_t queue, std::span<const uint8_t> present,
                     std::span<const Eigen::Vector2d> positions_m, const Journeys& journeys) {
  const std::vector<Rectangle>& areas = ways_.queues()[queue].plan.areas;
  Queue& q = queues_[queue];
  std::erase_if(q.guests, [&](const Guest& guest) {
    const uint32_t id = guest.id;
    const Doing doing = journeys.doing(id);
    const bool stands = doing == Doing::kWaiting || doing == Doing::kStaying;
    const bool is_served = stands && journeys.visits(id) == guest.visits + 1;
    const bool goes_in = journeys.is_let_in(id) && journeys.stop(id).queue == queue;
    if (is_served) facings_[id] = ways_.queues()[queue].plan.fronts[guest.area];
    const Rectangle around = areas[guest.area].grown(stands ? 0 : kOut_m);
    if (present[id] != 0 && (goes_in || is_served || around.contains(positions_m[id])))
      return false;
    --q.guest_counts[guest.area];
    facings_[id].setZero();
    return true;
  });
}

/// The nearest first.
void Queues::find_comers(std::span<const Eigen::Vector2d> positions_m, const Journeys& journeys) {
  comers_.clear();
  for (const uint32_t id : queuers_) {
    if (!journeys.seeks_queue(id)) continue;
    const uint32_t queue = *journeys.stop(id).queue;
    const Eigen::Vector2d& at_m = positions_m[id];
    const Eigen::Vector2d end = end_m(queue);
    double away_m = (end - at_m).norm();
    bool joins = away_m < kJoins_m && sees(queue, at_m, end), goes_in = false;
    if (!joins && queues_[queue].waiting.empty() && has_free_area(queue)) {
      const Rectangle& area = journeys.stop(id).area_near(at_m);
      const Eigen::Vector2d rim = area.nearest_m(at_m);
      away_m = (rim - at_m).norm();
      joins = goes_in = away_m < kJoins_m && sees(queue, at_m, rim);
    }
    if (joins) comers_.push_back({queue, away_m, id, goes_in});
  }
  std::sort(comers_.begin(), comers_.end(), [](const Comer& a, const Comer& b) {
    return std::tie(a.queue, a.away_m, a.id) < std::tie(b.queue, b.away_m, b.id);
  });
}

void Queues::add(const Comer& comer, const Eigen::Vector2d& position_m, Journeys& journeys) {
  Queue& q = queues_[comer.queue];
  const QueuePlan& plan = ways_.queues()[comer.queue].plan;
  const uint32_t id = comer.id;
  if (comer.goes_in && q.waiting.size() >= free_places(comer.queue)) return;
  journeys.join_queue(id);
  const double place_m = plan.along_m(q.waiting.size());
  spots_[id] = q.waiting.size() < plan.places ? kNoSpot : first_spot(comer.queue);
  if (spots_[id] != kNoSpot) q.is_taken[spots_[id]] = 1;
  along_m_[id] =
      plan.line.nearest_m(position_m, place_m - 0.5 * plan.spacing_m, place_m + kJoins_m);
  steps_[id] = kSteps;
  q.waiting.push_back(id);
}

void Queues::let_in(uint32_t queue, std::span<const Eigen::Vector2d> positions_m,
                    Journeys& journeys) {
  const QueuePlan& plan = ways_.queues()[queue].plan;
  Queue& q = queues_[queue];
  size_t let = 0;
  for (; let < q.waiting.size() && has_free_area(queue); ++let) {
    const uint32_t id = q.waiting[let];
    const auto away_m2 = [&](size_t area) {
      return (plan.areas[area].middle_m() - positions_m[id]).squaredNorm();
    };
    size_t nearest = plan.areas.size();
    for (size_t area = 0; area < plan.areas.size(); ++area)
      if (q.guest_counts[area] < plan.most_inside &&
          (nearest == plan.areas.size() || away_m2(area) < away_m2(nearest)))
        nearest = area;
    const auto area = static_cast<uint32_t>(nearest);
    journeys.let_in(id, area, positions_m[id]);
    facings_[id].setZero();
    steps_[id] = kStands;
    if (spots_[id] != kNoSpot) q.is_taken[spots_[id]] = 0;
    spots_[id] = kNoSpot;
    ++q.guest_counts[area];
    // Somebody who comes again before being out is still the same guest.
    std::erase_if(q.guests, [&](const Guest& guest) {
      if (guest.id != id) return false;
      --q.guest_counts[guest.area];
      return true;
    });
    q.guests.push_back({id, area, journeys.visits(id)});
  }
  q.waiting.erase(q.waiting.begin(), q.waiting.begin() + static_cast<ptrdiff_t>(let));
}

/// From the first to the last, as nobody goes where the one before still is.
void Queues::line_up(uint32_t queue, std::span<const Eigen::Vector2d> positions_m,
                     Journeys& journeys) {
  const QueueWays& ways = ways_.queues()[queue];
  Queue& q = queues_[queue];
  for (size_t place = 0; place < q.waiting.size(); ++place) {
    const uint32_t id = q.waiting[place];
    const Eigen::Vector2d& at_m = positions_m[id];
    if (place < ways.plan.places && spots_[id] != kNoSpot) {
      q.is_taken[spots_[id]] = 0;
      spots_[id] = kNoSpot;
      along_m_[id] = ways.plan.line.length_m();
    }
    const Errand to = errand(queue, place, at_m);
    // Where the way is not straight, others have pushed them round a corner.
    const size_t corner = ways.plan.line.corner_near(to.along_m);
    const double pace = std::min(1.0, to.left_m / tuning::kBrakes_m);
    Eigen::Vector2d way = Eigen::Vector2d::Zero();
    if (pace > tuning::kCreeps)
      way = sees(queue, at_m, to.to_m) ? Eigen::Vector2d((to.to_m - at_m).normalized())
                                       : ways.to_corners[corner]->direction(at_m);
    journeys.guide(id, pace * way, static_cast<uint32_t>(corner));
    face(queue, place, positions_m);
  }
}

Queues::Errand Queues::errand(uint32_t queue, size_t place, const Eigen::Vector2d& position_m) {
  const QueuePlan& plan = ways_.queues()[queue].plan;
  const uint32_t id = queues_[queue].waiting[place];
  const double step_m = kStepFrom * plan.spacing_m;
  Errand errand;
  errand.along_m = plan.line.length_m();
  if (place >= plan.places) {
    const bool has_spot = spots_[id] != kNoSpot;
    errand.to_m = has_spot ? plan.spots_m[spots_[id]] : plan.line.corners_m().back();
    errand.left_m = (errand.to_m - position_m).norm();
    // Whoever finds no room at all stands wherever others let them.
    if (!has_spot && errand.left_m < 3 * plan.spacing_m) errand.left_m = 0;
  } else {
    double& along_m = along_m_[id];
    along_m = plan.line.nearest_m(position_m, along_m - kJoins_m, along_m + kJoins_m);
    const double own_m = plan.along_m(place);
    double to_m = own_m;
    if (place > 0)
      to_m =
          std::max(to_m, along_m_[queues_[queue].waiting[place - 1]] + kNearest * plan.spacing_m);
    // The one before has to move on first.
    if (to_m > along_m && along_m >= own_m) to_m = along_m;
    errand.along_m = std::max(to_m, along_m - kAhead_m);
    errand.to_m = plan.line.at(errand.along_m);
    errand.left_m = std::max(along_m - to_m, (errand.to_m - position_m).norm());
  }
  // Nobody moves for a few centimetres.
  uint8_t& steps = steps_[id];
  if (errand.left_m < tuning::kCreeps * tuning::kBrakes_m) steps = kStands;
  if (steps != kStands || errand.left_m > step_m) steps = kSteps;
  if (steps == kStands) errand.left_m = 0;
  if (place < plan.places && errand.left_m > plan.spacing_m) steps = kAwaited;
  return errand;
}

/// To the goal, or to the one before; those off the line to its end.
void Queues::face(uint32_t queue, size_t place, std::span<const Eigen::Vector2d> positions_m) {
  const QueuePlan& plan = ways_.queues()[queue].plan;
  const std::vector<uint32_t>& waiting = queues_[queue].waiting;
  const uint32_t id = waiting[place];
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
  if (spots_[id] != kNoSpot) {
    to_m = plan.line.corners_m().back();
  } else if (place > 0) {
    to_m = positions_m[waiting[place - 1]];
  } else {
    for (const Rectangle& area : plan.areas)
      to_m += area.middle_m() / static_cast<double>(plan.areas.size());
  }
  const Eigen::Vector2d way = to_m - positions_m[id];
  if (!way.isZero()) facings_[id] = way.normalized();
}

void Queues::lead_to_end(uint32_t id, const Eigen::Vector2d& position_m, Journeys& journeys) {
  const uint32_t queue = *journeys.stop(id).queue;
  const QueueWays& ways = ways_.queues()[queue];
  const FlowField* field = journeys.stop(id).field;
  uint32_t corner = Journeys::kNoCorner;
  Eigen::Vector2d to_m = journeys.stop(id).area_near(position_m).middle_m();
  bool goes_straight = false;
  if (!queues_[queue].waiting.empty() || !has_free_area(queue)) {
    to_m = end_m(queue);
    const double end_m =
        std::min(ways.plan.along_m(queues_[queue].waiting.size()), ways.plan.line.length_m());
    corner = static_cast<uint32_t>(ways.plan.line.corner_near(end_m));
    field = ways.to_corners[corner].get();
    goes_straight =
        (to_m - position_m).squaredNorm() < kSees_m * kSees_m && sees(queue, position_m, to_m);
  }
  Eigen::Vector2d way = Eigen::Vector2d::Zero();
  if (!goes_straight) way = field->direction(position_m);
  if (way.isZero() && to_m != position_m) way = (to_m - position_m).normalized();
  journeys.guide(id, way, corner);
}

Eigen::Vector2d Queues::keep_out(uint32_t id, const Eigen::Vector2d& from_m,
                                 const Eigen::Vector2d& to_m, const Journeys& journeys) const {
  const bool is_let_in = journeys.is_let_in(id);
  if (journeys.doing(id) != Doing::kQueuing && !journeys.seeks_queue(id) && !is_let_in) return to_m;
  Eigen::Vector2d end_m = to_m;
  const std::vector<Rectangle>& areas = journeys.stop(id).goal.areas;
  for (uint32_t i = 0; i < areas.size(); ++i) {
    const Rectangle& area = areas[i];
    if (is_let_in && journeys.area(id) == i) continue;
    if (!area.contains(end_m) || area.contains(from_m)) continue;
    // Along the sides that they come from.
    for (int axis = 0; axis < 2; ++axis)
      if (from_m[axis] < area.min_m[axis] || from_m[axis] > area.max_m[axis])
        end_m[axis] = from_m[axis];
  }
  return end_m;
}

size_t Queues::free_places(uint32_t queue) const {
  const size_t most = ways_.queues()[queue].plan.most_inside;
  size_t free = 0;
  for (const uint32_t count : queues_[queue].guest_counts) free += most - count;
  return free;
}

uint32_t Queues::first_spot(uint32_t queue) const {
  const std::vector<uint8_t>& taken = queues_[queue].is_taken;
  const auto free = std::find(taken.begin(), taken.end(), uint8_t{0});
  return free == taken.end() ? kNoSpot : static_cast<uint32_t>(free - taken.begin());
}

/// Where the next one will stand.
Eigen::Vector2d Queues::end_m(uint32_t queue) const {
  const QueuePlan& plan = ways_.queues()[queue].plan;
  const size_t count = queues_[queue].waiting.size();
  if (count < plan.places) return plan.line.at(plan.along_m(count));
  const uint32_t spot = first_spot(queue);
  return spot == kNoSpot ? plan.line.corners_m().back() : plan.spots_m[spot];
}

/// True if nothing that stops people is on the straight way, nor anybody who is served.
bool Queues::sees(uint32_t queue, const Eigen::Vector2d& from_m,
                  const Eigen::Vector2d& to_m) const {
  const int pieces = static_cast<int>(std::ceil((to_m - from_m).norm() / kSample_m));
  if (!ways_.walkable().is_clear_between(from_m, to_m, kClearWay_m, pieces)) return false;
  for (const Rectangle& area : ways_.queues()[queue].plan.areas)
    for (int i = 1; i < pieces; ++i)
      if (area.contains(from_m + (i / double(pieces)) * (to_m - from_m))) return false;
  return true;
}

}  // namespace throng
