// ProximityOracle compares proximity rows with triangle distances in double precision. Pairs within
// the margin must be listed, and bounds must contain the distance. Every hundredth pair is also
// tested with all pairs of triangles.
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
  uint64_t touching = 0;   ///< number of these that touch
  uint64_t listed = 0;     ///< number of tested pairs with a row
  uint64_t missed = 0;     ///< pairs within the margin without a row
  uint64_t outside = 0;    ///< rows whose bounds do not contain the distance
  uint64_t wide = 0;       ///< rows by triangles with bounds more than 1 mm apart
  uint64_t by_all = 0;     ///< pairs with equal distances by all triangles and by the tree
  uint64_t differing = 0;  ///< pairs with different ones
  std::string first_wrong;

  bool is_right() const { return missed + outside + wide + differing == 0; }
  void add(const ProximityTally& other);
};

/// Prints the header and a row of the table to standard output, flushed.
void print_proximity_head(std::string_view what);
void print_proximity_rows(std::string_view name, const ProximityTally& tally);

/// Checks one pair of parts.
class ProximityOracle {
 public:
  ProximityOracle(float margin_m, ProximityTally& tally) : margin_m_(margin_m), tally_(tally) {}

  /// `rows`: sorted rows of the frame. `describe()` returns a text that identifies the pair.
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
