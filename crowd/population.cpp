#include "crowd/population.h"

#include <algorithm>

#include "base/random.h"

namespace throng {
namespace {

/// Gap between an entering agent and all others: a hand's breadth.
constexpr double kEntryGap_m = 0.1;
/// Attempts per agent and decision; the next decision tries again.
constexpr uint32_t kEntryTries = 24;
/// Members of a social group enter within this distance of each other, if there is room.
constexpr double kJoin_m = 1;

/// Returns whether a path leads to the stop from some part of an area. Without one, agents enter
/// nevertheless and are reported as stranded.
bool has_path(const Stop& stop, const Area& area) {
  constexpr int kSamples = 24;
  for (int i = 0; i <= kSamples; ++i)
    for (int j = 0; j <= kSamples; ++j) {
      const Eigen::Vector2d share(i / double{kSamples}, j / double{kSamples});
      if (stop.field->reaches(area.at(share))) return true;
    }
  return false;
}

}  // namespace

Population::Population(const NavigationMap& map, std::span<const AgentSpec> people, uint64_t seed)
    : map_(map), seed_(seed) {
  for (const Area& area : map.entrances()) entrances_.push_back({area, false, 0, 0});
  spares_.assign(map.groups(), {UINT32_MAX, 0});
  uint64_t outside = 0, external = 0;
  for (uint32_t id = 0; id < people.size(); ++id) {
    const AgentSpec& person = people[id];
    groups_.push_back(person.group);
    follows_previous_.push_back(id > 0 && person.social_group != AgentSpec::kAlone &&
                                people[id - 1].social_group == person.social_group);
    radii_m_.push_back(person.radius_m);
    wall_gaps_m_.push_back(wall_gap_m(person.radius_m, person.height_m));
    max_radius_m_ = std::max(max_radius_m_, person.radius_m);
    enters_s_.push_back(person.enters_s);
    const bool is_in = person.entrance == AgentSpec::kFromTheStart;
    present_.push_back(is_in);
    is_open_ |= !is_in || person.is_external || map.on_arrival(person.group) == OnArrival::kLeave;
    if (person.is_external) ++external;
    if (is_in || person.is_external) continue;
    ++outside;
    if (person.entrance == AgentSpec::kSpare) {
      spares_[person.group].end = id + 1;
      spares_[person.group].next = std::min(spares_[person.group].next, id);
      continue;
    }
    Entrance& entrance = entrances_[person.entrance];
    if (entrance.end == 0) {
      entrance.next = id;
      entrance.has_path = has_path(map.route(person.group).front(), entrance.area);
    }
    entrance.end = id + 1;
  }
  for (Spares& spares : spares_)
    if (spares.end == 0) spares.next = 0;
  if (is_open_) open();
  entered_.reserve(outside);  // any step may admit all that are outside
  counters_.entered = counters_.present = people.size() - outside - external;
  count(0);
}

void Population::add_spares(size_t group, uint32_t count) {
  std::fill_n(present_.begin() + spares_[group].next, count, uint8_t{1});
  spares_[group].next += count;
  counters_.entered += count;
  counters_.present += count;
}

void Population::remove(uint32_t id) {
  present_[id] = 0;
  --counters_.present;
  ++counters_.left;
  open();
}

void Population::open() {
  is_open_ = true;
  nearby_.reserve(present_.size());  // any step may find all agents near an entrance
}

void Population::archive(Archive& a) {
  a(is_open_, present_, decisions_, counters_);
  if (a.is_reading() && is_open_) open();
  for (Spares& spares : spares_) {
    const uint32_t first = spares.next;  // set by the constructor when reading
    a(spares.next);
    if (spares.next < first || spares.next > spares.end)
      a.reject("a spare agent of the group", "another agent");
  }
  for (Entrance& entrance : entrances_) {
    const uint32_t first = entrance.next;  // set by the constructor when reading
    a(entrance.next);
    if (entrance.next < first || entrance.next > entrance.end)
      a.reject("an agent of the entrance", "another agent");
  }
}

void Population::release(Journeys& journeys) {
  for (uint32_t id = 0; id < present_.size(); ++id) {
    if (journeys.state(id) != JourneyState::kLeaving) continue;
    journeys.leave(id);
    present_[id] = 0;
    --counters_.present;
    ++counters_.left;
  }
}

bool Population::has_due(double now_s) const {
  return std::any_of(entrances_.begin(), entrances_.end(), [&](const Entrance& entrance) {
    return entrance.next < entrance.end && enters_s_[entrance.next] <= now_s;
  });
}

void Population::list_nearby(const Entrance& entrance,
                             std::span<const Eigen::Vector2d> positions_m) {
  const Rectangle around = entrance.area.bounds().grown(2 * max_radius_m_ + kEntryGap_m);
  nearby_.clear();
  for (uint32_t id = 0; id < present_.size(); ++id)
    if (present_[id] != 0 && around.contains(positions_m[id])) nearby_.push_back(id);
}

bool Population::find_place(const Entrance& entrance, std::span<Eigen::Vector2d> positions_m,
                            uint64_t decision) {
  const uint32_t id = entrance.next;
  const Stop& goal = map_.route(groups_[id]).front();
  for (uint32_t attempt = 0; attempt < kEntryTries; ++attempt) {
    const RandomKey key{seed_, id, decision, Purpose::kEmission};
    Rectangle where = entrance.area.bounds();
    // Two thirds of the attempts.
    const bool joins =
        follows_previous_[id] != 0 && present_[id - 1] != 0 && attempt < 2 * kEntryTries / 3;
    if (joins) {
      const Eigen::Vector2d near = entrance.area.nearest_m(positions_m[id - 1]);
      where.min_m = where.min_m.cwiseMax(near - Eigen::Vector2d::Constant(kJoin_m));
      where.max_m = where.max_m.cwiseMin(near + Eigen::Vector2d::Constant(kJoin_m));
    }
    const Eigen::Vector2d share(random_uniform(key, 2 * attempt + 1),
                                random_uniform(key, 2 * attempt + 2));
    const Eigen::Vector2d point =
        joins ? where.min_m + where.size_m().cwiseProduct(share) : entrance.area.at(share);
    if (joins && !entrance.area.contains(point)) continue;
    const bool is_taken = std::any_of(nearby_.begin(), nearby_.end(), [&](uint32_t other) {
      const double apart_m = radii_m_[id] + radii_m_[other] + kEntryGap_m;
      return (positions_m[other] - point).squaredNorm() < apart_m * apart_m;
    });
    if (is_taken || map_.walkable().clearance_m(point) < wall_gaps_m_[id]) continue;
    if (entrance.has_path && !goal.field->reaches(point)) continue;
    positions_m[id] = point;
    return true;
  }
  return false;
}

void Population::admit(double now_s, Journeys& journeys, std::span<Eigen::Vector2d> positions_m) {
  entered_.clear();
  const uint64_t decision = ++decisions_;
  if (has_due(now_s)) {
    for (Entrance& entrance : entrances_) {
      if (entrance.next == entrance.end || enters_s_[entrance.next] > now_s) continue;
      list_nearby(entrance, positions_m);
      while (entrance.next < entrance.end && enters_s_[entrance.next] <= now_s &&
             find_place(entrance, positions_m, decision)) {
        const uint32_t id = entrance.next++;
        journeys.enter(id, positions_m[id], now_s);
        present_[id] = 1;
        nearby_.push_back(id);
        entered_.push_back(id);
        ++counters_.entered;
        ++counters_.present;
      }
    }
  }
  count(now_s);
}

void Population::count(double now_s) {
  counters_.waiting_to_enter = counters_.scheduled = 0;
  for (const Entrance& entrance : entrances_) {
    const auto first = enters_s_.begin() + entrance.next;
    const auto end = enters_s_.begin() + entrance.end;
    const auto due = std::upper_bound(first, end, now_s);
    counters_.waiting_to_enter += static_cast<uint64_t>(due - first);
    counters_.scheduled += static_cast<uint64_t>(end - due);
  }
}

}  // namespace throng
