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
/// An agent that stays at a goal stops this close to its place.
constexpr double kStop_m = 0.25;
/// Distance of places to the rim: arriving implies having entered.
constexpr double kRim_m = 0.3;
/// Distance between the places of members of a social group.
constexpr double kPlacesApart_m = 0.7;
constexpr uint32_t kPlaceTries = 16;
/// Upper bound of coordinates in scene files.
constexpr double kMaxTarget_m = 1e6;
/// An obstacle this close to the end of a path is reported as its cause.
constexpr double kObstructing_m = 1;

}  // namespace

Journeys::Journeys(const NavigationMap& map, const Detours& detours,
                   std::span<const AgentSpec> people, uint64_t seed)
    : map_(map), detours_(detours), seed_(seed) {
  for (const AgentSpec& person : people) {
    journeys_.push_back({.route = person.group});
    if (person.entrance == AgentSpec::kSpare) journeys_.back().state = JourneyState::kGone;
    delays_s_.push_back(person.premovement_s);
    radii_m_.push_back(person.radius_m);
    const auto id = static_cast<uint32_t>(first_members_.size());
    const bool follows = id > 0 && person.social_group != AgentSpec::kAlone &&
                         people[id - 1].social_group == person.social_group;
    first_members_.push_back(follows ? first_members_.back() : id);
    targets_m_.push_back(person.position_m);
  }
  until_s_.assign(people.size(), kNever);
  visits_.assign(people.size(), 0);
  if (!map.queues().empty()) {
    areas_.assign(people.size(), kNoArea);
    guides_.resize(people.size());
  }
  for (size_t group = 0; group < map.groups(); ++group)
    departures_s_.push_back(map.after(group) ? kNever : 0);
  for (uint32_t id = 0; id < people.size(); ++id) {
    if (people[id].entrance != AgentSpec::kFromTheStart) continue;
    if (people[id].is_external)
      set_present(id, true);
    else
      enter(id, people[id].position_m, 0);
  }
}

void Journeys::archive(Archive& a) {
  std::vector<size_t> groups;
  for (const Journey& journey : journeys_) groups.push_back(map_.group_of(journey.route));
  a(journeys_, until_s_, visits_, targets_m_, areas_, guides_, departures_s_);
  if (!a.is_reading()) return;
  for (const double time_s : departures_s_)
    if (!(time_s >= 0)) a.reject("a time from the start on", "another value");
  for (uint32_t id = 0; id < journeys_.size(); ++id) {
    if (journeys_[id].state > JourneyState::kGone || journeys_[id].next > JourneyState::kGone)
      a.reject("a state of a journey", "another value");
    if (journeys_[id].route >= map_.routes() || map_.group_of(journeys_[id].route) != groups[id])
      a.reject("a route of the agent's group", "another route");
    // Recorded agents have no route.
    if (journeys_[id].stop >= std::max<size_t>(1, map_.route(journeys_[id].route).size()))
      a.reject("an index of a stop of the route", "another value");
    if (journeys_[id].exit != kNoExit &&
        (journeys_[id].state != JourneyState::kWalking || stop(id).exits == 0))
      a.reject("an exit only of agents that walk to one", "an exit of another agent");
    if (journeys_[id].exit < kOpen && journeys_[id].exit - stop(id).first_exit >= stop(id).exits)
      a.reject("an exit of the goal", "another exit");
    if (journeys_[id].state == JourneyState::kQueuing && (areas_.empty() || !stop(id).queue))
      a.reject("queuing agents only at goals with a queue", "one at another goal");
    if (is_admitted(id) && (journeys_[id].state != JourneyState::kWalking || !stop(id).queue ||
                            areas_[id] >= stop(id).goal.areas.size()))
      a.reject("an area of a goal with a queue", "another area");
    // Negated to reject NaN as well.
    if (!guides_.empty() && stop(id).queue &&
        (!(guides_[id].path_direction.norm() <= 1.001) ||
         (guides_[id].corner != kNoCorner &&
          guides_[id].corner >= map_.queues()[*stop(id).queue].to_corners.size())))
      a.reject("a direction to a queue of length up to 1", "another vector");
    if (!(targets_m_[id].cwiseAbs().maxCoeff() <= kMaxTarget_m))
      a.reject("a target in the scene", "one beyond the largest coordinate");
  }
}

