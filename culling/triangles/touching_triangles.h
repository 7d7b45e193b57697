// TouchingTriangles finds the touching triangles of two parts by traversing both trees.
// Invariant: no touching pair is missed: boxes count as overlapping within the rounding error.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/pose.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/triangles/triangle_test.h"

namespace throng {

// RelativeFrame and the helpers below serve all traversals of two trees. They use double precision
// and treat float-rounded rotations as exact, so that the inverse is exact.

inline Eigen::Vector3d to_double(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

inline Eigen::Matrix3d scaled_rotation(const PartPose& pose, float scale) {
  Eigen::Matrix3d out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      out(r, c) = static_cast<double>(scale) * static_cast<double>(pose.rows[r][c]);
  return out;
}

inline Eigen::Vector3d translation(const PartPose& pose) {
  return {static_cast<double>(pose.rows[0][3]), static_cast<double>(pose.rows[1][3]),
          static_cast<double>(pose.rows[2][3])};
}

/// B's part frame in A's: a = linear * b + offset, in A's unit of length.
struct RelativeFrame {
  Eigen::Matrix3d linear, inverse;
  Eigen::Matrix3d linear_abs, inverse_abs;
  Eigen::Vector3d offset;

  /// a_to_b_m: B's root minus A's.
  RelativeFrame(const PartPose& pose_a, float scale_a, const PartPose& pose_b, float scale_b,
                const Eigen::Vector3f& a_to_b_m) {
    const Eigen::Matrix3d world_from_a = scaled_rotation(pose_a, scale_a);
    const Eigen::Matrix3d world_from_b = scaled_rotation(pose_b, scale_b);
    const Eigen::Matrix3d a_from_world = world_from_a.inverse();
    linear = a_from_world * world_from_b;
    inverse = world_from_b.inverse() * world_from_a;
    offset = a_from_world * (a_to_b_m.cast<double>() + translation(pose_b) - translation(pose_a));
    linear_abs = linear.cwiseAbs();
    inverse_abs = inverse.cwiseAbs();
  }
};

/// Squared distance from a point in the same frame to the box.
inline double squared_to_box(const TriangleBvh::Node& node, const Eigen::Vector3d& from) {
  return ((from - to_double(node.centre_m)).cwiseAbs() - to_double(node.half_m))
      .cwiseMax(0)
      .squaredNorm();
}

/// Sum of the half sides.
inline double width(const TriangleBvh::Node& node) {
  return static_cast<double>(node.half_m[0]) + static_cast<double>(node.half_m[1]) +
         static_cast<double>(node.half_m[2]);
}

/// True to open the node of A, false for B: the wider one that is not a leaf. At most one of the
/// two is a leaf. `ratio`: B's unit of length in A's.
inline bool opens_a(const TriangleBvh::Node& a, const TriangleBvh::Node& b, double ratio) {
  return b.count > 0 || (a.count == 0 && width(a) > ratio * width(b));
}

inline Triangle in_own_frame(const std::array<Eigen::Vector3f, 3>& corners) {
  return {{corners[0].cast<double>(), corners[1].cast<double>(), corners[2].cast<double>()}};
}

/// Tests the face normals of both boxes; edge axes cost more than the nodes they would save. Forced
/// inline: a call per node costs a twentieth of the narrow phase.
[[gnu::always_inline]] inline bool boxes_overlap(const TriangleBvh::Node& a,
                                                 const TriangleBvh::Node& b,
                                                 const RelativeFrame& a_from_b, double slack) {
  const Eigen::Vector3d half_a = to_double(a.half_m), half_b = to_double(b.half_m);
  const Eigen::Vector3d t =
      a_from_b.linear * to_double(b.centre_m) + a_from_b.offset - to_double(a.centre_m);
  const Eigen::Vector3d reach_a = half_a + a_from_b.linear_abs * half_b;
  for (int i = 0; i < 3; ++i)
    if (std::fabs(t[i]) > reach_a[i] + slack) return false;
  const Eigen::Vector3d u = a_from_b.inverse * t;
  const Eigen::Vector3d reach_b = half_b + a_from_b.inverse_abs * half_a;
  for (int i = 0; i < 3; ++i)
    if (std::fabs(u[i]) > reach_b[i] + slack) return false;
  return true;
}

/// Order of traversal: which two nodes are opened first, and which not at all. Here any order, all
/// nodes. A rank is computed from that of the previous nodes and the opened one.
struct InAnyOrder {
  struct Rank {};
  static Rank with_a(Rank, const TriangleBvh::Node&) { return {}; }
  static Rank with_b(Rank, const TriangleBvh::Node&) { return {}; }
  static bool is_open(Rank) { return true; }
  static bool is_before(Rank, Rank) { return false; }
};

/// Calls visit(triangle of A, of B), in A's frame, for each touching pair until it returns true.
class TouchingTriangles {
 public:
  TouchingTriangles(const TriangleBvh& a, const TriangleBvh& b, const RelativeFrame& a_from_b,
                    double ratio, TriangleCounters& counters)
      : a_(a), b_(b), a_from_b_(a_from_b), ratio_(ratio), counters_(counters) {
    // Far above double rounding in the products below, far below any measurable length.
    const Node& root_a = a.nodes()[0];
    const Node& root_b = b.nodes()[0];
    const double size = a_from_b.offset.cwiseAbs().maxCoeff() + size_of(root_a) +
                        a_from_b.linear_abs.maxCoeff() * size_of(root_b);
    slack_ = 1e-13 * size * std::max(1.0, a_from_b.inverse_abs.maxCoeff());
  }

  /// True if a visit returned true.
  template <typename Visit, typename Order = InAnyOrder>
  bool visit(const Visit& visit, const Order& order = {}) const {
    // Each step removes one pair and adds at most two, one level deeper in one tree.
    struct Pair {
      uint32_t a, b;
      [[no_unique_address]] typename Order::Rank rank;
    };
    Pair stack[2 * TriangleBvh::kMaxDepth + 2];
    int top = 0;
    stack[top++] = {0, 0, {}};
    while (top > 0) {
      const Pair at = stack[--top];
      if (!order.is_open(at.rank)) continue;
      const Node& node_a = a_.nodes()[at.a];
      const Node& node_b = b_.nodes()[at.b];
      ++counters_.node_tests;
      if (!boxes_overlap(node_a, node_b, a_from_b_, slack_)) continue;
      if (node_a.count > 0 && node_b.count > 0) {
        if (visit_leaves(node_a, node_b, visit)) return true;
        continue;
      }
      const auto with_a = [&](uint32_t a) {
        return Pair{a, at.b, order.with_a(at.rank, a_.nodes()[a])};
      };
      const auto with_b = [&](uint32_t b) {
        return Pair{at.a, b, order.with_b(at.rank, b_.nodes()[b])};
      };
      const bool of_a = opens_a(node_a, node_b, ratio_);
      Pair near = of_a ? with_a(at.a + 1) : with_b(at.b + 1);
      Pair far = of_a ? with_a(node_a.first) : with_b(node_b.first);
      if (order.is_before(far.rank, near.rank)) std::swap(near, far);
      stack[top++] = far;
      stack[top++] = near;
    }
    return false;
  }

 private:
  using Node = TriangleBvh::Node;

  static double size_of(const Node& node) {
    return (to_double(node.centre_m).cwiseAbs() + to_double(node.half_m)).sum();
  }

  template <typename Visit>
  bool visit_leaves(const Node& node_a, const Node& node_b, const Visit& visit) const {
    const Eigen::Vector3d centre = to_double(node_a.centre_m), half = to_double(node_a.half_m);
    for (uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
      Triangle tb = in_own_frame(b_.triangles()[j]);
      for (Eigen::Vector3d& corner : tb.corner)
        corner = a_from_b_.linear * corner + a_from_b_.offset;
      const Eigen::Vector3d low =
          tb.corner[0].cwiseMin(tb.corner[1]).cwiseMin(tb.corner[2]) - centre;
      const Eigen::Vector3d high =
          tb.corner[0].cwiseMax(tb.corner[1]).cwiseMax(tb.corner[2]) - centre;
      bool apart = false;
      for (int i = 0; i < 3; ++i) apart |= low[i] > half[i] + slack_ || high[i] < -half[i] - slack_;
      if (apart) continue;
      for (uint32_t i = node_a.first; i < node_a.first + node_a.count; ++i) {
        ++counters_.triangle_tests;
        const Triangle ta = in_own_frame(a_.triangles()[i]);
        if (triangles_touch(ta, tb) && visit(ta, tb)) return true;
      }
    }
    return false;
  }

  const TriangleBvh& a_;
  const TriangleBvh& b_;
  const RelativeFrame& a_from_b_;
  double ratio_;  ///< B's unit of length in A's
  double slack_ = 0;
  TriangleCounters& counters_;
};

/// A point of one surface, in A's frame, inside a solid of the other. Requires that no triangles
/// touch: each piece of a surface is then completely inside or outside each solid.
std::optional<Eigen::Vector3d> piece_inside(const TriangleBvh& a, const TriangleBvh& b,
                                            const RelativeFrame& a_from_b);

}  // namespace throng
