// TriangleBvh is a bounding volume hierarchy over the triangles of a part; solids_touch() is the
// test of the narrow phase. It is the reference for all volumes, so it uses double precision.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"

namespace throng {

/// Tests in the narrow phase: the two parts of the paper's N_p.
struct TriangleCounters {
  uint64_t node_tests = 0;
  uint64_t triangle_tests = 0;
};

/// Tree of boxes over the triangles of one part, in the part's frame. Built once and shared by all
/// bodies. The same input gives the same tree with every compiler.
class TriangleBvh {
 public:
  /// Needs triangles (see BodyType::has_triangles()) and valid indices (asserted).
  TriangleBvh(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3i> triangles);

  /// Box of a subtree. Nodes are in depth-first order: the left child follows its parent.
  struct Node {
    std::array<float, 3> centre_m;
    std::array<float, 3> half_m;  ///< rounded up
    uint32_t first;               ///< leaf: first triangle; otherwise: right child
    uint32_t count;               ///< number of triangles of a leaf; 0: not a leaf
  };
  static_assert(sizeof(Node) == 32);
  static constexpr uint32_t kLeafTriangles = 4;
  /// Splits below this depth are halves, which limits the depth to kMaxDepth.
  static constexpr int kFreeDepth = 24;
  static constexpr int kMaxDepth = kFreeDepth + 32;

  std::span<const Node> nodes() const { return nodes_; }
  /// Corners of the triangles in the order of the leaves, in the part's frame, in metres.
  std::span<const std::array<Eigen::Vector3f, 3>> triangles() const { return triangles_; }
  /// One corner of each connected piece of the surface.
  std::span<const Eigen::Vector3f> pieces() const { return pieces_; }

  /// Number of closed pieces, each a solid with an inside; see Surface::solids().
  uint32_t solid_count() const { return solid_count_; }
  /// True if a solid winds around the point (part's frame, metres), in either orientation. Each
  /// solid counts separately: overlapping solids form their union, and a cavity counts as inside.
  /// Either result is possible on the surface.
  bool contains(const Eigen::Vector3d& point_m) const;

 private:
  std::vector<Node> nodes_;
  std::vector<std::array<Eigen::Vector3f, 3>> triangles_;
  std::vector<Eigen::Vector3f> pieces_;
  uint32_t solid_count_ = 0;
  std::vector<uint32_t> solids_;  ///< indexed by triangle; empty if all bound a single solid
};

/// True if triangles of A and B touch, or a piece of one is inside a solid of the other. Poses and
/// scales as in base/pose.h; a_to_b_m: B's root minus A's. Does not allocate.
bool solids_touch(const TriangleBvh& a, const PartPose& pose_a, float scale_a, const TriangleBvh& b,
                  const PartPose& pose_b, float scale_b, const Eigen::Vector3f& a_to_b_m,
                  TriangleCounters& counters);

}  // namespace throng
