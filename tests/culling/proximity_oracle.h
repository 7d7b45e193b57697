// Near rows held against triangles in double precision, a pair of parts after another: whatever is
// within the margin must be listed, and every interval must hold the distance.
// One rule: of every hundredth pair the distance is worked out by all triangles against all, too.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "culling/proximity.h"
#include "tests/culling/distance_tree.h"

namespace throng::test {

struct ProximityTally {
  uint64_t tested = 0;     ///< pairs within the margin
  uint64_t touching = 0;   ///< of these
  uint64_t listed = 0;     ///< pairs looked at that have a row
  uint64_t missed = 0;     ///< near and without a row
  uint64_t outside = 0;    ///< rows whose interval does not hold the distance
  uint64_t wide = 0;       ///< rows by triangles that are more than 1 mm wide
  uint64_t by_all = 0;     ///< pairs whose distance by all triangles was that by the tree
  uint64_t differing = 0;  ///< or not
  std::string first_wrong;

  bool is_right() const { return missed + outside + wide + differing == 0; }
  void add(const ProximityTally& other);
};

/// The head of a table, and a line of it: to standard output, at once.
void print_proximity_head(std::string_view what);
void print_proximity_rows(std::string_view name, const ProximityTally& tally);

/// Judges one pair of parts.
class ProximityOracle {
 public:
  ProximityOracle(float margin_m, ProximityTally& tally) : margin_m_(margin_m), tally_(tally) {}

  /// `rows`: of the frame, sorted. `describe()` says which pair it is.
  template <typename Describe>
  void judge(const DistanceTree::Placed& a, const DistanceTree::Placed& b,
             const Eigen::Vector3d& a_to_b_m, bool touches, PairKey key, const ProximityRows& rows,
             const Describe& describe) {
    const std::string wrong = verdict(a, b, a_to_b_m, touches, key, rows);
    if (!wrong.empty() && tally_.first_wrong.empty())
      tally_.first_wrong = describe() + ": " + wrong;
  }

 private:
  std::string verdict(const DistanceTree::Placed& a, const DistanceTree::Placed& b,
                      const Eigen::Vector3d& a_to_b_m, bool touches, PairKey key,
                      const ProximityRows& rows);

  float margin_m_;
  ProximityTally& tally_;
};

}  // namespace throng::test
