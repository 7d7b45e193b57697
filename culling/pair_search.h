// Broad phase: the pairs of bodies whose spheres overlap.
// One rule: grid, sweep and brute force find the same pairs; they differ in how many they look at.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/workers.h"
#include "culling/culler.h"
#include "culling/grow_buffer.h"
#include "culling/kernels.h"

namespace throng {

/// The spheres of a frame in the order of the bodies, coordinates relative to any common origin.
struct SphereInput {
  size_t count = 0;
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  const float* radius = nullptr;   ///< inflated by the float margin
  const float* upright = nullptr;  ///< radius of the upright cylinder, inflated too, at most radius
};

/// Sorts small bodies into slots and lists the overlapping pairs of slots, in blocks.
/// Large bodies (walls, stands) are not in it: they are few and asked one by one with around().
class PairSearcher {
 public:
  /// Slots for the bodies in `small` (indices into the input, ascending).
  void build(PairSearch kind, const SphereInput& spheres, std::span<const uint32_t> small);

  size_t slot_count() const { return slot_count_; }
  uint32_t body_of_slot(size_t slot) const { return body_[slot]; }

  /// The blocks in which the search runs; a block may run on any thread.
  size_t block_count() const { return (slot_count_ + kBlockSlots - 1) / kBlockSlots; }
  /// Writes the pairs whose first slot lies in `block`; returns how many pairs were tested.
  uint64_t search_block(const Kernels& kernels, size_t block, GrowBuffer<SlotPair>& out,
                        size_t& found) const;

  /// Calls visit(first_slot, end_slot) for runs of slots that hold every body whose centre lies
  /// within the rectangle.
  template <typename Visit>
  void around(float min_x, float min_y, float max_x, float max_y, const Visit& visit) const {
    if (kind_ != PairSearch::kGrid) return visit(uint32_t{0}, static_cast<uint32_t>(slot_count_));
    const int first = column_of(min_x), last = column_of(max_x);
    for (int row = row_of(min_y); row <= row_of(max_y); ++row)
      visit(cell_start(first, row), cell_start(last, row, 1));
  }

  uint32_t times_grown() const;

 private:
  static constexpr size_t kBlockSlots = 256;
  /// Beyond this many columns a float cell coordinate could be off by more than the cell's slack.
  static constexpr int kMaxCellsPerAxis = 8192;

  void choose_cells(const SphereInput& spheres, std::span<const uint32_t> small);
  void sort_by_cell(const SphereInput& spheres, std::span<const uint32_t> small);
  void sort_by_low_x(const SphereInput& spheres, std::span<const uint32_t> small);
  int column_of(float x) const;
  int row_of(float y) const;
  uint32_t cell_start(int column, int row, int after = 0) const {
    return start_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                  static_cast<size_t>(column + after)];
  }

  PairSearch kind_ = PairSearch::kGrid;
  size_t slot_count_ = 0;
  GrowBuffer<uint32_t> body_;
  GrowBuffer<float> x_, y_, z_, radius_, upright_;
  GrowBuffer<float> low_x_;  // kSweep: x - upright, ascending
  GrowBuffer<uint32_t> cell_, start_;
  float origin_x_ = 0, origin_y_ = 0, per_metre_ = 1;
  int columns_ = 1, rows_ = 1;
};

}  // namespace throng
