#include "crowd/spawn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/errors.h"
#include "base/portable_math.h"
#include "base/random.h"
#include "crowd/crowd_plan.h"
#include "crowd/dense_placement.h"

namespace throng {
namespace {

/// Gaps between discs, from comfortable to touching; each is tried kDarts times.
constexpr double kGaps_m[] = {0.30, 0.12, 0.02};
constexpr uint32_t kDarts = 60;
constexpr double kReferenceHeight_m = 1.70;
constexpr double kReferenceRadius_m = 0.22;
constexpr uint32_t kNone = UINT32_MAX;
/// Distance between members at the start: first exactly abreast, then anywhere in this range.
constexpr double kMemberSpacing_m = 0.75;
constexpr double kMinMemberDistance_m = 0.55, kMaxMemberDistance_m = 1.3;
constexpr uint32_t kMemberDarts = 80;

/// Placed agents in lists by cell.
class PlacedDiscs {
 public:
  /// `max_radius_m` is the largest radius of all.
  PlacedDiscs(const Rectangle& ground, double max_radius_m) : origin_m_(ground.min_m) {
    // A cell is as wide as two discs with their gap: the nine cells around contain all conflicts.
    cell_m_ =
        std::max({1.0, 2 * max_radius_m + kGaps_m[0], std::sqrt(ground.area_m2() / (1 << 22))});
    columns_ = static_cast<int>(ground.size_m().x() / cell_m_) + 1;
    rows_ = static_cast<int>(ground.size_m().y() / cell_m_) + 1;
    first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), kNone);
  }

  bool is_free(const Eigen::Vector2d& point, double radius_m, double gap_m,
               const std::vector<AgentSpec>& people) const {
    const auto [column, row] = cell_of(point);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
      for (int rule = std::max(0, column - 1); rule <= std::min(columns_ - 1, column + 1); ++rule)
        for (uint32_t id = first_[index(rule, r)]; id != kNone; id = next_[id]) {
          const double apart = radius_m + people[id].radius_m + gap_m;
          if ((people[id].position_m - point).squaredNorm() < apart * apart) return false;
        }
    return true;
  }

  /// Index of an agent nearer than min_apart_m(), if there is one.
  std::optional<size_t> find_overlapping(const AgentSpec& person,
                                         const std::vector<AgentSpec>& people) const {
    const auto [column, row] = cell_of(person.position_m);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
        for (uint32_t id = first_[index(c, r)]; id != kNone; id = next_[id]) {
          const double apart_m = min_apart_m(person.radius_m, people[id].radius_m);
          if ((people[id].position_m - person.position_m).norm() < apart_m) return id;
        }
    return {};
  }

  void add(const Eigen::Vector2d& point, size_t id) {
    const auto [column, row] = cell_of(point);
    uint32_t& first = first_[index(column, row)];
    next_.resize(id + 1, kNone);
    next_[id] = first;
    first = static_cast<uint32_t>(id);
  }

 private:
  std::pair<int, int> cell_of(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d offset = (point - origin_m_) / cell_m_;
    return {std::clamp(static_cast<int>(offset.x()), 0, columns_ - 1),
            std::clamp(static_cast<int>(offset.y()), 0, rows_ - 1)};
  }
  size_t index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
  }

  Eigen::Vector2d origin_m_;
  double cell_m_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<uint32_t> first_;  ///< per cell
  std::vector<uint32_t> next_;   ///< per id
};

void place_at(const Eigen::Vector2d& point, const Stop& goal, AgentSpec& person) {
  person.position_m = point;
  Eigen::Vector2d heading = goal.field->direction(point);
  if (heading.squaredNorm() == 0) heading = goal.nearest_area(point).middle_m() - point;
  if (heading.squaredNorm() > 0) person.heading = heading.normalized();
}

/// Agents that stand at first face their look-at point.
void look_at_target(uint64_t seed, uint64_t id, const Group& group, AgentSpec& person) {
  if (!person.look_at_m || (person.premovement_s == 0 && !group.after)) return;
  const Eigen::Vector2d to_target = *person.look_at_m - person.position_m;
  if (to_target.squaredNorm() == 0) return;
  const SinCos off =
      sin_cos(std::clamp(random_normal({seed, id, 0, Purpose::kFacing}, 0, tuning::kFacing_rad),
                         -tuning::kMaxFacing_rad, tuning::kMaxFacing_rad));
  person.heading = Eigen::Vector2d(off.cos * to_target.x() - off.sin * to_target.y(),
                                   off.sin * to_target.x() + off.cos * to_target.y())
                       .normalized();
}

