#include "avatars/mesh/primitives.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "base/portable_math.h"

namespace throng {
namespace {

/// Compensates rounding to float: the mesh encloses the solid to the last bit.
constexpr double kRoundingMargin = 1 + 1e-6;

/// Returns a solid of revolution about z with 24 sides, circumscribed around a profile. The profile
/// lists (distance from z, height) of its corners from below; both ends are flat.
Mesh turned_mesh(const std::vector<Eigen::Vector2d>& profile_m) {
  constexpr int kSides = 24;
  const double inwards = sin_cos(std::numbers::pi / kSides).cos;
  const auto last = static_cast<int>(profile_m.size() - 1) * kSides;
  Mesh mesh;
  for (const Eigen::Vector2d& corner_m : profile_m)
    for (int i = 0; i < kSides; ++i) {
      const SinCos angle = sin_cos(2 * std::numbers::pi * i / kSides);
      const double outer = kRoundingMargin * corner_m.x() / inwards;
      mesh.vertices.emplace_back(
          Eigen::Vector3d(outer * angle.cos, outer * angle.sin, corner_m.y()).cast<float>());
    }
  for (int i = 0; i < kSides; ++i) {
    const int next = (i + 1) % kSides;
    for (int ring = 0; ring < last; ring += kSides) {
      mesh.triangles.emplace_back(ring + i, ring + next, ring + kSides + next);
      mesh.triangles.emplace_back(ring + i, ring + kSides + next, ring + kSides + i);
    }
    if (i == 0 || next == 0) continue;
    mesh.triangles.emplace_back(0, next, i);
    mesh.triangles.emplace_back(last, last + i, last + next);
  }
  return mesh;
}

}  // namespace

Mesh box_mesh(const Eigen::Vector3d& size_m) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices.emplace_back(sign.cwiseProduct(size_m).cast<float>());
  }
  // Bit k of a corner's number is its side along axis k; each face as two triangles.
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},   // -x, +x
                    {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},   // -y, +y
                    {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};  // -z, +z
  return mesh;
}

Mesh cylinder_mesh(double radius_m, double length_m) {
  const double half_m = 0.5 * length_m;
  return turned_mesh({{radius_m, -half_m}, {radius_m, half_m}});
}

Mesh prism_mesh(const std::vector<Eigen::Vector2d>& ring_m, double height_m) {
  Mesh mesh;
  const auto count = static_cast<int>(ring_m.size());
  for (const double z_m : {-0.5 * height_m, 0.5 * height_m})
    for (const Eigen::Vector2d& corner : ring_m)
      mesh.vertices.emplace_back(Eigen::Vector3d(corner.x(), corner.y(), z_m).cast<float>());
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % count;
    mesh.triangles.emplace_back(i, next, count + next);
    mesh.triangles.emplace_back(i, count + next, count + i);
    if (i == 0 || next == 0) continue;
    mesh.triangles.emplace_back(0, next, i);
    mesh.triangles.emplace_back(count, count + i, count + next);
  }
  return mesh;
}

Mesh capsule_mesh(double radius_m, double length_m) {
  // Tangents of a quarter circle: its edges lie between those at 0 and at 90 degrees.
  constexpr int kRings = 5;
  constexpr double kStep_rad = 0.5 * std::numbers::pi / kRings;
  const double corner_m = radius_m / sin_cos(0.5 * kStep_rad).cos;
  std::vector<Eigen::Vector2d> profile_m;
  for (int ring = -kRings; ring < kRings; ++ring) {
    const SinCos angle = sin_cos((ring + 0.5) * kStep_rad);
    profile_m.emplace_back(
        corner_m * angle.cos,
        kRoundingMargin * (corner_m * angle.sin + std::copysign(0.5 * length_m, angle.sin)));
  }
  return turned_mesh(profile_m);
}

Mesh sphere_mesh(double radius_m) {
  const double g = std::numbers::phi;
  std::vector<Eigen::Vector3d> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                         {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                         {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Eigen::Vector3i> faces = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int division = 0; division < 2; ++division) {
    std::map<std::pair<int, int>, int> midpoints;
    const auto midpoint = [&](int a, int b) {
      const auto [entry, is_new] =
          midpoints.emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (is_new)
        points.push_back((points[static_cast<size_t>(a)].normalized() +
                          points[static_cast<size_t>(b)].normalized()));
      return entry->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& f : faces) {
      const int a = midpoint(f[0], f[1]);
      const int b = midpoint(f[1], f[2]);
      const int c = midpoint(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
    }
    faces = std::move(finer);
  }
  for (Eigen::Vector3d& point : points) point.normalize();
  double inner = 1;  // minimum distance of the unit mesh's faces from the centre
  for (const Eigen::Vector3i& f : faces) {
    const auto& [a, b, c] =
        std::tie(points[static_cast<size_t>(f[0])], points[static_cast<size_t>(f[1])],
                 points[static_cast<size_t>(f[2])]);
    inner = std::min(inner, (b - a).cross(c - a).normalized().dot(a));
  }
  Mesh mesh;
  for (const Eigen::Vector3d& point : points)
    mesh.vertices.emplace_back((point * (kRoundingMargin * radius_m / inner)).cast<float>());
  mesh.triangles = std::move(faces);
  return mesh;
}

}  // namespace throng
