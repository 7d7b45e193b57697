// The narrow phase agrees with brute force, for triangles and solids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "culling/triangles/triangle_bvh.h"
#include "culling/triangles/triangle_test.h"
#include "shapes.h"

namespace throng::test::narrow_phase_test {
namespace {

using Eigen::Vector3d;
constexpr uint64_t kSeed = 20262;

const PartPose kUpright = to_part_pose(Eigen::Isometry3d::Identity());

Triangle swapped(const Triangle& t, int turn, bool mirror) {
  Triangle out;
  for (int i = 0; i < 3; ++i) out.corner[i] = t.corner[(turn + (mirror ? 3 - i : i)) % 3];
  return out;
}

/// Result in every order of corners and of the two triangles; all must agree.
bool touch(const Triangle& a, const Triangle& b) {
  const bool result = triangles_touch(a, b);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const Triangle sa = swapped(a, i % 3, i > 2), sb = swapped(b, j % 3, j > 2);
      EXPECT_EQ(triangles_touch(sa, sb), result);
      EXPECT_EQ(triangles_touch(sb, sa), result);
    }
  }
  return result;
}

struct Case {
  const char* what;
  Triangle b;
  bool touches;
};

/// Cases against the triangle (0,0,0) (1,0,0) (0,1,0), whose plane is z = 0.
const Triangle kFloor = {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
const Case kCases[] = {
    {"a corner on the face", {{{{0.2, 0.2, 0}, {0.2, 0.2, 1}, {0.5, 0.2, 1}}}}, true},
    {"a corner just above the face", {{{{0.2, 0.2, 1e-9}, {0.2, 0.2, 1}, {0.5, 0.2, 1}}}}, false},
    {"a corner on an edge", {{{{0.5, 0, 0}, {0.5, -1, 1}, {0.6, -1, 1}}}}, true},
    {"a corner next to an edge", {{{{0.5, -1e-9, 0}, {0.5, -1, 1}, {0.6, -1, 1}}}}, false},
    {"a corner on a corner", {{{{1, 0, 0}, {2, 0, 1}, {2, 0, -1}}}}, true},
    {"an edge along an edge", {{{{0.2, 0, 0}, {0.7, 0, 0}, {0.5, 0, 1}}}}, true},
    {"an edge in line with an edge", {{{{1.1, 0, 0}, {1.7, 0, 0}, {1.5, 0, 1}}}}, false},
    {"an edge on the face", {{{{0.1, 0.1, 0}, {0.3, 0.3, 0}, {0.2, 0.2, 1}}}}, true},
    {"an edge across an edge", {{{{0.5, 0, -1}, {0.5, 0, 1}, {0.5, -1, 0}}}}, true},
    {"through the middle", {{{{0.2, 0.2, -1}, {0.2, 0.2, 1}, {2, 2, 0}}}}, true},
    {"through the plane, outside the triangle", {{{{1, 1, -1}, {1, 1, 1}, {2, 2, 0}}}}, false},
    {"parallel above", {{{{0, 0, 1e-9}, {1, 0, 1e-9}, {0, 1, 1e-9}}}}, false},
    {"the same triangle", {{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}, true},
    {"in the plane, inside", {{{{0.1, 0.1, 0}, {0.2, 0.1, 0}, {0.1, 0.2, 0}}}}, true},
    {"in the plane, around", {{{{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}}}}, true},
    {"in the plane, crossing without a corner inside",
     {{{{-1, 0.4, 0}, {2, 0.4, 0}, {2, 0.5, 0}}}},
     true},
    {"in the plane, next to an edge", {{{{0.6, 0.6, 0}, {1, 1, 0}, {0.6, 1, 0}}}}, false},
    {"in the plane, next to a corner", {{{{1.1, -1, 0}, {1.1, 1, 0}, {3, 0, 0}}}}, false},
    {"in the plane, corner to edge", {{{{0.5, 0.5, 0}, {1, 1, 0}, {0.6, 1, 0}}}}, true},
    {"a segment through the face", {{{{0.2, 0.2, -1}, {0.2, 0.2, 1}, {0.2, 0.2, 0.5}}}}, true},
    {"a segment next to the face", {{{{0.6, 0.6, -1}, {0.6, 0.6, 1}, {0.6, 0.6, 0.5}}}}, false},
    {"a segment in the plane, inside", {{{{0.1, 0.1, 0}, {0.2, 0.2, 0}, {0.1, 0.1, 0}}}}, true},
    {"a segment in the plane, outside", {{{{0.6, 0.6, 0}, {1, 1, 0}, {0.6, 0.6, 0}}}}, false},
    {"a segment in line with an edge", {{{{1.1, 0, 0}, {1.7, 0, 0}, {1.2, 0, 0}}}}, false},
    {"a segment that reaches the edge", {{{{1, 0, 0}, {1.7, 0, 0}, {1.2, 0, 0}}}}, true},
    {"a point on the face", {{{{0.2, 0.2, 0}, {0.2, 0.2, 0}, {0.2, 0.2, 0}}}}, true},
    {"a point above the face", {{{{0.2, 0.2, 1e-9}, {0.2, 0.2, 1e-9}, {0.2, 0.2, 1e-9}}}}, false},
    {"a point in the plane, outside", {{{{0.6, 0.6, 0}, {0.6, 0.6, 0}, {0.6, 0.6, 0}}}}, false},
    {"a point on a corner", {{{{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}}}, true},
};

TEST(Triangles, TouchAsExpectedInEveryOrder) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.what);
    EXPECT_EQ(touch(kFloor, c.b), c.touches);
  }
}