void Journeys::leave(uint32_t id) {
  Journey& journey = journeys_[id];
  journey.state = JourneyState::kGone;
  journey.exit = kNoExit;
  if (map_.is_set_goal(journey.route)) {  // its route may be replaced
    journey.route = static_cast<uint32_t>(map_.group_of(journey.route));
    journey.stop = 0;
  }
  if (!areas_.empty()) areas_[id] = kNoArea;
}

std::vector<uint8_t> Journeys::routes_in_use() const {
  std::vector<uint8_t> is_used(map_.routes(), 0);
  for (const Journey& journey : journeys_)
    if (journey.state != JourneyState::kGone) is_used[journey.route] = 1;
  return is_used;
}

void Journeys::take_route(uint32_t id, size_t route, const Eigen::Vector2d& position_m) {
  journeys_[id].route = static_cast<uint32_t>(route);
  journeys_[id].stop = 0;
  if (!areas_.empty()) areas_[id] = kNoArea;
  set_out(id, position_m);
}

void Journeys::enter(uint32_t id, const Eigen::Vector2d& position_m, double now_s) {
  set_out(id, position_m);
  const double from_s = std::max(now_s, departure_s(id));
  if (journeys_[id].state != JourneyState::kWalking || (delays_s_[id] == 0 && from_s == now_s))
    return;
  journeys_[id].state = JourneyState::kWaiting;
  journeys_[id].exit = kNoExit;
  journeys_[id].next = JourneyState::kWalking;
  until_s_[id] = from_s + delays_s_[id];
}

void Journeys::set_out(uint32_t id, const Eigen::Vector2d& position_m) {
  until_s_[id] = kNever;
  journeys_[id].state =
      map_.leads(stop(id), position_m) ? JourneyState::kWalking : JourneyState::kStranded;
  journeys_[id].exit =
      journeys_[id].state == JourneyState::kWalking && stop(id).exits > 0 ? kOpen : kNoExit;
  choose_target(id, position_m);
}

void Journeys::admit(uint32_t id, uint32_t area, const Eigen::Vector2d& position_m) {
  journeys_[id].state = JourneyState::kWalking;
  areas_[id] = area;
  choose_target(id, position_m);
}

/// Areas that the agent may enter now.
std::span<const Area> Journeys::areas_of_goal(uint32_t id) const {
  const Stop& to = stop(id);
  const std::span<const Area> all(to.goal.areas);
  if (areas_.empty() || !to.queue) return all;
  return is_admitted(id) ? all.subspan(areas_[id], 1) : all.first(0);
}

bool Journeys::is_at_goal(uint32_t id, const Eigen::Vector2d& position_m) const {
  const std::span<const Area> areas = areas_of_goal(id);
  return std::any_of(areas.begin(), areas.end(), [&](const Area& area) {
    return has_reached(map_.walkable(), area, position_m, radii_m_[id]);
  });
}

bool Journeys::is_round_small_goal(uint32_t id, const Eigen::Vector2d& position_m) const {
  const std::span<const Area> areas = areas_of_goal(id);
  return std::any_of(areas.begin(), areas.end(), [&](const Area& area) {
    return area.size_m().maxCoeff() <= tuning::kSmallGoal_m &&
           is_beside(map_.walkable(), area, position_m, tuning::kAroundSmall_m);
  });
}

bool Journeys::is_beside_goal(uint32_t id, const Eigen::Vector2d& position_m) const {
  const std::span<const Area> areas = areas_of_goal(id);
  return std::any_of(areas.begin(), areas.end(), [&](const Area& area) {
    return is_beside(map_.walkable(), area, position_m, radii_m_[id] + kMaxWallOffset_m);
  });
}

