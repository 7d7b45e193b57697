#include "crowd/navigation/flow_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "crowd/navigation/arrival.h"

namespace throng {
namespace {

/// Two cells fit between the margins of a doorway of 0.8 m; finer ones only cost memory.
constexpr double kMinFlowCell_m = 0.2;
/// A field of a million cells takes 12 MB and half a second to march.
constexpr double kMaxCells = 1 << 20;
/// Distance at which a centre passes a wall in a doorway.
constexpr double kBodyMargin_m = 0.2;
/// Preferred distance to walls: half the shoulders and a hand's breadth.
constexpr double kComfort_m = 0.5;
/// Cost of a metre along a wall relative to the open.
constexpr double kMaxSlowness = 2.5;
/// Two cells closer than this to walls may be linked through a gap that is too narrow.
constexpr double kNarrow_m = 0.35;
/// Disc radius of a person of 1.70 m.
constexpr double kPerson_m = 0.22;
/// Number of cells before a gap from which agents aim at separate places, clear of its corners.
constexpr int kApproach = 2;
constexpr float kFar = std::numeric_limits<float>::infinity();

/// Neighbours in the order left, right, below, above; -1 where the grid ends.
using Neighbours = std::array<ptrdiff_t, 4>;

Neighbours neighbours_of(const FlowGrid& grid, size_t cell) {
  const auto columns = static_cast<ptrdiff_t>(grid.columns());
  const auto at = static_cast<ptrdiff_t>(cell);
  const ptrdiff_t column = at % columns;
  const ptrdiff_t row = at / columns;
  return {column > 0 ? at - 1 : -1, column + 1 < columns ? at + 1 : -1, row > 0 ? at - columns : -1,
          row + 1 < grid.rows() ? at + columns : -1};
}

template <typename Value>
const Value* find_cell(const std::vector<std::pair<size_t, Value>>& by_cell, size_t cell) {
  const auto at = std::lower_bound(by_cell.begin(), by_cell.end(), cell,
                                   [](const auto& entry, size_t to) { return entry.first < to; });
  return at == by_cell.end() || at->first != cell ? nullptr : &at->second;
}

/// Returns the point within half a cell of a centre with the largest `worth`. The best of 49
/// samples is refined with halved steps, to a 160th of a cell.
template <typename Worth>
Eigen::Vector2d best_place(const Eigen::Vector2d& centre, double cell_m, const Worth& worth) {
  const Eigen::Vector2d low = centre.array() - 0.5 * cell_m;
  const Eigen::Vector2d high = centre.array() + 0.5 * cell_m;
  Eigen::Vector2d best = centre;
  double most = worth(centre);
  const auto try_around = [&](const Eigen::Vector2d& middle, int reach, double step_m) {
    for (int i = -reach; i <= reach; ++i)
      for (int k = -reach; k <= reach; ++k) {
        const Eigen::Vector2d point =
            (middle + step_m * Eigen::Vector2d(i, k)).cwiseMax(low).cwiseMin(high);
        const double found = worth(point);
        if (found <= most) continue;
        most = found;
        best = point;
      }
  };
  try_around(centre, 3, cell_m / 6);
  for (const double part : {10, 20, 40, 80, 160})
    try_around(Eigen::Vector2d(best), 1, cell_m / part);
  return best;
}

/// Replaces `walls` by the footprints of which a point within `radius_m` of the centre can be
/// nearer than `reach_m`.
void list_walls(const Walkable& walkable, const Eigen::Vector2d& centre, double radius_m,
                double reach_m, std::vector<uint32_t>& walls) {
  walls.clear();
  for (const uint32_t wall : walkable.nearby_footprints(centre))
    if (!walkable.is_beyond(wall, centre, reach_m + radius_m)) walls.push_back(wall);
}

float slowness_at(double clearance_m) {
  const double tightness = std::clamp((kComfort_m - clearance_m) / kComfort_m, 0.0, 1.0);
  return static_cast<float>(1 + (kMaxSlowness - 1) * tightness);
}

/// Distance from the nearer neighbour along each axis: the quadratic of the upwind scheme.
double eikonal(double x, double y, double step_m) {
  const double low = std::min(x, y);
  const double high = std::max(x, y);
  if (high - low >= step_m) return low + step_m;
  const double gap = high - low;
  return 0.5 * (low + high + std::sqrt(2 * step_m * step_m - gap * gap));
}

}  // namespace

FlowGrid::FlowGrid(const Walkable& walkable)
    : walkable_(&walkable), origin_m_(walkable.ground().min_m) {
  const Eigen::Vector2d size = walkable.ground().size_m();
  cell_m_ = std::max(kMinFlowCell_m, std::sqrt(size.prod() / kMaxCells));
  cells_per_m_ = 1 / cell_m_;
  columns_ = std::max(1, static_cast<int>(std::ceil(size.x() / cell_m_)));
  rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / cell_m_)));
  const double margin = margin_m(cell_m_);
  slowness_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  std::vector<float> clearances_m(slowness_.size());
  for (size_t cell = 0; cell < slowness_.size(); ++cell) {
    const Eigen::Vector2d centre = centre_m(cell);
    const double clearance = walkable.obstacle_clearance_m(centre);
    clearances_m[cell] = static_cast<float>(clearance);
    if (clearance >= margin && walkable.is_on_floor(centre))
      slowness_[cell] = slowness_at(clearance);
  }
  find_narrow(walkable, clearances_m);
  link(walkable, clearances_m);
}

