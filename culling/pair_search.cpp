#include "culling/pair_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace throng {
namespace {

/// An interval of cell coordinates that must be covered.
struct Range {
  float low = 0, high = 0;
  float length() const { return high - low; }
};

Range extent(const float* values, std::span<const uint32_t> bodies) {
  Range r{values[bodies[0]], values[bodies[0]]};
  for (const uint32_t body : bodies) {
    r.low = std::min(r.low, values[body]);
    r.high = std::max(r.high, values[body]);
  }
  return r;
}

/// Where most of the values lie: the mean and six mean deviations to both sides. What lies outside
/// is counted into the border cells.
Range bulk(const float* values, std::span<const uint32_t> bodies) {
  const double n = static_cast<double>(bodies.size());
  double mean = 0, deviation = 0;
  for (const uint32_t body : bodies) mean += static_cast<double>(values[body]) / n;
  for (const uint32_t body : bodies)
    deviation += std::fabs(static_cast<double>(values[body]) - mean) / n;
  const Range all = extent(values, bodies);
  return {std::max(all.low, static_cast<float>(mean - 6 * deviation)),
          std::min(all.high, static_cast<float>(mean + 6 * deviation))};
}

}  // namespace

void PairSearcher::build(PairSearch kind, const SphereInput& spheres,
                         std::span<const uint32_t> small) {
  kind_ = kind;
  slot_count_ = small.size();
  const size_t padded = slot_count_ + 16;  // a full register may be loaded at the last slot
  body_.resize(slot_count_);
  for (GrowBuffer<float>* column : {&x_, &y_, &z_, &radius_, &upright_}) column->resize(padded);
  if (slot_count_ == 0) {
    columns_ = rows_ = 1;
    start_.resize(2);
    start_[0] = start_[1] = 0;
    return;
  }
  if (kind == PairSearch::kGrid) {
    choose_cells(spheres, small);
    sort_by_cell(spheres, small);
  } else if (kind == PairSearch::kSweep) {
    sort_by_low_x(spheres, small);
  } else {
    std::copy(small.begin(), small.end(), body_.data());
  }
  for (size_t slot = 0; slot < slot_count_; ++slot) {
    const uint32_t body = body_[slot];
    x_[slot] = spheres.x[body];
    y_[slot] = spheres.y[body];
    z_[slot] = spheres.z[body];
    radius_[slot] = spheres.radius[body];
    upright_[slot] = spheres.upright[body];
  }
  for (size_t slot = slot_count_; slot < padded; ++slot)
    x_[slot] = y_[slot] = z_[slot] = radius_[slot] = upright_[slot] = 0;
}

void PairSearcher::choose_cells(const SphereInput& spheres, std::span<const uint32_t> small) {
  float radius = 0;
  for (const uint32_t body : small) radius = std::max(radius, spheres.upright[body]);
  // Two bodies that may touch lie at most one cell apart; the slack covers the rounding of
  // column_of().
  float cell = std::max(2 * radius * 1.004f, 1e-6f);
  const double most_cells = 4.0 * static_cast<double>(small.size()) + 1024;
  const auto cells = [&](const Range& range) {
    return std::floor(static_cast<double>(range.length() / cell)) + 1;
  };
  Range rx = extent(spheres.x, small), ry = extent(spheres.y, small);
  if (cells(rx) * cells(ry) > most_cells) rx = bulk(spheres.x, small), ry = bulk(spheres.y, small);
  while (cells(rx) * cells(ry) > most_cells || std::max(cells(rx), cells(ry)) > kMaxCellsPerAxis)
    cell *= 1.5f;
  origin_x_ = rx.low;
  origin_y_ = ry.low;
  per_metre_ = 1 / cell;
  columns_ = static_cast<int>(cells(rx));
  rows_ = static_cast<int>(cells(ry));
}

int PairSearcher::column_of(float x) const {
  return static_cast<int>(
      std::clamp((x - origin_x_) * per_metre_, 0.0f, static_cast<float>(columns_ - 1)));
}

