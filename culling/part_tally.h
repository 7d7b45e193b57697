// What the part stages did, pair of parts by pair of parts: which parts are tested in vain.
// One rule: sums over all cells are the counters of the stages; counts are the same for any number
// of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace throng {

/// Two parts of two bodies, whichever of the two has which.
struct PartPairCounts {
  uint64_t box_tests = 0;    ///< box against box
  uint64_t box_passed = 0;   ///< and then volume against volume
  uint64_t part_passed = 0;  ///< and then, where asked, triangles against triangles
  uint64_t touching = 0;     ///< truly, see PartTally::counts_touching
  void add(const PartPairCounts& other);
};

class PartTally {
 public:
  /// Cells of two types of bodies, the lower first: parts_a x parts_b. Of one type the upper
  /// triangle.
  struct Block {
    size_t parts_a = 0, parts_b = 0;
    uint64_t body_pairs = 0;  ///< whose part boxes were tested, all with all
    std::vector<PartPairCounts> cells;
  };
  using Blocks = std::map<std::pair<uint16_t, uint16_t>, Block>;

  Block& block(uint16_t type_a, uint16_t type_b, size_t parts_a, size_t parts_b);
  /// The cell of two parts in a block of these types.
  static PartPairCounts& cell(Block& block, uint16_t type_a, uint16_t type_b, size_t part_a,
                              size_t part_b);
  void add(const PartTally& other);

  /// With box_tests filled in.
  Blocks blocks() const;

  /// False where parts have no triangles and nobody can say what truly touches.
  bool counts_touching = true;

 private:
  Blocks blocks_;
};

}  // namespace throng
