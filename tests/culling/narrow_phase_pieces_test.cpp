// Parts of several pieces: each closed piece has an inside, regardless of the others.
#include <gtest/gtest.h>

#include "culling/triangles/triangle_bvh.h"
#include "shapes.h"

namespace throng::test::narrow_phase_pieces_test {
namespace {

using Eigen::Vector3d;

const PartPose kUpright = to_part_pose(Eigen::Isometry3d::Identity());

bool solids_touch_upright(const Solid& a, const Solid& b, const Eigen::Vector3f& a_to_b) {
  TriangleCounters counters;
  return solids_touch(TriangleBvh(a.points, a.triangles), kUpright, 1,
                      TriangleBvh(b.points, b.triangles), kUpright, 1, a_to_b, counters);
}

Solid loose_triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  return {{a, b, c}, {{0, 1, 2}}};
}

TEST(Solids, AreIndependentOfLooseTriangles) {
  const Solid box = box_solid({0.5, 0.5, 0.5}), small = box_solid({0.1, 0.1, 0.1});
  const Eigen::Vector3f far(2, 2, 2), out(1, 1, 1), up(0, 0, 2);
  const std::pair<const char*, Solid> cases[] = {
      {"a triangle outside", loose_triangle(far, far + out, far + up)},
      {"a triangle inside", loose_triangle({0.3f, 0, 0}, {0.4f, 0, 0}, {0.3f, 0.1f, 0})},
      {"a triangle at a corner", loose_triangle(box.points[7], far, far + up)},
      {"a fin on an edge", loose_triangle(box.points[7], box.points[6], far)},
      {"a wall across a face", loose_triangle(box.points[0], box.points[3], box.points[1] + up)},
      {"a segment", loose_triangle(far, far + up, far)},
      {"a point", loose_triangle(far, far, far)}};
  for (const auto& [what, loose] : cases) {
    SCOPED_TRACE(what);
    for (const Solid& mesh : {both(box, loose), both(loose, box)}) {
      EXPECT_TRUE(TriangleBvh(mesh.points, mesh.triangles).contains({0.1, 0.2, 0}));
      EXPECT_FALSE(TriangleBvh(mesh.points, mesh.triangles).contains({0.6, 0.2, 0}));
      EXPECT_TRUE(solids_touch_upright(mesh, small, {-0.2f, -0.2f, 0}));
      EXPECT_TRUE(solids_touch_upright(small, mesh, {0.2f, 0.2f, 0}));
      EXPECT_FALSE(solids_touch_upright(mesh, small, {-0.7f, 0, 0}));
    }
  }
}

TEST(Solids, IncludeTheirCavities) {
  // An inverted piece may be a cavity or a wrongly exported mesh. Including it misses no contact.
  const Solid shell = both(box_solid({0.5, 0.5, 0.5}), inside_out(box_solid({0.3, 0.3, 0.3})));
  const TriangleBvh tree(shell.points, shell.triangles);
  EXPECT_EQ(tree.solid_count(), 2u);
  EXPECT_TRUE(tree.contains({0.4, 0, 0}));
  EXPECT_TRUE(tree.contains({0, 0, 0}));
  EXPECT_FALSE(tree.contains({0.6, 0, 0}));
  EXPECT_TRUE(solids_touch_upright(shell, box_solid({0.1, 0.1, 0.1}), {0, 0, 0}));
}

TEST(Surface, SeparatesSolidsFromLooseTriangles) {
  int inside = 0, outside = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    Draw draw(seed, 7);
    const MixedPart part = mixed_part(draw, 0.3, false);
    const TriangleBvh tree(part.mesh.points, part.mesh.triangles);
    ASSERT_EQ(tree.solid_count(), part.solids.size()) << "seed " << seed;
    for (int i = 0; i < 100; ++i) {
      const Vector3d point = draw.in_box(0.5);
      const bool expected = part.contains(point);
      (expected ? inside : outside) += 1;
      ASSERT_EQ(tree.contains(point), expected)
          << "at " << point.transpose() << ", seed " << seed << ", " << part.solids.size()
          << " solids, " << part.loose.size() << " loose triangles";
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

}  // namespace
}  // namespace throng::test::narrow_phase_pieces_test
