#include "culling/stages/pair_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/counting_sort.h"

namespace throng {
namespace {

struct Range {
  float low = 0, high = 0;
  float length() const { return high - low; }
};

/// Range of most values: mean plus and minus six mean deviations; border cells hold the rest.
template <typename Value>
Range bulk(const Range& all, std::span<const uint32_t> bodies, const Value& value) {
  const double n = static_cast<double>(bodies.size());
  double mean = 0, deviation = 0;
  for (const uint32_t body : bodies) mean += static_cast<double>(value(body)) / n;
  for (const uint32_t body : bodies)
    deviation += std::fabs(static_cast<double>(value(body)) - mean) / n;
  return {std::max(all.low, static_cast<float>(mean - 6 * deviation)),
          std::min(all.high, static_cast<float>(mean + 6 * deviation))};
}

int blocks_of(size_t count, size_t block) { return static_cast<int>((count + block - 1) / block); }

}  // namespace

void PairSearcher::build(PairSearch kind, std::span<const PlacedBody> bodies,
                         std::span<const uint32_t> small, Workers& workers) {
  kind_ = kind;
  slot_count_ = small.size();
  body_.resize(slot_count_);
  if (slot_count_ == 0) {
    columns_ = rows_ = 1;
    strip_shift_ = 0;
    start_.resize(2);
    start_[0] = start_[1] = 0;
    return;
  }
  if (kind == PairSearch::kGrid) {
    choose_cells(bodies, small, workers);
    sort_by_cell(bodies, small, workers);
  } else if (kind == PairSearch::kSweep) {
    sort_by_low_x(bodies, small);
  } else {
    std::copy(small.begin(), small.end(), body_.data());
  }
  fill_rows(bodies, workers);
}

void PairSearcher::fill_rows(std::span<const PlacedBody> bodies, Workers& workers) {
  const size_t padded = slot_count_ + 16;  // a full register may be loaded at the last slot
  std::array<float*, kColumns> to;
  for (size_t c = 0; c < kColumns; ++c) {
    columns_of_slots_[c].resize(padded);
    to[c] = columns_of_slots_[c].data();
    std::fill(to[c] + slot_count_, to[c] + padded, 0.0f);
  }
  workers.for_blocks(blocks_of(slot_count_, kTaskBodies), [&](int block, int) {
    constexpr size_t kAhead = 8;  // bodies are not in memory order
    const size_t first = static_cast<size_t>(block) * kTaskBodies;
    const size_t end = std::min(slot_count_, first + kTaskBodies);
    for (size_t slot = first; slot < end; ++slot) {
      if (slot + kAhead < end) __builtin_prefetch(&bodies[body_[slot + kAhead]]);
      const PlacedBody& p = bodies[body_[slot]];
      to[0][slot] = p.x, to[1][slot] = p.y, to[2][slot] = p.z;
      to[3][slot] = p.radius, to[4][slot] = p.upright;
      to[5][slot] = p.mid_x, to[6][slot] = p.mid_y;
      to[7][slot] = p.axis_x, to[8][slot] = p.axis_y;
      to[9][slot] = p.half_x, to[10][slot] = p.half_y;
    }
  });
}

PairSearcher::Extent PairSearcher::measure(std::span<const PlacedBody> bodies,
                                           std::span<const uint32_t> small, Workers& workers) {
  const int tasks = blocks_of(small.size(), kTaskBodies);
  extents_.resize(static_cast<size_t>(tasks));
  workers.for_blocks(tasks, [&](int task, int) {
    const size_t first = static_cast<size_t>(task) * kTaskBodies;
    const PlacedBody& one = bodies[small[first]];
    Extent e{one.x, one.x, one.y, one.y, one.upright};
    for (const uint32_t body : small.subspan(first, std::min(kTaskBodies, small.size() - first))) {
      const PlacedBody& p = bodies[body];
      e = {std::min(e.low_x, p.x), std::max(e.high_x, p.x), std::min(e.low_y, p.y),
           std::max(e.high_y, p.y), std::max(e.upright, p.upright)};
    }
    extents_[static_cast<size_t>(task)] = e;
  });
  Extent all = extents_[0];
  for (size_t i = 1; i < static_cast<size_t>(tasks); ++i) {
    const Extent& e = extents_[i];
    all = {std::min(all.low_x, e.low_x), std::max(all.high_x, e.high_x),
           std::min(all.low_y, e.low_y), std::max(all.high_y, e.high_y),
           std::max(all.upright, e.upright)};
  }
  return all;
}

void PairSearcher::choose_cells(std::span<const PlacedBody> bodies, std::span<const uint32_t> small,
                                Workers& workers) {
  const Extent extent = measure(bodies, small, workers);
  // Bodies that may touch are at most one cell apart; the slack covers rounding in column_of().
  float side = std::max(2 * extent.upright * 1.004f, 1e-6f);
  const double max_cells = 4.0 * static_cast<double>(small.size()) + 1024;
  const auto cells = [&](const Range& range) {
    return std::floor(static_cast<double>(range.length() / side)) + 1;
  };
  Range rx = {extent.low_x, extent.high_x}, ry = {extent.low_y, extent.high_y};
  if (cells(rx) * cells(ry) > max_cells) {
    rx = bulk(rx, small, [&](uint32_t body) { return bodies[body].x; });
    ry = bulk(ry, small, [&](uint32_t body) { return bodies[body].y; });
  }
  while (cells(rx) * cells(ry) > max_cells || std::max(cells(rx), cells(ry)) > kMaxCellsPerAxis)
    side *= 1.5f;
  origin_x_ = rx.low;
  origin_y_ = ry.low;
  per_metre_ = 1 / side;
  columns_ = static_cast<int>(cells(rx));
  rows_ = static_cast<int>(cells(ry));
  strip_shift_ = std::min(kMaxStripShift,
                          static_cast<int>(std::bit_width(static_cast<unsigned>(columns_ - 1))));
}

void PairSearcher::sort_by_cell(std::span<const PlacedBody> bodies, std::span<const uint32_t> small,
                                Workers& workers) {
  cell_.resize(slot_count_);
  workers.for_blocks(blocks_of(slot_count_, kTaskBodies), [&](int block, int) {
    const size_t first = static_cast<size_t>(block) * kTaskBodies;
    for (size_t i = first; i < std::min(slot_count_, first + kTaskBodies); ++i) {
      const PlacedBody& p = bodies[small[i]];
      cell_[i] = static_cast<uint32_t>(cell(column_of(p.x), row_of(p.y)));
    }
  });
  const size_t cells = cell(columns_ - 1, rows_ - 1) + 1;
  start_.resize(cells + 2);
  counting_sort(
      slot_count_, cells, start_.data(), [&](size_t i) { return cell_[i]; },
      [&](size_t i, uint32_t slot) { body_[slot] = small[i]; });
}

void PairSearcher::sort_by_low_x(std::span<const PlacedBody> bodies,
                                 std::span<const uint32_t> small) {
  std::copy(small.begin(), small.end(), body_.data());
  const auto low = [&](uint32_t body) { return bodies[body].x - bodies[body].upright; };
  std::sort(body_.data(), body_.data() + slot_count_,
            [&](uint32_t a, uint32_t b) { return std::pair(low(a), a) < std::pair(low(b), b); });
  low_x_.resize(slot_count_);
  for (size_t slot = 0; slot < slot_count_; ++slot) low_x_[slot] = low(body_[slot]);
}

PairSearcher::BlockCounts PairSearcher::search_block(const Kernels& kernels, size_t block,
                                                     GrowBuffer<SlotPair>& out) const {
  const auto& c = columns_of_slots_;
  const SphereRows spheres{c[0].data(), c[1].data(), c[2].data(), c[3].data(), c[4].data()};
  const RectangleRows rectangles{c[5].data(), c[6].data(), c[7].data(),
                                 c[8].data(), c[9].data(), c[10].data()};
  const uint32_t end_slot = static_cast<uint32_t>(slot_count_);
  const uint32_t first = static_cast<uint32_t>(block * kBlockSlots);
  const uint32_t last = std::min(end_slot, first + static_cast<uint32_t>(kBlockSlots));
  BlockCounts found;
  const auto test = [&](SlotRun own, std::span<const SlotRun> runs) {
    uint64_t tests = 0;
    for (uint32_t slot = own.begin; slot < own.end; ++slot)
      for (const SlotRun& run : runs) tests += run.end - run.first_for(slot);
    found.tests += tests;
    out.grow(found.pairs + tests + kPairSlack, found.pairs);
    found.pairs += kernels.body_runs(spheres, rectangles, own, runs.data(), runs.size(),
                                     out.data() + found.pairs, &found.spheres);
  };
  for (uint32_t slot = first; slot < last;) {
    SlotRun own{slot, slot + 1};
    if (kind_ == PairSearch::kBrute) {
      test(own, {{SlotRun{slot + 1, end_slot}}});
    } else if (kind_ == PairSearch::kSweep) {
      // The float margin in the radii covers the rounding of both sums.
      const float high = spheres.x[slot] + spheres.upright[slot];
      const float* end =
          std::upper_bound(low_x_.data() + slot + 1, low_x_.data() + slot_count_, high);
      test(own, {{SlotRun{slot + 1, static_cast<uint32_t>(end - low_x_.data())}}});
    } else {
      const CellRuns runs = later_neighbours(column_of(spheres.x[slot]), row_of(spheres.y[slot]));
      // A whole cell at a time, unless its pairs would need too much memory.
      own.end = std::min(last, runs.end_of_cell);
      const uint32_t others = runs.slots();
      if (uint64_t{own.end - slot} * others > kMaxTests)
        own.end = slot + std::max(1u, kMaxTests / others);
      test(own, {runs.run.data(), runs.count});
    }
    slot = own.end;
  }
  return found;
}

PairSearcher::CellRuns PairSearcher::later_neighbours(int column, int row) const {
  CellRuns out;
  const auto add = [&](uint32_t begin, uint32_t end) {
    if (begin < end) out.run[out.count++] = {begin, end};
  };
  out.end_of_cell = start_[cell(column, row) + 1];
  const int next = std::min(column + 1, columns_ - 1);
  runs_of_row(column, next, row, add);
  if (row + 1 < rows_) runs_of_row(std::max(column - 1, 0), next, row + 1, add);
  return out;
}

uint32_t PairSearcher::times_grown() const {
  uint32_t sum = body_.times_grown() + low_x_.times_grown() + cell_.times_grown() +
                 start_.times_grown() + extents_.times_grown();
  for (const auto& column : columns_of_slots_) sum += column.times_grown();
  return sum;
}

}  // namespace throng
