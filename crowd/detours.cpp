#include "crowd/detours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

constexpr double kMinCell_m = 2;
/// A field of this many cells takes two milliseconds.
constexpr int kMaxCells = 1 << 14;
constexpr float kNoPath_m = std::numeric_limits<float>::infinity();
/// Flow field cells whose distances differ by more have a closed door between them.
constexpr float kJump_m = static_cast<float>(FlowField::kClosed_m) / 2;
/// A detoured direction keeps at least this share of the original one.
constexpr double kMinForwardShare = 0.15;

/// Below this share of the desired speed an agent counts as standing.
constexpr float kMinRelativeSpeed = 0.15f;

/// Index into CellDensity: the eighth of the circle that an agent walks into, or last if it stands.
size_t bin_of(const Eigen::Vector2f& relative_velocity) {
  if (relative_velocity.squaredNorm() < kMinRelativeSpeed * kMinRelativeSpeed) return 8;
  const bool is_steep = std::abs(relative_velocity.y()) > std::abs(relative_velocity.x());
  return (relative_velocity.x() < 0 ? 4u : 0u) + (relative_velocity.y() < 0 ? 2u : 0u) +
         (is_steep ? 1u : 0u);
}

float density_ramp(double from, double to, float per_m2) {
  return static_cast<float>(tuning::ramp(from, to, static_cast<double>(per_m2)));
}

/// As in FlowField: the quadratic of the upwind scheme.
float eikonal(float x, float y, float step_m) {
  const float low = std::min(x, y), gap = std::max(x, y) - low;
  if (gap >= step_m) return low + step_m;
  return low + 0.5f * (gap + std::sqrt(2 * step_m * step_m - gap * gap));
}

}  // namespace

Detours::Detours(const NavigationMap& map, Workers& workers)
    : map_(map), marches_(static_cast<size_t>(workers.threads())) {
  const FlowGrid& grid = map.grid();
  merge_factor_ = std::max(1, static_cast<int>(std::lround(kMinCell_m / grid.cell_m())));
  const auto merged = [&](int cells) { return (cells + merge_factor_ - 1) / merge_factor_; };
  while (merged(grid.columns()) * merged(grid.rows()) > kMaxCells) ++merge_factor_;
  columns_ = merged(grid.columns());
  rows_ = merged(grid.rows());
  cell_m_ = merge_factor_ * grid.cell_m();
  cells_per_m_ = 1 / cell_m_;
  const auto cells = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
  free_area_m2_.resize(cells);
  for (size_t cell = 0; cell < grid.cell_count(); ++cell)
    if (grid.is_free(cell))
      free_area_m2_[coarse_of(cell)] += static_cast<float>(grid.cell_m() * grid.cell_m());
  counted_.resize(cells);
  present_.resize(cells);
  per_m2_.resize(cells);
  dense_.resize(cells);
  fields_.resize(map.field_count());
  for (DetourField& detour : fields_) {
    detour.links.resize(cells);
    detour.free_m.resize(cells);
    detour.along.resize(cells);
    detour.slopes.assign(cells, Eigen::Vector2f::Zero());
  }
  for (MarchBuffers& march : marches_) {
    march.distance_m.resize(cells);
    march.queue.reserve(4 * cells);  // each cell once from each side
  }
  find_cells(workers);
}

void Detours::archive(Archive& a) {
  a(present_);
  for (DetourField& detour : fields_) {
    a(detour.is_detoured);
    if (detour.is_detoured) a(detour.slopes);
  }
  if (!a.is_reading()) return;
  find_dense();
  // Negated to reject NaN as well.
  for (const CellDensity& present : present_)
    for (const DirectionBin& bin : present) {
      if (!(bin.people >= 0 && bin.people < kNoPath_m))
        a.reject("a number of agents per cell", "another value");
      if (!(bin.velocity_sum.norm() < kNoPath_m)) a.reject("a sum of velocities", "another value");
    }
  for (const DetourField& detour : fields_)
    for (const Eigen::Vector2f& slope : detour.slopes)
      if (!(slope.norm() < kNoPath_m)) a.reject("a slope of the delay", "another value");
}

void Detours::clear_counts() { std::fill(counted_.begin(), counted_.end(), CellDensity{}); }

CellPatch Detours::patch_at(const Eigen::Vector2d& place_m) const {
  return {cells_per_m_ * (place_m - map_.grid().origin_m()), columns_, rows_};
}

