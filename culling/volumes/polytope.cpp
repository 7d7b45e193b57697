#include "culling/volumes/polytope.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace throng {
namespace {

struct HalfSpace {
  Eigen::Vector3d normal;
  double offset;  ///< inside: normal . x <= offset
};

std::vector<HalfSpace> half_spaces(const Slabs& slabs, int k) {
  std::vector<HalfSpace> out;
  for (size_t i = 0; i < kDirections.size(); ++i) {
    if (!has_direction(k, static_cast<int>(i))) continue;
    const Eigen::Vector3d n(kDirections[i][0], kDirections[i][1], kDirections[i][2]);
    const double centre = static_cast<double>(slabs.slab[i].centre);
    const double half = static_cast<double>(slabs.slab[i].half);
    out.push_back({n / n.norm(), (centre + half) / n.norm()});
    out.push_back({-n / n.norm(), (half - centre) / n.norm()});
  }
  return out;
}

/// Square on the plane, large enough to contain any face.
std::vector<Eigen::Vector3d> square_on(const HalfSpace& plane, double size) {
  const Eigen::Vector3d u = plane.normal.unitOrthogonal() * size;
  const Eigen::Vector3d v = plane.normal.cross(u);
  const Eigen::Vector3d o = plane.normal * plane.offset;
  return {o + u + v, o - u + v, o - u - v, o + u - v};
}

/// Clips a polygon to a half space (Sutherland and Hodgman 1974).
std::vector<Eigen::Vector3d> clipped(const std::vector<Eigen::Vector3d>& polygon,
                                     const HalfSpace& space, double slack) {
  std::vector<Eigen::Vector3d> out;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& p = polygon[i];
    const Eigen::Vector3d& q = polygon[(i + 1) % polygon.size()];
    const double dp = space.normal.dot(p) - space.offset - slack;
    const double dq = space.normal.dot(q) - space.offset - slack;
    if (dp <= 0) out.push_back(p);
    if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) out.push_back(p + (q - p) * (dp / (dp - dq)));
  }
  return out;
}

}  // namespace

Polytope polytope_of(const Slabs& slabs, int k) {
  const std::vector<HalfSpace> spaces = half_spaces(slabs, k);
  double size = 0;
  for (int i = 0; i < kAxisDirections; ++i) {
    const Slab& slab = slabs.slab[static_cast<size_t>(i)];
    size += 4 * static_cast<double>(std::fabs(slab.centre) + slab.half);
  }
  const double slack = 1e-12 * size;  // keeps faces that meet in one corner closed
  const Eigen::Vector3d centre(static_cast<double>(slabs.slab[0].centre),
                               static_cast<double>(slabs.slab[1].centre),
                               static_cast<double>(slabs.slab[2].centre));
  Polytope out;
  for (size_t i = 0; i < spaces.size(); ++i) {
    std::vector<Eigen::Vector3d> face = square_on(spaces[i], size);
    for (size_t j = 0; j < spaces.size() && !face.empty(); ++j)
      if (j != i) face = clipped(face, spaces[j], slack);
    for (size_t v = 1; v + 1 < face.size(); ++v) {
      const double twice_area = (face[v] - face[0]).cross(face[v + 1] - face[0]).norm();
      out.volume_m3 += twice_area / 6 * (spaces[i].offset - spaces[i].normal.dot(centre));
    }
    out.corners_m.insert(out.corners_m.end(), face.begin(), face.end());
    if (!face.empty()) out.face_ends.push_back(out.corners_m.size());
  }
  return out;
}

}  // namespace throng
