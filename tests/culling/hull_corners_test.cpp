// Hull corners are few, are found within a bound of tests and enclose all points, for any points.
#include "culling/distance/hull_corners.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "culling/culler.h"
#include "culling/distance/growing_polytope.h"
#include "culling/distance/hull_depth.h"
#include "tests/culling/degenerate_hulls.h"
#include "tests/culling/shapes.h"

namespace throng::hull_corners_test {
namespace {

using Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using test::Draw;

Points matrix_of(const std::vector<Eigen::Vector3f>& points) {
  Points out(static_cast<Eigen::Index>(points.size()), 3);
  for (size_t i = 0; i < points.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) = points[i].cast<double>();
  return out;
}

double size_of(const Points& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).maxCoeff();
}

HullCorners corners_of(const std::vector<Eigen::Vector3f>& points) {
  const Points matrix = matrix_of(points);
  return hull_corners(matrix, 1e-7 * size_of(matrix));
}

/// Turned part: rings of `spokes` points, its flat end at 0, 1e-15 or 2e-7 m in turn.
std::vector<Eigen::Vector3f> turned_part(int spokes) {
  constexpr std::array<std::pair<double, double>, 8> kProfile = {{{0, 0.012},
                                                                  {0, 0.018},
                                                                  {0, 0.021},
                                                                  {0.004, 0.021},
                                                                  {0.004, 0.03},
                                                                  {0.02, 0.03},
                                                                  {0.02, 0.01},
                                                                  {0.05, 0.01}}};
  constexpr std::array<double, 3> kEnds = {0, 1e-15, 2e-7};
  std::vector<Eigen::Vector3f> out;
  for (const auto& [x, radius] : kProfile)
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double turn = 2 * std::numbers::pi * spoke / spokes;
      out.push_back(Vector3d(x > 0 ? x : kEnds[out.size() % 3], radius * std::cos(turn),
                             radius * std::sin(turn))
                        .cast<float>());
    }
  return out;
}

TEST(HullCorners, EncloseRandomAndDegenerateCloudsWithinABound) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const test::DegenerateHullsTally tally = test::check_degenerate_hulls(400, 3000, seed);
    test::print_degenerate_hulls(tally);
    EXPECT_EQ(tally.wrong, 0u) << tally.first_wrong;
    EXPECT_EQ(tally.incomplete, 0u) << "seed " << seed;
    EXPECT_LT(tally.max_tests, 200) << "seed " << seed;
  }
}

TEST(HullCorners, AreFoundForATurnedPart) {
  for (const int spokes : {13, 78, 500, 1200}) {
    const std::vector<Eigen::Vector3f> points = turned_part(spokes);
    const HullCorners corners = corners_of(points);
    EXPECT_TRUE(corners.is_complete);
    EXPECT_LE(corners.max_faces, 2 * points.size());
    EXPECT_LE(corners.indices.size(), points.size() / 2 + 4) << "the inner rings are no corners";
    EXPECT_LT(corners.tests, 200 * points.size());
    PartShape part;
    part.points = points;
    const auto type = std::make_shared<const BodyType>(std::vector<PartShape>{part},
                                                       RootSphere{{0, 0, 0}, 0.1f, 0.1f}, false);
    CullerOptions options;
    options.proximity.margin_m = 0.1f;
    Workers workers(1);
    const Culler culler({type}, options, workers);
    EXPECT_TRUE(culler.proximity_pairs().empty());
  }
}

