// Agents of a row of cells as lanes: near ones are packed, then ranked by counting.
#include <cstddef>
#include <cstdint>

#include "base/simd/dispatch.h"
#include "crowd/neighbours/neighbour_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd/neighbours/neighbour_search_simd.cpp"
#include <hwy/foreach_target.h>

#include "base/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace throng::HWY_NAMESPACE {
#if THRONG_HAS_LANES
namespace {

using D = Lanes;
using DU = LaneBits;
constexpr size_t kMaxNeighbours = NeighbourGrid::kMaxNeighbours;

/// Agents found so far, in ascending order of slots.
class Candidates {
 public:
  size_t count() const { return count_; }
  void clear() { count_ = 0; }
  bool is_full() const { return count_ > kFull; }

  /// Packs registers and stores them whole: packing into memory takes some processors a hundred
  /// cycles. Data beyond the last one is overwritten or never read.
  HWY_INLINE void add(hn::Vec<D> squares, hn::Vec<DU> slots, hn::Mask<D> mask) {
    const D d;
    const DU du;
    const Packing packed(mask);
    hn::StoreU(packed(squares), d, squares_ + count_);
    hn::StoreU(packed(slots), du, slots_ + count_);
    count_ += hn::CountTrue(d, mask);
  }

  /// Keeps the nearest in ascending order of slots; returns the largest squared distance.
  float keep_nearest() {
    rank();
    size_t kept = 0;
    float farthest = 0;
    for (size_t i = 0; i < count_; ++i) {
      if (ranks_[i] >= kMaxNeighbours) continue;
      squares_[kept] = squares_[i];
      slots_[kept++] = slots_[i];
      if (squares_[i] > farthest) farthest = squares_[i];
    }
    count_ = kept;
    return farthest;
  }

  /// Writes the kMaxNeighbours nearest by distance.
  size_t sort_into(uint32_t* found) {
    rank();
    uint32_t sorted[kCapacity];
    for (size_t i = 0; i < count_; ++i) sorted[ranks_[i]] = slots_[i];
    const size_t most = count_ < kMaxNeighbours ? count_ : kMaxNeighbours;
    for (size_t i = 0; i < most; ++i) found[i] = sorted[i];
    return most;
  }

 private:
  /// Ranking is quadratic in this; a smaller value would rank too often in dense crowds.
  static constexpr size_t kFull = 40;
  static constexpr size_t kCapacity = kFull + 2 * kLanes;

  /// Counts for each the number of nearer ones; of equal ones the first counts as nearer.
  HWY_INLINE void rank() {
    const D d;
    const DU du;
    size_t sum = 0;
    for (size_t i = 0; i < count_; i += kLanes) {
      const auto mine = hn::LoadU(d, squares_ + i);
      auto nearer = hn::Zero(du);
      for (size_t j = 0; j < count_; ++j)  // a mask is -1 in every lane where it holds
        nearer = hn::Sub(
            nearer, hn::VecFromMask(du, hn::RebindMask(du, hn::Lt(hn::Set(d, squares_[j]), mine))));
      hn::StoreU(nearer, du, ranks_ + i);
    }
    for (size_t i = 0; i < count_; ++i) sum += ranks_[i];
    if (2 * sum == count_ * (count_ - 1)) return;
    // Equal distances are rare; they leave equal ranks, which are resolved here.
    for (size_t i = 0; i < count_; ++i)
      for (size_t j = 0; j < i; ++j) ranks_[i] += squares_[j] == squares_[i] ? 1 : 0;
  }

  float squares_[kCapacity];
  uint32_t slots_[kCapacity];
  uint32_t ranks_[kCapacity];
  size_t count_ = 0;
};

void search(const GridView& grid, std::span<const uint32_t> slots, float reach_m, uint32_t* found,
            uint8_t* counts) {
  const D d;
  const DU du;
  const auto lane = counting_from(0);
  Candidates near;
  for (const uint32_t own : slots) {
    const Rings rings(grid, own);
    const auto x = hn::Set(d, grid.x[own]);
    const auto y = hn::Set(d, grid.y[own]);
    const auto self = hn::Set(du, own);
    for (int ring = 1;; ++ring) {
      const float covered_m = rings.covered_m(ring, reach_m);
      auto limit = hn::Set(d, covered_m * covered_m);
      near.clear();
      rings.for_rows(ring, [&](uint32_t first, uint32_t last) HWY_ATTR {
        for (uint32_t slot = first; slot < last; slot += kLanes) {
          const auto dx = hn::Sub(hn::LoadU(d, grid.x + slot), x);
          const auto dy = hn::Sub(hn::LoadU(d, grid.y + slot), y);
          const auto square = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
          const auto those = hn::Add(lane, hn::Set(du, slot));
          const auto other = hn::And(hn::Ne(those, self), hn::FirstN(du, last - slot));
          const auto mask = hn::And(hn::Le(square, limit), hn::RebindMask(d, other));
          if (hn::AllFalse(d, mask)) continue;
          near.add(square, those, mask);
          if (near.is_full()) limit = hn::Set(d, near.keep_nearest());
        }
      });
      if (near.count() >= kMaxNeighbours || !(covered_m < reach_m)) break;
    }
    counts[own] = static_cast<uint8_t>(near.sort_into(found + kMaxNeighbours * size_t{own}));
  }
}

}  // namespace

void nearest_all(const GridView& grid, std::span<const uint32_t> slots, float reach_m,
                 uint32_t* found, uint8_t* counts) {
  search(grid, slots, reach_m, found, counts);
}

#endif
}  // namespace throng::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace throng {

NeighbourSearch neighbour_search_on(SimdTarget target) {
  return THRONG_CHOOSE(resolved(target), nearest_all, nearest_scalar);
}

}  // namespace throng
#endif
