// Neighbours: which people stand near each other, by a uniform grid filled by counting sort.
// One rule: the nearest others are the same, in the same order, on every SIMD target and thread,
// and however far people have walked since they were sorted into cells.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/rectangle.h"
#include "base/simd.h"

namespace throng {

/// The grid as its search sees it. A slot is a place in the order of cells; single precision holds
/// a place to 4 mm in 50 km, which is near enough to decide who is in the way.
struct GridView {
  const float* x = nullptr;  ///< by slot, from the middle of the ground
  const float* y = nullptr;
  const uint32_t* starts = nullptr;  ///< columns * rows + 1 entries: a cell's first slot
  int columns = 1;
  int rows = 1;
  float cell_m = 1;
  float cells_per_m = 1;
  float low_x = 0;
  float low_y = 0;
  float slack_m = 0;  ///< how far outside of their cells people may be
};

class NeighbourGrid {
 public:
  /// How many others are looked up, at most.
  static constexpr size_t kMaxNeighbours = 10;
  /// Vectors may read this far beyond the last slot.
  static constexpr size_t kPadding = 16;

  /// Cells are as wide as `people` spread over the ground need. Points outside the ground are kept
  /// in its border cells: nothing is lost, only slower.
  NeighbourGrid(const Rectangle& ground, size_t people, SimdTarget target = SimdTarget::kBest);

  /// Sorts the points into cells; allocates only if there are more than ever before. Whoever is not
  /// `present` (one byte a point; empty: everybody is) gets no slot.
  void rebuild(std::span<const Eigen::Vector2d> positions_m, std::span<const uint8_t> present = {});

  /// From now on that slot is there; it stays in its cell.
  void move(size_t slot, const Eigen::Vector2d& position_m) {
    const Eigen::Vector2f place = local(position_m);
    x_[slot] = place.x();
    y_[slot] = place.y();
  }
  /// Nobody has moved farther than this since the latest call, or rebuild(). Whoever searches next
  /// looks into so much more of the cells around.
  void add_slack_m(double max_m) { slack_m_ += max_m; }

  /// Cells and slack; the points are found again by rebuild_as_read().
  void archive(Archive& a);
  /// After reading: the slots are those that were written.
  void rebuild_as_read(std::span<const Eigen::Vector2d> positions_m);

  /// Ids by slot: neighbours in space lie near in memory.
  std::span<const uint32_t> order() const { return order_; }
  std::span<const float> x() const { return {x_.data(), order_.size()}; }
  std::span<const float> y() const { return {y_.data(), order_.size()}; }
  /// What x() and y() count from.
  const Eigen::Vector2d& middle_m() const { return middle_m_; }

  /// For each of the slots the nearest others within `reach_m` (at most kMost) as slots,
  /// ordered by (distance, slot): found[kMost * slot ...], counts[slot]. The arrays are those of
  /// all slots.
  void nearest(std::span<const uint32_t> slots, float reach_m, uint32_t* found,
               uint8_t* counts) const;

 private:
  using Search = void (*)(const GridView&, std::span<const uint32_t>, float, uint32_t*, uint8_t*);
  static constexpr uint32_t kAbsent = UINT32_MAX;

  GridView view() const;
  size_t cell_count() const {
    return static_cast<size_t>(shape_.columns) * static_cast<size_t>(shape_.rows);
  }
  Eigen::Vector2f local(const Eigen::Vector2d& position_m) const {
    return (position_m - middle_m_).cast<float>();
  }
  void sort(std::span<const Eigen::Vector2d> positions_m);

  Eigen::Vector2d middle_m_;
  GridView shape_;  ///< without its arrays; its slack is what rounding can hide
  double slack_m_ = 0;
  Search search_;
  std::vector<uint32_t> starts_;
  std::vector<uint32_t> cells_;  ///< of every id, or kAbsent
  std::vector<uint32_t> order_;
  std::vector<float> x_, y_;
};

}  // namespace throng
