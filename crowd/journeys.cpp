#include "crowd/journeys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/random.h"
#include "crowd/crowd_tuning.h"
#include "crowd/navigation/arrival.h"
#include "crowd/navigation/footprints.h"

namespace throng {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// Whoever stays at a goal stops this near to the chosen place.
constexpr double kStop_m = 0.25;
/// Away from the rim, so that arriving means having entered; a narrow goal has only its middle.
constexpr double kRim_m = 0.3;
/// Companions take places so far from each other.
constexpr double kPlacesApart_m = 0.7;
constexpr uint32_t kPlaceTries = 16;
/// Beyond any coordinate of a scene file.
constexpr double kLargestCoordinate_m = 1e6;
/// What is this near to the end of a way is what ends it.
constexpr double kInTheWay_m = 1;

}  // namespace

Journeys::Journeys(const Ways& ways, const Detours& detours, std::span<const Person> people,
                   uint64_t seed)
    : ways_(ways), detours_(detours), seed_(seed) {
  for (const Person& person : people) {
    trips_.push_back({.group = static_cast<uint32_t>(person.group)});
    delays_s_.push_back(person.delay_s);
    radii_m_.push_back(person.radius_m);
    const auto id = static_cast<uint32_t>(firsts_.size());
    const bool follows =
        id > 0 && person.party != Person::kAlone && people[id - 1].party == person.party;
    firsts_.push_back(follows ? firsts_.back() : id);
    targets_m_.push_back(person.position_m);
  }
  until_s_.assign(people.size(), kNever);
  visits_.assign(people.size(), 0);
  if (!ways.queues().empty()) {
    areas_.assign(people.size(), kNoArea);
    guides_.resize(people.size());
  }
  for (size_t group = 0; group < ways.groups(); ++group)
    sets_out_s_.push_back(ways.after(group) ? kNever : 0);
  for (uint32_t id = 0; id < people.size(); ++id) {
    if (people[id].entrance != Person::kFromTheStart) continue;
    if (people[id].is_led)
      lead(id, true);
    else
      enter(id, people[id].position_m, 0);
  }
}

void Journeys::archive(Archive& a) {
  a(trips_, until_s_, visits_, targets_m_, areas_, guides_, sets_out_s_);
  if (!a.is_reading()) return;
  for (const double time_s : sets_out_s_)
    if (!(time_s >= 0)) a.refuse("a time from the start on", "another");
  for (uint32_t id = 0; id < trips_.size(); ++id) {
    if (trips_[id].doing > Doing::kGone || trips_[id].next > Doing::kGone)
      a.refuse("something that people do", "something else");
    // Those who are led have no route.
    if (trips_[id].stop >= std::max<size_t>(1, ways_.route(trips_[id].group).size()))
      a.refuse("a stop of the route", "another");
    if (trips_[id].exit != kNoExit && (trips_[id].doing != Doing::kWalking || stop(id).exits == 0))
      a.refuse("nobody with an exit who does not walk to one", "somebody");
    if (trips_[id].exit < kOpen && trips_[id].exit - stop(id).first_exit >= stop(id).exits)
      a.refuse("an exit of the goal", "another");
    if (trips_[id].doing == Doing::kQueuing && (areas_.empty() || !stop(id).queue))
      a.refuse("somebody in a queue where there is one", "somebody elsewhere");
    if (is_let_in(id) && (trips_[id].doing != Doing::kWalking || !stop(id).queue ||
                          areas_[id] >= stop(id).goal.areas.size()))
      a.refuse("an area of a goal with a queue", "another");
    // Written so that NaN is refused, too.
    if (!guides_.empty() && stop(id).queue &&
        (!(guides_[id].way.norm() <= 1.001) ||
         (guides_[id].corner != kNoCorner &&
          guides_[id].corner >= ways_.queues()[*stop(id).queue].to_corners.size())))
      a.refuse("the way to a queue", "another");
    if (!(targets_m_[id].cwiseAbs().maxCoeff() <= kLargestCoordinate_m))
      a.refuse("a place", "one out of the world");
  }
}

void Journeys::enter(uint32_t id, const Eigen::Vector2d& position_m, double now_s) {
  set_out(id, position_m);
  const double from_s = std::max(now_s, sets_out_s_[trips_[id].group]);
  if (trips_[id].doing != Doing::kWalking || (delays_s_[id] == 0 && from_s == now_s)) return;
  trips_[id].doing = Doing::kWaiting;
  trips_[id].exit = kNoExit;
  trips_[id].next = Doing::kWalking;
  until_s_[id] = from_s + delays_s_[id];
}