TEST(Triangles, TouchAsExpectedForSegmentsAndPoints) {
  const auto segment = [](Vector3d p, Vector3d q) { return Triangle{{p, q, 0.5 * (p + q)}}; };
  const auto point = [](Vector3d p) { return Triangle{{p, p, p}}; };
  const Triangle x = segment({0, 0, 0}, {1, 0, 0});
  EXPECT_TRUE(touch(x, segment({0.5, -1, 0}, {0.5, 1, 0})));
  EXPECT_FALSE(touch(x, segment({0.5, -1, 1e-9}, {0.5, 1, 1e-9})));
  EXPECT_FALSE(touch(x, segment({0.5, 1e-9, 0}, {0.5, 1, 0})));
  EXPECT_TRUE(touch(x, segment({1, 0, 0}, {2, 0, 0})));
  EXPECT_FALSE(touch(x, segment({1 + 1e-9, 0, 0}, {2, 0, 0})));
  EXPECT_FALSE(touch(x, segment({0, 1e-9, 0}, {1, 1e-9, 0})));
  EXPECT_TRUE(touch(x, segment({0.2, 0, 0}, {0.4, 0, 0})));
  EXPECT_TRUE(touch(x, point({0.3, 0, 0})));
  EXPECT_FALSE(touch(x, point({0.3, 0, 1e-9})));
  EXPECT_TRUE(touch(point({1, 2, 3}), point({1, 2, 3})));
  EXPECT_FALSE(touch(point({1, 2, 3}), point({1, 2, 3 + 1e-9})));
}

/// Triangles in general position touch if and only if an edge of one pierces the other.
bool pierces(const Vector3d& p, const Vector3d& q, const Triangle& t) {
  const auto side = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    return (b - a).cross(c - a).dot(d - a) > 0;
  };
  const Vector3d &a = t.corner[0], &b = t.corner[1], &c = t.corner[2];
  if (side(a, b, c, p) == side(a, b, c, q)) return false;
  const bool first = side(p, q, a, b);
  return side(p, q, b, c) == first && side(p, q, c, a) == first;
}

bool touch_in_general_position(const Triangle& a, const Triangle& b) {
  for (int i = 0; i < 3; ++i)
    if (pierces(a.corner[i], a.corner[(i + 1) % 3], b) ||
        pierces(b.corner[i], b.corner[(i + 1) % 3], a))
      return true;
  return false;
}

TEST(Triangles, AgreeWithPiercedEdgesInGeneralPosition) {
  Draw draw(kSeed, 1);
  int touching = 0;
  for (int i = 0; i < 200000; ++i) {
    Triangle a, b;
    const double thin = i % 3 == 0 ? 1e-4 : 1;  // including slivers
    for (int c = 0; c < 3; ++c) {
      a.corner[c] = draw.in_box(1).cwiseProduct(Vector3d(1, thin, 1));
      b.corner[c] = draw.in_box(1).cwiseProduct(Vector3d(1, 1, thin));
    }
    const bool expected = touch_in_general_position(a, b);
    touching += expected;
    ASSERT_EQ(triangles_touch(a, b), expected) << "case " << i << ", seed " << kSeed;
  }
  EXPECT_GT(touching, 20000);
}

