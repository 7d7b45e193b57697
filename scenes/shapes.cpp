#include "scenes/shapes.h"

#include <algorithm>
#include <numbers>

#include "scenes/trig.h"

namespace throng {
namespace {

/// The tallest person a scene may hold is 2.5 m; what hangs higher is in nobody's way.
constexpr double kHeadroom_m = 2.6;

Eigen::Vector3f to_float(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).cast<float>();
}

}  // namespace

Mesh box_mesh(const Eigen::Vector3d& size_m) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.push_back(to_float((corner & 1 ? 0.5 : -0.5) * size_m.x(),
                                     (corner & 2 ? 0.5 : -0.5) * size_m.y(),
                                     (corner & 4 ? 0.5 : -0.5) * size_m.z()));
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.emplace_back(q[0], q[1], q[2]);
    mesh.triangles.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

Mesh cylinder_mesh(double diameter_m, double height_m) {
  Mesh mesh;
  for (int side = 0; side < kCylinderSides; ++side) {
    const SinCos turn = sin_cos(2 * std::numbers::pi * side / kCylinderSides);
    const double x = 0.5 * diameter_m * turn.cos;
    const double y = 0.5 * diameter_m * turn.sin;
    mesh.vertices.push_back(to_float(x, y, -0.5 * height_m));
    mesh.vertices.push_back(to_float(x, y, 0.5 * height_m));
  }
  const int bottom = 2 * kCylinderSides;
  const int top = bottom + 1;
  mesh.vertices.push_back(to_float(0, 0, -0.5 * height_m));
  mesh.vertices.push_back(to_float(0, 0, 0.5 * height_m));
  for (int side = 0; side < kCylinderSides; ++side) {
    const int a = 2 * side;
    const int b = 2 * ((side + 1) % kCylinderSides);
    mesh.triangles.emplace_back(a, b, b + 1);
    mesh.triangles.emplace_back(a, b + 1, a + 1);
    mesh.triangles.emplace_back(bottom, b, a);
    mesh.triangles.emplace_back(top, a + 1, b + 1);
  }
  return mesh;
}

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
  for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices) {
    const Eigen::Vector3d v = vertex.cast<double>();
    points.emplace_back(obstacle.centre_m.x() + turn.cos * v.x() - turn.sin * v.y(),
                        obstacle.centre_m.y() + turn.sin * v.x() + turn.cos * v.y());
  }
  return convex_hull(std::move(points));
}

bool blocks_people(const Obstacle& obstacle) {
  double bottom = kHeadroom_m;
  double top = 0;
  for (const Eigen::Vector3f& vertex : obstacle.mesh.vertices) {
    const double z = obstacle.centre_m.z() + static_cast<double>(vertex.z());
    bottom = std::min(bottom, z);
    top = std::max(top, z);
  }
  return bottom < kHeadroom_m && top > 0;
}

}  // namespace throng
