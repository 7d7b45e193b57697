// Tests that a drawn volume is a closed surface around all points of its part, with its edges.
#include "viewer/picture/volume_outline.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "avatars/avatars.h"
#include "bench/workbench/random_pairs.h"
#include "culling/volumes/pose_math.h"

namespace throng::volume_outline_test {
namespace {

constexpr uint64_t kSeed = 20268;

/// Returns the maximum distance of a point beyond a face. The corners of a drawn sphere lie on it:
/// its faces cut a little off.
float beyond_m(const VolumeOutline& outline, const Eigen::Vector3f& point) {
  float max_m = -1e30F;
  for (const Eigen::Vector3i& t : outline.faces.triangles) {
    const auto at = [&](int i) { return outline.faces.vertices[static_cast<size_t>(t[i])]; };
    const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
    if (normal.norm() < 1e-6F) continue;  // degenerate: its neighbours have the same plane
    max_m = std::max(max_m, normal.normalized().dot(point - at(0)));
  }
  return max_m;
}

TEST(VolumeOutlines, EnclosePartPoints) {
  bench::Draw draw(kSeed);
  const auto adult = load_model(adult_urdf());
  std::vector<PartShape> shapes;
  for (const Part& part : adult->parts) shapes.push_back({part.mesh.vertices, part.mesh.triangles});
  const BodyType type(shapes, RootSphere{}, false);
  for (const VolumeKind kind : kAllVolumes)
    for (size_t part = 0; part < shapes.size(); ++part) {
      const PartPose pose = draw.pose(1);
      const auto scale = static_cast<float>(draw.uniform(0.7, 1.2));
      const VolumeOutline outline = outline_of(kind, type, part, pose, scale);
      ASSERT_FALSE(outline.faces.triangles.empty()) << name_of(kind);
      EXPECT_GT(signed_volume_m3(outline.faces), 0) << name_of(kind) << ": faces turned inwards";
      const float allowed_m = kind == VolumeKind::kSphere ? 0.006F : 2e-4F;
      float worst_m = -1;
      for (const Eigen::Vector3f& p : shapes[part].points)
        worst_m = std::max(worst_m, beyond_m(outline, placed_point(pose, scale, p)));
      EXPECT_LE(worst_m, allowed_m)
          << name_of(kind) << " of " << adult->parts[part].name << ", seed " << kSeed;
      EXPECT_GE(outline.edges.size(), 12u);
    }
}

TEST(VolumeOutlines, HaveTwelveEdgesForABox) {
  const VolumeOutline box = box_outline({0, 0, 0}, {1, 2, 3});
  EXPECT_EQ(box.edges.size(), 12u);
  EXPECT_NEAR(signed_volume_m3(box.faces), 6, 1e-5);
  const Mesh bars = bars_of(box, 0.01F);
  EXPECT_EQ(bars.triangles.size(), 12u * 12u);
  EXPECT_NEAR(signed_volume_m3(bars), 0.01 * 0.01 * (4 * 6 + 12 * 0.01), 1e-6);
}

}  // namespace
}  // namespace throng::volume_outline_test