TEST(Triangles, AgreeWithPiercedEdgesIfNearlyParallel) {
  Draw draw(kSeed, 2);
  int touching = 0;
  for (int i = 0; i < 50000; ++i) {
    Triangle a, b;
    const double tilt = std::pow(10.0, draw.uniform(-7, -1));
    for (int c = 0; c < 3; ++c) {
      a.corner[c] = draw.in_box(1).cwiseProduct(Vector3d(1, 1, 0));
      b.corner[c] = draw.in_box(1).cwiseProduct(Vector3d(1, 1, tilt));
    }
    const bool expected = touch_in_general_position(a, b);
    touching += expected;
    ASSERT_EQ(triangles_touch(a, b), expected)
        << "case " << i << ", tilt " << tilt << ", seed " << kSeed;
  }
  EXPECT_GT(touching, 5000);
}

/// Coplanar triangles touch if edges cross or one contains a corner of the other.
bool touch_in_plane(const Triangle& a, const Triangle& b) {
  const auto left = [](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
    return (q - p).cross(r - p).z() > 0;
  };
  const auto holds = [&](const Triangle& t, const Vector3d& p) {
    const bool first = left(t.corner[0], t.corner[1], p);
    return left(t.corner[1], t.corner[2], p) == first && left(t.corner[2], t.corner[0], p) == first;
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vector3d &p = a.corner[i], &q = a.corner[(i + 1) % 3];
      const Vector3d &r = b.corner[j], &s = b.corner[(j + 1) % 3];
      if (left(p, q, r) != left(p, q, s) && left(r, s, p) != left(r, s, q)) return true;
    }
  return holds(a, b.corner[0]) || holds(b, a.corner[0]);
}

TEST(Triangles, AgreeWithPlaneGeometryInAnyPlane) {
  Draw draw(kSeed, 3);
  int touching = 0;
  for (int i = 0; i < 20000; ++i) {
    Triangle a, b;
    for (int c = 0; c < 3; ++c) {
      a.corner[c] = draw.in_box(1).cwiseProduct(Vector3d(1, 1, 0));
      b.corner[c] = draw.in_box(1).cwiseProduct(Vector3d(1, 1, 0)) + Vector3d(0.5, 0, 0);
    }
    const bool expected = touch_in_plane(a, b);
    touching += expected;
    const Eigen::Matrix3d turn = draw.rotation().toRotationMatrix();
    const Vector3d shift = draw.in_box(2);
    for (int c = 0; c < 3; ++c) {
      a.corner[c] = turn * a.corner[c] + shift;
      b.corner[c] = turn * b.corner[c] + shift;
    }
    ASSERT_EQ(triangles_touch(a, b), expected) << "case " << i << ", seed " << kSeed;
  }
  EXPECT_GT(touching, 5000);
  EXPECT_LT(touching, 15000);
}

bool solids_touch_upright(const Solid& a, const Solid& b, const Eigen::Vector3f& a_to_b) {
  TriangleCounters counters;
  return solids_touch(TriangleBvh(a.points, a.triangles), kUpright, 1,
                      TriangleBvh(b.points, b.triangles), kUpright, 1, a_to_b, counters);
}

TEST(Solids, TouchAtACornerAnEdgeOrAFace) {
  const Solid box = box_solid({0.5, 0.5, 0.5});
  EXPECT_TRUE(solids_touch_upright(box, box, {0, 0, 0}));
  EXPECT_TRUE(solids_touch_upright(box, box, {1, 0, 0}));
  EXPECT_TRUE(solids_touch_upright(box, box, {1, 0.3f, 0.2f}));
  EXPECT_TRUE(solids_touch_upright(box, box, {1, 1, 0}));
  EXPECT_TRUE(solids_touch_upright(box, box, {1, 1, 1}));
  EXPECT_TRUE(solids_touch_upright(box, box, {-1, 1, -1}));
  EXPECT_FALSE(solids_touch_upright(box, box, {1.000001f, 0, 0}));
  EXPECT_FALSE(solids_touch_upright(box, box, {1.000001f, 1, 1}));
  EXPECT_FALSE(solids_touch_upright(box, box, {0, -1.000001f, 0.5f}));
}

TEST(Solids, TouchIfOneIsInsideTheOther) {
  const Solid large = box_solid({0.5, 0.5, 0.5}), small = box_solid({0.1, 0.1, 0.1});
  EXPECT_TRUE(solids_touch_upright(large, small, {0, 0, 0}));
  EXPECT_TRUE(solids_touch_upright(small, large, {0, 0, 0}));
  EXPECT_TRUE(solids_touch_upright(large, small, {0.3f, -0.3f, 0.39f}));
  EXPECT_FALSE(solids_touch_upright(large, small, {0.61f, 0, 0}));
}

