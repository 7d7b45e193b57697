#include "culling/distance/surface_point.h"

#include <limits>
#include <utility>

#include "culling/distance/simplex.h"
#include "culling/exact/tree_pair.h"

namespace throng {
namespace {

using Eigen::Vector3d;

/// The point of a triangle nearest to `to`, less that.
Vector3d nearest_on_triangle(const std::array<Eigen::Vector3f, 3>& corners, const Vector3d& to) {
  const Vector3d a = corners[0].cast<double>() - to, b = corners[1].cast<double>() - to,
                 c = corners[2].cast<double>() - to;
  const std::array<double, 3> weights = weights_of_nearest(a, b, c);
  return weights[0] * a + weights[1] * b + weights[2] * c;
}

}  // namespace

SurfacePoint nearest_on_surface(const TriangleBvh& surface, const Vector3d& to,
                                ExactCounters& counters) {
  struct Waiting {
    uint32_t node;
    double squared;
  };
  const auto waiting = [&](uint32_t node) {
    ++counters.node_tests;
    return Waiting{node, squared_to_box(surface.nodes()[node], to)};
  };
  SurfacePoint out{to, std::numeric_limits<double>::infinity()};
  Waiting stack[TriangleBvh::kMaxDepth + 2];
  int top = 0;
  stack[top++] = waiting(0);
  while (top > 0) {
    const Waiting at = stack[--top];
    if (at.squared >= out.squared) continue;
    const TriangleBvh::Node& node = surface.nodes()[at.node];
    if (node.count == 0) {
      Waiting near = waiting(at.node + 1), far = waiting(node.first);
      if (far.squared < near.squared) std::swap(near, far);
      stack[top++] = far;
      stack[top++] = near;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Vector3d between = nearest_on_triangle(surface.triangles()[i], to);
      if (const double squared = between.squaredNorm(); squared < out.squared)
        out = {to + between, squared};
    }
  }
  return out;
}

}  // namespace throng