/// Finds a free place in the group's spawn area for agent `id`. A place without a path to the goal
/// is used if there is no other: its agents are reported as stranded.
bool find_place(const CrowdPlan& plan, const Group& group, const NavigationMap& map, uint64_t id,
                const std::vector<AgentSpec>& people, const PlacedDiscs& places,
                AgentSpec& person) {
  const Stop& goal = map.route(person.group).front();
  uint32_t dart = 0;
  bool has_fallback = false;
  for (const double gap_m : kGaps_m) {
    for (uint32_t attempt = 0; attempt < kDarts; ++attempt, ++dart) {
      const RandomKey key{plan.seed, id, dart, Purpose::kSpawnPosition};
      const Eigen::Vector2d point =
          group.spawn.at({random_uniform(key, 0), random_uniform(key, 1)});
      if (!places.is_free(point, person.radius_m, gap_m, people)) continue;
      if (map.walkable().clearance_m(point) < wall_gap_m(person.radius_m, person.height_m))
        continue;
      const bool reaches_goal = goal.field->reaches(point);
      if (!reaches_goal && has_fallback) continue;
      place_at(point, goal, person);
      look_at_target(plan.seed, id, group, person);
      if (reaches_goal) return true;
      has_fallback = true;
    }
  }
  return has_fallback;
}

/// Returns whether an agent with this disc may stand at a point.
bool is_free_place(const Group& group, const NavigationMap& map, const Eigen::Vector2d& point,
                   double gap_m, const std::vector<AgentSpec>& people, const PlacedDiscs& places,
                   const AgentSpec& person) {
  return group.spawn.contains(point) && places.is_free(point, person.radius_m, gap_m, people) &&
         map.walkable().clearance_m(point) >= wall_gap_m(person.radius_m, person.height_m) &&
         map.route(person.group).front().field->reaches(point);
}

/// Finds a place near the members placed so far, of which `first` is the first. Prefers its left
/// and right side to places near any of them.
bool find_place_beside(const CrowdPlan& plan, const Group& group, const NavigationMap& map,
                       uint64_t id, size_t first, const std::vector<AgentSpec>& people,
                       const PlacedDiscs& places, AgentSpec& person) {
  const auto take = [&](const Eigen::Vector2d& point, double gap_m) {
    if (!is_free_place(group, map, point, gap_m, people, places, person)) return false;
    place_at(point, map.route(person.group).front(), person);
    look_at_target(plan.seed, id, group, person);
    return true;
  };
  const Eigen::Vector2d left(-people[first].heading.y(), people[first].heading.x());
  const double apart_m =
      kMemberSpacing_m + person.radius_m + people[first].radius_m - 2 * kReferenceRadius_m;
  for (const double places_off : {1.0, -1.0, 2.0, -2.0})
    if (take(people[first].position_m + places_off * apart_m * left, kGaps_m[1])) return true;
  for (uint32_t dart = 0; dart < kMemberDarts; ++dart) {
    const RandomKey key{plan.seed, id, dart, Purpose::kSocialGroup};
    const auto among = static_cast<double>(people.size() - first);
    const size_t other = first + static_cast<size_t>(random_uniform(key, 0, among, 0));
    const SinCos turn = sin_cos(random_uniform(key, 0, 2 * std::numbers::pi, 1));
    const double away_m = random_uniform(key, kMinMemberDistance_m, kMaxMemberDistance_m, 2);
    if (take(people[other].position_m + away_m * Eigen::Vector2d(turn.cos, turn.sin), kGaps_m[2]))
      return true;
  }
  return false;
}

/// Gives members the delay of the first and the speed of the slowest.
void form_group(std::span<AgentSpec> social_group, uint64_t number) {
  if (social_group.size() < 2) return;
  double speed_mps = social_group.front().desired_speed_mps;
  for (const AgentSpec& person : social_group)
    speed_mps = std::min(speed_mps, person.desired_speed_mps);
  for (AgentSpec& person : social_group) {
    person.social_group = static_cast<uint32_t>(number);
    person.desired_speed_mps = speed_mps;
    person.premovement_s = social_group.front().premovement_s;
  }
}