/// Gaps that contain no cell centre are passable nevertheless.
void FlowGrid::find_narrow(const Walkable& walkable, std::span<const float> clearances_m) {
  const double gap_limit_m = max_gap_m(cell_m_);
  std::vector<uint32_t> walls;
  // The most distant point from both walls; before a thin wall there is more clearance.
  const auto clearance_in_gap = [&](const Eigen::Vector2d& point) {
    return walkable.gap_at(point, gap_limit_m, walls).width_m < gap_limit_m
               ? walkable.obstacle_clearance_m(point, walls)
               : -1.0;
  };
  for (size_t cell = 0; cell < slowness_.size(); ++cell) {
    const Eigen::Vector2d centre = centre_m(cell);
    if (is_free(cell) || static_cast<double>(clearances_m[cell]) + 0.71 * cell_m_ < kMinGap_m / 2)
      continue;
    // Walls stand on both sides of a point in a gap, also for a point inside one of them.
    list_walls(walkable, centre, 0.71 * cell_m_, gap_limit_m, walls);
    const auto is_next_to = [&](uint32_t wall) {
      return !walkable.is_beyond(wall, centre, gap_limit_m) &&
             walkable.nearest(wall, centre).distance_m < gap_limit_m;
    };
    if (walls.size() < 2 || std::count_if(walls.begin(), walls.end(), is_next_to) < 2) continue;
    const Eigen::Vector2d place = best_place(centre, cell_m_, clearance_in_gap);
    if (clearance_in_gap(place) >= kMinGap_m / 2 && walkable.is_on_floor(place))
      narrow_.emplace_back(cell, place);
  }
  if (narrow_.empty()) return;
  for (int round = 0; round < kApproach; ++round) add_approaches(walkable, clearances_m);
  for (const auto& [cell, place] : narrow_)
    slowness_[cell] = slowness_at(walkable.obstacle_clearance_m(place));
}

/// Before a gap a cell's centre may be too close to a corner. The path then leads through the place
/// in the cell from which the gap is best entered.
void FlowGrid::add_approaches(const Walkable& walkable, std::span<const float> clearances_m) {
  constexpr double kClear_m = kBodyMargin_m + 0.05;
  std::vector<std::pair<size_t, Eigen::Vector2d>> approaches;
  std::vector<uint32_t> walls;
  for (const auto& [narrow, gap] : narrow_)
    for (const ptrdiff_t next : neighbours_of(*this, narrow)) {
      const auto cell = static_cast<size_t>(next);
      if (next < 0 || is_free(cell) || is_narrow(cell)) continue;
      if (static_cast<double>(clearances_m[cell]) + 0.71 * cell_m_ < kMinGap_m / 2) continue;
      list_walls(walkable, centre_m(cell), 0.71 * cell_m_, kClear_m, walls);
      const Eigen::Vector2d place =
          best_place(centre_m(cell), cell_m_, [&, &middle = gap](const Eigen::Vector2d& point) {
            return std::min(walkable.obstacle_clearance_m(point, walls), kClear_m) -
                   0.01 * (point - middle).norm();
          });
      if (walkable.obstacle_clearance_m(place, walls) >= kBodyMargin_m &&
          walkable.is_on_floor(place))
        approaches.emplace_back(cell, place);
    }
  const auto by_cell = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(approaches.begin(), approaches.end(), by_cell);
  approaches.erase(std::unique(approaches.begin(), approaches.end(),
                               [](const auto& a, const auto& b) { return a.first == b.first; }),
                   approaches.end());
  narrow_.insert(narrow_.end(), approaches.begin(), approaches.end());
  std::sort(narrow_.begin(), narrow_.end(), by_cell);
}

