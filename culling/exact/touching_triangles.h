// The triangles of two parts that touch each other, found down both trees.
// One rule: none is missed: boxes count as overlapping while rounding leaves a doubt.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "culling/exact/tree_pair.h"

namespace throng {

/// The face normals of both boxes; the edge axes cost more than the nodes that they would spare.
/// Inlined for certain: a call for each node costs a twentieth of the exact stage.
[[gnu::always_inline]] inline bool boxes_overlap(const TriangleBvh::Node& a,
                                                 const TriangleBvh::Node& b,
                                                 const Relative& a_from_b, double slack) {
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

/// Which two nodes are opened first, and which not at all: here any, and all are. A rank is made of
/// that of the nodes before and of the one that was opened.
struct InAnyOrder {
  struct Rank {};
  static Rank with_a(Rank, const TriangleBvh::Node&) { return {}; }
  static Rank with_b(Rank, const TriangleBvh::Node&) { return {}; }
  static bool is_open(Rank) { return true; }
  static bool is_before(Rank, Rank) { return false; }
};

/// Calls visit(triangle of A, triangle of B), both in A's frame, for each two triangles that touch,
/// until it returns true.
class TouchingTriangles {
 public:
  TouchingTriangles(const TriangleBvh& a, const TriangleBvh& b, const Relative& a_from_b,
                    double ratio, ExactCounters& counters)
      : a_(a), b_(b), a_from_b_(a_from_b), ratio_(ratio), counters_(counters) {
    // Far above what double rounds in the products below, far below what anyone measures.
    const Node& root_a = a.nodes()[0];
    const Node& root_b = b.nodes()[0];
    const double size = a_from_b.offset.cwiseAbs().maxCoeff() + size_of(root_a) +
                        a_from_b.linear_abs.maxCoeff() * size_of(root_b);
    slack_ = 1e-13 * size * std::max(1.0, a_from_b.inverse_abs.maxCoeff());
  }

  /// True if a visit did.
  template <typename Visit, typename Order = InAnyOrder>
  bool visit(const Visit& visit, const Order& order = {}) const {
    // Each step takes one pair off and puts at most two on, one level deeper in one tree.
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
  const Relative& a_from_b_;
  double ratio_;  ///< B's unit of length in A's
  double slack_ = 0;
  ExactCounters& counters_;
};

/// A point of one surface, in A's frame, that lies inside a solid of the other, where no triangles
/// touch: each piece of a surface then lies wholly inside or wholly outside each solid.
std::optional<Eigen::Vector3d> piece_inside(const TriangleBvh& a, const TriangleBvh& b,
                                            const Relative& a_from_b);

}  // namespace throng