/// Places agents of a group from `first_id` on anywhere in its area; returns their number.
int place_at_random(const CrowdPlan& plan, size_t group_index, const NavigationMap& map,
                    uint64_t first_id, PlacedDiscs& places, std::vector<AgentSpec>& people) {
  const Group& group = plan.groups[group_index];
  std::vector<AgentSpec> social_group;
  int placed = 0;
  for (int i = 0; i < group.count; i += static_cast<int>(social_group.size())) {
    const uint64_t begin = first_id + static_cast<uint64_t>(i);
    const int size = draw_group_size(group, plan.seed, begin, group.count - i);
    social_group.clear();
    for (int k = 0; k < size; ++k)
      social_group.push_back(make_agent(plan, group_index, begin + static_cast<uint64_t>(k)));
    form_group(social_group, begin);
    const size_t first = people.size();
    for (size_t k = 0; k < social_group.size(); ++k) {
      const bool is_beside =
          people.size() > first &&
          find_place_beside(plan, group, map, begin + k, first, people, places, social_group[k]);
      if (!is_beside && !find_place(plan, group, map, begin + k, people, places, social_group[k]))
        continue;
      places.add(social_group[k].position_m, people.size());
      people.push_back(social_group[k]);
      ++placed;
    }
  }
  return placed;
}

/// Discs of agents that stand in an area or reach into it.
std::vector<StandingDisc> discs_near(const Rectangle& area, const std::vector<AgentSpec>& people) {
  const Rectangle around = area.grown(kMaxRadius_m + 1);
  std::vector<StandingDisc> discs;
  for (const AgentSpec& person : people)
    if (person.entrance == AgentSpec::kFromTheStart && around.contains(person.position_m))
      discs.push_back({person.position_m, person.radius_m});
  return discs;
}

/// Sets the radius scales of agents that stand closer than their discs.
void set_radius_scales(std::span<AgentSpec> people, double max_radius_m) {
  std::vector<uint32_t> by_x;
  for (uint32_t i = 0; i < people.size(); ++i) by_x.push_back(i);
  std::sort(by_x.begin(), by_x.end(), [&](uint32_t a, uint32_t b) {
    const double ax = people[a].position_m.x(), bx = people[b].position_m.x();
    return ax < bx || (ax == bx && a < b);
  });
  for (size_t i = 0; i < by_x.size(); ++i)
    for (size_t k = i + 1; k < by_x.size(); ++k) {
      AgentSpec &a = people[by_x[i]], &b = people[by_x[k]];
      if (b.position_m.x() - a.position_m.x() > 2 * max_radius_m) break;
      const double share = (b.position_m - a.position_m).norm() / (a.radius_m + b.radius_m);
      a.radius_scale = std::min(a.radius_scale, static_cast<float>(share));
      b.radius_scale = std::min(b.radius_scale, static_cast<float>(share));
    }
}

/// Places agents of a group with a density, from `first_id` on. Returns the number of placed ones.
int place_densely(const CrowdPlan& plan, size_t group_index, const NavigationMap& map,
                  uint64_t first_id, double max_radius_m, PlacedDiscs& places,
                  std::vector<AgentSpec>& people) {
  const Group& group = plan.groups[group_index];
  std::vector<AgentSpec> requested;
  std::vector<StandingBody> bodies;
  double gap_m = 0;
  for (int i = 0; i < group.count; ++i) {
    requested.push_back(make_agent(plan, group_index, first_id + static_cast<uint64_t>(i)));
    bodies.emplace_back().size = requested.back().height_m / kReferenceHeight_m;
    gap_m = std::max(gap_m, wall_gap_m(requested.back().radius_m, requested.back().height_m));
  }
  const std::vector<StandingDisc> others = discs_near(group.spawn.bounds(), people);
  const Stop& goal = map.route(group_index).front();
  const StandingArea where{map.walkable(), group.spawn, gap_m, others,
                           [&](size_t i, const Eigen::Vector2d& place_m) {
                             place_at(place_m, goal, requested[i]);
                             look_at_target(plan.seed, first_id + i, group, requested[i]);
                             return requested[i].heading;
                           }};
  const std::vector<uint8_t> is_placed =
      place_standing(where, random_bits({plan.seed, first_id, 0, Purpose::kSpawnPosition}), bodies);
  const size_t first = people.size();
  for (size_t i = 0; i < requested.size(); ++i) {
    if (is_placed[i] == 0) continue;
    places.add(requested[i].position_m, people.size());
    people.push_back(requested[i]);
  }
  set_radius_scales(std::span(people).subspan(first), max_radius_m);
  return static_cast<int>(people.size() - first);
}

/// Throws InputError unless the disc of agent `row` keeps half its radius clear of walls.
void require_off_walls(const Group& group, const NavigationMap& map, size_t row,
                       const AgentSpec& person) {
  const double clearance_m = map.walkable().clearance_m(person.position_m);
  const double min_m = min_clearance_m(person.radius_m);
  if (clearance_m >= min_m) return;
  const Starts& starts = group.starts;
  throw InputError(
      at_line(starts.file, starts.lines[row]),
      fmt::format("position {} of group '{}' on the ground, at least {:.3g} m from walls and its "
                  "edge",
                  row + 1, group.name, min_m),
      fmt::format("[{}, {}], {}", person.position_m.x(), person.position_m.y(),
                  clearance_m < 0 ? std::string("in a wall or outside")
                                  : fmt::format("{:.3g} m from one", clearance_m)));
}

