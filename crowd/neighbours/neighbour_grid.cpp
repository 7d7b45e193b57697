#include "crowd/neighbours/neighbour_grid.h"

#include <cmath>

#include "base/counting_sort.h"
#include "crowd/neighbours/neighbour_search.h"

namespace throng {
namespace {

/// Nine cells then hold about thirty agents, which usually include the ten nearest of any of them.
constexpr double kCellsPerSpacing = 1.8;
constexpr double kMinCell_m = 1.0;
constexpr double kMaxCell_m = 5.0;
constexpr double kMaxCells = 1 << 20;

}  // namespace

NeighbourGrid::NeighbourGrid(const Rectangle& ground, size_t people, SimdTarget target)
    : middle_m_(0.5 * (ground.min_m + ground.max_m)) {
  const Eigen::Vector2d size = ground.size_m();
  const double spacing_m =
      std::sqrt(size.prod() / static_cast<double>(std::max<size_t>(people, 1)));
  const double cell_m = std::max(std::clamp(kCellsPerSpacing * spacing_m, kMinCell_m, kMaxCell_m),
                                 std::sqrt(size.prod() / kMaxCells));
  shape_.cell_m = static_cast<float>(cell_m);
  shape_.cells_per_m = 1 / shape_.cell_m;
  shape_.columns = std::max(1, static_cast<int>(std::ceil(size.x() / cell_m)));
  shape_.rows = std::max(1, static_cast<int>(std::ceil(size.y() / cell_m)));
  shape_.low_x = static_cast<float>(-0.5 * size.x());
  shape_.low_y = static_cast<float>(-0.5 * size.y());
  shape_.slack_m = 1e-4f + 1e-6f * static_cast<float>(size.maxCoeff());
  starts_.resize(cell_count() + 2);  // see counting_sort()
  latest_in_.resize(cell_count(), kNone);
  inserted_.reserve(people / 8);
  search_ = neighbour_search_on(target);
}

GridView NeighbourGrid::view() const {
  GridView view = shape_;
  view.x = x_.data();
  view.y = y_.data();
  view.starts = starts_.data();
  view.slack_m += static_cast<float>(slack_m_);
  return view;
}

void NeighbourGrid::rebuild(std::span<const Eigen::Vector2d> positions_m,
                            std::span<const uint8_t> present) {
  slack_m_ = 0;
  cells_.resize(positions_m.size());
  for (size_t id = 0; id < positions_m.size(); ++id) {
    cells_[id] = kAbsent;
    if (!present.empty() && present[id] == 0) continue;
    cells_[id] = static_cast<uint32_t>(cell_of(positions_m[id]));
  }
  sort(positions_m);
}

size_t NeighbourGrid::cell_of(const Eigen::Vector2d& position_m) const {
  const Eigen::Vector2f place = local(position_m);
  return static_cast<size_t>(row_of(shape_, place.y())) * static_cast<size_t>(shape_.columns) +
         static_cast<size_t>(column_of(shape_, place.x()));
}

void NeighbourGrid::insert(uint32_t id, const Eigen::Vector2d& position_m) {
  uint32_t& latest = latest_in_[cell_of(position_m)];
  inserted_.push_back({id, latest});
  latest = static_cast<uint32_t>(inserted_.size() - 1);
}

void NeighbourGrid::sort(std::span<const Eigen::Vector2d> positions_m) {
  const size_t count = cells_.size();
  if (!inserted_.empty()) std::fill(latest_in_.begin(), latest_in_.end(), kNone);
  inserted_.clear();
  // Full capacity from the start: agents that enter later must not make a step allocate.
  order_.resize(count);
  x_.resize(count + kPadding);
  y_.resize(count + kPadding);
  const size_t cells = cell_count();
  counting_sort(
      cells, starts_.data(),
      [&](const auto& visit) {
        for (size_t id = 0; id < count; ++id)
          if (cells_[id] != kAbsent) visit(id);
      },
      [&](size_t id) { return cells_[id]; },
      [&](size_t id, uint32_t slot) {
        order_[slot] = static_cast<uint32_t>(id);
        move(slot, positions_m[id]);
      });
  order_.resize(starts_[cells]);
}

/// Comparisons are negated to reject NaN as well.
void NeighbourGrid::archive(Archive& a) {
  a(cells_, slack_m_);
  if (!a.is_reading()) return;
  for (const uint32_t cell : cells_)
    if (cell != kAbsent && cell >= cell_count()) a.reject("a cell of the ground", "another cell");
  if (!(slack_m_ >= 0)) a.reject("a displacement of at least 0 m", "another value");
}

void NeighbourGrid::rebuild_as_read(std::span<const Eigen::Vector2d> positions_m) {
  sort(positions_m);
}

void NeighbourGrid::nearest(std::span<const uint32_t> slots, float reach_m, uint32_t* found,
                            uint8_t* counts) const {
  search_(view(), slots, reach_m, found, counts);
}

void nearest_scalar(const GridView& grid, std::span<const uint32_t> slots, float reach_m,
                    uint32_t* found, uint8_t* counts) {
  struct Candidate {
    float square_m2;
    uint32_t slot;
  };
  constexpr size_t kMaxNeighbours = NeighbourGrid::kMaxNeighbours;
  for (const uint32_t own : slots) {
    const Rings rings(grid, own);
    Candidate best[kMaxNeighbours];
    size_t count = 0;
    for (int ring = 1;; ++ring) {
      const float covered_m = rings.covered_m(ring, reach_m);
      count = 0;
      rings.for_rows(ring, [&](uint32_t first, uint32_t last) {
        for (uint32_t slot = first; slot < last; ++slot) {
          const float dx = grid.x[slot] - grid.x[own];
          const float dy = grid.y[slot] - grid.y[own];
          const float square_m2 = dx * dx + dy * dy;
          if (slot == own || square_m2 > covered_m * covered_m) continue;
          // Slots come in ascending order: of equal distances the earlier slot stays ahead.
          if (count == kMaxNeighbours && !(square_m2 < best[kMaxNeighbours - 1].square_m2))
            continue;
          size_t place = count < kMaxNeighbours ? count++ : kMaxNeighbours - 1;
          for (; place > 0 && square_m2 < best[place - 1].square_m2; --place)
            best[place] = best[place - 1];
          best[place] = {square_m2, slot};
        }
      });
      if (count == kMaxNeighbours || !(covered_m < reach_m)) break;
    }
    counts[own] = static_cast<uint8_t>(count);
    for (size_t k = 0; k < count; ++k) found[kMaxNeighbours * size_t{own} + k] = best[k].slot;
  }
}

}  // namespace throng