void Journeys::set_out(uint32_t id, const Eigen::Vector2d& position_m) {
  until_s_[id] = kNever;
  trips_[id].doing = ways_.leads(stop(id), position_m) ? Doing::kWalking : Doing::kStranded;
  trips_[id].exit = trips_[id].doing == Doing::kWalking && stop(id).exits > 0 ? kOpen : kNoExit;
  choose_target(id, position_m);
}

void Journeys::let_in(uint32_t id, uint32_t area, const Eigen::Vector2d& position_m) {
  trips_[id].doing = Doing::kWalking;
  areas_[id] = area;
  choose_target(id, position_m);
}

/// Those that an agent may go into now.
std::span<const Rectangle> Journeys::areas_of_goal(uint32_t id) const {
  const Stop& to = stop(id);
  const std::span<const Rectangle> all(to.goal.areas);
  if (areas_.empty() || !to.queue) return all;
  return is_let_in(id) ? all.subspan(areas_[id], 1) : all.first(0);
}

bool Journeys::is_at_goal(uint32_t id, const Eigen::Vector2d& position_m) const {
  const std::span<const Rectangle> areas = areas_of_goal(id);
  return std::any_of(areas.begin(), areas.end(), [&](const Rectangle& area) {
    return has_reached(ways_.walkable(), area, position_m, radii_m_[id]);
  });
}

bool Journeys::is_round_small_goal(uint32_t id, const Eigen::Vector2d& position_m) const {
  const std::span<const Rectangle> areas = areas_of_goal(id);
  return std::any_of(areas.begin(), areas.end(), [&](const Rectangle& area) {
    return area.size_m().maxCoeff() <= tuning::kSmallGoal_m &&
           is_beside(ways_.walkable(), area, position_m, tuning::kAroundSmall_m);
  });
}

bool Journeys::is_beside_goal(uint32_t id, const Eigen::Vector2d& position_m) const {
  const std::span<const Rectangle> areas = areas_of_goal(id);
  return std::any_of(areas.begin(), areas.end(), [&](const Rectangle& area) {
    return is_beside(ways_.walkable(), area, position_m, radii_m_[id] + kWallKeepsOff_m);
  });
}

bool Journeys::walks_to_stay(uint32_t id) const {
  return trips_[id].doing == Doing::kWalking && is_last_stop(id) && !stop(id).queue &&
         ways_.on_arrival(trips_[id].group) == OnArrival::kStay;
}

const FlowField& Journeys::queue_field(uint32_t id) const {
  const Stop& to = stop(id);
  if (is_let_in(id)) return *ways_.queues()[*to.queue].to_areas[areas_[id]];
  const uint32_t corner = guides_[id].corner;
  return corner != kNoCorner ? *ways_.queues()[*to.queue].to_corners[corner] : *to.field;
}

void Journeys::choose_target(uint32_t id, const Eigen::Vector2d& position_m) {
  const Stop& to = stop(id);
  const Rectangle* area = is_let_in(id) ? &to.goal.areas[areas_[id]] : &to.area_near(position_m);
  const Eigen::Vector2d rim = (0.25 * area->size_m()).cwiseMin(kRim_m);
  const uint32_t first = firsts_[id];
  for (uint32_t attempt = 0; attempt < kPlaceTries; ++attempt) {
    const RandomKey key{seed_, first, visits_[id], Purpose::kGoal};
    targets_m_[id] = {
        random_uniform(key, area->min_m.x() + rim.x(), area->max_m.x() - rim.x(), 2 * attempt),
        random_uniform(key, area->min_m.y() + rim.y(), area->max_m.y() - rim.y(), 2 * attempt + 1)};
    if (to.field->reaches(targets_m_[id])) break;
  }
  if (id == first) return;
  // Companions stand in a square, which lies within the area where that is large enough.
  const Eigen::Vector2d inwards = area->middle_m() - targets_m_[id];
  const Eigen::Vector2d step(std::copysign(kPlacesApart_m, inwards.x()),
                             std::copysign(kPlacesApart_m, inwards.y()));
  const uint32_t corner = id - first;
  const Eigen::Vector2d beside =
      (targets_m_[id] + Eigen::Vector2d(corner != 2 ? step.x() : 0, corner != 1 ? step.y() : 0))
          .cwiseMax(area->min_m + rim)
          .cwiseMin(area->max_m - rim);
  if (to.field->reaches(beside)) targets_m_[id] = beside;
}