TEST(Solids, HaveNoInsideIfOpen) {
  Solid large = box_solid({0.5, 0.5, 0.5});
  const Solid small = box_solid({0.1, 0.1, 0.1});
  large.triangles.pop_back();
  EXPECT_EQ(TriangleBvh(large.points, large.triangles).solid_count(), 0u);
  EXPECT_FALSE(solids_touch_upright(large, small, {0, 0, 0}));
  EXPECT_FALSE(solids_touch_upright(small, large, {0, 0, 0}));
  // An open surface can be inside another.
  Solid open = small;
  open.triangles.resize(1);
  EXPECT_TRUE(solids_touch_upright(box_solid({0.5, 0.5, 0.5}), open, {0, 0, 0}));
}

TEST(Solids, IgnoreInwardOrientation) {
  const Solid large = inside_out(box_solid({0.5, 0.5, 0.5}));
  EXPECT_TRUE(solids_touch_upright(large, box_solid({0.1, 0.1, 0.1}), {0, 0, 0}));
}

TEST(Solids, TestEveryPiece) {
  const Solid outer = box_solid({0.5, 0.5, 0.5});
  const Solid outside = box_solid({0.1, 0.1, 0.1}, {2, 0, 0}), inside = box_solid({0.1, 0.1, 0.1});
  EXPECT_EQ(
      TriangleBvh(both(outside, inside).points, both(outside, inside).triangles).pieces().size(),
      2u);
  EXPECT_TRUE(solids_touch_upright(outer, both(outside, inside), {0, 0, 0}));
  EXPECT_TRUE(solids_touch_upright(both(inside, outside), outer, {0, 0, 0}));
  EXPECT_FALSE(solids_touch_upright(outer, both(outside, outside), {0, 0, 0}));
}

TEST(Solids, FormTheUnionOfOverlappingPieces) {
  const Solid two = both(box_solid({0.5, 0.5, 0.5}), box_solid({0.5, 0.5, 0.5}, {0.2, 0.1, 0.05}));
  EXPECT_TRUE(TriangleBvh(two.points, two.triangles).contains({0.1, 0.05, 0.02}));
  EXPECT_TRUE(solids_touch_upright(two, box_solid({0.05, 0.05, 0.05}), {0.1f, 0.05f, 0.02f}));
}