/// Links two free cells if an agent can walk straight from place to place.
void FlowGrid::join(const Walkable& walkable, size_t from, size_t to) {
  const Eigen::Vector2d start = place_m(from), end = place_m(to);
  const bool is_new = is_narrow(from) || is_narrow(to);
  const double gap_limit_m = max_gap_m(cell_m_);
  const int steps = std::max(1, static_cast<int>(std::ceil((end - start).norm() / 0.04)));
  std::vector<uint32_t> walls;
  list_walls(walkable, start, (end - start).norm(), gap_limit_m, walls);
  bool is_gap = is_new;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d point = start + (static_cast<double>(i) / steps) * (end - start);
    // At a single corner a shoulder may brush it; between two walls there has to be room.
    if (is_new && walkable.obstacle_clearance_m(point, walls) < 0.7 * kBodyMargin_m) return;
    const Gap gap = walkable.gap_at(point, gap_limit_m, walls);
    if (gap.width_m < kMinGap_m) {
      closures_.push_back(gap.across);
      return;
    }
    is_gap = is_gap || gap.width_m < gap_limit_m;
  }
  if (is_gap) passages_.push_back({start, end});
  const unsigned side = to == from + 1 ? 1 : 3;
  links_[from] = static_cast<uint8_t>(links_[from] | (1u << side));
  links_[to] = static_cast<uint8_t>(links_[to] | (1u << (side - 1)));
}

void FlowGrid::link(const Walkable& walkable, std::span<const float> clearances_m) {
  links_.resize(slowness_.size());
  for (size_t cell = 0; cell < slowness_.size(); ++cell) {
    if (!is_free(cell)) continue;
    const Neighbours around = neighbours_of(*this, cell);
    for (const unsigned side : {1u, 3u}) {
      const auto next = static_cast<size_t>(around[side]);
      if (around[side] < 0 || !is_free(next)) continue;
      if (std::min(clearances_m[cell], clearances_m[next]) < static_cast<float>(kNarrow_m)) {
        join(walkable, cell, next);
        continue;
      }
      links_[cell] = static_cast<uint8_t>(links_[cell] | (1u << side));
      links_[next] = static_cast<uint8_t>(links_[next] | (1u << (side - 1)));
    }
  }
}

bool FlowGrid::is_narrow(size_t cell) const { return find_cell(narrow_, cell) != nullptr; }

Eigen::Vector2d FlowGrid::place_m(size_t cell) const {
  const Eigen::Vector2d* narrow = find_cell(narrow_, cell);
  return narrow == nullptr ? centre_m(cell) : *narrow;
}

bool FlowGrid::reaches(size_t cell, const Area& area) const {
  // The first free cell before a wall lies within its margin and one cell.
  const double off_m = std::max(kPerson_m + kMaxWallOffset_m, margin_m(cell_m_) + cell_m_);
  return has_reached(*walkable_, area, place_m(cell), kPerson_m, off_m - kPerson_m);
}

bool FlowGrid::is_open_to(size_t cell, const Area& area) const {
  return is_freely_reachable(*walkable_, area, centre_m(cell));
}

std::array<ptrdiff_t, 4> FlowGrid::free_neighbours(size_t cell) const {
  const auto at = static_cast<ptrdiff_t>(cell);
  const auto columns = static_cast<ptrdiff_t>(columns_);
  const unsigned links = links_[cell];
  return {(links & 1u) != 0 ? at - 1 : -1, (links & 2u) != 0 ? at + 1 : -1,
          (links & 4u) != 0 ? at - columns : -1, (links & 8u) != 0 ? at + columns : -1};
}

bool FlowGrid::is_free_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const int steps = static_cast<int>(std::ceil(10 * (to - from).norm() / cell_m_));
  for (int i = 0; i <= steps; ++i)
    if (!is_free(cell_at(from + (i + 0.5) / (steps + 1) * (to - from)))) return false;
  return true;
}

double FlowGrid::margin_m(double cell_m) { return std::max(kBodyMargin_m, 0.71 * cell_m); }

Eigen::Vector2d FlowGrid::centre_m(size_t cell) const {
  const auto columns = static_cast<size_t>(columns_);
  const size_t column = cell % columns, row = cell / columns;
  return origin_m_ + cell_m_ * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                               static_cast<double>(row) + 0.5);
}