int PairSearcher::row_of(float y) const {
  return static_cast<int>(
      std::clamp((y - origin_y_) * per_metre_, 0.0f, static_cast<float>(rows_ - 1)));
}

void PairSearcher::sort_by_cell(const SphereInput& spheres, std::span<const uint32_t> small) {
  const size_t cells = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
  cell_.resize(slot_count_);
  start_.resize(cells + 2);
  // Counted one cell late, so that after scattering start_[c] is where cell c begins.
  std::fill_n(start_.data(), cells + 2, 0u);
  for (size_t i = 0; i < slot_count_; ++i) {
    const size_t row = static_cast<size_t>(row_of(spheres.y[small[i]]));
    const size_t cell =
        row * static_cast<size_t>(columns_) + static_cast<size_t>(column_of(spheres.x[small[i]]));
    cell_[i] = static_cast<uint32_t>(cell);
    ++start_[cell + 2];
  }
  std::partial_sum(start_.data(), start_.data() + cells + 2, start_.data());
  for (size_t i = 0; i < slot_count_; ++i) body_[start_[cell_[i] + 1]++] = small[i];
}

void PairSearcher::sort_by_low_x(const SphereInput& spheres, std::span<const uint32_t> small) {
  std::copy(small.begin(), small.end(), body_.data());
  const auto low = [&](uint32_t body) { return spheres.x[body] - spheres.upright[body]; };
  std::sort(body_.data(), body_.data() + slot_count_,
            [&](uint32_t a, uint32_t b) { return std::pair(low(a), a) < std::pair(low(b), b); });
  low_x_.resize(slot_count_);
  for (size_t slot = 0; slot < slot_count_; ++slot) low_x_[slot] = low(body_[slot]);
}

uint64_t PairSearcher::search_block(const Kernels& kernels, size_t block, GrowBuffer<SlotPair>& out,
                                    size_t& found) const {
  const SphereRows rows{x_.data(), y_.data(), z_.data(), radius_.data(), upright_.data()};
  const uint32_t end_slot = static_cast<uint32_t>(slot_count_);
  uint64_t tests = 0;
  found = 0;
  const auto run = [&](uint32_t slot, uint32_t begin, uint32_t end) {
    if (begin >= end) return;
    tests += end - begin;
    out.grow(found + (end - begin), found);
    found += kernels.sphere_run(rows, slot, begin, end, out.data() + found);
  };
  const uint32_t first = static_cast<uint32_t>(block * kBlockSlots);
  const uint32_t last = std::min(end_slot, first + static_cast<uint32_t>(kBlockSlots));
  for (uint32_t slot = first; slot < last; ++slot) {
    if (kind_ == PairSearch::kBrute) {
      run(slot, slot + 1, end_slot);
    } else if (kind_ == PairSearch::kSweep) {
      // The float margin in the radii covers the rounding of both sums.
      const float high = x_[slot] + upright_[slot];
      const float* end =
          std::upper_bound(low_x_.data() + slot + 1, low_x_.data() + slot_count_, high);
      run(slot, slot + 1, static_cast<uint32_t>(end - low_x_.data()));
    } else {
      // Half of the neighbourhood: the rest of this cell and the next, and three cells of the next
      // row.
      const int column = column_of(x_[slot]), row = row_of(y_[slot]);
      const int next = std::min(column + 1, columns_ - 1);
      run(slot, slot + 1, cell_start(next, row, 1));
      if (row + 1 < rows_)
        run(slot, cell_start(std::max(column - 1, 0), row + 1), cell_start(next, row + 1, 1));
    }
  }
  return tests;
}

uint32_t PairSearcher::times_grown() const {
  return body_.times_grown() + x_.times_grown() + y_.times_grown() + z_.times_grown() +
         radius_.times_grown() + upright_.times_grown() + low_x_.times_grown() +
         cell_.times_grown() + start_.times_grown();
}

}  // namespace throng