/// Distributes an agent over the four cells around; only cells with free area take part.
void Detours::count(const AgentSample& agent) {
  const CellPatch p = patch_at(agent.place_m);
  const size_t cells[] = {p.cell, p.cell + p.right, p.cell + p.above, p.cell + p.above + p.right};
  float shares[] = {(1 - p.fx) * (1 - p.fy), p.fx * (1 - p.fy), (1 - p.fx) * p.fy, p.fx * p.fy};
  float sum = 0;
  for (int i = 0; i < 4; ++i) sum += shares[i] *= free_area_m2_[cells[i]];
  if (!(sum > 0)) return;
  const Eigen::Vector2f relative_velocity = agent.relative_velocity.cast<float>();
  const size_t bin = bin_of(relative_velocity);
  for (int i = 0; i < 4; ++i) {
    counted_[cells[i]][bin].people += shares[i] / sum;
    counted_[cells[i]][bin].velocity_sum += shares[i] / sum * relative_velocity;
  }
}

void Detours::smooth_counts() {
  constexpr auto share = static_cast<float>(tuning::kDensityUpdateShare);
  for (size_t cell = 0; cell < cell_count(); ++cell)
    for (size_t k = 0; k < present_[cell].size(); ++k) {
      const DirectionBin& counted = counted_[cell][k];
      DirectionBin& smoothed = present_[cell][k];
      smoothed.people += share * (counted.people - smoothed.people);
      smoothed.velocity_sum += share * (counted.velocity_sum - smoothed.velocity_sum);
    }
  find_dense();
}

void Detours::find_dense() {
  is_dense_ = false;
  for (size_t cell = 0; cell < cell_count(); ++cell) {
    float people = 0;
    for (const DirectionBin& bin : present_[cell]) people += bin.people;
    per_m2_[cell] = people > 0 ? people / free_area_m2_[cell] : 0;
    dense_[cell] = density_ramp(tuning::kSlowFrom_per_m2, tuning::kSlowTo_per_m2, per_m2_[cell]);
    is_dense_ = is_dense_ || dense_[cell] > 0;
  }
}

/// Returns the speed, as a share of the desired one, at which agents make progress along
/// `direction` in a cell; 0 if all come the other way.
/// Standing agents count, oncoming ones only in dense crowds, where they leave no room. Otherwise
/// two streams in a corridor would turn into the walls.
float Detours::relative_speed_along(const Eigen::Vector2f& direction, size_t cell) const {
  const float blocks =
      density_ramp(tuning::kBlockedFrom_per_m2, tuning::kBlockedTo_per_m2, per_m2_[cell]);
  float people = 0, relative_velocity = 0;
  for (size_t k = 0; k < present_[cell].size(); ++k) {
    const DirectionBin& bin = present_[cell][k];
    const float along = direction.dot(bin.velocity_sum);
    const bool stands = k + 1 == present_[cell].size();
    people += (along < 0 && !stands ? blocks : 1) * bin.people;
    relative_velocity += std::max(along, 0.0f);
  }
  return people > 0 ? relative_velocity / people : 0;
}

/// Time to walk a metre relative to an empty scene.
float Detours::slowness(const DetourField& detour, size_t cell) const {
  if (dense_[cell] == 0) return 1;
  const float relative_velocity = relative_speed_along(detour.along[cell], cell);
  return 1 + dense_[cell] * (1 / std::clamp(relative_velocity,
                                            static_cast<float>(tuning::kMinRelativeSpeed), 1.0f) -
                             1);
}

void Detours::update_fields(uint64_t turn, Workers& workers) {
  if (revision_ != map_.revision()) find_cells(workers);
  const auto due = (fields_.size() + kRound - 1 - turn) / kRound;
  workers.for_blocks(static_cast<int>(due), [&](int block, int worker) {
    find_slopes(turn + kRound * static_cast<size_t>(block), marches_[static_cast<size_t>(worker)]);
  });
}

/// Called again after doors have opened or closed.
void Detours::find_cells(Workers& workers) {
  revision_ = map_.revision();
  workers.for_blocks(static_cast<int>(fields_.size()), [&](int block, int worker) {
    const FlowField& field = map_.field(static_cast<size_t>(block));
    DetourField& detour = fields_[static_cast<size_t>(block)];
    MarchBuffers& march = marches_[static_cast<size_t>(worker)];
    link(field, detour);
    this->march(detour, true, march);
    for (size_t cell = 0; cell < cell_count(); ++cell)
      detour.free_m[cell] = march.distance_m[cell] < kNoPath_m ? march.distance_m[cell] : -1;
    for (size_t cell = 0; cell < cell_count(); ++cell) {
      const Eigen::Vector2f up = slope(detour, detour.free_m, cell);
      detour.along[cell] = up.isZero() ? up : Eigen::Vector2f(-up.normalized());
    }
  });
}

