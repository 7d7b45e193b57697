// Shapes of distant people: coarser, near the original, and whole. Clothes are those of the page.
#include "viewer/picture/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "avatars/mesh/primitives.h"
#include "avatars/models/adult_body.h"
#include "viewer/picture/clothes.h"

namespace throng::shape_test {
namespace {

TEST(Simplified, IsCoarserAndNearItsOriginal) {
  constexpr float kCell_m = 0.028F;
  size_t triangles = 0, coarse_triangles = 0;
  for (const AdultPart& part : adult_parts()) {
    const Mesh coarse = simplified(part.mesh, kCell_m);
    triangles += part.mesh.triangles.size();
    coarse_triangles += coarse.triangles.size();
    EXPECT_GT(coarse.triangles.size(), 8u) << part.file;
    for (const Eigen::Vector3f& p : coarse.vertices) {
      float nearest = 1;
      for (const Eigen::Vector3f& q : part.mesh.vertices)
        nearest = std::min(nearest, (p - q).norm());
      EXPECT_LE(nearest, kCell_m) << part.file;  // a mean of points in one cell
    }
  }
  EXPECT_LT(2 * coarse_triangles, triangles);
}

TEST(Sleeve, IsClosedAndAsThickAsItsOriginal) {
  for (const AdultPart& part : adult_parts())
    for (const auto& [rings, sides] : {std::pair(6, 8), {3, 5}, {2, 4}}) {
      const Mesh tube = sleeve(part.mesh, rings, sides);
      EXPECT_TRUE(is_closed(tube)) << part.file;
      const double ratio = signed_volume_m3(tube) / signed_volume_m3(part.mesh);
      EXPECT_GT(ratio, 0.5) << part.file << ", " << rings << " rings";
      EXPECT_LT(ratio, 2.5) << part.file << ", " << rings << " rings";
    }
}

TEST(Shape, SharesLightAtSmoothEdgesOnly) {
  const Mesh box = box_mesh(Eigen::Vector3d::Ones());
  for (const Eigen::Vector3f& normal : shape_of(box, Edges::kSmooth).normals)
    EXPECT_LT(normal.cwiseAbs().maxCoeff(), 0.99F);
  const Shape sharp = shape_of(box);
  for (const Eigen::Vector3i& t : sharp.triangles)
    for (int i = 0; i < 3; ++i)
      EXPECT_GT(sharp.normals[static_cast<size_t>(t[i])].cwiseAbs().maxCoeff(), 0.99F);
}

TEST(Shape, LiesInItsSphere) {
  for (const AdultPart& part : adult_parts()) {
    const Shape shape = shape_of(part.mesh);
    for (const Eigen::Vector3f& p : shape.vertices)
      EXPECT_LE((p - shape.centre).norm(), 1.0001F * shape.radius);
  }
}

TEST(Clothes, CoverTheAdult) {
  for (const auto& [part, slot] : {std::pair("head", Slot::kSkin),
                                   {"RightHand", Slot::kSkin},
                                   {"leftFoot", Slot::kShoes},
                                   {"lowerLeftLeg", Slot::kTrousers},
                                   {"pelvis", Slot::kTrousers},
                                   {"torso", Slot::kShirt},
                                   {"upperRightArm", Slot::kShirt},
                                   {"chassis", Slot::kShirt}})
    EXPECT_EQ(slot_of(part), slot) << part;
}

TEST(Clothes, ArePickedByIdAsInThePagesShaders) {
  // scatter(18) of viewer/page/src/shaders.ts, computed apart: shirt 0, trousers 1, skin 1, hair 1.
  const auto srgb = [](const Eigen::Vector3f& linear) {
    std::string hex = "#";
    for (int i = 0; i < 3; ++i) {
      const float c = linear[i];
      const float curved = c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F;
      for (const int digit : {static_cast<int>(std::lround(255 * curved)) / 16,
                              static_cast<int>(std::lround(255 * curved)) % 16})
        hex += "0123456789abcdef"[digit];
    }
    return hex;
  };
  EXPECT_EQ(srgb(clothes_rgb(Slot::kShirt, 17)), "#6d7f94");
  EXPECT_EQ(srgb(clothes_rgb(Slot::kTrousers, 17)), "#4a5261");
  EXPECT_EQ(srgb(clothes_rgb(Slot::kSkin, 17)), "#a8775a");
  EXPECT_EQ(srgb(clothes_rgb(Slot::kHair, 17)), "#231f20");
  EXPECT_EQ(srgb(clothes_rgb(Slot::kShoes, 17)), "#2b2d33");
  EXPECT_EQ(srgb(mark_rgb(PairLevel::kTriangles)), "#d55e00");
}

TEST(Clothes, LeaveTheFaceFreeOfHair) {
  Part head;
  head.name = "head";
  head.mesh = head_shape();
  Shape shape = shape_of(head.mesh);
  add_hair(head, shape);
  const auto share =
      static_cast<double>(std::count(shape.is_second.begin(), shape.is_second.end(), 1)) /
      static_cast<double>(shape.is_second.size());
  EXPECT_GT(share, 0.2);
  EXPECT_LT(share, 0.8);
  Part torso = head;
  torso.name = "torso";
  Shape bald = shape_of(torso.mesh);
  add_hair(torso, bald);
  EXPECT_TRUE(bald.is_second.empty());
}

}  // namespace
}  // namespace throng::shape_test
