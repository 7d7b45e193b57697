// PairSearcher lists pairs of bodies whose spheres and ground rectangles overlap.
// Invariant: grid, sweep and brute force find the same pairs; they differ in the number of tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/workers.h"
#include "culling/culler.h"
#include "culling/kernels/kernels.h"

namespace throng {

/// Body as the search reads it. SphereRows and RectangleRows describe the fields.
struct PlacedBody {
  float x = 0, y = 0, z = 0;
  float radius = 0, upright = 0;
  float mid_x = 0, mid_y = 0, axis_x = 0, axis_y = 0, half_x = 0, half_y = 0;
};

/// Sorts small bodies into slots and lists overlapping pairs of slots, in blocks. Large bodies
/// (walls, stands) are not included: callers test the few of them with around().
class PairSearcher {
 public:
  /// Assigns slots to the bodies in `small` (indices into `bodies`, ascending).
  void build(PairSearch kind, std::span<const PlacedBody> bodies, std::span<const uint32_t> small,
             Workers& workers);

  /// Bodies in slot order.
  std::span<const uint32_t> bodies() const { return {body_.data(), slot_count_}; }

  /// Blocks of the search. A block may run on any thread.
  static constexpr size_t kBlockSlots = 256;
  size_t block_count() const { return (slot_count_ + kBlockSlots - 1) / kBlockSlots; }
  struct BlockCounts {
    uint64_t tests = 0;
    uint64_t spheres = 0;  ///< number of pairs with overlapping spheres
    size_t pairs = 0;      ///< number of these with overlapping rectangles, written to `out`
  };
  /// Writes the pairs whose first slot is in `block`.
  BlockCounts search_block(const Kernels& kernels, size_t block, GrowBuffer<SlotPair>& out) const;

  /// Calls visit(first_slot, end_slot) for slots that include all bodies centred in the rectangle.
  template <typename Visit>
  void around(float min_x, float min_y, float max_x, float max_y, const Visit& visit) const {
    if (kind_ != PairSearch::kGrid) return visit(uint32_t{0}, static_cast<uint32_t>(slot_count_));
    for (int row = row_of(min_y); row <= row_of(max_y); ++row)
      runs_of_row(column_of(min_x), column_of(max_x), row, visit);
  }

  uint32_t times_grown() const;

 private:
  static constexpr size_t kTaskBodies = 4096;
  /// 2^shift columns of cells are consecutive in memory. A block of slots is then a roughly square
  /// patch of the ground and shares few bodies with other blocks.
  static constexpr int kMaxStripShift = 5;
  /// With more columns a float cell coordinate could be off by more than the cell's slack.
  static constexpr int kMaxCellsPerAxis = 8192;

  struct Extent {
    float low_x, high_x, low_y, high_y, upright;
  };
  Extent measure(std::span<const PlacedBody> bodies, std::span<const uint32_t> small,
                 Workers& workers);
  void choose_cells(std::span<const PlacedBody> bodies, std::span<const uint32_t> small,
                    Workers& workers);
  void sort_by_cell(std::span<const PlacedBody> bodies, std::span<const uint32_t> small,
                    Workers& workers);
  void sort_by_low_x(std::span<const PlacedBody> bodies, std::span<const uint32_t> small);
  void fill_rows(std::span<const PlacedBody> bodies, Workers& workers);

  int column_of(float x) const {
    return static_cast<int>(
        std::clamp((x - origin_x_) * per_metre_, 0.0f, static_cast<float>(columns_ - 1)));
  }
  int row_of(float y) const {
    return static_cast<int>(
        std::clamp((y - origin_y_) * per_metre_, 0.0f, static_cast<float>(rows_ - 1)));
  }
  size_t cell(int column, int row) const {
    const int strip = column >> strip_shift_;
    return ((static_cast<size_t>(strip) * static_cast<size_t>(rows_) + static_cast<size_t>(row))
            << strip_shift_) +
           static_cast<size_t>(column & strip_mask());
  }
  int strip_mask() const { return (1 << strip_shift_) - 1; }
  /// Visits the slots of neighbouring cells in a row, strip by strip.
  template <typename Visit>
  void runs_of_row(int first, int last, int row, const Visit& visit) const {
    while (first <= last) {
      const int end_of_strip = first | strip_mask();
      const size_t from = cell(first, row),
                   count = static_cast<size_t>(std::min(last, end_of_strip) - first) + 1;
      visit(start_[from], start_[from + count]);
      first = end_of_strip + 1;
    }
  }

  /// Half of a cell's neighbourhood: the cell, the next one, and three cells of the next row. A row
  /// has two runs at the end of a strip.
  struct CellRuns {
    std::array<SlotRun, 4> run{};
    size_t count = 0;
    uint32_t end_of_cell = 0;
    uint32_t slots() const {
      uint32_t sum = 0;
      for (size_t i = 0; i < count; ++i) sum += run[i].end - run[i].begin;
      return sum;
    }
  };
  CellRuns later_neighbours(int column, int row) const;
  /// Maximum number of pairs per kernel call, unless a single slot has more.
  static constexpr uint32_t kMaxTests = 4096;

  PairSearch kind_ = PairSearch::kGrid;
  size_t slot_count_ = 0;
  GrowBuffer<uint32_t> body_;
  static constexpr size_t kColumns = sizeof(PlacedBody) / sizeof(float);
  std::array<GrowBuffer<float>, kColumns> columns_of_slots_;  // in the order of PlacedBody
  GrowBuffer<float> low_x_;                                   // kSweep: x - upright, ascending
  GrowBuffer<uint32_t> cell_, start_;
  GrowBuffer<Extent> extents_;  // by task
  float origin_x_ = 0, origin_y_ = 0, per_metre_ = 1;
  int columns_ = 1, rows_ = 1, strip_shift_ = 0;
};

}  // namespace throng