void Journeys::follow(uint32_t id, const Eigen::Vector2d& position_m, double now_s,
                      HeldUp held_up) {
  // Of those who wait, only the ones whose group has not been let go do not know how long.
  if (trips_[id].doing == Doing::kWaiting && until_s_[id] == kNever)
    until_s_[id] = std::max(now_s, sets_out_s_[trips_[id].group]) + delays_s_[id];
  if (trips_[id].doing == Doing::kWaiting && now_s >= until_s_[id]) {
    trips_[id].doing = trips_[id].next;
    until_s_[id] = kNever;
    if (trips_[id].doing == Doing::kWalking) set_out(id, position_m);
  }
  if (trips_[id].doing != Doing::kWalking) return;
  const Stop& to = stop(id);
  // Agents that stay before a goal which nobody can enter are as good as its rim.
  const bool is_at =
      is_at_goal(id, position_m) || (held_up == HeldUp::kBehindStaying && walks_to_stay(id));
  const bool gets_no_nearer = held_up == HeldUp::kStuck && is_beside_goal(id, position_m);
  if (!is_at && !gets_no_nearer && !is_round_small_goal(id, position_m)) return;
  const bool is_last = is_last_stop(id);
  const OnArrival after = ways_.on_arrival(trips_[id].group);
  const bool leaves = is_last && after == OnArrival::kLeave;
  if (until_s_[id] == kNever) {
    // Inside for the first time: with several areas, the place lies in the one that was reached.
    until_s_[id] = now_s + tuning::kPatience_s;
    if (to.goal.areas.size() > 1) choose_target(id, position_m);
  }
  const bool stays = to.goal.wait_s.max > 0 || (is_last && after == OnArrival::kStay);
  const double near_m = stays ? kStop_m : tuning::kArrival_m;
  const bool is_there = (targets_m_[id] - position_m).norm() < near_m;
  const bool is_enough = is_there || to.goal.pass || (leaves && !stays);
  if ((is_at && is_enough) || gets_no_nearer || now_s >= until_s_[id])
    arrive(id, position_m, now_s);
}

void Journeys::arrive(uint32_t id, const Eigen::Vector2d& position_m, double now_s) {
  const size_t stops = ways_.route(trips_[id].group).size();
  const bool is_last = trips_[id].stop + 1 == stops;
  const double wait_s = draw_wait_s(id);
  ++visits_[id];
  trips_[id].exit = kNoExit;
  if (!areas_.empty()) areas_[id] = kNoArea;
  Doing next = Doing::kWalking;
  if (is_last && ways_.on_arrival(trips_[id].group) == OnArrival::kStay) next = Doing::kStaying;
  if (is_last && ways_.on_arrival(trips_[id].group) == OnArrival::kLeave) next = Doing::kLeaving;
  if (next == Doing::kWalking)
    trips_[id].stop = static_cast<uint32_t>((trips_[id].stop + 1) % stops);
  if (wait_s > 0) {
    trips_[id].doing = Doing::kWaiting;
    trips_[id].next = next;
    until_s_[id] = now_s + wait_s;
  } else if (next == Doing::kWalking) {
    set_out(id, position_m);
  } else {
    trips_[id].doing = next;
  }
}

double Journeys::draw_wait_s(uint32_t id) const {
  return draw(stop(id).goal.wait_s, seed_, id, Purpose::kWaiting, visits_[id]);
}

namespace {

/// The way from here, or from beside here. As long as it goes on as it went, one look-up will do:
/// beside the latest way.
Eigen::Vector2d way_along(const FlowField& field, const Eigen::Vector2d& position_m,
                          const OwnSide& side) {
  constexpr double kGoesOn = 0.7;  // cosine
  if (side.to_left_m == 0) return field.direction(position_m);
  if (!side.lately.isZero()) {
    const Eigen::Vector2d beside_m = side.beside_m(position_m, side.lately);
    Eigen::Vector2d own = field.direction(beside_m);
    if (own.dot(side.lately) > kGoesOn &&
        std::abs(side.to_left_m) <= tuning::kOwnSideShare * field.distance_m(beside_m))
      return own;
  }
  const Eigen::Vector2d way = field.direction(position_m);
  const double most_m = tuning::kOwnSideShare * field.distance_m(position_m);
  const OwnSide nearer{std::clamp(side.to_left_m, -most_m, most_m), way};
  const Eigen::Vector2d own = field.direction(nearer.beside_m(position_m, way));
  return own.dot(way) > 0 ? own : way;
}

}  // namespace

