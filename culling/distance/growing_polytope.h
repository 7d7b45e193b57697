// GrowingPolytope is a convex polytope that grows point by point, as triangles with their planes.
// Invariant: closed and convex whatever the points are, with at most two faces per point; which
// faces lie in front of a point is decided exactly, on a grid.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace throng {

class GrowingPolytope {
 public:
  struct Face {
    std::array<uint32_t, 3> corners{};     ///< counter-clockwise from outside
    std::array<uint32_t, 3> neighbours{};  ///< the face across the edge from corner i to the next
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, outwards
    Eigen::Vector3d cross = Eigen::Vector3d::Zero();   ///< the same in squares of the grid
  };

  /// Edge of the grid that holds coordinates of up to `reach_m`: 2e-12 to 4e-12 of it.
  static double grid_m(double reach_m);
  /// The nearest point of a grid.
  static Eigen::Vector3d on_grid(const Eigen::Vector3d& point, double grid_m) {
    return (point / grid_m).array().round().matrix() * grid_m;
  }

  /// Starts with four corners that span a volume on the grid of `reach_m` (asserted), in any order.
  /// Every point moves to the grid. Keeps its memory.
  void start(const std::array<Eigen::Vector3d, 4>& corners, double reach_m);
  /// Makes the polytope the hull of itself and of a point in front of a face; false if the point is
  /// behind that face or in its plane, or, without a face, behind all of them.
  bool add(const Eigen::Vector3d& point, uint32_t face);
  bool add(const Eigen::Vector3d& point);

  /// Slots of faces; some are free, see is_face().
  std::span<const Face> faces() const { return faces_; }
  bool is_face(uint32_t slot) const { return distances_[slot] < kFree; }
  /// By slot: inside, normal . x <= distance. Infinite for free slots.
  std::span<const double> distances() const { return distances_; }
  /// Slots of the faces that the latest add() took away and put in; a slot may be in both.
  std::span<const uint32_t> removed() const { return removed_; }
  std::span<const uint32_t> added() const { return added_; }
  /// All points added, on the grid; those that are inside by now are no corners.
  std::span<const Eigen::Vector3d> points() const { return points_; }
  double grid_m() const { return grid_m_; }

  /// Which side of a face's plane a point of the grid is on, exactly: 1 in front, 0 in it.
  int side(uint32_t face, const Eigen::Vector3d& on_grid) const {
    const Face& f = faces_[face];
    const Eigen::Vector3d terms = f.cross.cwiseProduct(on_grid - points_[f.corners[0]]);
    const double sum = terms.sum();
    // Three products of rounded numbers: off by 5e-16 of them at most.
    if (std::abs(sum) > 1e-15 * terms.cwiseAbs().sum()) return sum > 0 ? 1 : -1;
    return exact_side(f, on_grid);
  }

 private:
  static constexpr double kFree = std::numeric_limits<double>::infinity();

  struct Edge {
    uint32_t from, to;
    uint32_t beyond;  ///< the face that stays
  };

  int exact_side(const Face& face, const Eigen::Vector3d& on_grid) const;
  uint32_t add_face(uint32_t a, uint32_t b, uint32_t c);
  void find_horizon(const Eigen::Vector3d& point, uint32_t face);

  double grid_m_ = 1;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Face> faces_;  // by slot, as the next two
  std::vector<double> distances_;
  std::vector<uint32_t> visible_for_;  // the number of points when a point was last in front of it
  std::vector<uint32_t> free_;
  std::vector<Edge> horizon_;  // of the faces in front of which a point lies
  std::vector<uint32_t> removed_, added_;
  std::vector<uint32_t> begins_at_;  // by point: the added face whose horizon edge begins there
};

}  // namespace throng
