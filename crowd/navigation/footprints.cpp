#include "crowd/navigation/footprints.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/portable_math.h"
#include "geometry/polygon_union.h"

namespace throng {
namespace {

/// Clearance above the tallest avatar from which an obstacle blocks no agent.
constexpr double kAboveTallest_m = 0.1;
/// Rounding of meshes, which hold floats: a beam of 100 m may hang this much lower than it should.
constexpr double kRoundingUp_m = 1e-5;
/// Rounding of footprints: a wall along the edge of a ground of 10 km may stand out by as much.
constexpr double kRounding_m = 1e-3;
/// Corners that lie closer together are merged.
constexpr double kSameCorner_m = 1e-6;

/// A mesh whose outline fills this share of its hull is treated as convex.
constexpr double kConvexShare = 0.98;

Eigen::Vector2d seen_from_above(const Obstacle& obstacle, const SinCos& turn,
                                const Eigen::Vector3f& vertex) {
  const Eigen::Vector3d v = vertex.cast<double>();
  return {obstacle.centre_m.x() + turn.cos * v.x() - turn.sin * v.y(),
          obstacle.centre_m.y() + turn.sin * v.x() + turn.cos * v.y()};
}

/// Union of all triangles seen from above.
std::vector<Polygon> mesh_outline_of(const Obstacle& obstacle) {
  const SinCos turn = sin_cos(obstacle.heading_rad);
  std::vector<Polygon::Ring> triangles;
  for (const Eigen::Vector3i& triangle : obstacle.mesh.triangles) {
    Polygon::Ring& ring = triangles.emplace_back();
    for (int corner = 0; corner < 3; ++corner)
      ring.push_back(seen_from_above(
          obstacle, turn, obstacle.mesh.vertices[static_cast<size_t>(triangle[corner])]));
  }
  return united(triangles);
}

}  // namespace

std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d> points) {
  const auto before = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                       const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Eigen::Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {  // the lower chain, then the upper
    const size_t start = hull.size();
    for (const Eigen::Vector2d& point : points) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0)
        hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

std::vector<Eigen::Vector2d> footprint_of(const Obstacle& obstacle) {
  const SinCos turn = sin_cos(obstacle.heading_rad);
  std::vector<Eigen::Vector2d> points;
  points.reserve(obstacle.mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices)
    points.push_back(seen_from_above(obstacle, turn, vertex));
  return convex_hull(std::move(points));
}

double distance_m(const std::vector<Eigen::Vector2d>& footprint, const Eigen::Vector2d& point) {
  double nearest_m = std::numeric_limits<double>::infinity();
  bool is_inside = true;
  for (size_t i = 0; i < footprint.size(); ++i) {
    const Eigen::Vector2d &from = footprint[i], &to = footprint[(i + 1) % footprint.size()];
    is_inside = is_inside && cross(to - from, point - from) >= 0;
    nearest_m = std::min(nearest_m, distance_to_segment_m(point, from, to));
  }
  return is_inside ? 0 : nearest_m;
}

std::vector<Eigen::Vector2d> footprint_of(const Door& door) {
  const Eigen::Vector2d along = (door.to_m - door.from_m).normalized();
  const Eigen::Vector2d aside = 0.5 * door.thickness_m * Eigen::Vector2d(-along.y(), along.x());
  return convex_hull(
      {door.from_m - aside, door.to_m - aside, door.to_m + aside, door.from_m + aside});
}

std::vector<Eigen::Vector2d> clipped(std::vector<Eigen::Vector2d> footprint,
                                     const Rectangle& ground) {
  const Rectangle reach = ground.grown(kRounding_m);
  if (std::all_of(footprint.begin(), footprint.end(),
                  [&](const Eigen::Vector2d& corner) { return reach.contains(corner); }))
    return footprint;
  footprint = clipped_to(std::move(footprint), ground);
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& corner : footprint)
    if (corners.empty() || (corner - corners.back()).norm() > kSameCorner_m)
      corners.push_back(corner);
  while (corners.size() > 1 && (corners.front() - corners.back()).norm() <= kSameCorner_m)
    corners.pop_back();
  corners = convex_hull(std::move(corners));
  if (corners.size() < 3) corners.clear();
  return corners;
}

std::vector<std::vector<Eigen::Vector2d>> footprint_pieces_of(const Obstacle& obstacle) {
  std::vector<Eigen::Vector2d> hull = footprint_of(obstacle);
  if (obstacle.kind != Obstacle::Kind::kMesh) return {std::move(hull)};
  const std::vector<Polygon> outline = mesh_outline_of(obstacle);
  double outline_m2 = 0;
  for (const Polygon& polygon : outline) outline_m2 += area_m2(polygon);
  if (outline_m2 >= kConvexShare * 0.5 * doubled_area(hull)) return {std::move(hull)};
  std::vector<std::vector<Eigen::Vector2d>> pieces;
  for (const Polygon& polygon : outline)
    for (Polygon::Ring& piece : convex_pieces_of(polygon))
      if (std::vector<Eigen::Vector2d> convex = convex_hull(std::move(piece)); convex.size() >= 3)
        pieces.push_back(std::move(convex));
  return pieces;
}

double headroom_m(const CrowdPlan& plan) { return tallest_m(plan) + kAboveTallest_m; }

std::vector<Footprint> footprints_of(const CrowdPlan& plan) {
  const double headroom = headroom_m(plan);
  std::vector<Footprint> footprints;
  uint32_t surface = 0;
  for (const Obstacle& obstacle : plan.obstacles) surface = std::max(surface, obstacle.surface);
  for (const Obstacle& obstacle : plan.obstacles) {
    if (obstacle.lines_floor || !blocks_people(obstacle, headroom)) continue;
    std::vector<std::vector<Eigen::Vector2d>> pieces = footprint_pieces_of(obstacle);
    const uint32_t own = pieces.size() > 1 ? ++surface : obstacle.surface;
    for (std::vector<Eigen::Vector2d>& piece : pieces) {
      std::vector<Eigen::Vector2d> corners = clipped(std::move(piece), plan.ground);
      if (!corners.empty()) footprints.push_back({&obstacle, std::move(corners), own});
    }
  }
  return footprints;
}

bool blocks_people(const Obstacle& obstacle, double headroom_m) {
  double bottom = headroom_m;
  double top = 0;
  for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices) {
    const double z = obstacle.centre_m.z() + static_cast<double>(vertex.z());
    bottom = std::min(bottom, z);
    top = std::max(top, z);
  }
  return bottom < headroom_m - kRoundingUp_m && top > 0;
}

}  // namespace throng