bool Journeys::walks_to_stay(uint32_t id) const {
  return journeys_[id].state == JourneyState::kWalking && is_last_stop(id) && !stop(id).queue &&
         map_.on_arrival(journeys_[id].route) == OnArrival::kStay;
}

const FlowField& Journeys::queue_field(uint32_t id) const {
  const Stop& to = stop(id);
  if (is_admitted(id)) return *map_.queues()[*to.queue].to_areas[areas_[id]];
  const uint32_t corner = guides_[id].corner;
  return corner != kNoCorner ? *map_.queues()[*to.queue].to_corners[corner] : *to.field;
}

void Journeys::choose_target(uint32_t id, const Eigen::Vector2d& position_m) {
  const Stop& to = stop(id);
  const Area* area = is_admitted(id) ? &to.goal.areas[areas_[id]] : &to.nearest_area(position_m);
  const uint32_t first = first_members_[id];
  for (uint32_t attempt = 0; attempt < kPlaceTries; ++attempt) {
    const RandomKey key{seed_, first, visits_[id], Purpose::kGoal};
    targets_m_[id] =
        area->at({random_uniform(key, 2 * attempt), random_uniform(key, 2 * attempt + 1)}, kRim_m);
    if (to.field->reaches(targets_m_[id])) break;
  }
  if (id == first) return;
  // Members stand in a square, which lies within the area if that is large enough.
  const Eigen::Vector2d inwards = area->middle_m() - targets_m_[id];
  const Eigen::Vector2d step(std::copysign(kPlacesApart_m, inwards.x()),
                             std::copysign(kPlacesApart_m, inwards.y()));
  const uint32_t corner = id - first;
  const Eigen::Vector2d neighbour_place = area->nearest_inside_m(
      targets_m_[id] + Eigen::Vector2d(corner != 2 ? step.x() : 0, corner != 1 ? step.y() : 0),
      kRim_m);
  if (to.field->reaches(neighbour_place)) targets_m_[id] = neighbour_place;
}

void Journeys::follow(uint32_t id, const Eigen::Vector2d& position_m, double now_s,
                      StallCause stall_cause) {
  // Agents of a group that may not depart yet wait without an end time.
  if (journeys_[id].state == JourneyState::kWaiting && until_s_[id] == kNever)
    until_s_[id] = std::max(now_s, departure_s(id)) + delays_s_[id];
  if (journeys_[id].state == JourneyState::kWaiting && now_s >= until_s_[id]) {
    journeys_[id].state = journeys_[id].next;
    until_s_[id] = kNever;
    if (journeys_[id].state == JourneyState::kWalking) set_out(id, position_m);
  }
  if (journeys_[id].state != JourneyState::kWalking) return;
  const Stop& to = stop(id);
  // At a goal that no agent can enter, agents that stay in front of it stand for its rim.
  const bool is_at = is_at_goal(id, position_m) ||
                     (stall_cause == StallCause::kBehindStaying && walks_to_stay(id));
  const bool gets_no_nearer = stall_cause == StallCause::kStuck && is_beside_goal(id, position_m);
  if (!is_at && !gets_no_nearer && !is_round_small_goal(id, position_m)) return;
  const bool is_last = is_last_stop(id);
  const OnArrival after = map_.on_arrival(journeys_[id].route);
  const bool leaves = is_last && after == OnArrival::kLeave;
  if (until_s_[id] == kNever) {
    // First time inside: with several areas, the target lies in the one that was reached.
    until_s_[id] = now_s + tuning::kPatience_s;
    if (to.goal.areas.size() > 1) choose_target(id, position_m);
  }
  const bool stays = to.goal.wait_s.max > 0 || (is_last && after == OnArrival::kStay);
  const double arrival_m = stays ? kStop_m : tuning::kArrival_m;
  const bool is_there = (targets_m_[id] - position_m).norm() < arrival_m;
  const bool is_close_enough = is_there || to.goal.waypoint || (leaves && !stays);
  if ((is_at && is_close_enough) || gets_no_nearer || now_s >= until_s_[id])
    arrive(id, position_m, now_s);
}