/// Index of the coarse cell that contains a flow field cell.
size_t Detours::coarse_of(size_t cell) const {
  const auto columns = static_cast<size_t>(map_.grid().columns());
  const auto merged = static_cast<size_t>(merge_factor_);
  return cell / columns / merged * static_cast<size_t>(columns_) + cell % columns / merged;
}

/// Returns whether a path leads from a flow field cell to the next without crossing a closed door.
bool Detours::is_linked(const FlowField& field, size_t from, ptrdiff_t to) {
  if (to < 0) return false;
  const float here_m = field.cell_distance_m(from);
  const float there_m = field.cell_distance_m(static_cast<size_t>(to));
  return here_m < kNoPath_m && there_m < kNoPath_m && std::abs(here_m - there_m) < kJump_m;
}

/// Returns for each flow field cell whether its coarse cell represents it. A coarse cell divided by
/// a wall represents its larger part: no path then leads through the wall.
std::vector<uint8_t> Detours::parts_of(const FlowField& field) const {
  const FlowGrid& grid = map_.grid();
  std::vector<uint32_t> part_of(grid.cell_count());  // numbered from 1; 0: none
  struct LargestPart {
    uint32_t part = 0;
    size_t cells = 0;
  };
  std::vector<LargestPart> largest(cell_count());
  std::vector<size_t> part;
  uint32_t parts = 0;
  for (size_t first = 0; first < part_of.size(); ++first) {
    if (part_of[first] != 0 || !(field.cell_distance_m(first) < kNoPath_m)) continue;
    const size_t own = coarse_of(first);
    part_of[first] = ++parts;
    part.assign(1, first);
    for (size_t i = 0; i < part.size(); ++i)
      for (const ptrdiff_t next : grid.free_neighbours(part[i])) {
        if (!is_linked(field, part[i], next)) continue;
        const auto cell = static_cast<size_t>(next);
        if (part_of[cell] != 0 || coarse_of(cell) != own) continue;
        part_of[cell] = parts;
        part.push_back(cell);
      }
    if (part.size() > largest[own].cells) largest[own] = {parts, part.size()};
  }
  std::vector<uint8_t> is_part(part_of.size());
  for (size_t cell = 0; cell < is_part.size(); ++cell)
    is_part[cell] = part_of[cell] != 0 && part_of[cell] == largest[coarse_of(cell)].part;
  return is_part;
}

/// Finds the links between coarse cells, and the cells of the goal.
void Detours::link(const FlowField& field, DetourField& detour) const {
  const FlowGrid& grid = map_.grid();
  const std::vector<uint8_t> is_part = parts_of(field);
  std::fill(detour.links.begin(), detour.links.end(), uint8_t{0});
  detour.ends.clear();
  for (size_t cell = 0; cell < is_part.size(); ++cell) {
    const size_t own = coarse_of(cell);
    if (static_cast<double>(field.cell_distance_m(cell)) <= 0.71 * grid.cell_m())
      detour.ends.push_back(static_cast<uint32_t>(own));
    if (!is_part[cell]) continue;
    const auto around = grid.free_neighbours(cell);
    for (const unsigned side : {1u, 3u}) {
      if (!is_linked(field, cell, around[side])) continue;
      const auto next = static_cast<size_t>(around[side]);
      const size_t other = coarse_of(next);
      if (!is_part[next] || other == own) continue;
      detour.links[own] = static_cast<uint8_t>(detour.links[own] | (1u << side));
      detour.links[other] = static_cast<uint8_t>(detour.links[other] | (1u << (side - 1)));
    }
  }
  std::sort(detour.ends.begin(), detour.ends.end());
  detour.ends.erase(std::unique(detour.ends.begin(), detour.ends.end()), detour.ends.end());
}

