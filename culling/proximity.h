// ProximityRows lists pairs of parts within a margin, or the closest parts of two bodies, each with
// bounds of their distance. ContactPoint is a point of a contact.
// Invariant: no pair within the margin is missed, and both distance bounds are proven.
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

/// Maximum margin in metres. Larger ones are rejected: they are probably unit errors.
inline constexpr float kMaxProximity_m = 100;

struct ProximityOptions {
  /// Margin in metres within which all pairs of parts of two bodies are listed; 0: off. Pairs are
  /// listed unless they are proven to be farther apart.
  float margin_m = 0;
  /// Margin in metres within which the closest parts of each two moving bodies are listed; 0: off.
  float closest_margin_m = 0;
  /// Time between frames in seconds, for closing speeds; 0: speeds are unknown.
  double step_s = 0;
  /// Compute a ContactPoint for every contact. Requires CullerOptions::exact, but no margin.
  bool contact_points = false;

  /// True if a margin is set.
  bool is_enabled() const { return margin_m > 0 || closest_margin_m > 0; }
  bool needs_search() const { return is_enabled() || contact_points; }
  float max_margin_m() const { return margin_m > closest_margin_m ? margin_m : closest_margin_m; }
};

/// Distance between the triangles of two parts (between points if there are none). It is 0 if they
/// touch or one solid contains the other. The fields after `level` are known if triangles were
/// tested (PairLevel::kTriangles). Otherwise they are NaN, and depth_m is 0.
struct ProximityPair {
  PairKey pair;
  /// Lower and upper bound of the distance; by triangles at most 1 mm apart.
  float lo_m = 0, hi_m = 0;
  PairLevel level = PairLevel::kPartVolume;

  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  static constexpr double kNoPosition = std::numeric_limits<double>::quiet_NaN();
  /// Closest points of parts a and b in the world frame, hi_m apart. If the parts touch, both are
  /// the same point.
  std::array<double, 3> point_a_m = {kNoPosition, kNoPosition, kNoPosition};
  std::array<double, 3> point_b_m = {kNoPosition, kNoPosition, kNoPosition};
  /// Unit vector from point a to point b, world frame. If the parts touch: direction in which the
  /// least translation of b separates the convex hulls.
  std::array<float, 3> normal = {kUnknown, kUnknown, kUnknown};
  /// Penetration depth of the convex hulls along the normal; 0 if the parts are apart.
  float depth_m = 0;
  /// Speed at which the two material points approached along the normal since the last frame;
  /// negative if they moved apart. NaN if a body was absent, or near no other, in the last frame.
  float closing_speed_mps = kUnknown;

  /// hi_m over the closing speed: 0 if the parts touch, infinite if they do not approach, NaN if
  /// the speed is unknown.
  float time_to_contact_s() const {
    if (level == PairLevel::kTriangles && hi_m == 0) return 0;
    if (!(closing_speed_mps <= 0)) return hi_m / closing_speed_mps;
    return std::numeric_limits<float>::infinity();
  }
};

/// ProximityPair whose distance is bounded by volumes only, without the unknown fields. A crowd has
/// hundreds of thousands.
struct DistanceBounds {
  PairKey pair;
  float lo_m = 0, hi_m = 0;

  ProximityPair row() const { return {pair, lo_m, hi_m}; }
};

/// Read-only view of rows as ProximityPairs, valid as long as the rows. A row is created on access:
/// keep the row, not its address.
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
  const DistanceBounds* intervals_ = nullptr;  ///< used if pairs_ is null
  size_t size_ = 0;
};

/// Random access iterator. Rows are created on access.
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

/// Point, normal and penetration depth of a contact.
struct ContactPoint {
  PairKey pair;
  std::array<double, 3> point_m = {};  ///< point on both parts, world frame
  std::array<float, 3> normal = {};    ///< unit vector, as in ProximityPair, world frame
  float depth_m = 0;                   ///< penetration depth of the convex hulls along the normal
};

}  // namespace throng