void Journeys::arrive(uint32_t id, const Eigen::Vector2d& position_m, double now_s) {
  const size_t stops = map_.route(journeys_[id].route).size();
  const bool is_last = journeys_[id].stop + 1 == stops;
  const double wait_s = draw_wait_s(id);
  ++visits_[id];
  journeys_[id].exit = kNoExit;
  if (!areas_.empty()) areas_[id] = kNoArea;
  JourneyState next = JourneyState::kWalking;
  if (is_last && map_.on_arrival(journeys_[id].route) == OnArrival::kStay)
    next = JourneyState::kStaying;
  if (is_last && map_.on_arrival(journeys_[id].route) == OnArrival::kLeave)
    next = JourneyState::kLeaving;
  if (next == JourneyState::kWalking)
    journeys_[id].stop = static_cast<uint32_t>((journeys_[id].stop + 1) % stops);
  if (wait_s > 0) {
    journeys_[id].state = JourneyState::kWaiting;
    journeys_[id].next = next;
    until_s_[id] = now_s + wait_s;
  } else if (next == JourneyState::kWalking) {
    set_out(id, position_m);
  } else {
    journeys_[id].state = next;
  }
}

double Journeys::draw_wait_s(uint32_t id) const {
  return draw(stop(id).goal.wait_s, seed_, id, Purpose::kWaiting, visits_[id]);
}

namespace {

/// Direction at the agent's place, or at the offset place. Without a change of direction one
/// look-up suffices: at the place offset from the latest direction.
Eigen::Vector2d direction_along(const FlowField& field, const Eigen::Vector2d& position_m,
                                const LateralOffset& side) {
  constexpr double kSameDirection = 0.7;  // cosine
  if (side.offset_m == 0) return field.direction(position_m);
  if (!side.last_direction.isZero()) {
    const Eigen::Vector2d beside_m = side.beside_m(position_m, side.last_direction);
    Eigen::Vector2d own = field.direction(beside_m);
    if (own.dot(side.last_direction) > kSameDirection &&
        std::abs(side.offset_m) <= tuning::kLateralOffsetShare * field.distance_m(beside_m))
      return own;
  }
  const Eigen::Vector2d path_direction = field.direction(position_m);
  const double max_m = tuning::kLateralOffsetShare * field.distance_m(position_m);
  const LateralOffset nearer{std::clamp(side.offset_m, -max_m, max_m), path_direction};
  const Eigen::Vector2d own = field.direction(nearer.beside_m(position_m, path_direction));
  return own.dot(path_direction) > 0 ? own : path_direction;
}

}  // namespace

Eigen::Vector2d Journeys::direction(uint32_t id, const Eigen::Vector2d& position_m,
                                    const LateralOffset& side, double clearance_m) const {
  if (journeys_[id].state == JourneyState::kQueuing || seeks_queue(id))
    return guides_[id].path_direction;
  if (journeys_[id].state != JourneyState::kWalking) return Eigen::Vector2d::Zero();
  if (!is_at_goal(id, position_m)) {
    const Eigen::Vector2d path_direction = direction_along(field(id), position_m, side);
    if (path_direction.squaredNorm() > 0) {
      const double share =
          tuning::ramp(tuning::kDetourClearanceFrom_m, tuning::kDetourClearanceTo_m, clearance_m);
      if (share == 0) return path_direction;
      return (path_direction +
              share * (detoured_direction(id, position_m, path_direction) - path_direction))
          .normalized();
    }
  }
  const Eigen::Vector2d path_direction = targets_m_[id] - position_m;
  const double length_m = path_direction.norm();
  return length_m > 0 ? Eigen::Vector2d(path_direction / length_m) : Eigen::Vector2d::Zero();
}