/// Throws InputError if the disc of agent `row` overlaps another by more than half.
void require_apart(const Group& group, size_t row, const AgentSpec& person,
                   const std::vector<AgentSpec>& people, const PlacedDiscs& places) {
  const std::optional<size_t> other = places.find_overlapping(person, people);
  if (!other) return;
  const Starts& starts = group.starts;
  const Eigen::Vector2d& there = people[*other].position_m;
  throw InputError(
      at_line(starts.file, starts.lines[row]),
      fmt::format("position {} of group '{}' at least {:.3g} m from other agents", row + 1,
                  group.name, min_apart_m(person.radius_m, people[*other].radius_m)),
      fmt::format("[{}, {}], {:.3g} m from the one at [{}, {}]", person.position_m.x(),
                  person.position_m.y(), (there - person.position_m).norm(), there.x(), there.y()));
}

/// Places agents of a group at its explicit positions, from `first_id` on.
void place_at_starts(const CrowdPlan& plan, size_t group_index, const NavigationMap& map,
                     uint64_t first_id, double max_radius_m, PlacedDiscs& places,
                     std::vector<AgentSpec>& people) {
  const Group& group = plan.groups[group_index];
  const Starts& starts = group.starts;
  const Stop& goal = map.route(group_index).front();
  const size_t first = people.size();
  for (size_t row = 0; row < starts.positions_m.size(); ++row) {
    AgentSpec person = make_agent(plan, group_index, first_id + row);
    place_at(starts.positions_m[row], goal, person);
    look_at_target(plan.seed, first_id + row, group, person);
    if (!starts.headings_rad.empty()) {
      const SinCos heading = sin_cos(starts.headings_rad[row]);
      person.heading = {heading.cos, heading.sin};
    }
    if (!starts.speeds_mps.empty()) person.enters_mps = starts.speeds_mps[row];
    require_off_walls(group, map, row, person);
    require_apart(group, row, person, people, places);
    places.add(person.position_m, people.size());
    people.push_back(person);
  }
  set_radius_scales(std::span(people).subspan(first), max_radius_m);
}

double disc_of(const Group& group, double height_m) {
  if (group.radius_m > 0) return group.radius_m;
  if (has_people(group)) return disc_radius_m(height_m);
  const Model& body = *group.body;
  // The whole outline of a robot at its start: it has no arms to tuck.
  return std::clamp(static_cast<double>(body.footprint_radius_m()) * height_m /
                        static_cast<double>(body.height_m),
                    kMinRadius_m, kMaxRadius_m);
}

double tallest_m(const Group& group) {
  if (group.height_m) return group.height_m->max;
  double max_m = 0;
  for (size_t age = 0; age < kAgeCount; ++age)
    max_m = std::max(max_m, age_group(static_cast<Age>(age)).height_m.max);
  return max_m;
}

/// Adds the agents of one source with their entry times.
void add_source(const CrowdPlan& plan, const NavigationMap& map, size_t group, const Source& source,
                uint32_t entrance, uint64_t first_id, std::vector<AgentSpec>& people) {
  double time_s = source.start_s;
  const size_t first = people.size();
  for (int i = 0; i < source.count; ++i) {
    const uint64_t id = first_id + static_cast<uint64_t>(i);
    AgentSpec person = make_agent(plan, group, id);
    // Gaps of a Poisson process are exponential; 1 - u is above 0.
    const double gap =
        source.is_poisson ? -natural_log(1 - random_uniform({plan.seed, id, 0, Purpose::kEmission}))
                          : (i == 0 ? 0.0 : 1.0);
    time_s += gap / source.rate_per_s;
    person.enters_s = time_s;
    person.enters_mps = source.enters_mps;
    person.entrance = entrance;
    place_at(source.area.middle_m(), map.route(group).front(), person);
    people.push_back(person);
  }
  // Members of a social group enter at the time of the first.
  for (int i = 0; i < source.count;) {
    const uint64_t id = first_id + static_cast<uint64_t>(i);
    const int size = draw_group_size(plan.groups[group], plan.seed, id, source.count - i);
    const std::span<AgentSpec> social_group =
        std::span(people).subspan(first + static_cast<size_t>(i), static_cast<size_t>(size));
    form_group(social_group, id);
    for (AgentSpec& person : social_group) person.enters_s = social_group.front().enters_s;
    i += size;
  }
}

}  // namespace

