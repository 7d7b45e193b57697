// A convex polytope that grows point by point, as triangles with their planes.
// One rule: every point added is a corner or inside, to within what rounding and faces too thin to
// have a plane leave: some nanometres at the size of a body.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace throng {

class GrowingPolytope {
 public:
  struct Face {
    std::array<uint32_t, 3> corners{};                 ///< counter-clockwise from outside
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, outwards
    /// Inside: normal . x <= distance. Infinite: a face too thin to have a plane; its neighbours
    /// bound what it does.
    double distance = std::numeric_limits<double>::infinity();
    bool settled = false;  ///< for the caller's use: false for a new face
    bool is_thin() const { return distance == std::numeric_limits<double>::infinity(); }
  };

  /// Four corners that span a volume, in any order. Keeps its memory.
  void start(const std::array<Eigen::Vector3d, 4>& corners);
  /// Makes the polytope the hull of itself and the point; false if it is that already.
  bool add(const Eigen::Vector3d& point);

  std::span<const Face> faces() const { return faces_; }
  void settle(size_t face) { faces_[face].settled = true; }
  /// All that were added; those that are inside by now are nobody's corner.
  std::span<const Eigen::Vector3d> points() const { return points_; }

 private:
  struct Edge {
    uint32_t from, to;
  };

  Face face(uint32_t a, uint32_t b, uint32_t c) const;
  void remove(size_t face);
  void remove_thin_beside_removed();

  std::vector<Eigen::Vector3d> points_;
  std::vector<Face> faces_;
  std::vector<Edge> removed_;  ///< the edges of the faces that a point sees
  double size_m_ = 0;
};

}  // namespace throng
