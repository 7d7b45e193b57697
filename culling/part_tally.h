// PartTally counts the tests of each pair of parts.
// Invariant: sums over all cells equal the counters of the stages, for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace throng {

/// Counts of two parts of two bodies, in either order.
struct PartPairCounts {
  uint64_t box_tests = 0;    ///< tests of part boxes
  uint64_t box_passed = 0;   ///< overlapping boxes: tests of part volumes
  uint64_t part_passed = 0;  ///< overlapping volumes: tests of triangles, if enabled
  uint64_t touching = 0;     ///< contacts by triangles, see PartTally::counts_touching
  void add(const PartPairCounts& other);
};

class PartTally {
 public:
  /// parts_a x parts_b cells of two body types, the lower first; upper triangle for equal types.
  struct Block {
    size_t parts_a = 0, parts_b = 0;
    uint64_t body_pairs = 0;  ///< pairs of bodies whose part boxes were tested, all with all
    std::vector<PartPairCounts> cells;
  };
  using Blocks = std::map<std::pair<uint16_t, uint16_t>, Block>;

  Block& block(uint16_t type_a, uint16_t type_b, size_t parts_a, size_t parts_b);
  /// Cell of two parts in a block of these types.
  static PartPairCounts& cell(Block& block, uint16_t type_a, uint16_t type_b, size_t part_a,
                              size_t part_b);
  void add(const PartTally& other);

  /// All blocks, with box_tests filled in.
  Blocks blocks() const;

  /// False if a part has no triangles, so that contacts cannot be counted.
  bool counts_touching = true;

 private:
  Blocks blocks_;
};

}  // namespace throng