int draw_group_size(const Group& group, uint64_t seed, uint64_t id, int left) {
  if (!group.social_groups || left < 2) return 1;
  const SocialGroupRule& rule = *group.social_groups;
  double groups = 0, people = 0;
  for (size_t i = 0; i < rule.sizes.size(); ++i) {
    groups += rule.sizes[i];
    people += static_cast<double>(i + 2) * rule.sizes[i];
  }
  // Probability of a social group, from the share of agents that belong to one.
  const double group_share =
      rule.share * groups / (rule.share * groups + (1 - rule.share) * people);
  const RandomKey key{seed, id, 0, Purpose::kSocialGroup};
  if (random_uniform(key, 0) >= group_share) return 1;
  double where = random_uniform(key, 1) * groups;
  int size = 2;
  for (size_t i = 0; i + 1 < rule.sizes.size() && where >= rule.sizes[i]; ++i, ++size)
    where -= rule.sizes[i];
  return std::min(size, left);
}

AgentSpec make_agent(const CrowdPlan& plan, size_t group_index, uint64_t id) {
  const Group& group = plan.groups[group_index];
  AgentSpec person;
  person.group = static_cast<uint32_t>(group_index);
  const AgeGroup& age = age_group(draw_age(group.ages, plan.seed, id));
  person.height_m = draw(group.height_m.value_or(age.height_m), plan.seed, id, Purpose::kHeight);
  person.desired_speed_mps =
      draw(group.speed_mps.value_or(age.speed_mps), plan.seed, id, Purpose::kDesiredSpeed);
  person.premovement_s = draw(group.premovement_s, plan.seed, id, Purpose::kDelay);
  person.look_at_m = group.look_at_m;
  person.radius_m = disc_of(group, person.height_m);
  person.phase = random_uniform({plan.seed, id, 0, Purpose::kGaitPhase});
  if (!group.is_external() || group.gait_styles)
    person.style = draw_style(group.gait_styles.value_or(age.styles), plan.seed, id);
  return person;
}

double disc_radius_m(double height_m) {
  return kReferenceRadius_m * (height_m / kReferenceHeight_m);
}

double wall_gap_m(double radius_m, double height_m) {
  // Half of 0.25 m for 1.70 m; at most the usual disc, because robots may be tall.
  return std::max(radius_m, std::min(kReferenceRadius_m, 0.125 * (height_m / kReferenceHeight_m)));
}

SpawnResult spawn(const CrowdPlan& plan, const NavigationMap& map,
                  std::span<const AgentSpec> external) {
  SpawnResult out;
  out.people.assign(external.begin(), external.end());
  double max_radius_m = 0;
  for (const Group& group : plan.groups)
    max_radius_m = std::max(max_radius_m, disc_of(group, tallest_m(group)));
  for (const AgentSpec& person : external) max_radius_m = std::max(max_radius_m, person.radius_m);
  PlacedDiscs places(plan.ground, max_radius_m);
  for (size_t i = 0; i < external.size(); ++i)
    if (external[i].entrance == AgentSpec::kFromTheStart) places.add(external[i].position_m, i);
  uint64_t id = 0;
  uint32_t entrance = 0;
  for (size_t g = 0; g < plan.groups.size(); ++g) {
    const Group& group = plan.groups[g];
    // A robot's size comes from a file that may be in millimetres: it is reported.
    if (!has_people(group))
      out.notes.push_back(fmt::format("group '{}': {}", group.name, describe_size(group)));
    int placed = 0;
    if (!group.starts.positions_m.empty()) {
      place_at_starts(plan, g, map, id, max_radius_m, places, out.people);
      placed = group.count;
    } else if (group.density_per_m2 > 0) {
      placed = place_densely(plan, g, map, id, max_radius_m, places, out.people);
    } else {
      placed = place_at_random(plan, g, map, id, places, out.people);
    }
    id += static_cast<uint64_t>(group.count);
    for (const Source& source : group.sources) {
      add_source(plan, map, g, source, entrance++, id, out.people);
      id += static_cast<uint64_t>(source.count);
    }
    for (int i = 0; i < group.spare; ++i) {
      AgentSpec& person = out.people.emplace_back(make_agent(plan, g, id++));
      person.entrance = AgentSpec::kSpare;
      person.position_m = group.spawn.middle_m();
    }
    out.unplaced.push_back(group.count - placed);
    if (placed < group.count)
      out.notes.push_back(
          fmt::format("group '{}': placed {} of {} agents; enlarge `spawn` or ask for fewer",
                      group.name, placed, group.count));
  }
  return out;
}

}  // namespace throng
