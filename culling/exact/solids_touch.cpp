#include <cassert>

#include "culling/exact/touching_triangles.h"
#include "culling/exact/triangle_bvh.h"

namespace throng {

std::optional<Eigen::Vector3d> piece_inside(const TriangleBvh& a, const TriangleBvh& b,
                                            const Relative& a_from_b) {
  for (const Eigen::Vector3f& p : b.pieces()) {
    const Eigen::Vector3d in_a = a_from_b.linear * p.cast<double>() + a_from_b.offset;
    if (a.contains(in_a)) return in_a;
  }
  for (const Eigen::Vector3f& p : a.pieces())
    if (b.contains(a_from_b.inverse * (p.cast<double>() - a_from_b.offset)))
      return p.cast<double>();
  return std::nullopt;
}

bool solids_touch(const TriangleBvh& a, const PartPose& pose_a, float scale_a, const TriangleBvh& b,
                  const PartPose& pose_b, float scale_b, const Eigen::Vector3f& a_to_b_m,
                  ExactCounters& counters) {
  assert(scale_a > 0 && scale_b > 0);
  const Relative a_from_b(pose_a, scale_a, pose_b, scale_b, a_to_b_m);
  const double ratio = static_cast<double>(scale_b) / static_cast<double>(scale_a);
  const TouchingTriangles triangles(a, b, a_from_b, ratio, counters);
  if (triangles.visit([](const Triangle&, const Triangle&) { return true; })) return true;
  return piece_inside(a, b, a_from_b).has_value();
}

}  // namespace throng
