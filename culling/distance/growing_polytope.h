// GrowingPolytope is a convex polytope that grows point by point, stored as triangles with planes.
// Invariant: it stays closed and convex for any points, with at most two faces per point. An exact
// test on a grid decides whether a point is in front of a face.
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
    std::array<uint32_t, 3> neighbours{};  ///< face across the edge from corner i to the next
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit outward normal
    Eigen::Vector3d cross = Eigen::Vector3d::Zero();   ///< the same normal in squared grid units
  };

  /// Grid spacing for coordinates of up to `reach_m`: 2e-12 to 4e-12 of it.
  static double grid_m(double reach_m);
  static Eigen::Vector3d on_grid(const Eigen::Vector3d& point, double grid_m) {
    return (point / grid_m).array().round().matrix() * grid_m;
  }

  /// Starts with four corners, in any order, that span a volume on the grid of `reach_m`
  /// (asserted). Moves every point to the grid. Keeps its memory.
  void start(const std::array<Eigen::Vector3d, 4>& corners, double reach_m);
  /// Extends the polytope to include a point in front of a face. False if the point is behind that
  /// face or in its plane; without a face: behind all faces.
  bool add(const Eigen::Vector3d& point, uint32_t face);
  bool add(const Eigen::Vector3d& point);

  /// Slots of faces; some are free, see is_face().
  std::span<const Face> faces() const { return faces_; }
  bool is_face(uint32_t slot) const { return distances_[slot] < kFree; }
  /// By slot: inside, normal . x <= distance. Infinite for free slots.
  std::span<const double> distances() const { return distances_; }
  /// Slots of the faces that the latest add() removed and added; a slot may be in both.
  std::span<const uint32_t> removed() const { return removed_; }
  std::span<const uint32_t> added() const { return added_; }
  /// All points added, on the grid, including those that are now inside.
  std::span<const Eigen::Vector3d> points() const { return points_; }
  double grid_m() const { return grid_m_; }

  /// Exact side of a face's plane for a grid point: 1 in front, 0 in the plane, -1 behind.
  int side(uint32_t face, const Eigen::Vector3d& on_grid) const {
    const Face& f = faces_[face];
    const Eigen::Vector3d terms = f.cross.cwiseProduct(on_grid - points_[f.corners[0]]);
    const double sum = terms.sum();
    // Three products of rounded numbers: their error is at most 5e-16 of their sum.
    if (std::abs(sum) > 1e-15 * terms.cwiseAbs().sum()) return sum > 0 ? 1 : -1;
    return exact_side(f, on_grid);
  }

 private:
  static constexpr double kFree = std::numeric_limits<double>::infinity();

  struct Edge {
    uint32_t from, to;
    uint32_t beyond;  ///< remaining face
  };

  int exact_side(const Face& face, const Eigen::Vector3d& on_grid) const;
  uint32_t add_face(uint32_t a, uint32_t b, uint32_t c);
  void find_horizon(const Eigen::Vector3d& point, uint32_t face);

  double grid_m_ = 1;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Face> faces_;  // by slot, as the next two
  std::vector<double> distances_;
  // number of points when a point was last in front of the face
  std::vector<uint32_t> visible_for_;
  std::vector<uint32_t> free_;
  std::vector<Edge> horizon_;  // around the faces with the point in front
  std::vector<uint32_t> removed_, added_;
  std::vector<uint32_t> begins_at_;  // by point: added face whose horizon edge begins there
};

}  // namespace throng