/// Computes travel distances by fast marching (Sethian 1996).
void Detours::march(const DetourField& detour, bool is_empty, MarchBuffers& march) const {
  auto& queue = march.queue;
  std::vector<float>& distance_m = march.distance_m;
  std::fill(distance_m.begin(), distance_m.end(), kNoPath_m);
  queue.clear();
  const auto push = [&](float found_m, size_t cell) {
    distance_m[cell] = found_m;
    queue.emplace_back(found_m, static_cast<uint32_t>(cell));
    std::push_heap(queue.begin(), queue.end(), std::greater<>());
  };
  for (const uint32_t cell : detour.ends) push(0, cell);
  const std::array<ptrdiff_t, 4> steps = {-1, 1, -static_cast<ptrdiff_t>(columns_),
                                          static_cast<ptrdiff_t>(columns_)};
  const auto neighbour_of = [&](size_t cell, unsigned side) {
    return static_cast<size_t>(static_cast<ptrdiff_t>(cell) + steps[side]);
  };
  const auto value = [&](size_t cell, unsigned side) {
    return (detour.links[cell] >> side & 1u) != 0 ? distance_m[neighbour_of(cell, side)]
                                                  : kNoPath_m;
  };
  while (!queue.empty()) {
    const auto [reached_m, cell] = queue.front();
    std::pop_heap(queue.begin(), queue.end(), std::greater<>());
    queue.pop_back();
    if (reached_m > distance_m[cell]) continue;
    for (unsigned side = 0; side < 4; ++side) {
      if ((detour.links[cell] >> side & 1u) == 0) continue;
      const size_t next = neighbour_of(cell, side);
      const float step_m = static_cast<float>(cell_m_) * (is_empty ? 1 : slowness(detour, next));
      const float found_m = eikonal(std::min(value(next, 0), value(next, 1)),
                                    std::min(value(next, 2), value(next, 3)), step_m);
      if (found_m < distance_m[next]) push(found_m, next);
    }
  }
}

/// Slope of the delay: the travel distance minus that of an empty scene.
void Detours::find_slopes(size_t index, MarchBuffers& march) {
  DetourField& detour = fields_[index];
  if (!is_dense_) {
    if (detour.is_detoured)
      std::fill(detour.slopes.begin(), detour.slopes.end(), Eigen::Vector2f::Zero());
    detour.is_detoured = false;
    return;
  }
  this->march(detour, false, march);
  std::vector<float>& delay_m = march.distance_m;
  for (size_t cell = 0; cell < cell_count(); ++cell)
    delay_m[cell] = detour.free_m[cell] >= 0 ? delay_m[cell] - detour.free_m[cell] : 0;
  detour.is_detoured = true;
  for (size_t cell = 0; cell < cell_count(); ++cell)
    detour.slopes[cell] = (1 - dense_[cell]) * slope(detour, delay_m, cell);
}

/// Central difference between linked cells on both sides, or one-sided.
Eigen::Vector2f Detours::slope(const DetourField& detour, std::span<const float> height_m,
                               size_t cell) const {
  const auto along = [&](unsigned low_side, size_t step) {
    const bool low = (detour.links[cell] >> low_side & 1u) != 0;
    const bool high = (detour.links[cell] >> (low_side + 1) & 1u) != 0;
    if (!low && !high) return 0.0f;
    const float rise_m = height_m[high ? cell + step : cell] - height_m[low ? cell - step : cell];
    return rise_m / static_cast<float>((low && high ? 2 : 1) * cell_m_);
  };
  return {along(0, 1), along(2, static_cast<size_t>(columns_))};
}

void Detours::prefetch(size_t number, const Eigen::Vector2d& place_m) const {
  const CellPatch patch = patch_at(place_m);
  const std::vector<Eigen::Vector2f>& slopes = fields_[number].slopes;
  __builtin_prefetch(&slopes[patch.cell]);
  __builtin_prefetch(&slopes[patch.cell + patch.above]);
}

Eigen::Vector2d Detours::detoured_direction(size_t number, const Eigen::Vector2d& place_m,
                                            const Eigen::Vector2d& along,
                                            double delay_weight) const {
  if (!is_detoured(number)) return along;
  const Eigen::Vector2f slope =
      patch_at(place_m).blend([&slopes = fields_[number].slopes](
                                  size_t cell) -> const Eigen::Vector2f& { return slopes[cell]; });
  if (slope == Eigen::Vector2f::Zero()) return along;
  const Eigen::Vector2d left(-along.y(), along.x());
  const Eigen::Vector2d steep = delay_weight * slope.cast<double>();
  const double forward_share = std::max(1 - steep.dot(along), kMinForwardShare);
  return (forward_share * along - steep.dot(left) * left).normalized();
}

}  // namespace throng