FlowField::FlowField(const FlowGrid& grid, std::span<const Area> areas,
                     std::span<const uint8_t> closed, std::span<const CellPolicy> cell_policies)
    : grid_(&grid), cells_(grid.cell_count()), is_closed_(closed.begin(), closed.end()) {
  march(areas, closed, cell_policies);
  compute_directions();
  fill_blocked_cells();
  aim_through_gaps();
}

void FlowField::march(std::span<const Area> areas, std::span<const uint8_t> closed,
                      std::span<const CellPolicy> cell_policies) {
  // A queue of (distance, cell): equal distances leave in the order of cells.
  using Entry = std::pair<float, size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (size_t cell = 0; cell < cells_.size(); ++cell) {
    // Distance from the cell to a rectangle: small goals between cell centres also count.
    const Eigen::Vector2d centre = grid_->centre_m(cell);
    double away = 1e300;
    for (const Area& area : areas) away = std::min(away, (centre - area.nearest_m(centre)).norm());
    const bool is_free = grid_->is_free(cell), is_far = away > 0.71 * grid_->cell_m();
    // An area behind a wall, or flush with it, attracts no agent to this side.
    const auto is_open = [&](const Area& area) { return grid_->is_open_to(cell, area); };
    if (!is_far && away > 0 && std::none_of(areas.begin(), areas.end(), is_open)) continue;
    if (is_far || (!is_free && away > 0)) {
      const auto reaches_area = [&](const Area& area) { return grid_->reaches(cell, area); };
      const auto area = std::find_if(areas.begin(), areas.end(), reaches_area);
      if (area != areas.end())
        aims_.emplace_back(cell, area->nearest_m(centre));
      else if (is_far)
        continue;
    }
    if (!is_free) continue;
    cells_[cell].distance_m = static_cast<float>(away);
    queue.emplace(cells_[cell].distance_m, cell);
  }
  const auto value = [&](ptrdiff_t cell) {
    return cell < 0 ? kFar : cells_[static_cast<size_t>(cell)].distance_m;
  };
  while (!queue.empty()) {
    const auto [distance, cell] = queue.top();
    queue.pop();
    if (distance > cells_[cell].distance_m) continue;
    for (const ptrdiff_t next : grid_->free_neighbours(cell)) {
      if (next < 0) continue;
      const CellPolicy off =
          cell_policies.empty() ? CellPolicy::kFree : cell_policies[static_cast<size_t>(next)];
      if (off == CellPolicy::kBlocked) continue;
      const Neighbours around = grid_->free_neighbours(static_cast<size_t>(next));
      const auto x = static_cast<double>(std::min(value(around[0]), value(around[1])));
      const auto y = static_cast<double>(std::min(value(around[2]), value(around[3])));
      double step_m = grid_->cell_m() * grid_->slowness(static_cast<size_t>(next));
      if (off == CellPolicy::kPenalised) step_m *= kPenalty;
      if (!closed.empty() && closed[static_cast<size_t>(next)] != 0) step_m += kClosed_m;
      const auto found = static_cast<float>(eikonal(x, y, step_m));
      if (!(found < cells_[static_cast<size_t>(next)].distance_m)) continue;
      cells_[static_cast<size_t>(next)].distance_m = found;
      if (!closed.empty())
        is_closed_[static_cast<size_t>(next)] =
            closed[static_cast<size_t>(next)] | is_closed_[cell];
      queue.emplace(found, static_cast<size_t>(next));
    }
  }
}

void FlowField::compute_directions() {
  const auto fall = [&](float here, ptrdiff_t back, ptrdiff_t ahead) {
    const float behind = back < 0 ? kFar : cells_[static_cast<size_t>(back)].distance_m;
    const float before = ahead < 0 ? kFar : cells_[static_cast<size_t>(ahead)].distance_m;
    const float lower = std::min(behind, before);
    if (!(lower < here)) return 0.0f;
    return before < behind ? here - lower : lower - here;
  };
  for (size_t cell = 0; cell < cells_.size(); ++cell) {
    if (!(cells_[cell].distance_m < kFar)) continue;
    const Neighbours around = grid_->free_neighbours(cell);
    const Eigen::Vector2f down(fall(cells_[cell].distance_m, around[0], around[1]),
                               fall(cells_[cell].distance_m, around[2], around[3]));
    if (down.squaredNorm() > 0) cells_[cell].direction = down.normalized();
  }
}