TEST(Surface, IsClosedByPositionNotByIndex) {
  const Solid box = box_solid({0.5, 0.5, 0.5});
  Solid soup;  // each triangle has separate corners, as in STL files
  for (const Eigen::Vector3i& t : box.triangles) {
    const int first = static_cast<int>(soup.points.size());
    for (int c = 0; c < 3; ++c) soup.points.push_back(box.points[static_cast<size_t>(t[c])]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const TriangleBvh tree(soup.points, soup.triangles);
  EXPECT_EQ(tree.solid_count(), 1u);
  EXPECT_EQ(tree.pieces().size(), 1u);
  Solid flipped = box;
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_EQ(TriangleBvh(flipped.points, flipped.triangles).solid_count(), 0u);
}

TEST(Surface, ContainsPointsThatItWindsAround) {
  Draw draw(kSeed, 4);
  int inside = 0, total = 0;
  for (int i = 0; i < 20; ++i) {
    const Solid solid = bumpy_ellipsoid(draw, 8, 10, {0.3, 0.2, 0.4}, 0.2);
    const TriangleBvh tree(solid.points, solid.triangles);
    ASSERT_EQ(tree.solid_count(), 1u);
    for (int p = 0; p < 500; ++p) {
      Vector3d point = draw.in_box(0.4);
      // Rays that graze corners and edges, which a simple parity test counts twice.
      if (p % 5 == 0)
        point.tail<2>() = solid.points[static_cast<size_t>(p) % 70].tail<2>().cast<double>();
      if (p % 5 == 1)
        point.z() = static_cast<double>(solid.points[static_cast<size_t>(p) % 70].z());
      const double turns = winding_number(solid, point);
      if (std::fabs(turns - std::round(turns)) > 1e-6) continue;  // on the surface
      ++total;
      inside += turns > 0.5;
      ASSERT_EQ(tree.contains(point), turns > 0.5)
          << "winding number " << turns << " at " << point.transpose() << ", seed " << kSeed;
    }
  }
  EXPECT_GT(total, 9000);
  EXPECT_GT(inside, 2000);
}

Triangle placed_triangle(const Solid& s, size_t i, const PartPose& pose, float scale,
                         const Vector3d& root) {
  Triangle out;
  for (int c = 0; c < 3; ++c)
    out.corner[c] =
        root + placed_exactly(pose, scale, s.points[static_cast<size_t>(s.triangles[i][c])]);
  return out;
}

enum class Contact { kNone, kSurfaces, kInside };

Contact contact_by_brute_force(const Solid& a, const PartPose& pose_a, float scale_a,
                               const Solid& b, const PartPose& pose_b, float scale_b,
                               const Eigen::Vector3f& a_to_b) {
  std::vector<Triangle> placed_b;
  for (size_t j = 0; j < b.triangles.size(); ++j)
    placed_b.push_back(placed_triangle(b, j, pose_b, scale_b, a_to_b.cast<double>()));
  for (size_t i = 0; i < a.triangles.size(); ++i) {
    const Triangle placed_a = placed_triangle(a, i, pose_a, scale_a, Vector3d::Zero());
    for (const Triangle& triangle : placed_b)
      if (triangles_touch(placed_a, triangle)) return Contact::kSurfaces;
  }
  const auto inside = [](const Solid& s, const PartPose& pose, float scale, const Vector3d& q) {
    const Vector3d p = to_isometry(pose).linear().inverse() *
                       (q - to_isometry(pose).translation()) / static_cast<double>(scale);
    return winding_number(s, p) > 0.5;
  };
  const bool one_inside =
      inside(a, pose_a, scale_a,
             a_to_b.cast<double>() + placed_exactly(pose_b, scale_b, b.points[0])) ||
      inside(b, pose_b, scale_b,
             placed_exactly(pose_a, scale_a, a.points[0]) - a_to_b.cast<double>());
  return one_inside ? Contact::kInside : Contact::kNone;
}

TEST(Solids, AgreeWithAllPairsOfTriangles) {
  Draw draw(kSeed, 5);
  int touching = 0, contained = 0;
  constexpr int kCasesTried = 800;
  for (int i = 0; i < kCasesTried; ++i) {
    const Solid a = bumpy_ellipsoid(draw, 6, 7, {0.3, 0.1, 0.2}, 0.2);
    const Solid b = bumpy_ellipsoid(draw, 5, 6, {0.1, 0.2, 0.1}, 0.2);
    const PartPose pose_a = draw.pose(0.5), pose_b = draw.pose(0.5);
    const float scale_a = static_cast<float>(draw.uniform(0.5, 2));
    // Some of B are small enough to fit inside A.
    const bool small = i % 4 == 0;
    const float scale_b = small ? 0.1f : static_cast<float>(draw.uniform(0.5, 2));
    const Vector3d between = to_isometry(pose_a).translation() - to_isometry(pose_b).translation() +
                             draw.uniform(0, small ? 0.2 : 0.7) * draw.direction();
    const Eigen::Vector3f a_to_b = between.cast<float>();
    const Contact contact = contact_by_brute_force(a, pose_a, scale_a, b, pose_b, scale_b, a_to_b);
    const bool expected = contact != Contact::kNone;
    contained += contact == Contact::kInside;
    touching += expected;
    const TriangleBvh tree_a(a.points, a.triangles), tree_b(b.points, b.triangles);
    TriangleCounters counters;
    ASSERT_EQ(solids_touch(tree_a, pose_a, scale_a, tree_b, pose_b, scale_b, a_to_b, counters),
              expected)
        << "case " << i << ", seed " << kSeed;
    ASSERT_EQ(solids_touch(tree_b, pose_b, scale_b, tree_a, pose_a, scale_a, -a_to_b, counters),
              expected)
        << "in reverse order, case " << i << ", seed " << kSeed;
  }
  EXPECT_GT(contained, 25);
  EXPECT_GT(touching, kCasesTried / 4);
  EXPECT_LT(touching, kCasesTried * 3 / 4);
}

TEST(Solids, AgreeWithEachOfSeveralPieces) {
  int touching = 0, contained = 0, apart = 0;
  for (uint64_t seed = 1; seed <= 1500; ++seed) {
    Draw draw(seed, 8);
    const MixedPart a = mixed_part(draw, 0.3, false), b = mixed_part(draw, 0.05, true);
    const Eigen::Vector3f a_to_b = draw.in_box(0.4).cast<float>();
    bool expected = false;
    for (const Solid& piece : b.solids)
      expected = expected || a.contains((piece.points[0] + a_to_b).cast<double>());
    for (const Solid& piece : b.loose)
      expected = expected || a.contains((piece.points[0] + a_to_b).cast<double>());
    const bool surfaces = contact_by_brute_force(a.mesh, kUpright, 1, b.mesh, kUpright, 1,
                                                 a_to_b) == Contact::kSurfaces;
    contained += expected && !surfaces;
    expected = expected || surfaces;
    for (const auto* pieces : {&a.solids, &a.loose})
      for (const Solid& piece : *pieces)
        expected = expected || b.contains((piece.points[0] - a_to_b).cast<double>());
    (expected ? touching : apart) += 1;
    ASSERT_EQ(solids_touch_upright(a.mesh, b.mesh, a_to_b), expected) << "seed " << seed;
    ASSERT_EQ(solids_touch_upright(b.mesh, a.mesh, -a_to_b), expected) << "seed " << seed;
  }
  EXPECT_GT(contained, 50);
  EXPECT_GT(touching, 300);
  EXPECT_GT(apart, 300);
}

TEST(TriangleBvh, HoldsEveryTriangleOnceAndInsideItsBoxes) {
  Draw draw(kSeed, 6);
  const Solid solid = bumpy_ellipsoid(draw, 20, 25, {0.3, 0.1, 0.2}, 0.2);
  const TriangleBvh tree(solid.points, solid.triangles);
  ASSERT_EQ(tree.triangles().size(), solid.triangles.size());
  std::vector<int> seen(solid.triangles.size(), 0);
  // Descends with the boxes of all ancestors.
  const auto walk = [&](auto& self, uint32_t at, std::vector<uint32_t> path, int depth) -> void {
    ASSERT_LE(depth, TriangleBvh::kMaxDepth);
    path.push_back(at);
    const TriangleBvh::Node& node = tree.nodes()[at];
    if (node.count == 0) {
      self(self, at + 1, path, depth + 1);
      self(self, node.first, path, depth + 1);
      return;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      ++seen[i];
      for (uint32_t above : path)
        for (const Eigen::Vector3f& p : tree.triangles()[i])
          for (size_t c = 0; c < 3; ++c)
            ASSERT_LE(std::fabs(static_cast<double>(p[static_cast<Eigen::Index>(c)]) -
                                static_cast<double>(tree.nodes()[above].centre_m[c])),
                      static_cast<double>(tree.nodes()[above].half_m[c]));
    }
  };
  walk(walk, 0, {}, 0);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<long>(seen.size()));
}

TEST(TriangleBvh, StaysShallowForGeometricallyGrowingTriangles) {
  Solid solid;  // the surface area heuristic would separate these one by one
  for (int i = 0; i < 3000; ++i) {
    const float size = std::ldexp(1.0f, i % 100 - 60);
    const int first = static_cast<int>(solid.points.size());
    solid.points.insert(solid.points.end(), {{size, 0, 0}, {0, size, 0}, {0, 0, size}});
    solid.triangles.push_back({first, first + 1, first + 2});
  }
  const TriangleBvh tree(solid.points, solid.triangles);
  TriangleCounters counters;
  EXPECT_TRUE(solids_touch(tree, kUpright, 1, tree, kUpright, 1, {0, 0, 0}, counters));
  EXPECT_FALSE(solids_touch(tree, kUpright, 1, tree, kUpright, 1, {-1e13f, 0, 0}, counters));
}

TEST(TriangleCounters, CountNodesAndTriangles) {
  const Solid box = box_solid({0.5, 0.5, 0.5});
  const TriangleBvh tree(box.points, box.triangles);
  TriangleCounters counters;
  EXPECT_FALSE(solids_touch(tree, kUpright, 1, tree, kUpright, 1, {5, 0, 0}, counters));
  EXPECT_EQ(counters.node_tests, 1u);
  EXPECT_EQ(counters.triangle_tests, 0u);
  EXPECT_TRUE(solids_touch(tree, kUpright, 1, tree, kUpright, 1, {0.5f, 0, 0}, counters));
  EXPECT_GT(counters.node_tests, 1u);
  EXPECT_GT(counters.triangle_tests, 0u);
}

}  // namespace
}  // namespace throng::test::narrow_phase_test
