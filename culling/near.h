// How near parts are to each other: every pair within a margin, with an interval that holds its
// distance; of each two bodies the pair that is nearest; and where those that touch do.
// One rule: no pair within the margin is missed; an interval is proven from both sides.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "culling/pair.h"

namespace throng {

/// Larger margins are refused: a mistake of units, more likely than not.
inline constexpr float kMostNear_m = 100;

struct NearOptions {
  /// Every pair of parts of two bodies that is not proven farther apart is listed; 0: none.
  float near_m = 0;
  /// Of each two bodies, neither of them static, that are not proven farther apart the nearest pair
  /// of parts; 0: none.
  float body_near_m = 0;
  /// From frame to frame, for closing speeds; 0: they are unknown.
  double step_s = 0;
  /// Of every pair of parts that touches a point; needs triangles, and no margin.
  bool contact_points = false;

  /// Margins.
  bool is_asked() const { return near_m > 0 || body_near_m > 0; }
  bool needs_search() const { return is_asked() || contact_points; }
  float most_m() const { return near_m > body_near_m ? near_m : body_near_m; }
};

/// The distance of two parts' triangles, of points where there are none; 0 where they touch or one
/// solid holds the other. What stands below `level` is known where the triangles were asked
/// (PairLevel::kExact), else it is NaN.
struct NearPair {
  PairKey pair;
  float lo_m = 0, hi_m = 0;  ///< hold the distance; at most 1 mm apart by triangles
  PairLevel level = PairLevel::kPartVolume;

  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  static constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
  /// Of part a and of part b, in the world: nearest to each other at hi_m; where they touch, twice
  /// a point that both share.
  std::array<double, 3> point_a_m = {kNowhere, kNowhere, kNowhere};
  std::array<double, 3> point_b_m = {kNowhere, kNowhere, kNowhere};
  /// Unit, from a to b: along the points; where they touch, along which b is out of a soonest.
  std::array<float, 3> normal = {kUnknown, kUnknown, kUnknown};
  float depth_m = 0;  ///< of the convex hulls, along the normal; 0: apart (see hull_depth.h)
  /// At which the material of the parts at the two points came nearer along the normal since the
  /// last frame; NaN also where a body was not near anybody, or not there, in the last frame.
  float closing_mps = kUnknown;

  /// At that speed; 0 where they touch, infinite where they do not come nearer, NaN where it is
  /// unknown.
  float contact_in_s() const {
    if (level == PairLevel::kExact && hi_m == 0) return 0;
    if (!(closing_mps <= 0)) return hi_m / closing_mps;
    return std::numeric_limits<float>::infinity();
  }
};

/// A NearPair that volumes alone have bounded, as it is kept: a crowd has hundreds of thousands.
struct NearInterval {
  PairKey pair;
  float lo_m = 0, hi_m = 0;

  NearPair row() const { return {pair, lo_m, hi_m}; }
};

/// Rows as NearPairs, whatever they are kept as; a view. A row is made when it is asked for: keep
/// the row, not its address.
class NearRows {
 public:
  class Iterator;

  NearRows() = default;
  NearRows(std::span<const NearPair> pairs) : pairs_(pairs.data()), size_(pairs.size()) {}
  NearRows(std::span<const NearInterval> intervals)
      : intervals_(intervals.data()), size_(intervals.size()) {}
  NearRows(const std::vector<NearPair>& pairs) : NearRows(std::span<const NearPair>(pairs)) {}

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  NearPair operator[](size_t i) const { return pairs_ ? pairs_[i] : intervals_[i].row(); }
  Iterator begin() const;
  Iterator end() const;

 private:
  const NearPair* pairs_ = nullptr;
  const NearInterval* intervals_ = nullptr;  ///< where pairs_ is none
  size_t size_ = 0;
};

/// Random access; what it refers to is made when it is asked for.
class NearRows::Iterator {
 public:
  using iterator_category = std::random_access_iterator_tag;
  using value_type = NearPair;
  using difference_type = std::ptrdiff_t;
  using reference = NearPair;
  struct Arrow {
    NearPair row;
    const NearPair* operator->() const { return &row; }
  };
  using pointer = Arrow;

  Iterator() = default;
  Iterator(const NearRows& rows, size_t at) : rows_(rows), at_(at) {}

  NearPair operator*() const { return rows_[at_]; }
  pointer operator->() const { return {**this}; }
  NearPair operator[](difference_type n) const { return *(*this + n); }
  Iterator& operator+=(difference_type n) {
    at_ += static_cast<size_t>(n);
    return *this;
  }
  Iterator& operator-=(difference_type n) { return *this += -n; }
  Iterator& operator++() { return *this += 1; }
  Iterator& operator--() { return *this -= 1; }
  Iterator operator++(int) { return std::exchange(*this, *this + 1); }
  Iterator operator--(int) { return std::exchange(*this, *this - 1); }
  friend Iterator operator+(Iterator i, difference_type n) { return i += n; }
  friend Iterator operator+(difference_type n, Iterator i) { return i += n; }
  friend Iterator operator-(Iterator i, difference_type n) { return i -= n; }
  friend difference_type operator-(const Iterator& a, const Iterator& b) {
    return static_cast<difference_type>(a.at_ - b.at_);
  }
  friend bool operator==(const Iterator& a, const Iterator& b) { return a.at_ == b.at_; }
  friend std::strong_ordering operator<=>(const Iterator& a, const Iterator& b) {
    return a.at_ <=> b.at_;
  }

 private:
  NearRows rows_;
  size_t at_ = 0;
};

inline NearRows::Iterator NearRows::begin() const { return {*this, 0}; }
inline NearRows::Iterator NearRows::end() const { return {*this, size_}; }

/// Where two parts touch and how deep, as a NearPair of theirs has it.
struct ContactPoint {
  PairKey pair;
  std::array<double, 3> point_m = {};   ///< that both share, in the world
  std::array<float, 3> direction = {};  ///< unit: along which b is out of a soonest
  float depth_m = 0;                    ///< of the convex hulls, along it
};

}  // namespace throng