TEST(HullCorners, AreAsFewAsTheShapeHas) {
  Draw draw(1);
  std::vector<Eigen::Vector3f> box, flat, line;
  for (float x = 0; x <= 12; ++x)
    for (float y = 0; y <= 12; ++y) {
      for (float z = 0; z <= 12; ++z) box.emplace_back(0.1f * x, 0.2f * y, 0.3f * z);
      flat.emplace_back(0.1f * x, 0.3f, 0.2f * y);
    }
  for (float i = 0; i < 100; ++i) line.emplace_back(0.01f * i, 0.02f * i, 0.5f);
  EXPECT_EQ(corners_of(box).indices.size(), 8u);
  EXPECT_LE(corners_of(flat).indices.size(), 12u) << "floats move its edges slightly";
  EXPECT_EQ(corners_of(line).indices, (std::vector<Eigen::Index>{0, 99}));
  EXPECT_EQ(corners_of({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}).indices.size(), 1u);
  EXPECT_EQ(corners_of({{1, 2, 3}}).indices.size(), 1u);
}

TEST(HullCorners, EncloseAllPointsAtTheMaximumOfTests) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    Draw draw(seed);
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 300; ++i) points.push_back((0.2 * draw.direction()).cast<float>());
    const Points matrix = matrix_of(points);
    const double gap_m = 1e-7 * size_of(matrix);
    for (const size_t tests : {0, 3, 10}) {
      const HullCorners cut = hull_corners(matrix, gap_m, tests);
      EXPECT_FALSE(cut.is_complete);
      EXPECT_LT(cut.tests, tests * points.size() + 40 * points.size());
      for (int i = 0; i < 100; ++i) {
        const Vector3d n = draw.direction();
        double max = -1;
        for (const Eigen::Index corner : cut.indices)
          max = std::max(max, Vector3d(matrix.row(corner)).dot(n));
        EXPECT_LE((matrix * n).maxCoeff(), max + gap_m) << "seed " << seed;
      }
    }
  }
}

/// Every edge of a face is, reversed, the edge of exactly one neighbour. The number of faces is
/// that of a closed surface of triangles.
void expect_closed(const GrowingPolytope& hull, uint64_t seed) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> face_of;
  std::map<uint32_t, int> corners;
  size_t faces = 0;
  for (uint32_t slot = 0; slot < hull.faces().size(); ++slot) {
    if (!hull.is_face(slot)) continue;
    ++faces;
    for (size_t i = 0; i < 3; ++i) {
      const auto& c = hull.faces()[slot].corners;
      ++corners[c[i]];
      EXPECT_TRUE(face_of.emplace(std::pair(c[i], c[(i + 1) % 3]), slot).second) << "seed " << seed;
    }
  }
  for (const auto& [edge, slot] : face_of) {
    const auto other = face_of.find({edge.second, edge.first});
    ASSERT_NE(other, face_of.end()) << "seed " << seed;
    const GrowingPolytope::Face& face = hull.faces()[slot];
    const size_t i = static_cast<size_t>(
        std::find(face.corners.begin(), face.corners.end(), edge.first) - face.corners.begin());
    EXPECT_EQ(face.neighbours[i], other->second) << "seed " << seed;
  }
  EXPECT_EQ(faces, 2 * corners.size() - 4) << "seed " << seed;
}

TEST(GrowingPolytope, StaysClosedAndConvexForPlaneBoxAndBall) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Draw draw(seed);
    const double thick_m = std::pow(10.0, draw.uniform(-16, -5));
    GrowingPolytope hull;
    hull.start({Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0.1, 0.1, 0.5)},
               2);
    for (int i = 0; i < 200; ++i) {
      Vector3d p = draw.in_box(0.9);
      if (seed % 3 == 0) p.z() = 0.001 * std::round(p.z()) + thick_m * draw.uniform(-1, 1);
      if (seed % 3 == 1) p = (8 * p).array().round().matrix() / 8 + thick_m * draw.direction();
      if (seed % 3 == 2) p.normalize();
      hull.add(p);
    }
    expect_closed(hull, seed);
    for (uint32_t slot = 0; slot < hull.faces().size(); ++slot) {
      if (!hull.is_face(slot)) continue;
      for (const Vector3d& p : hull.points()) EXPECT_LE(hull.side(slot, p), 0) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace throng::hull_corners_test
