#include "culling/distance/surface_front.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "culling/exact/tree_pair.h"

namespace throng {
namespace {

using Eigen::Vector3d;

/// The directions that are asked are those of doubles; boxes and corners are of floats: their sums
/// round by less.
constexpr double kSumRounding = 1e-12;

double reach_along(const TriangleBvh::Node& node, const Vector3d& direction,
                   const Vector3d& direction_abs) {
  return direction.dot(to_double(node.centre_m)) + direction_abs.dot(to_double(node.half_m)) +
         kSumRounding;
}

double foremost_corner(const std::array<Eigen::Vector3f, 3>& corners, const Vector3d& direction) {
  const auto along = [&](size_t i) { return direction.dot(corners[i].cast<double>()); };
  return std::max({along(0), along(1), along(2)});
}

/// Calls visit(index, how far its foremost corner reaches) for the triangles of all leaves that may
/// reach least(), which may grow meanwhile; the foremost of two nodes first.
template <typename Least, typename Visit>
void for_foremost(const TriangleBvh& surface, const Vector3d& direction, const Least& least,
                  const Visit& visit) {
  const Vector3d direction_abs = direction.cwiseAbs();
  struct Waiting {
    uint32_t node;
    double reach;
  };
  const auto waiting = [&](uint32_t node) {
    return Waiting{node, reach_along(surface.nodes()[node], direction, direction_abs)};
  };
  Waiting stack[TriangleBvh::kMaxDepth + 2];
  int top = 0;
  stack[top++] = waiting(0);
  while (top > 0) {
    const Waiting at = stack[--top];
    if (at.reach < least()) continue;
    const TriangleBvh::Node& node = surface.nodes()[at.node];
    for (uint32_t i = node.first; i < node.first + node.count; ++i)
      visit(i, foremost_corner(surface.triangles()[i], direction));
    if (node.count > 0) continue;
    Waiting near = waiting(at.node + 1), far = waiting(node.first);
    if (far.reach > near.reach) std::swap(near, far);
    stack[top++] = far;
    stack[top++] = near;
  }
}

}  // namespace

bool SurfaceFront::gather(const TriangleBvh& surface, const Vector3d& direction, double ends,
                          double behind) {
  count = 0;
  bool has_room = true;
  for_foremost(
      surface, direction,
      [&] { return has_room ? ends - behind : std::numeric_limits<double>::infinity(); },
      [&](uint32_t index, double reach) {
        if (ends - reach > behind) return;
        has_room &= count < kMost;
        if (has_room) triangles[count++] = {index, ends - reach};
      });
  std::sort(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Triangle& p, const Triangle& q) {
              return p.behind < q.behind || (p.behind == q.behind && p.index < q.index);
            });
  return has_room;
}

}  // namespace throng
