#include "crowd/detours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "crowd/crowd_tuning.h"

namespace throng {
namespace {

constexpr double kFinest_m = 2;
/// A way of that many cells takes two milliseconds.
constexpr int kMostCells = 1 << 14;
constexpr float kNoWay_m = std::numeric_limits<float>::infinity();
/// Cells of a flow field whose distances differ by more have a closed door between them.
constexpr float kJump_m = static_cast<float>(FlowField::kClosed_m) / 2;
/// A way that is bent keeps at least this share of its own direction.
constexpr double kKeeps = 0.15;

/// Slower than this share of the free speed a person stands.
constexpr float kStands = 0.15f;

/// Of Present: the eighth of the circle that somebody walks into, or the last.
size_t heading_of(const Eigen::Vector2f& pace) {
  if (pace.squaredNorm() < kStands * kStands) return 8;
  const bool is_steep = std::abs(pace.y()) > std::abs(pace.x());
  return (pace.x() < 0 ? 4u : 0u) + (pace.y() < 0 ? 2u : 0u) + (is_steep ? 1u : 0u);
}

/// What grows between two densities: 0 up to `from`, 1 from `to` on.
float grown(double from, double to, float per_m2) {
  return static_cast<float>(tuning::share_between(from, to, static_cast<double>(per_m2)));
}

/// As FlowField's: the upwind scheme's quadratic.
float eikonal(float x, float y, float step_m) {
  const float low = std::min(x, y), gap = std::max(x, y) - low;
  if (gap >= step_m) return low + step_m;
  return low + 0.5f * (gap + std::sqrt(2 * step_m * step_m - gap * gap));
}

}  // namespace

Detours::Detours(const Ways& ways, Workers& workers)
    : all_(ways), marches_(static_cast<size_t>(workers.threads())) {
  const FlowGrid& grid = ways.grid();
  merged_ = std::max(1, static_cast<int>(std::lround(kFinest_m / grid.cell_m())));
  const auto merged = [&](int cells) { return (cells + merged_ - 1) / merged_; };
  while (merged(grid.columns()) * merged(grid.rows()) > kMostCells) ++merged_;
  columns_ = merged(grid.columns());
  rows_ = merged(grid.rows());
  cell_m_ = merged_ * grid.cell_m();
  cells_per_m_ = 1 / cell_m_;
  const auto cells = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
  room_m2_.resize(cells);
  for (size_t cell = 0; cell < grid.cell_count(); ++cell)
    if (grid.is_free(cell))
      room_m2_[coarse_of(cell)] += static_cast<float>(grid.cell_m() * grid.cell_m());
  counted_.resize(cells);
  present_.resize(cells);
  per_m2_.resize(cells);
  dense_.resize(cells);
  ways_.resize(ways.way_count());
  for (BentWay& way : ways_) {
    way.links.resize(cells);
    way.free_m.resize(cells);
    way.along.resize(cells);
    way.slopes.assign(cells, Eigen::Vector2f::Zero());
  }
  for (March& march : marches_) {
    march.distance_m.resize(cells);
    march.queue.reserve(4 * cells);  // each cell once from each side
  }
  find_cells(workers);
}

void Detours::archive(Archive& a) {
  a(present_);
  for (BentWay& way : ways_) {
    a(way.is_bent);
    if (way.is_bent) a(way.slopes);
  }
  if (!a.is_reading()) return;
  find_dense();
  // Written so that NaN is refused, too.
  for (const Present& present : present_)
    for (const Heading& heading : present) {
      if (!(heading.people >= 0 && heading.people < kNoWay_m))
        a.refuse("so many people in a cell", "others");
      if (!(heading.paces.norm() < kNoWay_m)) a.refuse("how fast people get on", "another");
    }
  for (const BentWay& way : ways_)
    for (const Eigen::Vector2f& slope : way.slopes)
      if (!(slope.norm() < kNoWay_m)) a.refuse("the slope of a delay", "another");
}

void Detours::clear_counts() { std::fill(counted_.begin(), counted_.end(), Present{}); }

CellPatch Detours::patch_at(const Eigen::Vector2d& place_m) const {
  return {cells_per_m_ * (place_m - all_.grid().origin_m()), columns_, rows_};
}

/// Shared out among the four cells around, of which those with room take part.
void Detours::count(const Walker& walker) {
  const CellPatch p = patch_at(walker.place_m);
  const size_t cells[] = {p.cell, p.cell + p.right, p.cell + p.above, p.cell + p.above + p.right};
  float shares[] = {(1 - p.fx) * (1 - p.fy), p.fx * (1 - p.fy), (1 - p.fx) * p.fy, p.fx * p.fy};
  float sum = 0;
  for (int i = 0; i < 4; ++i) sum += shares[i] *= room_m2_[cells[i]];
  if (!(sum > 0)) return;
  const Eigen::Vector2f pace = walker.pace.cast<float>();
  const size_t heading = heading_of(pace);
  for (int i = 0; i < 4; ++i) {
    counted_[cells[i]][heading].people += shares[i] / sum;
    counted_[cells[i]][heading].paces += shares[i] / sum * pace;
  }
}

void Detours::take_counts() {
  constexpr auto share = static_cast<float>(tuning::kCrowdingNew);
  for (size_t cell = 0; cell < cell_count(); ++cell)
    for (size_t k = 0; k < present_[cell].size(); ++k) {
      const Heading& counted = counted_[cell][k];
      Heading& smoothed = present_[cell][k];
      smoothed.people += share * (counted.people - smoothed.people);
      smoothed.paces += share * (counted.paces - smoothed.paces);
    }
  find_dense();
}

void Detours::find_dense() {
  is_dense_ = false;
  for (size_t cell = 0; cell < cell_count(); ++cell) {
    float people = 0;
    for (const Heading& heading : present_[cell]) people += heading.people;
    per_m2_[cell] = people > 0 ? people / room_m2_[cell] : 0;
    dense_[cell] = grown(tuning::kSlowFrom_per_m2, tuning::kSlowTo_per_m2, per_m2_[cell]);
    is_dense_ = is_dense_ || dense_[cell] > 0;
  }
}

/// The share of the free speed at which those get on along a way who walk it or stand; 0 where all
/// come towards one. Where some walk it, those who come do not count: two streams in one corridor
/// would each seem to stand to the other, and ways would bend into the walls. But the denser it is,
/// the less is there a way through them, and they count as those who stand.
float Detours::pace_along(const Eigen::Vector2f& way, size_t cell) const {
  const float blocks = grown(tuning::kBlockedFrom_per_m2, tuning::kBlockedTo_per_m2, per_m2_[cell]);
  float people = 0, pace = 0;
  for (size_t k = 0; k < present_[cell].size(); ++k) {
    const Heading& heading = present_[cell][k];
    const float along = way.dot(heading.paces);
    const bool stands = k + 1 == present_[cell].size();
    people += (along < 0 && !stands ? blocks : 1) * heading.people;
    pace += std::max(along, 0.0f);
  }
  return people > 0 ? pace / people : 0;
}

/// How much longer than in the open a metre of a way takes.
float Detours::slowness(const BentWay& way, size_t cell) const {
  if (dense_[cell] == 0) return 1;
  const float pace = pace_along(way.along[cell], cell);
  return 1 + dense_[cell] * (1 / std::clamp(pace, static_cast<float>(tuning::kSlowest), 1.0f) - 1);
}

void Detours::update_ways(uint64_t turn, Workers& workers) {
  if (revision_ != all_.revision()) find_cells(workers);
  const auto due = (ways_.size() + kRound - 1 - turn) / kRound;
  workers.for_blocks(static_cast<int>(due), [&](int block, int worker) {
    find_slopes(turn + kRound * static_cast<size_t>(block), marches_[static_cast<size_t>(worker)]);
  });
}

/// Anew once doors have opened or closed.
void Detours::find_cells(Workers& workers) {
  revision_ = all_.revision();
  workers.for_blocks(static_cast<int>(ways_.size()), [&](int block, int worker) {
    const FlowField& field = all_.way(static_cast<size_t>(block));
    BentWay& way = ways_[static_cast<size_t>(block)];
    March& march = marches_[static_cast<size_t>(worker)];
    link(field, way);
    this->march(way, true, march);
    for (size_t cell = 0; cell < cell_count(); ++cell)
      way.free_m[cell] = march.distance_m[cell] < kNoWay_m ? march.distance_m[cell] : -1;
    for (size_t cell = 0; cell < cell_count(); ++cell) {
      const Eigen::Vector2f up = slope(way, way.free_m, cell);
      way.along[cell] = up.isZero() ? up : Eigen::Vector2f(-up.normalized());
    }
  });
}

/// The cell of ours that one of the flow field lies in.
size_t Detours::coarse_of(size_t cell) const {
  const auto columns = static_cast<size_t>(all_.grid().columns());
  const auto merged = static_cast<size_t>(merged_);
  return cell / columns / merged * static_cast<size_t>(columns_) + cell % columns / merged;
}

/// True if a way leads from a cell of a flow field to the next, through no closed door.
bool Detours::leads(const FlowField& field, size_t from, ptrdiff_t to) {
  if (to < 0) return false;
  const float here_m = field.cell_distance_m(from);
  const float there_m = field.cell_distance_m(static_cast<size_t>(to));
  return here_m < kNoWay_m && there_m < kNoWay_m && std::abs(here_m - there_m) < kJump_m;
}

/// By cell of the flow field, whether a cell of ours stands for it. A wall may divide one of ours:
/// then that stands for the larger part, so that no way leads through the wall.
std::vector<uint8_t> Detours::parts_of(const FlowField& field) const {
  const FlowGrid& grid = all_.grid();
  std::vector<uint32_t> part_of(grid.cell_count());  // numbered from 1 on; 0: none
  struct Largest {
    uint32_t part = 0;
    size_t cells = 0;
  };
  std::vector<Largest> largest(cell_count());
  std::vector<size_t> part;
  uint32_t parts = 0;
  for (size_t first = 0; first < part_of.size(); ++first) {
    if (part_of[first] != 0 || !(field.cell_distance_m(first) < kNoWay_m)) continue;
    const size_t own = coarse_of(first);
    part_of[first] = ++parts;
    part.assign(1, first);
    for (size_t i = 0; i < part.size(); ++i)
      for (const ptrdiff_t next : grid.ways_from(part[i])) {
        if (!leads(field, part[i], next)) continue;
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

/// Which cells a way leads between, and where it ends.
void Detours::link(const FlowField& field, BentWay& way) const {
  const FlowGrid& grid = all_.grid();
  const std::vector<uint8_t> is_part = parts_of(field);
  std::fill(way.links.begin(), way.links.end(), uint8_t{0});
  way.ends.clear();
  for (size_t cell = 0; cell < is_part.size(); ++cell) {
    const size_t own = coarse_of(cell);
    if (static_cast<double>(field.cell_distance_m(cell)) <= 0.71 * grid.cell_m())
      way.ends.push_back(static_cast<uint32_t>(own));
    if (!is_part[cell]) continue;
    const auto around = grid.ways_from(cell);
    for (const unsigned side : {1u, 3u}) {
      if (!leads(field, cell, around[side])) continue;
      const auto next = static_cast<size_t>(around[side]);
      const size_t other = coarse_of(next);
      if (!is_part[next] || other == own) continue;
      way.links[own] = static_cast<uint8_t>(way.links[own] | (1u << side));
      way.links[other] = static_cast<uint8_t>(way.links[other] | (1u << (side - 1)));
    }
  }
  std::sort(way.ends.begin(), way.ends.end());
  way.ends.erase(std::unique(way.ends.begin(), way.ends.end()), way.ends.end());
}

/// By fast marching.
void Detours::march(const BentWay& way, bool is_empty, March& march) const {
  auto& queue = march.queue;
  std::vector<float>& distance_m = march.distance_m;
  std::fill(distance_m.begin(), distance_m.end(), kNoWay_m);
  queue.clear();
  const auto push = [&](float found_m, size_t cell) {
    distance_m[cell] = found_m;
    queue.emplace_back(found_m, static_cast<uint32_t>(cell));
    std::push_heap(queue.begin(), queue.end(), std::greater<>());
  };
  for (const uint32_t cell : way.ends) push(0, cell);
  const std::array<ptrdiff_t, 4> steps = {-1, 1, -static_cast<ptrdiff_t>(columns_),
                                          static_cast<ptrdiff_t>(columns_)};
  const auto beside = [&](size_t cell, unsigned side) {
    return static_cast<size_t>(static_cast<ptrdiff_t>(cell) + steps[side]);
  };
  const auto value = [&](size_t cell, unsigned side) {
    return (way.links[cell] >> side & 1u) != 0 ? distance_m[beside(cell, side)] : kNoWay_m;
  };
  while (!queue.empty()) {
    const auto [reached_m, cell] = queue.front();
    std::pop_heap(queue.begin(), queue.end(), std::greater<>());
    queue.pop_back();
    if (reached_m > distance_m[cell]) continue;
    for (unsigned side = 0; side < 4; ++side) {
      if ((way.links[cell] >> side & 1u) == 0) continue;
      const size_t next = beside(cell, side);
      const float step_m = static_cast<float>(cell_m_) * (is_empty ? 1 : slowness(way, next));
      const float found_m = eikonal(std::min(value(next, 0), value(next, 1)),
                                    std::min(value(next, 2), value(next, 3)), step_m);
      if (found_m < distance_m[next]) push(found_m, next);
    }
  }
}

/// Of the delay: how much longer the way is than as if nobody were there.
void Detours::find_slopes(size_t index, March& march) {
  BentWay& way = ways_[index];
  if (!is_dense_) {
    if (way.is_bent) std::fill(way.slopes.begin(), way.slopes.end(), Eigen::Vector2f::Zero());
    way.is_bent = false;
    return;
  }
  this->march(way, false, march);
  std::vector<float>& delay_m = march.distance_m;
  for (size_t cell = 0; cell < cell_count(); ++cell)
    delay_m[cell] = way.free_m[cell] >= 0 ? delay_m[cell] - way.free_m[cell] : 0;
  way.is_bent = true;
  for (size_t cell = 0; cell < cell_count(); ++cell)
    way.slopes[cell] = (1 - dense_[cell]) * slope(way, delay_m, cell);
}

/// Between the cells on both sides that a way leads to, or from the cell to one of them.
Eigen::Vector2f Detours::slope(const BentWay& way, std::span<const float> height_m,
                               size_t cell) const {
  const auto along = [&](unsigned low_side, size_t step) {
    const bool low = (way.links[cell] >> low_side & 1u) != 0;
    const bool high = (way.links[cell] >> (low_side + 1) & 1u) != 0;
    if (!low && !high) return 0.0f;
    const float rise_m = height_m[high ? cell + step : cell] - height_m[low ? cell - step : cell];
    return rise_m / static_cast<float>((low && high ? 2 : 1) * cell_m_);
  };
  return {along(0, 1), along(2, static_cast<size_t>(columns_))};
}

void Detours::prefetch(size_t way, const Eigen::Vector2d& place_m) const {
  const CellPatch patch = patch_at(place_m);
  const std::vector<Eigen::Vector2f>& slopes = ways_[way].slopes;
  __builtin_prefetch(&slopes[patch.cell]);
  __builtin_prefetch(&slopes[patch.cell + patch.above]);
}

Eigen::Vector2d Detours::bend(size_t way, const Eigen::Vector2d& place_m,
                              const Eigen::Vector2d& along, double minds) const {
  if (!is_bent(way)) return along;
  const Eigen::Vector2f slope =
      patch_at(place_m).blend([&slopes = ways_[way].slopes](size_t cell) -> const Eigen::Vector2f& {
        return slopes[cell];
      });
  if (slope == Eigen::Vector2f::Zero()) return along;
  const Eigen::Vector2d left(-along.y(), along.x());
  const Eigen::Vector2d steep = minds * slope.cast<double>();
  const double keeps = std::max(1 - steep.dot(along), kKeeps);
  return (keeps * along - steep.dot(left) * left).normalized();
}

}  // namespace throng
