// Primitives: closed, oriented outwards, never smaller than the true solid.
#include "avatars/mesh/primitives.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace throng::primitives_test {
namespace {

/// Returns the minimum distance from the origin to the plane of a face whose normal `counts`.
template <typename Counts>
double nearest_face(const Mesh& mesh, const Counts& counts) {
  double nearest = 1e9;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return mesh.vertices[static_cast<size_t>(t[k])].cast<double>();
    };
    const Eigen::Vector3d normal =
        (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    if (counts(normal)) nearest = std::min(nearest, normal.dot(corner(0)));
  }
  return nearest;
}

double farthest_vertex(const Mesh& mesh) {
  double farthest = 0;
  for (const Eigen::Vector3f& v : mesh.vertices)
    farthest = std::max(farthest, v.cast<double>().norm());
  return farthest;
}

TEST(Primitives, AreClosedAndOrientedOutwards) {
  for (const Mesh& mesh : {box_mesh({1, 2, 3}), cylinder_mesh(0.5, 2), sphere_mesh(0.3),
                           capsule_mesh(0.2, 1), capsule_mesh(0.2, 0)}) {
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_GT(signed_volume_m3(mesh), 0);
  }
}

TEST(Primitives, IncludeBoxesOfTheGivenSize) {
  EXPECT_NEAR(signed_volume_m3(box_mesh({1, 2, 3})), 6, 1e-12);
  EXPECT_EQ(farthest_vertex(box_mesh({2, 4, 4})), 3);
}

TEST(Primitives, EncloseSpheresWithin3Percent) {
  for (const double radius_m : {0.001, 0.3, 7.0}) {
    const Mesh mesh = sphere_mesh(radius_m);
    EXPECT_GE(nearest_face(mesh, [](const Eigen::Vector3d&) { return true; }), radius_m);
    EXPECT_LT(farthest_vertex(mesh), 1.03 * radius_m);
  }
}

TEST(Primitives, EncloseCylindersWithin1Percent) {
  for (const double radius_m : {0.001, 0.3, 7.0}) {
    const Mesh mesh = cylinder_mesh(radius_m, 0.5);
    const auto is_side = [](const Eigen::Vector3d& normal) { return std::abs(normal.z()) < 0.5; };
    const auto is_cap = [](const Eigen::Vector3d& normal) { return std::abs(normal.z()) > 0.5; };
    EXPECT_GE(nearest_face(mesh, is_side), radius_m);
    EXPECT_EQ(nearest_face(mesh, is_cap), 0.25);
    EXPECT_LT(farthest_vertex(mesh), std::hypot(1.01 * radius_m, 0.25));
    EXPECT_LT(signed_volume_m3(mesh), 1.02 * std::numbers::pi * radius_m * radius_m * 0.5);
  }
}

TEST(Primitives, EncloseCapsulesWithin3Percent) {
  for (const double radius_m : {0.001, 0.3, 7.0})
    for (const double length_m : {0.0, 0.5, 30.0}) {
      const Mesh mesh = capsule_mesh(radius_m, length_m);
      // Outward distance of each face's plane from the nearer centre of a half sphere.
      for (const Eigen::Vector3i& t : mesh.triangles) {
        const Eigen::Vector3d a = mesh.vertices[static_cast<size_t>(t[0])].cast<double>();
        const Eigen::Vector3d b = mesh.vertices[static_cast<size_t>(t[1])].cast<double>();
        const Eigen::Vector3d c = mesh.vertices[static_cast<size_t>(t[2])].cast<double>();
        const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
        for (const double end : {-0.5 * length_m, 0.5 * length_m})
          EXPECT_GE(normal.dot(a - Eigen::Vector3d(0, 0, end)), radius_m);
      }
      for (const Eigen::Vector3f& vertex : mesh.vertices) {
        Eigen::Vector3d off = vertex.cast<double>();
        off.z() -= std::clamp(off.z(), -0.5 * length_m, 0.5 * length_m);
        EXPECT_LT(off.norm(), 1.03 * radius_m + 1e-6 * length_m);
      }
      const double true_m3 =
          std::numbers::pi * radius_m * radius_m * (length_m + 4. / 3 * radius_m);
      EXPECT_LT(signed_volume_m3(mesh), 1.04 * true_m3);
    }
}

}  // namespace
}  // namespace throng::primitives_test
