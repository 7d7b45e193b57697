#include "culling/part_tally.h"

#include <algorithm>

namespace throng {

void PartPairCounts::add(const PartPairCounts& other) {
  box_tests += other.box_tests;
  box_passed += other.box_passed;
  part_passed += other.part_passed;
  touching += other.touching;
}

PartTally::Block& PartTally::block(uint16_t type_a, uint16_t type_b, size_t parts_a,
                                   size_t parts_b) {
  if (type_b < type_a) {
    std::swap(type_a, type_b);
    std::swap(parts_a, parts_b);
  }
  Block& block = blocks_[{type_a, type_b}];
  if (block.cells.empty()) {
    block.parts_a = parts_a;
    block.parts_b = parts_b;
    block.cells.resize(parts_a * parts_b);
  }
  return block;
}

PartPairCounts& PartTally::cell(Block& block, uint16_t type_a, uint16_t type_b, size_t part_a,
                                size_t part_b) {
  if (type_b < type_a || (type_a == type_b && part_b < part_a)) std::swap(part_a, part_b);
  return block.cells[part_a * block.parts_b + part_b];
}

void PartTally::add(const PartTally& other) {
  counts_touching &= other.counts_touching;
  for (const auto& [types, source] : other.blocks_) {
    Block& target = block(types.first, types.second, source.parts_a, source.parts_b);
    target.body_pairs += source.body_pairs;
    for (size_t i = 0; i < target.cells.size(); ++i) target.cells[i].add(source.cells[i]);
  }
}

PartTally::Blocks PartTally::blocks() const {
  Blocks out = blocks_;
  for (auto& [types, block] : out) {
    const bool is_one = types.first == types.second;
    for (size_t a = 0; a < block.parts_a; ++a)
      for (size_t b = is_one ? a : 0; b < block.parts_b; ++b)
        block.cells[a * block.parts_b + b].box_tests =
            is_one && a != b ? 2 * block.body_pairs : block.body_pairs;
  }
  return out;
}

}  // namespace throng
