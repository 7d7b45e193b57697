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
inline constexpr float kMaxProximity_m = 100;

struct ProximityOptions {
  /// Every pair of parts of two bodies that is not proven farther apart is listed; 0: none.
  float margin_m = 0;
  /// Of each two bodies, neither of them static, that are not proven farther apart the nearest pair
  /// of parts; 0: none.
  float closest_margin_m = 0;
  /// From frame to frame, for closing speeds; 0: they are unknown.
  double step_s = 0;
  /// Of every pair of parts that touches a point; needs triangles, and no margin.
  bool contact_points = false;

  /// Margins.
  bool is_enabled() const { return margin_m > 0 || closest_margin_m > 0; }
  bool needs_search() const { return is_enabled() || contact_points; }
  float max_margin_m() const { return margin_m > closest_margin_m ? margin_m : closest_margin_m; }
};

/// The distance of two parts' triangles, of points where there are none; 0 where they touch or one
/// solid holds the other. What stands below `level` is known where the triangles were asked
/// (PairLevel::kTriangles), else it is NaN.
struct ProximityPair {
  PairKey pair;
  float lo_m = 0, hi_m = 0;  ///< hold the distance; at most 1 mm apart by triangles
  PairLevel level = PairLevel::kPartVolume;

  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  static constexpr double kNoPosition = std::numeric_limits<double>::quiet_NaN();
  /// Of part a and of part b, in the world: nearest to each other at hi_m; where they touch, twice
  /// a point that both share.
  std::array<double, 3> point_a_m = {kNoPosition, kNoPosition, kNoPosition};
  std::array<double, 3> point_b_m = {kNoPosition, kNoPosition, kNoPosition};
  /// Unit, from a to b: along the points; where they touch, along which b is out of a soonest.
  std::array<float, 3> normal = {kUnknown, kUnknown, kUnknown};
  float depth_m = 0;  ///< of the convex hulls, along the normal; 0: apart (see hull_depth.h)
  /// At which the material of the parts at the two points came nearer along the normal since the
  /// last frame; NaN also where a body was not near anybody, or not there, in the last frame.
  float closing_speed_mps = kUnknown;

  /// At that speed; 0 where they touch, infinite where they do not come nearer, NaN where it is
  /// unknown.
  float time_to_contact_s() const {
    if (level == PairLevel::kTriangles && hi_m == 0) return 0;
    if (!(closing_speed_mps <= 0)) return hi_m / closing_speed_mps;
    return std::numeric_limits<float>::infinity();
  }
};

/// A ProximityPair that volumes alone have bounded, as it is kept: a crowd has hundreds of
/// thousands.
struct DistanceBounds {
  PairKey pair;
  float lo_m = 0, hi_m = 0;

  ProximityPair row() const { return {pair, lo_m, hi_m}; }
};

/// Rows as NearPairs, whatever they are kept as; a view. A row is made when it is asked for: keep
/// the row, not its address.
class ProximityRows {
 public:
  class Iterator;

  ProximityRows() = default;
  ProximityRows(std::span<const ProximityPair> pairs) : pairs_(pairs.data()), size_(pairs.size()) {}
  ProximityRows(std::span<const DistanceBounds> intervals)
      : intervals_(intervals.data()), size_(intervals.size()) {}
  ProximityRows(const std::vector<ProximityPair>& pairs)
      : ProximityRows(std::span<const ProximityPair>(pairs)) {}

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  ProximityPair operator[](size_t i) const { return pairs_ ? pairs_[i] : intervals_[i].row(); }
  Iterator begin() const;
  Iterator end() const;

 private:
  const ProximityPair* pairs_ = nullptr;
  const DistanceBounds* intervals_ = nullptr;  ///< where pairs_ is none
  size_t size_ = 0;
};

/// Random access; what it refers to is made when it is asked for.
class ProximityRows::Iterator {
 public:
  using iterator_category = std::random_access_iterator_tag;
  using value_type = ProximityPair;
  using difference_type = std::ptrdiff_t;
  using reference = ProximityPair;
  struct Arrow {
    ProximityPair row;
    const ProximityPair* operator->() const { return &row; }
  };
  using pointer = Arrow;

  Iterator() = default;
  Iterator(const ProximityRows& rows, size_t at) : rows_(rows), at_(at) {}

  ProximityPair operator*() const { return rows_[at_]; }
  pointer operator->() const { return {**this}; }
  ProximityPair operator[](difference_type n) const { return *(*this + n); }
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
  ProximityRows rows_;
  size_t at_ = 0;
};

inline ProximityRows::Iterator ProximityRows::begin() const { return {*this, 0}; }
inline ProximityRows::Iterator ProximityRows::end() const { return {*this, size_}; }

/// Where two parts touch and how deep, as a ProximityPair of theirs has it.
struct ContactPoint {
  PairKey pair;
  std::array<double, 3> point_m = {};  ///< that both share, in the world
  std::array<float, 3> normal = {};    ///< unit: along which b is out of a soonest
  float depth_m = 0;                   ///< of the convex hulls, along it
};

}  // namespace throng
