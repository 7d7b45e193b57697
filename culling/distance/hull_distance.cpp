#include "culling/distance/hull_distance.h"

#include <algorithm>
#include <limits>

#include "culling/distance/placed_points.h"
#include "culling/distance/simplex.h"

namespace throng {
namespace {

using Eigen::Vector3d;

constexpr int kMostSteps = 32;
constexpr double kConverged_m = 1e-4;

NearestPoints points_of(const Simplex& simplex) {
  NearestPoints out{Vector3d::Zero(), Vector3d::Zero()};
  for (int i = 0; i < simplex.count; ++i) {
    const Simplex::Corner& corner = simplex.corners[static_cast<size_t>(i)];
    out.on_a += simplex.weights[static_cast<size_t>(i)] * corner.on_a;
    out.on_b += simplex.weights[static_cast<size_t>(i)] * corner.on_b;
  }
  return out;
}

}  // namespace

HullGap hull_gap(const PlacedHull& a, const PlacedHull& b, const Eigen::Vector3f& a_to_b_m,
                 const Eigen::Vector3d& direction) {
  const PlacedPoints there_a(a), there_b(b, a_to_b_m.cast<double>());
  HullGap out;
  out.direction = direction;
  out.corners_m = out.about_m = std::numeric_limits<double>::max();
  Simplex simplex;
  Vector3d towards = direction;
  double most = -std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    simplex.add(there_a.support(towards), there_b.support(-towards));
    const Vector3d& between = simplex.corners[static_cast<size_t>(simplex.count - 1)].between;
    out.corners_m = std::min(out.corners_m, between.norm());
    if (const double gap = towards.dot(between); gap > most) {
      most = gap;
      out.direction = towards;
    }
    const Vector3d nearest = simplex.reduce();
    if (simplex.count == 4) {  // the origin is inside
      out.about_m = 0;
      break;
    }
    const double distance = nearest.norm();
    if (!(distance < out.about_m)) break;
    out.about_m = distance;
    out.points_m = points_of(simplex);
    if (distance - most < kConverged_m) break;
    towards = nearest / distance;
  }
  out.lo_m = std::max(0.0, most - there_a.beyond_support_m() - there_b.beyond_support_m());
  return out;
}

}  // namespace throng
