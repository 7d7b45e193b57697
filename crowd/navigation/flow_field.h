// FlowField gives walking distance and direction to a goal from every point: a grid around inflated
// obstacles. Gaps too narrow for the grid's cells are found separately.
// Invariant: built once per goal; a query is O(1), plus a binary search near narrow gaps. Results
// are the same on every machine.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "crowd/navigation/walkable.h"

namespace throng {

/// The four cells whose centres surround a point, with bilinear weights.
struct CellPatch {
  size_t cell, right, above;  ///< the lower left cell, and the offsets to others: 0 at the rim
  float fx, fy;               ///< position of the point between the first and the last centre

  /// `in_cells`: a point in cells from the grid's corner.
  CellPatch(const Eigen::Vector2d& in_cells, int columns, int rows) {
    const double x = std::clamp(in_cells.x() - 0.5, 0.0, static_cast<double>(columns - 1));
    const double y = std::clamp(in_cells.y() - 0.5, 0.0, static_cast<double>(rows - 1));
    const auto column = static_cast<int>(x), row = static_cast<int>(y);
    cell = static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
    right = column + 1 < columns ? 1 : 0;
    above = row + 1 < rows ? static_cast<size_t>(columns) : 0;
    fx = static_cast<float>(x - column);
    fy = static_cast<float>(y - row);
  }

  /// Interpolates at(cell) bilinearly.
  template <typename At>
  Eigen::Vector2f blend(const At& at) const {
    return (1 - fy) * ((1 - fx) * at(cell) + fx * at(cell + right)) +
           fy * ((1 - fx) * at(cell + above) + fx * at(cell + above + right));
  }
};

/// FlowGrid divides the ground into cells and knows which of them an agent's centre may pass.
class FlowGrid {
 public:
  /// Keeps a reference to `walkable`.
  explicit FlowGrid(const Walkable& walkable);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  size_t cell_count() const { return slowness_.size(); }
  double cell_m() const { return cell_m_; }
  bool is_free(size_t cell) const { return slowness_[cell] > 0; }
  /// Cost of a metre relative to the open, higher near walls; 0 where no agent passes.
  double slowness(size_t cell) const { return static_cast<double>(slowness_[cell]); }
  Eigen::Vector2d centre_m(size_t cell) const;
  /// Where agents pass through a free cell: its centre, or in a narrow gap the middle of the gap.
  Eigen::Vector2d place_m(size_t cell) const;
  /// Returns whether an agent in a cell has reached an area, see has_reached().
  bool reaches(size_t cell, const Area& area) const;
  /// Returns whether no wall stands between the centre of a cell and an area.
  bool is_open_to(size_t cell, const Area& area) const;
  /// Narrowest gap for discs of 0.44 m (a person of 1.70 m), with a centimetre of tolerance for the
  /// position of walls relative to cells.
  static constexpr double kMinGap_m = 0.43;
  /// The cells left, right, below and above that are linked to a cell; -1 where none is.
  std::array<ptrdiff_t, 4> free_neighbours(size_t cell) const;
  /// Returns whether the straight segment leads through free cells only (to a tenth of a cell).
  bool is_free_between(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  /// Cells in and before gaps that contain no cell centre; ascending.
  const std::vector<std::pair<size_t, Eigen::Vector2d>>& narrow() const { return narrow_; }
  /// Straight segments between cells, through gaps that contain few cell centres or none.
  const std::vector<Passage>& passages() const { return passages_; }
  /// Segments from wall to wall between nearby cells where no agent fits through.
  const std::vector<Passage>& closures() const { return closures_; }
  /// Points beyond the ground count as at its rim.
  size_t cell_at(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d in_cells = this->in_cells(point);
    const auto at = [](double cells, int count) {
      return static_cast<size_t>(static_cast<int>(std::clamp(cells, 0.0, count - 0.5)));
    };
    return at(in_cells.y(), rows_) * static_cast<size_t>(columns_) + at(in_cells.x(), columns_);
  }
  /// From the grid's corner.
  Eigen::Vector2d in_cells(const Eigen::Vector2d& point) const {
    return cells_per_m_ * (point - origin_m_);
  }
  const Eigen::Vector2d& origin_m() const { return origin_m_; }

  /// Minimum distance of a centre to a footprint for this cell size: half the hips, or more to
  /// detect walls between two cell centres.
  static double margin_m(double cell_m);
  /// Wider gaps of any direction contain centres of neighbouring cells.
  static double max_gap_m(double cell_m) { return 2 * margin_m(cell_m) + 1.5 * cell_m; }

 private:
  void find_narrow(const Walkable& walkable, std::span<const float> clearances_m);
  void add_approaches(const Walkable& walkable, std::span<const float> clearances_m);
  void link(const Walkable& walkable, std::span<const float> clearances_m);
  void join(const Walkable& walkable, size_t from, size_t to);
  bool is_narrow(size_t cell) const;

  const Walkable* walkable_;
  Eigen::Vector2d origin_m_;
  double cell_m_ = 0, cells_per_m_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> slowness_;
  std::vector<uint8_t> links_;  ///< per cell, a bit for each of left, right, below, above
  std::vector<std::pair<size_t, Eigen::Vector2d>> narrow_;
  std::vector<Passage> passages_;
  std::vector<Passage> closures_;
};

/// Cost of a cell.
enum class CellPolicy : uint8_t {
  kFree,
  kPenalised,  ///< a metre counts FlowField::kPenalty times
  kBlocked,    ///< no path leads through
};

class FlowField {
 public:
  /// Solves |grad distance| = slowness from the areas of a goal by fast marching (Sethian 1996):
  /// each point leads to the area with the shortest path. Keeps a reference to `grid`. `closed` is
  /// empty or has 1 for cells in a closed door, which cost kClosed_m each. Policies are per cell,
  /// or empty.
  FlowField(const FlowGrid& grid, std::span<const Area> areas, std::span<const uint8_t> closed = {},
            std::span<const CellPolicy> cell_policies = {});
  FlowField(const FlowGrid& grid, const Area& area)
      : FlowField(grid, std::span<const Area>(&area, 1)) {}