Eigen::Vector2d Journeys::direction(uint32_t id, const Eigen::Vector2d& position_m,
                                    const OwnSide& side, double clearance_m) const {
  if (trips_[id].doing == Doing::kQueuing || seeks_queue(id)) return guides_[id].way;
  if (trips_[id].doing != Doing::kWalking) return Eigen::Vector2d::Zero();
  if (!is_at_goal(id, position_m)) {
    const Eigen::Vector2d way = way_along(field(id), position_m, side);
    if (way.squaredNorm() > 0) {
      const double share =
          tuning::share_between(tuning::kBendsFrom_m, tuning::kBendsWholly_m, clearance_m);
      if (share == 0) return way;
      return (way + share * (bend(id, position_m, way) - way)).normalized();
    }
  }
  const Eigen::Vector2d way = targets_m_[id] - position_m;
  const double length_m = way.norm();
  return length_m > 0 ? Eigen::Vector2d(way / length_m) : Eigen::Vector2d::Zero();
}

/// The way to the goal, or to the exit that was chosen, if crowds bend it.
std::optional<size_t> Journeys::bent_way(uint32_t id) const {
  const Stop& to = stop(id);
  if (to.queue) return std::nullopt;
  const uint32_t exit = trips_[id].exit;
  const size_t way = exit < kOpen ? ways_.exits()[exit].way : to.way;
  return detours_.is_bent(way) ? std::optional(way) : std::nullopt;
}

/// Round where a crowd is slow, each as much as they mind.
Eigen::Vector2d Journeys::bend(uint32_t id, const Eigen::Vector2d& position_m,
                               const Eigen::Vector2d& along) const {
  const std::optional<size_t> way = bent_way(id);
  if (!way) return along;
  const RandomKey key{seed_, id, 0, Purpose::kDetour};
  return detours_.bend(*way, position_m, along,
                       random_uniform(key, tuning::kLeastMinded, tuning::kMostMinded));
}

void Journeys::prefetch(uint32_t id, const Eigen::Vector2d& position_m, const OwnSide& side) const {
  if (trips_[id].doing != Doing::kWalking) return;
  const FlowField& field = this->field(id);
  field.prefetch(side.beside_m(position_m, side.lately));
  const std::optional<size_t> way = bent_way(id);
  if (!way) return;
  detours_.prefetch(*way, position_m);
  // A bent way often does not go on as the field here does: then way_along() asks for that, too.
  field.prefetch(position_m);
}

Eigen::Vector2d Journeys::facing(uint32_t id, const Eigen::Vector2d& position_m) const {
  if (trips_[id].doing != Doing::kWaiting || trips_[id].next != Doing::kWalking)
    return Eigen::Vector2d::Zero();
  return stop(id).field->direction(position_m);
}

std::vector<Stranding> Journeys::strandings(std::span<const Eigen::Vector2d> positions_m) const {
  std::vector<Stranding> all;
  for (uint32_t id = 0; id < trips_.size(); ++id) {
    if (trips_[id].doing != Doing::kStranded) continue;
    auto known = all.begin();
    while (known != all.end() &&
           (known->group != trips_[id].group || known->stop != trips_[id].stop))
      ++known;
    if (known == all.end()) {
      const Path path = ways_.nav_mesh().path(positions_m[id], stop(id).goal.areas);
      const Eigen::Vector2d end = path.corners_m.empty() ? positions_m[id] : path.corners_m.back();
      known = all.insert(all.end(), {trips_[id].group, trips_[id].stop, 0, positions_m[id], end});
    }
    ++known->people;
  }
  return all;
}

std::string describe(const Stranding& stranding, const CrowdPlan& plan) {
  std::string obstacle;
  double nearest_m = kInTheWay_m;
  for (const Footprint& each : footprints_of(plan)) {
    // Of the ground only what is near: there may be thousands of obstacles.
    const Eigen::Vector2d near = Eigen::Vector2d::Constant(kInTheWay_m);
    const Walkable alone({stranding.end_m - near, stranding.end_m + near}, {each.corners});
    const double away_m = alone.nearest(0, stranding.end_m).distance_m;
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    obstacle = fmt::format(" at '{}'", each.obstacle->name);
  }
  return fmt::format(
      "group '{}': {} cannot reach goal {} from ({:.1f}, {:.1f}) m; the way ends at ({:.1f}, "
      "{:.1f}) m{}",
      plan.groups[stranding.group].name,
      stranding.people == 1 ? "1 person" : fmt::format("{} people", stranding.people),
      stranding.stop + 1, stranding.place_m.x(), stranding.place_m.y(), stranding.end_m.x(),
      stranding.end_m.y(), obstacle);
}

}  // namespace throng