/// Number of the field to the goal, or to the chosen exit, if crowds detour it.
std::optional<size_t> Journeys::detour_number(uint32_t id) const {
  const Stop& to = stop(id);
  if (to.queue) return std::nullopt;
  const uint32_t exit = journeys_[id].exit;
  const size_t number = exit < kOpen ? map_.exits()[exit].field_number : to.field_number;
  return number != Stop::kNoNumber && detours_.is_detoured(number) ? std::optional(number)
                                                                   : std::nullopt;
}

/// Direction around slow crowds, weighted by the agent's own delay weight.
Eigen::Vector2d Journeys::detoured_direction(uint32_t id, const Eigen::Vector2d& position_m,
                                             const Eigen::Vector2d& along) const {
  const std::optional<size_t> number = detour_number(id);
  if (!number) return along;
  const RandomKey key{seed_, id, 0, Purpose::kDetour};
  return detours_.detoured_direction(
      *number, position_m, along,
      random_uniform(key, tuning::kMinDelayWeight, tuning::kMaxDelayWeight));
}

void Journeys::prefetch(uint32_t id, const Eigen::Vector2d& position_m,
                        const LateralOffset& side) const {
  if (journeys_[id].state != JourneyState::kWalking) return;
  const FlowField& field = this->field(id);
  field.prefetch(side.beside_m(position_m, side.last_direction));
  const std::optional<size_t> number = detour_number(id);
  if (!number) return;
  detours_.prefetch(*number, position_m);
  // A detoured direction often differs from the field's: direction_along() then reads this cell.
  field.prefetch(position_m);
}

Eigen::Vector2d Journeys::facing(uint32_t id, const Eigen::Vector2d& position_m) const {
  if (journeys_[id].state != JourneyState::kWaiting || journeys_[id].next != JourneyState::kWalking)
    return Eigen::Vector2d::Zero();
  return stop(id).field->direction(position_m);
}

std::vector<Stranding> Journeys::strandings(std::span<const Eigen::Vector2d> positions_m) const {
  std::vector<Stranding> all;
  for (uint32_t id = 0; id < journeys_.size(); ++id) {
    if (journeys_[id].state != JourneyState::kStranded) continue;
    const size_t route = journeys_[id].route;
    const auto group = static_cast<uint32_t>(map_.group_of(route));
    const uint32_t goal = map_.is_set_goal(route) ? Stranding::kSetGoal : journeys_[id].stop;
    auto known = all.begin();
    while (known != all.end() && (known->group != group || known->stop != goal)) ++known;
    if (known == all.end()) {
      const Path path = map_.nav_mesh().path(positions_m[id], stop(id).goal.areas);
      const Eigen::Vector2d end = path.corners_m.empty() ? positions_m[id] : path.corners_m.back();
      known = all.insert(all.end(), {group, goal, 0, positions_m[id], end});
    }
    ++known->people;
  }
  return all;
}

std::string describe(const Stranding& stranding, const CrowdPlan& plan) {
  std::string obstacle;
  double nearest_m = kObstructing_m;
  for (const Footprint& each : footprints_of(plan)) {
    // Only the nearby ground: a scene may have thousands of obstacles.
    const Eigen::Vector2d near = Eigen::Vector2d::Constant(kObstructing_m);
    const Walkable alone({stranding.end_m - near, stranding.end_m + near}, {each.corners});
    const double away_m = alone.nearest(0, stranding.end_m).distance_m;
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    obstacle = fmt::format(" at '{}'", each.obstacle->name);
  }
  return fmt::format(
      "group '{}': {} cannot reach {} from ({:.1f}, {:.1f}) m; the path ends at ({:.1f}, "
      "{:.1f}) m{}",
      plan.groups[stranding.group].name,
      stranding.people == 1 ? "1 person" : fmt::format("{} people", stranding.people),
      stranding.stop == Stranding::kSetGoal ? "the goal that was set"
                                            : fmt::format("goal {}", stranding.stop + 1),
      stranding.place_m.x(), stranding.place_m.y(), stranding.end_m.x(), stranding.end_m.y(),
      obstacle);
}

}  // namespace throng