  /// Unit direction to walk, interpolated between cells; zero at the goal and without a path.
  Eigen::Vector2d direction(const Eigen::Vector2d& point) const;
  /// Prefetches what direction() of the same point reads.
  void prefetch(const Eigen::Vector2d& point) const;
  /// Walking distance to the goal from the point's cell, weighted by slowness. Infinite without a
  /// path, or if the cell is too close to an obstacle.
  double distance_m(const Eigen::Vector2d& point) const;
  bool reaches(const Eigen::Vector2d& point) const;
  /// The same as distance_m() of any point of a cell.
  float cell_distance_m(size_t cell) const { return cells_[cell].distance_m; }
  bool is_closed(const Eigen::Vector2d& point) const {
    return !is_closed_.empty() && is_closed_[grid_->cell_at(point)] != 0;
  }

  /// Detour that agents prefer to waiting for a door. A leaf is one to three cells thick.
  static constexpr double kClosed_m = 20;
  /// Cost factor of penalised cells: agents pass them only if the path around is long.
  static constexpr double kPenalty = 4;

 private:
  /// Together, because both are read for one place.
  struct Cell {
    Eigen::Vector2f direction = Eigen::Vector2f::Zero();
    float distance_m = std::numeric_limits<float>::infinity();
  };

  CellPatch patch_at(const Eigen::Vector2d& point) const;
  void march(std::span<const Area> areas, std::span<const uint8_t> closed,
             std::span<const CellPolicy> cell_policies);
  void compute_directions();
  void fill_blocked_cells();
  void aim_through_gaps();
  size_t downhill_of(size_t cell) const;
  const Eigen::Vector2d* aim_at(const Eigen::Vector2d& point) const;

  const FlowGrid* grid_;
  std::vector<Cell> cells_;
  std::vector<uint8_t> is_closed_;  ///< per cell; empty without closed doors
  /// Places to walk to near narrow gaps and before goals without a free cell; ascending by cell.
  std::vector<std::pair<size_t, Eigen::Vector2d>> aims_;
};

}  // namespace throng
