// People so near to somebody else that their spheres overlap: what the first culling stage passes.
// One rule: only for showing; culling has its own search, made for speed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace throng {

struct PlacedSphere {
  float x = 0, y = 0, z = 0;
  float radius = 0;  ///< 0: nobody there
};

class Crowded {
 public:
  /// flags[i] becomes 1 if sphere i overlaps another one, else 0; returns how many do. Nothing is
  /// allocated once it has seen as many spheres.
  size_t mark(std::span<const PlacedSphere> spheres, std::span<uint8_t> flags);

 private:
  struct Grid;
  void sort_by_cell(std::span<const PlacedSphere> spheres, const Grid& grid);

  std::vector<uint32_t> cell_of_, start_, next_, order_;
};

}  // namespace throng