void FlowField::fill_blocked_cells() {
  // Cells too close to an obstacle lead to the nearest cell with a path: breadth first.
  std::vector<size_t> front;
  std::vector<uint8_t> known(cells_.size());
  for (size_t cell = 0; cell < cells_.size(); ++cell) {
    known[cell] = cells_[cell].distance_m < kFar;
    if (known[cell]) front.push_back(cell);
  }
  for (size_t i = 0; i < front.size(); ++i) {
    for (const ptrdiff_t next : neighbours_of(*grid_, front[i])) {
      if (next < 0) continue;
      const auto cell = static_cast<size_t>(next);
      if (known[cell] || grid_->is_free(cell)) continue;
      known[cell] = 1;
      const Eigen::Vector2d out = grid_->centre_m(front[i]) - grid_->centre_m(cell);
      // Mostly along the direction of the outer cell: straight out would be reversed at once.
      const Eigen::Vector2f heading =
          cells_[front[i]].direction + 0.5f * out.normalized().cast<float>();
      cells_[cell].direction = heading.normalized();
      front.push_back(cell);
    }
  }
}

/// Cells of 0.2 m direct agents to a gap of half a metre no better than to its corner. Agents there
/// walk to the place of the next cell but one, or of the next if a corner lies between.
/// The next cell alone may lie straight to the side: before a door of 0.7 m agents would swing.
void FlowField::aim_through_gaps() {
  std::vector<size_t> cells;
  for (const auto& [cell, place] : grid_->narrow()) cells.push_back(cell);
  for (int round = 0; round < kApproach; ++round)
    for (size_t i = 0, known = cells.size(); i < known; ++i)
      for (const ptrdiff_t next : grid_->free_neighbours(cells[i]))
        if (next >= 0) cells.push_back(static_cast<size_t>(next));
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  for (const size_t cell : cells) {
    const size_t next = downhill_of(cell), second = downhill_of(next);
    if (next == cell) continue;
    const Eigen::Vector2d from = grid_->place_m(cell), to = grid_->place_m(second);
    aims_.emplace_back(cell, grid_->is_free_between(from, to) ? to : grid_->place_m(next));
  }
  // A goal that contains no cell is the first aim.
  const auto by_cell = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::stable_sort(aims_.begin(), aims_.end(), by_cell);
  aims_.erase(std::unique(aims_.begin(), aims_.end(),
                          [](const auto& a, const auto& b) { return a.first == b.first; }),
              aims_.end());
}

/// The cell nearest to the goal of a cell and those that are linked to it.
size_t FlowField::downhill_of(size_t cell) const {
  size_t best = cell;
  for (const ptrdiff_t next : grid_->free_neighbours(cell))
    if (next >= 0 && cells_[static_cast<size_t>(next)].distance_m < cells_[best].distance_m)
      best = static_cast<size_t>(next);
  return best;
}

const Eigen::Vector2d* FlowField::aim_at(const Eigen::Vector2d& point) const {
  return aims_.empty() ? nullptr : find_cell(aims_, grid_->cell_at(point));
}

CellPatch FlowField::patch_at(const Eigen::Vector2d& point) const {
  return {grid_->in_cells(point), grid_->columns(), grid_->rows()};
}

void FlowField::prefetch(const Eigen::Vector2d& point) const {
  // A cell and the one to its right may lie in two cache lines.
  const CellPatch patch = patch_at(point);
  for (const size_t cell : {patch.cell, patch.cell + patch.above}) {
    __builtin_prefetch(&cells_[cell]);
    __builtin_prefetch(&cells_[cell + patch.right].distance_m);
  }
}

Eigen::Vector2d FlowField::direction(const Eigen::Vector2d& point) const {
  if (const Eigen::Vector2d* aim = aim_at(point)) {
    const Eigen::Vector2d heading = *aim - point;
    const double length = heading.norm();
    if (length > 1e-3) return heading / length;
  }
  const auto at = [&](size_t cell) -> const Eigen::Vector2f& { return cells_[cell].direction; };
  Eigen::Vector2f blend = patch_at(point).blend(at);
  // Where paths part, directions cancel: the cell's own direction is used instead.
  if (!(blend.squaredNorm() > 0.01f)) blend = at(grid_->cell_at(point));
  const Eigen::Vector2d heading = blend.cast<double>();
  const double square = heading.squaredNorm();
  return square > 0 ? Eigen::Vector2d(heading / std::sqrt(square)) : Eigen::Vector2d::Zero();
}

double FlowField::distance_m(const Eigen::Vector2d& point) const {
  return static_cast<double>(cells_[grid_->cell_at(point)].distance_m);
}

bool FlowField::reaches(const Eigen::Vector2d& point) const {
  return cells_[grid_->cell_at(point)].distance_m < kFar;
}

}  // namespace throng
