// NeighbourGrid finds the nearest agents, by a uniform grid filled by counting sort.
// Invariant: the result and its order are the same on every SIMD target and thread, regardless of
// movement since the agents were sorted into cells.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/rectangle.h"
#include "base/simd.h"

namespace throng {

/// The grid as its search sees it. Slots are in the order of cells. Single precision resolves 4 mm
/// in 50 km, which suffices to choose neighbours.
struct GridView {
  const float* x = nullptr;  ///< per slot, from the middle of the ground
  const float* y = nullptr;
  const uint32_t* starts = nullptr;  ///< columns * rows + 1 entries: a cell's first slot
  int columns = 1;
  int rows = 1;
  float cell_m = 1;
  float cells_per_m = 1;
  float low_x = 0;
  float low_y = 0;
  float slack_m = 0;  ///< maximum distance of agents to their cells
};

inline int column_of(const GridView& grid, float x) {
  return std::clamp(static_cast<int>((x - grid.low_x) * grid.cells_per_m), 0, grid.columns - 1);
}
inline int row_of(const GridView& grid, float y) {
  return std::clamp(static_cast<int>((y - grid.low_y) * grid.cells_per_m), 0, grid.rows - 1);
}

class NeighbourGrid {
 public:
  /// Maximum number of neighbours per agent.
  static constexpr size_t kMaxNeighbours = 10;
  /// Vectors may read this far beyond the last slot.
  static constexpr size_t kPadding = 16;

  /// Cells are sized for `people` agents spread over the ground. Points off the ground are stored
  /// in border cells: correct, but slower.
  NeighbourGrid(const Rectangle& ground, size_t people, SimdTarget target = SimdTarget::kBest);

  /// Sorts the points into cells; allocates only if there are more than in any call before.
  /// `present` has one byte per point, or is empty. Absent agents get no slot.
  void rebuild(std::span<const Eigen::Vector2d> positions_m, std::span<const uint8_t> present = {});

  /// Moves a slot to a new position; it stays in its cell.
  void move(size_t slot, const Eigen::Vector2d& position_m) {
    const Eigen::Vector2f place = local(position_m);
    x_[slot] = place.x();
    y_[slot] = place.y();
  }
  /// Adds a point without a slot until the next rebuild(): visit_near() finds it, nearest() does
  /// not. An id may be inserted again, at another point.
  void insert(uint32_t id, const Eigen::Vector2d& position_m);
  /// Number of points that insert() takes without allocating.
  size_t free_insertions() const { return inserted_.capacity() - inserted_.size(); }
  /// Declares that no agent has moved farther than this since the latest call, or rebuild().
  /// Searches extend to as many more cells.
  void add_slack_m(double max_m) { slack_m_ += max_m; }

  /// Saves or restores cells and slack; rebuild_as_read() then sets the points.
  void archive(Archive& a);
  /// After reading: rebuilds the slots that were saved.
  void rebuild_as_read(std::span<const Eigen::Vector2d> positions_m);

  /// Ids by slot: neighbours in space are near in memory.
  std::span<const uint32_t> order() const { return order_; }
  std::span<const float> x() const { return {x_.data(), order_.size()}; }
  std::span<const float> y() const { return {y_.data(), order_.size()}; }
  /// Origin of x() and y().
  const Eigen::Vector2d& middle_m() const { return middle_m_; }

  /// Calls visit(id) for all agents within `reach_m` of a point, and for some beyond. Agents that
  /// were inserted may come twice.
  template <typename Visit>
  void visit_near(const Eigen::Vector2d& point, double reach_m, const Visit& visit) const {
    const Eigen::Vector2f place = local(point);
    const auto reach = static_cast<float>(reach_m + slack_m_) + shape_.slack_m;
    const int first = column_of(shape_, place.x() - reach);
    const int last = column_of(shape_, place.x() + reach);
    for (int r = row_of(shape_, place.y() - reach); r <= row_of(shape_, place.y() + reach); ++r) {
      const auto begin = static_cast<size_t>(r) * static_cast<size_t>(shape_.columns);
      const uint32_t end = starts_[begin + static_cast<size_t>(last) + 1];
      for (uint32_t slot = starts_[begin + static_cast<size_t>(first)]; slot < end; ++slot)
        if ((Eigen::Vector2f(x_[slot], y_[slot]) - place).squaredNorm() <= reach * reach)
          visit(order_[slot]);
      if (inserted_.empty()) continue;
      for (auto cell = begin + static_cast<size_t>(first);
           cell <= begin + static_cast<size_t>(last); ++cell)
        for (uint32_t i = latest_in_[cell]; i != kNone; i = inserted_[i].before)
          visit(inserted_[i].id);
    }
  }

  /// For each of the slots finds the nearest others within `reach_m` (at most kMaxNeighbours) as
  /// slots, ordered by (distance, slot): found[kMaxNeighbours * slot ...], counts[slot].
  /// Both arrays cover all slots. Thread-safe.
  void nearest(std::span<const uint32_t> slots, float reach_m, uint32_t* found,
               uint8_t* counts) const;

 private:
  using Search = void (*)(const GridView&, std::span<const uint32_t>, float, uint32_t*, uint8_t*);
  static constexpr uint32_t kAbsent = UINT32_MAX, kNone = UINT32_MAX;
  struct Inserted {
    uint32_t id;
    uint32_t before;  ///< index of the point inserted before it into its cell, or kNone
  };

  GridView view() const;
  size_t cell_count() const {
    return static_cast<size_t>(shape_.columns) * static_cast<size_t>(shape_.rows);
  }
  Eigen::Vector2f local(const Eigen::Vector2d& position_m) const {
    return (position_m - middle_m_).cast<float>();
  }
  size_t cell_of(const Eigen::Vector2d& position_m) const;
  void sort(std::span<const Eigen::Vector2d> positions_m);

  Eigen::Vector2d middle_m_;
  GridView shape_;  ///< without its arrays; its slack covers rounding
  double slack_m_ = 0;
  Search search_;
  std::vector<uint32_t> starts_;
  std::vector<uint32_t> cells_;  ///< per id, or kAbsent
  std::vector<uint32_t> order_;
  std::vector<float> x_, y_;
  std::vector<Inserted> inserted_;
  std::vector<uint32_t> latest_in_;  ///< per cell, index in inserted_, or kNone
};

}  // namespace throng
