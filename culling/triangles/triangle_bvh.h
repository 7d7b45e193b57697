// The exact stage: whether the surfaces of two parts touch, or one lies inside the other.
// One rule: the truth that all volumes are measured by, so it is decided in double precision.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"

namespace throng {

/// The paper's N_p, in its two halves.
struct TriangleCounters {
  uint64_t node_tests = 0;
  uint64_t triangle_tests = 0;
};

/// Boxes over the triangles of one part, in the part's own frame; built once, shared by all bodies.
/// The same input gives the same tree, on every compiler.
class TriangleBvh {
 public:
  /// At least one triangle, indices in range (asserted). A point cloud has no surface to test: ask
  /// BodyType::has_triangles() first.
  TriangleBvh(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3i> triangles);

  /// A box over a subtree. Nodes stand in depth-first order: the left child follows its parent.
  struct Node {
    std::array<float, 3> centre_m;
    std::array<float, 3> half_m;  ///< rounded up
    uint32_t first;               ///< leaf: its first triangle; else: the right child
    uint32_t count;               ///< triangles of a leaf; 0: not a leaf
  };
  static_assert(sizeof(Node) == 32);
  static constexpr uint32_t kLeafTriangles = 4;
  /// Splits are forced into halves below this depth, so that no tree is deeper than kMaxDepth.
  static constexpr int kFreeDepth = 24;
  static constexpr int kMaxDepth = kFreeDepth + 32;

  std::span<const Node> nodes() const { return nodes_; }
  /// Corners of the triangles in the order of the leaves, part's frame, metres.
  std::span<const std::array<Eigen::Vector3f, 3>> triangles() const { return triangles_; }
  /// One corner of each connected piece of the surface.
  std::span<const Eigen::Vector3f> pieces() const { return pieces_; }

  /// How many pieces of the surface are closed, each a solid with an inside; see Surface::solids().
  uint32_t solid_count() const { return solid_count_; }
  /// True if one of the solids winds round the point (part's frame, metres), whichever way it is
  /// oriented: each counts by itself, so overlapping ones are their union, and a cavity, a solid
  /// inside another, is inside. On the surface itself: either.
  bool contains(const Eigen::Vector3d& point_m) const;

 private:
  std::vector<Node> nodes_;
  std::vector<std::array<Eigen::Vector3f, 3>> triangles_;
  std::vector<Eigen::Vector3f> pieces_;
  uint32_t solid_count_ = 0;
  std::vector<uint32_t> solids_;  ///< by triangle; empty: all bound the one solid there is
};

/// True if any triangle of A touches any triangle of B, or a piece of one lies inside a solid of
/// the other. Poses and scales as in base/pose.h; a_to_b_m is B's root minus A's. No allocation.
bool solids_touch(const TriangleBvh& a, const PartPose& pose_a, float scale_a, const TriangleBvh& b,
                  const PartPose& pose_b, float scale_b, const Eigen::Vector3f& a_to_b_m,
                  TriangleCounters& counters);

}  // namespace throng
