#include "crowd/navigation/navigation_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/errors.h"

namespace throng {

const Area& Stop::nearest_area(const Eigen::Vector2d& point) const {
  const auto square_m2 = [&](const Area& area) {
    return (point - area.nearest_m(point)).squaredNorm();
  };
  return *std::min_element(goal.areas.begin(), goal.areas.end(), [&](const Area& a, const Area& b) {
    return square_m2(a) < square_m2(b);
  });
}

namespace {

/// Pieces of the mesh that an area lies on, by samples on the rim and inside.
std::vector<int> pieces_of(const NavMesh& mesh, const Goal& goal) {
  constexpr int kSamples = 8;
  std::vector<int> pieces;
  for (const Area& area : goal.areas)
    for (int i = 0; i <= kSamples; ++i)
      for (int j = 0; j <= kSamples; ++j) {
        const Eigen::Vector2d share(i / double{kSamples}, j / double{kSamples});
        const int piece = mesh.piece_at(area.at(share));
        if (piece >= 0 && std::find(pieces.begin(), pieces.end(), piece) == pieces.end())
          pieces.push_back(piece);
      }
  return pieces;
}

/// Assigns in place: others keep references to the field.
void put(FlowField&& field, std::unique_ptr<FlowField>& place) {
  if (place == nullptr)
    place = std::make_unique<FlowField>(std::move(field));
  else
    *place = std::move(field);
}

}  // namespace

NavigationMap::NavigationMap(const CrowdPlan& plan, Workers& workers)
    : walkable_(plan), grid_(walkable_) {
  for (const Group& group : plan.groups)
    for (const Goal& goal : group.goals) add_goal(goal);
  fields_.resize(goals_.size());
  // A scene with a box has no agents to guide.
  if (plan.groups.empty()) return;
  add_queues(plan);
  resolve_triggers(plan);
  build_fields(workers);
  for (QueueFields& queue : queues_)
    queue.plan.find_overflow_positions(walkable_, *queue.to_corners.back());
  for (const Group& group : plan.groups) {
    std::vector<Stop>& route = routes_.emplace_back();
    for (const Goal& goal : group.goals) {
      Stop& stop = route.emplace_back(stop_at(goal, add_goal(goal)));
      if (!goal.is_limited()) continue;
      stop.exits = 0;
      stop.queue = queue_of(goal);
    }
    on_arrival_.push_back(group.on_arrival);
    for (const Source& source : group.sources) entrances_.push_back(source.area);
  }
}

/// Stop at a goal of the scene with this index.
Stop NavigationMap::stop_at(const Goal& goal, uint32_t index) const {
  return {goal,
          fields_[index].get(),
          index,
          pieces_of(*nav_mesh_, goal),
          first_exits_[index],
          first_exits_[index + 1] - first_exits_[index],
          {}};
}

size_t NavigationMap::route_to(size_t group, const Goal& goal, std::span<const uint8_t> is_used) {
  assert(!goal.is_limited());
  const auto known = std::find_if(set_goals_.begin(), set_goals_.end(), [&](const SetGoal& each) {
    return each.group == group && each.goal == goal;
  });
  auto index = static_cast<size_t>(known - set_goals_.begin());
  if (known != set_goals_.end()) return groups() + index;
  index = 0;
  while (index < set_goals_.size() && is_used[groups() + index] != 0) ++index;
  if (index == set_goals_.size()) {
    const size_t max = max_set_goals();
    if (index == max)
      throw InputError("goal", fmt::format("at most {} different goals at a time", max), "more");
    set_goals_.emplace_back();
    routes_.emplace_back();
  }
  set_goals_[index].group = group;
  set_goals_[index].goal = goal;
  build_set_goal(index);
  return groups() + index;
}

/// Ten thousand, or a gigabyte of fields.
size_t NavigationMap::max_set_goals() const {
  constexpr size_t kMax = 10'000, kMaxCells = 80'000'000;
  return std::clamp<size_t>(kMaxCells / grid_.cell_count(), 1, kMax);
}

void NavigationMap::build_set_goal(size_t index) {
  SetGoal& set = set_goals_[index];
  const auto known = std::find(goals_.begin(), goals_.end(), set.goal.areas);
  std::vector<Stop>& route = routes_[groups() + index];
  if (known != goals_.end()) {
    route = {stop_at(set.goal, static_cast<uint32_t>(known - goals_.begin()))};
    set.field.reset();
    return;
  }
  put(field_to(set.goal.areas), set.field);
  route = {{set.goal, set.field.get(), Stop::kNoNumber, pieces_of(*nav_mesh_, set.goal), 0, 0, {}}};
}

namespace {

void archive_ring(Archive& a, Polygon::Ring& ring) { a.resized(ring, kMaxVertices); }

void archive_area(Archive& a, Area& area, const Rectangle& ground) {
  std::vector<Polygon> polygons;
  if (!a.is_reading()) polygons = area.polygons();
  bool is_rectangle = area.is_rectangle();
  Rectangle bounds = area.bounds();
  auto count = static_cast<uint64_t>(polygons.size());
  a(is_rectangle, bounds.min_m, bounds.max_m, count);
  if (count > kMaxVertices) a.reject("the polygons of an area", "too many");
  polygons.resize(static_cast<size_t>(count));
  for (Polygon& polygon : polygons) {
    archive_ring(a, polygon.outline);
    auto holes = static_cast<uint64_t>(polygon.holes.size());
    a(holes);
    if (holes > kMaxVertices) a.reject("the holes of a polygon", "too many");
    polygon.holes.resize(static_cast<size_t>(holes));
    for (Polygon::Ring& hole : polygon.holes) archive_ring(a, hole);
  }
  if (!a.is_reading()) return;
  const auto is_on_ground = [&](const Eigen::Vector2d& corner) { return ground.contains(corner); };
  bool is_sound = is_on_ground(bounds.min_m) && is_on_ground(bounds.max_m) &&
                  (bounds.max_m.array() >= bounds.min_m.array()).all() && !polygons.empty();
  for (const Polygon& polygon : polygons)
    is_sound = is_sound &&
               std::all_of(polygon.outline.begin(), polygon.outline.end(), is_on_ground) &&
               (is_rectangle || !fault_of(polygon));
  if (!is_sound) a.reject("an area on the ground", "another one");
  area = is_rectangle ? Area(bounds) : Area(std::move(polygons));
}

}  // namespace

void NavigationMap::archive(Archive& a) {
  auto count = static_cast<uint64_t>(set_goals_.size());
  a(count);
  if (count > max_set_goals()) a.reject("the number of goals that were set", "too many");
  set_goals_.resize(static_cast<size_t>(count));
  routes_.resize(groups() + set_goals_.size());
  for (size_t i = 0; i < set_goals_.size(); ++i) {
    SetGoal& set = set_goals_[i];
    Distribution& wait_s = set.goal.wait_s;
    auto group = static_cast<uint64_t>(set.group),
         areas = static_cast<uint64_t>(set.goal.areas.size());
    a(group, areas, set.goal.waypoint, wait_s.mean, wait_s.std_dev, wait_s.min, wait_s.max);
    // Negated to reject NaN as well.
    if (group >= groups() || areas < 1 || areas > kMaxVertices ||
        !(wait_s.min >= 0 && wait_s.mean >= wait_s.min && wait_s.max >= wait_s.mean &&
          wait_s.std_dev >= 0))
      a.reject("a goal of a group", "another value");
    set.group = static_cast<size_t>(group);
    set.goal.areas.resize(static_cast<size_t>(areas));
    for (Area& area : set.goal.areas) archive_area(a, area, walkable_.ground());
    if (a.is_reading()) build_set_goal(i);
  }
}

/// Returns the index of a goal; adds it if it is new.
uint32_t NavigationMap::add_goal(const Goal& goal) {
  const auto at = std::find(goals_.begin(), goals_.end(), goal.areas);
  const auto index = static_cast<uint32_t>(at - goals_.begin());
  if (at == goals_.end()) {
    goals_.push_back(goal.areas);
    may_have_exits_.push_back(0);
  }
  if (!goal.is_limited()) may_have_exits_[index] = 1;
  return index;
}

/// Before triggers are resolved, while all doors are open.
void NavigationMap::add_queues(const CrowdPlan& plan) {
  for (const Group& group : plan.groups)
    for (const Goal& goal : group.goals) {
      if (!goal.is_limited() || queue_of(goal) < queues_.size()) continue;
      int64_t people = 0;
      for (const Group& other : plan.groups)
        if (std::any_of(other.goals.begin(), other.goals.end(), [&](const Goal& each) {
              return each.is_limited() && each.areas == goal.areas;
            }))
          people += other.total();
      QueueFields& queue = queues_.emplace_back(QueueFields{{goal, walkable_, people}, {}, {}});
      queue.to_areas.resize(queue.plan.areas.size());
      queue.to_corners.resize(queue.plan.line.corners_m().size());
    }
}

/// Returns the index of a goal's queue, or the number of queues.
uint32_t NavigationMap::queue_of(const Goal& goal) const {
  const auto at = std::find_if(queues_.begin(), queues_.end(), [&](const QueueFields& queue) {
    return queue.plan.areas == goal.areas;
  });
  return static_cast<uint32_t>(at - queues_.begin());
}

void NavigationMap::build_queues(Workers& workers) {
  for (QueueFields& queue : queues_) {
    const std::vector<Eigen::Vector2d>& corners_m = queue.plan.line.corners_m();
    const size_t areas = queue.plan.areas.size();
    workers.for_blocks(static_cast<int>(areas + corners_m.size()), [&](int block, int) {
      const auto index = static_cast<size_t>(block);
      if (index < areas) {
        const std::span<const Area> area(&queue.plan.areas[index], 1);
        put(field_to(area), queue.to_areas[index]);
        return;
      }
      const Eigen::Vector2d half = Eigen::Vector2d::Constant(grid_.cell_m());
      const Eigen::Vector2d& corner = corners_m[index - areas];
      const Area around(corner - half, corner + half);
      put(FlowField(grid_, {&around, 1}, closed_, penalise_other_goals({})),
          queue.to_corners[index - areas]);
    });
  }
}

/// Field to areas for the current doors, off the areas where others are served.
FlowField NavigationMap::field_to(std::span<const Area> areas) const {
  return FlowField(grid_, areas, closed_, penalise_other_goals(areas));
}

/// Policies that keep paths off the areas where others are served; empty without queues.
std::vector<CellPolicy> NavigationMap::penalise_other_goals(std::span<const Area> areas) const {
  std::vector<CellPolicy> policies;
  if (queues_.empty()) return policies;
  constexpr double kBody_m = 0.2;
  policies.resize(grid_.cell_count(), CellPolicy::kFree);
  for (size_t cell = 0; cell < policies.size(); ++cell) {
    const Eigen::Vector2d centre = grid_.centre_m(cell);
    for (const QueueFields& queue : queues_)
      for (const Area& area : queue.plan.areas)
        if (area.contains(centre, kBody_m)) policies[cell] = CellPolicy::kPenalised;
    for (const Area& area : areas)
      if (area.contains(centre, kBody_m)) policies[cell] = CellPolicy::kFree;
  }
  return policies;
}

/// Builds the fields of all goals for the current doors, and the mesh on the first call.
void NavigationMap::build_fields(Workers& workers) {
  // The mesh first, because it takes longest.
  workers.for_blocks(static_cast<int>(goals_.size()) + 1, [&](int block, int) {
    if (block == 0) {
      if (nav_mesh_ == nullptr)
        nav_mesh_ =
            std::make_unique<NavMesh>(walkable_.ground(), walkable_.footprints(), grid_.passages(),
                                      grid_.closures(), walkable_.floor());
      return;
    }
    const auto goal = static_cast<size_t>(block - 1);
    put(field_to(goals_[goal]), fields_[goal]);
  });
  workers.for_blocks(static_cast<int>(set_goals_.size()), [&](int block, int) {
    SetGoal& set = set_goals_[static_cast<size_t>(block)];
    if (set.field != nullptr) put(field_to(set.goal.areas), set.field);
  });
  if (!queues_.empty()) build_queues(workers);
  if (first_exits_.empty()) find_exits(workers);
  if (!exits_.empty()) build_exits(workers);
}

/// Doorways if there are several, otherwise areas if there are several.
void NavigationMap::find_exits(Workers& workers) {
  std::vector<std::vector<Doorway>> doorways(goals_.size());
  workers.for_blocks(static_cast<int>(goals_.size()), [&](int block, int) {
    const auto goal = static_cast<size_t>(block);
    if (may_have_exits_[goal] == 0) return;
    doorways[goal] = closed_.empty() ? doorways_before(grid_, *fields_[goal])
                                     : doorways_before(grid_, FlowField(grid_, goals_[goal]));
  });
  const auto add = [&](size_t goal, double width_m, std::vector<size_t> cells) {
    exits_.push_back({nullptr, fields_.size() + exits_.size(), width_m});
    goal_of_exit_.push_back(goal);
    doorways_.push_back(std::move(cells));
  };
  first_exits_.push_back(0);
  for (size_t goal = 0; goal < goals_.size(); ++goal) {
    for (Doorway& doorway : doorways[goal]) add(goal, doorway.width_m, std::move(doorway.cells));
    if (may_have_exits_[goal] != 0 && doorways[goal].empty() && goals_[goal].size() > 1)
      for (const Area& area : goals_[goal]) add(goal, area.size_m().maxCoeff(), {});
    first_exits_.push_back(static_cast<uint32_t>(exits_.size()));
  }
  exit_fields_.resize(exits_.size());
}

/// The plain fields of areas come first: from them follows what lies before another area.
void NavigationMap::build_exits(Workers& workers) {
  const auto build = [&](uint32_t exit, std::span<const CellPolicy> cell_policies) {
    const size_t goal = goal_of_exit_[exit];
    const std::span<const Area> areas(goals_[goal]);
    return FlowField(grid_,
                     doorways_[exit].empty() ? areas.subspan(exit - first_exits_[goal], 1) : areas,
                     closed_, cell_policies);
  };
  const auto count = static_cast<int>(exits_.size());
  workers.for_blocks(count, [&](int block, int) {
    const auto exit = static_cast<uint32_t>(block);
    if (doorways_[exit].empty()) put(build(exit, {}), exit_fields_[exit]);
  });
  std::vector<std::vector<CellPolicy>> cell_policies(exits_.size());
  workers.for_blocks(count, [&](int block, int) {
    const auto exit = static_cast<uint32_t>(block);
    cell_policies[exit] = avoid_other_exits(exit);
  });
  workers.for_blocks(count, [&](int block, int) {
    const auto exit = static_cast<uint32_t>(block);
    put(build(exit, cell_policies[exit]), exit_fields_[exit]);
    exits_[exit].field = exit_fields_[exit].get();
  });
}

std::vector<CellPolicy> NavigationMap::avoid_other_exits(uint32_t exit) const {
  const size_t goal = goal_of_exit_[exit];
  std::vector<CellPolicy> cell_policies = penalise_other_goals(goals_[goal]);
  cell_policies.resize(grid_.cell_count(), CellPolicy::kFree);
  for (uint32_t other = first_exits_[goal]; other < first_exits_[goal + 1]; ++other) {
    if (other == exit) continue;
    for (const size_t cell : doorways_[other]) cell_policies[cell] = CellPolicy::kBlocked;
    if (!doorways_[other].empty()) continue;
    const FlowField &own = *exit_fields_[exit], &its = *exit_fields_[other];
    for (size_t cell = 0; cell < cell_policies.size(); ++cell)
      if (its.cell_distance_m(cell) <
          std::min(own.cell_distance_m(cell), static_cast<float>(Exit::kMinOtherExit_m)))
        cell_policies[cell] = CellPolicy::kPenalised;
  }
  return cell_policies;
}

void NavigationMap::resolve_triggers(const CrowdPlan& plan) {
  for (const Group& group : plan.groups) {
    std::optional<uint32_t>& after = after_.emplace_back();
    if (group.after) after = add_trigger(plan, *group.after);
  }
  for (size_t door = 0; door < plan.doors.size(); ++door) {
    DoorTriggers& times = door_triggers_.emplace_back();
    for (const TriggerRule& rule : plan.doors[door].opens)
      times.opens.push_back(add_trigger(plan, rule));
    for (const TriggerRule& rule : plan.doors[door].closes)
      times.closes.push_back(add_trigger(plan, rule));
    doors_.push_back(times.opens.empty() ? DoorState::kOpen : DoorState::kShut);
    std::vector<size_t>& cells = door_cells_.emplace_back();
    for (size_t cell = 0; cell < grid_.cell_count(); ++cell)
      if (grid_.is_free(cell) &&
          nearest_door(door, grid_.centre_m(cell)).distance_m < 0.71 * grid_.cell_m())
        cells.push_back(cell);
  }
  apply_doors();
}

uint32_t NavigationMap::add_trigger(const CrowdPlan& plan, const TriggerRule& rule) {
  Trigger& trigger = triggers_.emplace_back();
  trigger.delay_s = rule.delay_s;
  if (!rule.group.empty()) {
    const auto group = std::find_if(plan.groups.begin(), plan.groups.end(),
                                    [&](const Group& each) { return each.name == rule.group; });
    assert(group != plan.groups.end());
    trigger.group = static_cast<uint32_t>(group - plan.groups.begin());
    trigger.goals =
        static_cast<uint32_t>(rule.goal > 0 ? static_cast<size_t>(rule.goal) : group->goals.size());
  }
  return static_cast<uint32_t>(triggers_.size() - 1);
}

void NavigationMap::apply_doors() {
  closed_.clear();
  std::vector<uint8_t> shut;
  for (size_t door = 0; door < doors_.size(); ++door) {
    shut.push_back(doors_[door] == DoorState::kShut ? 1 : 0);
    if (doors_[door] == DoorState::kOpen) continue;
    closed_.resize(grid_.cell_count());
    for (const size_t cell : door_cells_[door]) closed_[cell] = 1;
  }
  if (!doors_.empty()) walkable_.shut(shut);
}

void NavigationMap::set_doors(std::span<const DoorState> doors, Workers& workers) {
  const auto differs_in = [&](DoorState state) {
    for (size_t door = 0; door < doors.size(); ++door)
      if ((doors[door] == state) != (doors_[door] == state)) return true;
    return false;
  };
  const bool changes_paths = differs_in(DoorState::kOpen);
  if (!changes_paths && !differs_in(DoorState::kShut)) return;
  doors_.assign(doors.begin(), doors.end());
  apply_doors();
  if (!changes_paths) return;
  ++revision_;
  build_fields(workers);
}

/// Follows a field out of an obstacle's margin: returns false at a wall, and at a gap too narrow
/// for bodies.
bool NavigationMap::is_open_along(const FlowField& field, const Eigen::Vector2d& point) const {
  constexpr double kStep_m = 0.05;
  constexpr int kMaxSteps = 40;
  constexpr double kTolerance_m = 0.02;
  const double narrow_m =
      std::min(FlowGrid::kMinGap_m, walkable_.gap_at(point, FlowGrid::kMinGap_m).width_m) -
      kTolerance_m;
  Eigen::Vector2d at = point;
  for (int step = 0; step < kMaxSteps && !field.reaches(at); ++step) {
    const Eigen::Vector2d next = at + kStep_m * field.direction(at);
    if (next == at || walkable_.crosses(at, next)) return false;  // the field ends, or a wall
    at = next;
    if (walkable_.gap_at(at, FlowGrid::kMinGap_m).width_m < narrow_m) return false;
  }
  return true;
}

bool NavigationMap::leads(const Stop& stop, const Eigen::Vector2d& point) const {
  if (stop.field->reaches(point)) return true;
  // In the margin of an obstacle the field points out of it, perhaps to the wrong side.
  if (stop.field->direction(point).squaredNorm() == 0 || !is_open_along(*stop.field, point))
    return false;
  const int piece = nav_mesh_->piece_at(point);
  return piece < 0 || std::find(stop.pieces.begin(), stop.pieces.end(), piece) != stop.pieces.end();
}

}  // namespace throng
