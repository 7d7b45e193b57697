// part_distance() bounds the distance of any parts of two bodies, and equals the rows of a culler.
#include "culling/part_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "culling/culling.h"
#include "tests/culling/distance_tree.h"
#include "tests/culling/random_bodies.h"
#include "tests/culling/truth.h"
#include "tests/nightly.h"

namespace throng::part_distance_test {
namespace {

using Eigen::Vector3d;
using test::RandomBodies;

using Parts = std::vector<uint8_t>;

Parts all_parts(const RandomBodies& world, size_t body) {
  Parts out(world.types[world.type_of[body]]->parts().size());
  std::iota(out.begin(), out.end(), uint8_t{0});
  return out;
}

BodyInPose body_of(const RandomBodies& world, size_t body, const Parts& parts) {
  const size_t count = world.types[world.type_of[body]]->parts().size();
  return {world.ids[body],
          world.type_of[body],
          world.scales[body],
          world.roots[body].position_m,
          {&world.pose(body, 0), count},
          parts};
}

PartDistance distance_of(const RandomBodies& world, size_t a, const Parts& of_a, size_t b,
                         const Parts& of_b) {
  return part_distance(world.types, body_of(world, a, of_a), body_of(world, b, of_b));
}

auto values_of(const PartDistance& d) {
  return std::tuple(d.part_a, d.part_b, d.level, d.lo_m, d.hi_m, d.point_a_m, d.point_b_m, d.normal,
                    d.depth_m);
}

auto values_of(const ProximityPair& row) {
  return std::tuple(static_cast<uint8_t>(row.pair.part_a()),
                    static_cast<uint8_t>(row.pair.part_b()), row.level, row.lo_m, row.hi_m,
                    row.point_a_m, row.point_b_m, row.normal, row.depth_m);
}

TEST(PartDistance, EqualsTheRowsOfACuller) {
  size_t rows = 0, touching = 0, nearest = 0;
  for (uint64_t seed = 1; seed <= test::part_of(40u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomBodies world(seed, 30, 2, Vector3d::Constant(seed % 2 == 0 ? 40'000 : 0));
    CullerOptions options;
    options.exact = true;
    options.proximity = {0.3f, 0.5f, 0, false};
    Workers workers(1);
    Culler culler(world.types, options, workers);
    culler.step(world.view(), world);
    const auto body = [](uint32_t id) { return (id - 1) / 3; };
    for (const ProximityPair& row : culler.proximity_pairs()) {
      const PartDistance found =
          distance_of(world, body(row.pair.a()), {static_cast<uint8_t>(row.pair.part_a())},
                      body(row.pair.b()), {static_cast<uint8_t>(row.pair.part_b())});
      ASSERT_EQ(values_of(found), values_of(row)) << "row " << rows;
      ++rows;
      touching += row.hi_m == 0;
    }
    for (const ProximityPair& row : culler.closest_parts()) {
      const size_t a = body(row.pair.a()), b = body(row.pair.b());
      const PartDistance found = distance_of(world, a, all_parts(world, a), b, all_parts(world, b));
      ASSERT_EQ(values_of(found), values_of(row)) << "closest parts " << nearest;
      ++nearest;
    }
  }
  EXPECT_GT(rows, test::part_of(10'000u));
  EXPECT_GT(touching, test::part_of(1000u));
  EXPECT_GT(nearest, test::part_of(1000u));
}

/// Distance of the nearest two parts by brute force.
class Oracle {
 public:
  explicit Oracle(const RandomBodies& world) : world_(world) {
    for (const auto& type : world.types)
      trees_.emplace_back(type->parts().begin(), type->parts().end());
    const std::vector<PairKey> found = test::touching_by_brute_force(world);
    touching_ = {found.begin(), found.end()};
  }
  double distance(size_t a, const Parts& of_a, size_t b, const Parts& of_b) const {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const uint8_t i : of_a)
      for (const uint8_t j : of_b)
        nearest_m =
            std::min(nearest_m,
                     touches(a, i, b, j)
                         ? 0
                         : test::DistanceTree::distance(
                               placed(a, i), placed(b, j),
                               world_.roots[b].position_m - world_.roots[a].position_m, nearest_m));
    return nearest_m;
  }

 private:
  bool touches(size_t a, uint8_t i, size_t b, uint8_t j) const {
    const PairKey key = a < b ? PairKey(world_.ids[a], world_.ids[b], i, j)
                              : PairKey(world_.ids[b], world_.ids[a], j, i);
    return std::binary_search(touching_.begin(), touching_.end(), key);
  }
  test::DistanceTree::Placed placed(size_t body, size_t part) const {
    return {&trees_[world_.type_of[body]][part], &world_.pose(body, part), world_.scales[body]};
  }

  const RandomBodies& world_;
  std::vector<std::vector<test::DistanceTree>> trees_;
  std::vector<PairKey> touching_;
};

/// Each part with a probability of one half, at least one.
Parts some_parts(test::BodyDraw& draw, const Parts& all) {
  Parts out;
  for (const uint8_t part : all)
    if (draw.integer(0, 1) == 1) out.push_back(part);
  if (out.empty())
    out.push_back(all[static_cast<size_t>(draw.integer(0, static_cast<int>(all.size()) - 1))]);
  return out;
}

TEST(PartDistance, BoundsTheDistanceOfTheNearestParts) {
  uint64_t touching = 0, apart = 0;
  for (uint64_t seed = 1; seed <= test::part_of(300u); ++seed) {
    test::BodyDraw draw(seed + 1000);
    const double extent_m = seed % 3 == 0 ? 0.4 : seed % 3 == 1 ? 3 : 40;
    const RandomBodies world(seed, 5, extent_m, Vector3d::Constant(seed % 2 == 0 ? 40'000 : 0));
    const Oracle oracle(world);
    for (size_t a = 0; a < 5; ++a)
      for (size_t b = 0; b < 5; ++b) {
        // Pairs of static bodies touch by no oracle.
        if (a == b || (world.types[world.type_of[a]]->is_static() &&
                       world.types[world.type_of[b]]->is_static()))
          continue;
        SCOPED_TRACE(::testing::Message() << "seed " << seed << ", bodies " << a << ", " << b);
        const Parts of_a = some_parts(draw, all_parts(world, a)),
                    of_b = some_parts(draw, all_parts(world, b));
        const PartDistance found = distance_of(world, a, of_a, b, of_b);
        const double truth_m = oracle.distance(a, of_a, b, of_b);
        const double rounding_m = 2e-6 + 1e-7 * extent_m;
        ASSERT_LE(static_cast<double>(found.lo_m), truth_m + rounding_m);
        ASSERT_GE(static_cast<double>(found.hi_m), truth_m - rounding_m);
        ASSERT_LE(found.hi_m - found.lo_m, 1e-3f);
        ASSERT_EQ(found.level, PairLevel::kTriangles);
        ASSERT_TRUE(std::count(of_a.begin(), of_a.end(), found.part_a) == 1);
        ASSERT_TRUE(std::count(of_b.begin(), of_b.end(), found.part_b) == 1);
        ASSERT_NEAR(oracle.distance(a, {found.part_a}, b, {found.part_b}), truth_m, 1e-3);
        ASSERT_EQ(found.hi_m == 0, truth_m == 0);
        const Vector3d from_a_to_b =
            Vector3d(found.point_b_m.data()) - Vector3d(found.point_a_m.data());
        ASSERT_NEAR(from_a_to_b.norm(), static_cast<double>(found.hi_m), 2e-5);
        const Eigen::Vector3d normal = Eigen::Vector3f(found.normal.data()).cast<double>();
        ASSERT_NEAR(normal.norm(), 1, 1e-5);
        if (found.hi_m > 0.1f) {
          ASSERT_GT(normal.dot(from_a_to_b), 0.99 * from_a_to_b.norm());
        }
        ++(truth_m == 0 ? touching : apart);
      }
  }
  EXPECT_GT(touching, test::part_of(120u));
  EXPECT_GT(apart, test::part_of(3000u));
}

TEST(PartDistance, IsTheSameInBothOrders) {
  for (uint64_t seed = 1; seed <= test::part_of(50u); ++seed) {
    const RandomBodies world(seed, 2, seed % 2 == 0 ? 0.5 : 5, Vector3d::Zero());
    const Parts all_a = all_parts(world, 0), all_b = all_parts(world, 1);
    const PartDistance one = distance_of(world, 0, all_a, 1, all_b),
                       other = distance_of(world, 1, all_b, 0, all_a);
    EXPECT_EQ(one.lo_m, other.lo_m);
    EXPECT_EQ(one.hi_m, other.hi_m);
    EXPECT_EQ(one.part_a, other.part_b);
    EXPECT_EQ(one.part_b, other.part_a);
    EXPECT_EQ(one.point_a_m, other.point_b_m);
    EXPECT_EQ(one.point_b_m, other.point_a_m);
    EXPECT_EQ(Eigen::Vector3f(one.normal.data()), -Eigen::Vector3f(other.normal.data()));
  }
}

/// All points of a body, relative to its root.
std::vector<Vector3d> points_of(const RandomBodies& world, size_t body) {
  std::vector<Vector3d> out;
  const std::vector<PartShape>& parts = world.types[world.type_of[body]]->parts();
  for (size_t part = 0; part < parts.size(); ++part)
    for (const Eigen::Vector3f& point : parts[part].points)
      out.push_back(to_isometry(world.pose(body, part)) *
                    (double{world.scales[body]} * point.cast<double>()));
  return out;
}

// Triangle distances lose digits there. A gap along a line and two points bound the distance.
TEST(PartDistance, IsProvenBeyondTheRangeOfRows) {
  for (uint64_t seed = 1; seed <= test::part_of(50u); ++seed) {
    RandomBodies world(seed, 2, 1, Vector3d::Zero());
    const Parts all_a = all_parts(world, 0), all_b = all_parts(world, 1);
    const std::vector<Vector3d> of_a = points_of(world, 0), of_b = points_of(world, 1);
    test::BodyDraw draw(seed);
    for (const double far_m : {150.0, 1e4, 1e6, 1e9}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << far_m << " m");
      world.roots[1].position_m = world.roots[0].position_m + far_m * draw.vector(1).normalized();
      const Vector3d shift = world.roots[1].position_m - world.roots[0].position_m;
      const Vector3d along = shift.normalized();
      double min_m = std::numeric_limits<double>::infinity(), max_m = min_m;
      for (const Vector3d& a : of_a)
        for (const Vector3d& b : of_b) {
          min_m = std::min(min_m, along.dot(shift + b - a));
          max_m = std::min(max_m, (shift + b - a).norm());
        }
      const PartDistance found = distance_of(world, 0, all_a, 1, all_b);
      const double rounding_m = 1e-6 + 1e-15 * far_m;
      ASSERT_LE(static_cast<double>(found.lo_m), max_m + rounding_m);
      ASSERT_GE(static_cast<double>(found.hi_m), min_m - rounding_m);
      ASSERT_LE(static_cast<double>(found.hi_m - found.lo_m), 1e-3 + 4e-6 * far_m);
      const double points_m =
          (Vector3d(found.point_b_m.data()) - Vector3d(found.point_a_m.data())).norm();
      ASSERT_LE(points_m, static_cast<double>(found.hi_m) + rounding_m);
      ASSERT_GE(points_m, min_m - rounding_m - 1e-7 * far_m);
    }
  }
}

/// Distances of convex point clouds are at most those of their solids, and their corners are on
/// them.
TEST(PartDistance, BoundsPointCloudsByTheirHulls) {
  for (uint64_t seed = 1; seed <= test::part_of(50u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    RandomBodies world(seed, 2, 3, Vector3d::Zero());
    const Parts all_a = all_parts(world, 0), all_b = all_parts(world, 1);
    const PartDistance solid = distance_of(world, 0, all_a, 1, all_b);
    for (auto& type : world.types) {
      std::vector<PartShape> clouds = type->parts();
      for (PartShape& cloud : clouds) cloud.triangles.clear();
      type = std::make_shared<BodyType>(std::move(clouds), type->sphere(), type->is_static());
    }
    const PartDistance cloud = distance_of(world, 0, all_a, 1, all_b);
    EXPECT_EQ(cloud.level, PairLevel::kPartVolume);
    EXPECT_LE(cloud.lo_m, solid.hi_m);
    EXPECT_GE(cloud.hi_m, solid.lo_m);
    EXPECT_TRUE(std::isnan(cloud.point_a_m[0]) && std::isnan(cloud.normal[0]));
  }
}

}  // namespace
}  // namespace throng::part_distance_test
