#include <Eigen/LU>
#include <cassert>
#include <cmath>

#include "culling/exact/triangle_bvh.h"
#include "culling/exact/triangle_test.h"

namespace throng {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Node = TriangleBvh::Node;

Vector3d to_double(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Matrix3d scaled_rotation(const PartPose& pose, float scale) {
  Matrix3d out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      out(r, c) = static_cast<double>(scale) * static_cast<double>(pose.rows[r][c]);
  return out;
}

Vector3d translation(const PartPose& pose) {
  return {static_cast<double>(pose.rows[0][3]), static_cast<double>(pose.rows[1][3]),
          static_cast<double>(pose.rows[2][3])};
}

/// B's part frame seen from A's: a = linear * b + offset. Touching does not depend on the frame,
/// and the inverse is a true one, so that rotations rounded to float are taken as they are.
struct Relative {
  Matrix3d linear, inverse;
  Matrix3d linear_abs, inverse_abs;
  Vector3d offset;

  Relative(const PartPose& pose_a, float scale_a, const PartPose& pose_b, float scale_b,
           const Eigen::Vector3f& a_to_b_m) {
    const Matrix3d world_from_a = scaled_rotation(pose_a, scale_a);
    const Matrix3d world_from_b = scaled_rotation(pose_b, scale_b);
    const Matrix3d a_from_world = world_from_a.inverse();
    linear = a_from_world * world_from_b;
    inverse = world_from_b.inverse() * world_from_a;
    offset = a_from_world * (a_to_b_m.cast<double>() + translation(pose_b) - translation(pose_a));
    linear_abs = linear.cwiseAbs();
    inverse_abs = inverse.cwiseAbs();
  }
};

/// The face normals of both boxes; the edge axes cost more than the nodes that they would spare.
bool boxes_overlap(const Node& a, const Node& b, const Relative& a_from_b, double slack) {
  const Vector3d half_a = to_double(a.half_m), half_b = to_double(b.half_m);
  const Vector3d t =
      a_from_b.linear * to_double(b.centre_m) + a_from_b.offset - to_double(a.centre_m);
  const Vector3d reach_a = half_a + a_from_b.linear_abs * half_b;
  for (int i = 0; i < 3; ++i)
    if (std::fabs(t[i]) > reach_a[i] + slack) return false;
  const Vector3d u = a_from_b.inverse * t;
  const Vector3d reach_b = half_b + a_from_b.inverse_abs * half_a;
  for (int i = 0; i < 3; ++i)
    if (std::fabs(u[i]) > reach_b[i] + slack) return false;
  return true;
}

Triangle in_own_frame(const std::array<Eigen::Vector3f, 3>& corners) {
  return {{corners[0].cast<double>(), corners[1].cast<double>(), corners[2].cast<double>()}};
}

class Traversal {
 public:
  Traversal(const TriangleBvh& a, const TriangleBvh& b, const Relative& a_from_b, double ratio,
            ExactCounters& counters)
      : a_(a), b_(b), a_from_b_(a_from_b), ratio_(ratio), counters_(counters) {
    // Far above what double rounds in the products below, far below what anyone measures.
    const Node& root_a = a.nodes()[0];
    const Node& root_b = b.nodes()[0];
    const double size = a_from_b.offset.cwiseAbs().maxCoeff() + size_of(root_a) +
                        a_from_b.linear_abs.maxCoeff() * size_of(root_b);
    slack_ = 1e-13 * size * std::max(1.0, a_from_b.inverse_abs.maxCoeff());
  }

  bool surfaces_touch() {
    // Each step takes one pair off and puts at most two on, one level deeper in one tree.
    struct Pair {
      uint32_t a, b;
    };
    Pair stack[2 * TriangleBvh::kMaxDepth + 2];
    int top = 0;
    stack[top++] = {0, 0};
    while (top > 0) {
      const Pair at = stack[--top];
      const Node& node_a = a_.nodes()[at.a];
      const Node& node_b = b_.nodes()[at.b];
      ++counters_.node_tests;
      if (!boxes_overlap(node_a, node_b, a_from_b_, slack_)) continue;
      if (node_a.count > 0 && node_b.count > 0) {
        if (leaves_touch(node_a, node_b)) return true;
      } else if (node_b.count > 0 ||
                 (node_a.count == 0 && width(node_a) > ratio_ * width(node_b))) {
        stack[top++] = {node_a.first, at.b};
        stack[top++] = {at.a + 1, at.b};
      } else {
        stack[top++] = {at.a, node_b.first};
        stack[top++] = {at.a, at.b + 1};
      }
    }
    return false;
  }

 private:
  static double size_of(const Node& node) {
    return (to_double(node.centre_m).cwiseAbs() + to_double(node.half_m)).sum();
  }
  static double width(const Node& node) {
    return static_cast<double>(node.half_m[0]) + static_cast<double>(node.half_m[1]) +
           static_cast<double>(node.half_m[2]);
  }

  bool leaves_touch(const Node& node_a, const Node& node_b) {
    const Vector3d centre = to_double(node_a.centre_m), half = to_double(node_a.half_m);
    for (uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
      Triangle tb = in_own_frame(b_.triangles()[j]);
      for (Vector3d& corner : tb.corner) corner = a_from_b_.linear * corner + a_from_b_.offset;
      const Vector3d low = tb.corner[0].cwiseMin(tb.corner[1]).cwiseMin(tb.corner[2]) - centre;
      const Vector3d high = tb.corner[0].cwiseMax(tb.corner[1]).cwiseMax(tb.corner[2]) - centre;
      bool apart = false;
      for (int i = 0; i < 3; ++i) apart |= low[i] > half[i] + slack_ || high[i] < -half[i] - slack_;
      if (apart) continue;
      for (uint32_t i = node_a.first; i < node_a.first + node_a.count; ++i) {
        ++counters_.triangle_tests;
        if (triangles_touch(in_own_frame(a_.triangles()[i]), tb)) return true;
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

}  // namespace

bool solids_touch(const TriangleBvh& a, const PartPose& pose_a, float scale_a, const TriangleBvh& b,
                  const PartPose& pose_b, float scale_b, const Eigen::Vector3f& a_to_b_m,
                  ExactCounters& counters) {
  assert(scale_a > 0 && scale_b > 0);
  const Relative a_from_b(pose_a, scale_a, pose_b, scale_b, a_to_b_m);
  const double ratio = static_cast<double>(scale_b) / static_cast<double>(scale_a);
  if (Traversal(a, b, a_from_b, ratio, counters).surfaces_touch()) return true;
  // The surfaces do not meet, so each piece lies wholly inside or wholly outside each solid.
  for (const Eigen::Vector3f& p : b.pieces())
    if (a.contains(a_from_b.linear * p.cast<double>() + a_from_b.offset)) return true;
  for (const Eigen::Vector3f& p : a.pieces())
    if (b.contains(a_from_b.inverse * (p.cast<double>() - a_from_b.offset))) return true;
  return false;
}

}  // namespace throng
