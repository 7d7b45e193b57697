// The narrow phase agrees with FCL, an independent implementation.
#include <fcl/fcl.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "culling/triangles/triangle_bvh.h"
#include "shapes.h"
#include "tests/nightly.h"

namespace throng::test::narrow_phase_fcl_test {
namespace {

constexpr uint64_t kSeed = 20263;
using FclMesh = fcl::BVHModel<fcl::OBBRSSd>;

/// FCL has no scale: points are scaled first.
std::shared_ptr<FclMesh> fcl_mesh(const Solid& solid, float scale) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : solid.points)
    points.push_back(static_cast<double>(scale) * p.cast<double>());
  std::vector<fcl::Triangle> triangles;
  for (const Eigen::Vector3i& t : solid.triangles)
    triangles.emplace_back(static_cast<size_t>(t[0]), static_cast<size_t>(t[1]),
                           static_cast<size_t>(t[2]));
  auto mesh = std::make_shared<FclMesh>();
  mesh->beginModel();
  mesh->addSubModel(points, triangles);
  mesh->endModel();
  return mesh;
}

bool fcl_touch(const FclMesh& a, const Eigen::Isometry3d& pose_a, const FclMesh& b,
               const Eigen::Isometry3d& pose_b) {
  const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  return fcl::collide(&a, pose_a, &b, pose_b, request, result) > 0;
}

/// Rotations by quarter turns are exact in float, so both engines have the same geometry.
PartPose quarter_turns(Draw& draw) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (int i = draw.integer(0, 5); i > 0; --i) {
    const int axis = draw.integer(0, 2);
    Eigen::Matrix3d quarter = Eigen::Matrix3d::Zero();
    quarter(axis, axis) = 1;
    quarter((axis + 1) % 3, (axis + 2) % 3) = -1;
    quarter((axis + 2) % 3, (axis + 1) % 3) = 1;
    turn = quarter * turn;
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = turn;
  pose.translation() = draw.in_box(0.5);
  return to_part_pose(pose);
}

/// Mesh without one triangle: it has no inside, which FCL does not test.
Solid opened(Solid solid) {
  solid.triangles.pop_back();
  return solid;
}

struct Pair {
  Solid a, b;
  float scale_a = 1, scale_b = 1;
  PartPose pose_a, pose_b;
  Eigen::Vector3f a_to_b;

  Pair(Draw& draw, bool exact_rotations, bool scaled) {
    a = opened(bumpy_ellipsoid(draw, 12, 14, {0.2, 0.1, 0.3}, 0.1));
    b = opened(bumpy_ellipsoid(draw, 10, 12, {0.1, 0.2, 0.1}, 0.1));
    if (scaled) {
      scale_a = static_cast<float>(draw.uniform(0.5, 2));
      scale_b = static_cast<float>(draw.uniform(0.5, 2));
    }
    pose_a = exact_rotations ? quarter_turns(draw) : draw.pose(0.5);
    pose_b = exact_rotations ? quarter_turns(draw) : draw.pose(0.5);
    const Eigen::Vector3d together =
        to_isometry(pose_a).translation() - to_isometry(pose_b).translation();
    a_to_b = (together + draw.uniform(0.1, 0.7) * draw.direction()).cast<float>();
  }
  Eigen::Isometry3d world_from_b() const {
    Eigen::Isometry3d pose = to_isometry(pose_b);
    pose.translation() += a_to_b.cast<double>();
    return pose;
  }
};

int count_touching(bool exact_rotations, bool scaled, int cases, uint64_t id) {
  Draw draw(kSeed, id);
  int touching = 0;
  for (int i = 0; i < cases; ++i) {
    const Pair p(draw, exact_rotations, scaled);
    TriangleCounters counters;
    const bool found = solids_touch(TriangleBvh(p.a.points, p.a.triangles), p.pose_a, p.scale_a,
                                    TriangleBvh(p.b.points, p.b.triangles), p.pose_b, p.scale_b,
                                    p.a_to_b, counters);
    const bool expected = fcl_touch(*fcl_mesh(p.a, p.scale_a), to_isometry(p.pose_a),
                                    *fcl_mesh(p.b, p.scale_b), p.world_from_b());
    EXPECT_EQ(found, expected) << "case " << i << ", seed " << kSeed;
    touching += expected;
  }
  return touching;
}

int cases() { return test::part_of(1200); }

/// Requires between a sixth and five sixths of the cases to touch, so that the test is meaningful.
void expect_some_touch(int touching) {
  EXPECT_GT(touching, cases() / 6);
  EXPECT_LT(touching, 5 * cases() / 6);
}

TEST(AgainstFcl, AgreesForUprightPartsOfAnyScale) {
  expect_some_touch(count_touching(true, true, cases(), 1));
}

TEST(AgainstFcl, AgreesForRotatedParts) {
  expect_some_touch(count_touching(false, false, cases(), 2));
}

TEST(AgainstFcl, AgreesForRotatedAndScaledParts) {
  expect_some_touch(count_touching(false, true, cases(), 3));
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Prints times of near contacts of parts of about 1000 triangles.
TEST(AgainstFcl, MeasuresNearContacts) {
  Draw draw(kSeed, 4);
  const Solid a = opened(bumpy_ellipsoid(draw, 22, 24, {0.08, 0.07, 0.25}, 0.01));
  const Solid b = opened(bumpy_ellipsoid(draw, 22, 24, {0.06, 0.05, 0.2}, 0.01));
  const TriangleBvh tree_a(a.points, a.triangles), tree_b(b.points, b.triangles);
  const auto mesh_a = fcl_mesh(a, 1), mesh_b = fcl_mesh(b, 1);
  std::vector<double> throng_us[2], fcl_us[2];
  TriangleCounters counters;
  for (int i = 0; i < 4000; ++i) {
    const PartPose pose_a = draw.pose(0.1), pose_b = draw.pose(0.1);
    const Eigen::Vector3f a_to_b = (draw.uniform(0.05, 0.25) * draw.direction()).cast<float>();
    Eigen::Isometry3d world_from_b = to_isometry(pose_b);
    world_from_b.translation() += a_to_b.cast<double>();
    const auto t0 = std::chrono::steady_clock::now();
    const bool found = solids_touch(tree_a, pose_a, 1, tree_b, pose_b, 1, a_to_b, counters);
    const auto t1 = std::chrono::steady_clock::now();
    const bool expected = fcl_touch(*mesh_a, to_isometry(pose_a), *mesh_b, world_from_b);
    const auto t2 = std::chrono::steady_clock::now();
    ASSERT_EQ(found, expected) << "case " << i << ", seed " << kSeed;
    throng_us[found].push_back(std::chrono::duration<double, std::micro>(t1 - t0).count());
    fcl_us[found].push_back(std::chrono::duration<double, std::micro>(t2 - t1).count());
  }
  const char* names[2] = {"apart", "touching"};
  for (int f = 0; f < 2; ++f)
    std::printf("%zu triangles against %zu, %s: %zu pairs, Throng %.2f us, FCL %.2f us (medians)\n",
                a.triangles.size(), b.triangles.size(), names[f], throng_us[f].size(),
                median(throng_us[f]), median(fcl_us[f]));
  std::printf("each pair took %.0f node tests and %.1f triangle tests\n",
              static_cast<double>(counters.node_tests) / 4000,
              static_cast<double>(counters.triangle_tests) / 4000);
}

}  // namespace
}  // namespace throng::test::narrow_phase_fcl_test
