// Who stands near whom: a uniform grid filled by counting sort.
// One rule: the nearest others come ordered by (distance, id), so that no answer depends on
// threads.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "scenes/scene.h"

namespace throng {

struct Neighbour {
  double square_m2 = 0;  ///< squared distance
  uint32_t id = 0;
};

class NeighbourGrid {
 public:
  /// Points outside the ground are kept in its border cells: nothing is lost, only slower.
  explicit NeighbourGrid(const Rectangle& ground);

  /// Sorts the points into cells; allocates only if there are more than ever before. Whoever is not
  /// `present` (one byte a point; empty: everybody is) is left out.
  void rebuild(std::span<const Eigen::Vector2d> positions_m, std::span<const uint8_t> present = {});

  /// The nearest others of point `id` within `reach_m`, at most out.size(); returns how many.
  size_t nearest(uint32_t id, double reach_m, std::span<Neighbour> out) const;

  /// All ids that are in, cell by cell: neighbours in space lie near in memory.
  std::span<const uint32_t> order() const { return order_; }

 private:
  void visit_cell(int column, int row, uint32_t id, double reach_square, std::span<Neighbour> out,
                  size_t& count) const;
  size_t cell_of(const Eigen::Vector2d& point) const;

  Eigen::Vector2d origin_m_;
  double cell_m_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<uint32_t> starts_;  ///< cells + 1 entries into order_
  std::vector<uint32_t> cells_;   ///< of every id
  std::vector<uint32_t> order_;
  std::vector<Eigen::Vector2d> sorted_m_;  ///< positions in the order of order_
  std::vector<Eigen::Vector2d> positions_m_;
};

}  // namespace throng
