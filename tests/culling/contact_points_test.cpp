// Contact points lie on both parts of exactly the touching pairs, with all options.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/errors.h"
#include "culling/strategies/paper_culler.h"
#include "tests/culling/distance_oracle.h"
#include "tests/culling/random_bodies.h"
#include "tests/same_bits.h"

namespace throng::contact_points_test {
namespace {

using Eigen::Vector3d;
using test::RandomBodies;

/// Every other world is far from the origin.
RandomBodies world_of(uint64_t seed) {
  return RandomBodies(seed, 20, 1.6, Vector3d::Constant(seed % 2 == 0 ? 40'000 : 0));
}

CullerOptions with_points(float margin_m = 0, float closest_margin_m = 0) {
  CullerOptions options;
  options.exact = true;
  options.proximity = {margin_m, closest_margin_m, 0.1, true};
  return options;
}

std::vector<PairKey> pairs_of(std::span<const ContactPoint> rows) {
  std::vector<PairKey> out;
  for (const ContactPoint& row : rows) out.push_back(row.pair);
  return out;
}

std::vector<PairKey> pairs_of(const Culler& culler) {
  return {culler.pairs().begin(), culler.pairs().end()};
}

/// Surfaces of a world's parts, by key.
struct Parts {
  explicit Parts(const RandomBodies& of) : world(of) {
    for (const auto& type : world.types) {
      surfaces.emplace_back();
      for (const PartShape& part : type->parts())
        surfaces.back().emplace_back(part.points, part.triangles);
    }
  }

  static size_t body_of(uint32_t id) { return (id - 1) / 3; }
  bool is_on(uint32_t id, uint32_t part, const Vector3d& point_m) const {
    const size_t body = body_of(id);
    const uint16_t type = world.type_of[body];
    return test::is_on_part(point_m, world.types[type]->parts()[part], surfaces[type][part],
                            world.pose(body, part), world.scales[body],
                            world.roots[body].position_m);
  }
  /// Minimum and maximum of a part along a direction.
  std::pair<double, double> ends(uint32_t id, uint32_t part, const Vector3d& direction) const {
    const size_t body = body_of(id);
    std::pair out(std::numeric_limits<double>::infinity(),
                  -std::numeric_limits<double>::infinity());
    for (const Triangle& t : test::placed_triangles(world.types[world.type_of[body]]->parts()[part],
                                                    world.pose(body, part), world.scales[body],
                                                    world.roots[body].position_m))
      for (const Vector3d& corner : t.corner) {
        out.first = std::min(out.first, direction.dot(corner));
        out.second = std::max(out.second, direction.dot(corner));
      }
    return out;
  }

  const RandomBodies& world;
  std::vector<std::vector<TriangleBvh>> surfaces;
};

TEST(ContactPoints, ExistForExactlyTheTouchingPairs) {
  size_t points = 0;
  for (uint64_t seed = 1; seed <= 16; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomBodies world = world_of(seed);
    const Parts parts(world);
    Workers workers(1);
    Culler culler(world.types, with_points(), workers);
    culler.step(world.view(), world);
    ASSERT_EQ(pairs_of(culler.contact_points()), pairs_of(culler));
    EXPECT_TRUE(culler.proximity_pairs().empty()) << "no margin, no rows";
    for (const ContactPoint& row : culler.contact_points()) {
      ++points;
      const PairKey& key = row.pair;
      const Vector3d point(row.point_m.data());
      ASSERT_TRUE(parts.is_on(key.a(), key.part_a(), point)) << point.transpose();
      ASSERT_TRUE(parts.is_on(key.b(), key.part_b(), point)) << point.transpose();
      const Vector3d direction = Eigen::Vector3f(row.normal.data()).cast<double>();
      ASSERT_NEAR(direction.norm(), 1, 1e-6);
      ASSERT_GT(row.depth_m, 0) << "hulls of convex parts";
      const double end_of_a = parts.ends(key.a(), key.part_a(), direction).second;
      const double begin_of_b = parts.ends(key.b(), key.part_b(), direction).first;
      ASSERT_LE(end_of_a - begin_of_b, static_cast<double>(row.depth_m) + 1e-5)
          << "b, moved by the depth, no longer penetrates a";
    }
  }
  EXPECT_GT(points, 500u);
}

TEST(ContactPoints, AreIndependentOfMargins) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomBodies world = world_of(seed);
    Workers workers(1);
    Culler alone(world.types, with_points(), workers);
    alone.step(world.view(), world);
    for (const auto& [margin_m, closest_margin_m] :
         {std::pair(0.2f, 0.0f), std::pair(0.0f, 0.3f), std::pair(0.2f, 0.3f)}) {
      CullerOptions options = with_points(margin_m, closest_margin_m);
      Culler with(world.types, options, workers);
      options.proximity.contact_points = false;
      Culler without(world.types, options, workers);
      with.step(world.view(), world);
      without.step(world.view(), world);
      EXPECT_TRUE(same_bits<ContactPoint>(with.contact_points(), alone.contact_points()));
      EXPECT_TRUE(without.contact_points().empty());
      EXPECT_EQ(with.proximity_hash(), without.proximity_hash());
      EXPECT_EQ(with.proximity_pairs().size(), without.proximity_pairs().size());
      EXPECT_EQ(with.closest_parts().size(), without.closest_parts().size());
      EXPECT_EQ(with.hash(), without.hash());
      EXPECT_EQ(with.hash(), alone.hash());
    }
    Culler none(world.types, {.exact = true}, workers);
    none.step(world.view(), world);
    EXPECT_EQ(none.hash(), alone.hash());
  }
}

TEST(ContactPoints, AreTheSameForThreadsTargetsSearchesAndVolumes) {
  constexpr uint64_t kFrames = 4, kSeed = 7;
  const auto all_by = [](const CullerOptions& options, int threads) {
    Workers workers(threads);
    const RandomBodies first(kSeed, 60, 3, Vector3d::Zero());
    Culler culler(first.types, options, workers);
    std::vector<ContactPoint> out;
    for (uint64_t frame = 0; frame < kFrames; ++frame) {
      const RandomBodies world(kSeed + frame, 60, 3, Vector3d::Zero());
      culler.step(world.view(), world);
      EXPECT_EQ(pairs_of(culler.contact_points()), pairs_of(culler));
      out.insert(out.end(), culler.contact_points().begin(), culler.contact_points().end());
    }
    return out;
  };
  CullerOptions options = with_points();
  options.simd = SimdTarget::kScalar;
  options.pair_search = PairSearch::kBrute;
  const std::vector<ContactPoint> expected = all_by(options, 1);
  EXPECT_GT(expected.size(), 100u);
  for (const SimdTarget target : simd_targets_of_this_machine())
    for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep}) {
      options.simd = target;
      options.pair_search = search;
      EXPECT_TRUE(same_bits<ContactPoint>(all_by(options, 3), expected)) << name_of(target);
    }
  for (const VolumeKind volume : {VolumeKind::kSphere, VolumeKind::kObb, VolumeKind::kAabb}) {
    options.part_volume = volume;
    EXPECT_TRUE(same_bits<ContactPoint>(all_by(options, 2), expected)) << name_of(volume);
  }
}

/// Undecided pairs have no point. Decided pairs have the point of the complete frame.
TEST(ContactPoints, ExistForDecidedPairsWithABudget) {
  const RandomBodies world(5, 60, 3, Vector3d::Zero());
  Workers one(1), three(3);
  Culler whole(world.types, with_points(), one);
  whole.step(world.view(), world);
  const std::span<const ContactPoint> all = whole.contact_points();
  for (const float margin_m : {0.0f, 0.2f}) {
    size_t points = 0;
    for (const uint64_t tests : {0, 100, 400, 1'000'000}) {
      SCOPED_TRACE(::testing::Message() << tests << " tests, margin " << margin_m);
      CullerOptions options = with_points(margin_m);
      options.budget_tests = tests;
      Culler cut(world.types, options, one), again(world.types, options, three);
      cut.step(world.view(), world);
      again.step(world.view(), world);
      EXPECT_TRUE(same_bits<ContactPoint>(cut.contact_points(), again.contact_points()));
      EXPECT_EQ(cut.proximity_pairs().empty(), margin_m == 0);
      const std::vector<PairKey> touching = pairs_of(cut);
      for (const ContactPoint& row : cut.contact_points()) {
        EXPECT_TRUE(std::binary_search(touching.begin(), touching.end(), row.pair));
        const auto known = std::find_if(all.begin(), all.end(),
                                        [&](const ContactPoint& p) { return p.pair == row.pair; });
        ASSERT_NE(known, all.end());
        EXPECT_TRUE(same_bits(row, *known));
      }
      points = cut.contact_points().size();
      if (tests == 0) {
        EXPECT_EQ(points, 0u);
      }
    }
    EXPECT_EQ(points, all.size());
  }
}

TEST(ContactPoints, NeedTrianglesAndThePipeline) {
  const RandomBodies world(1, 5, 1, Vector3d::Zero());
  Workers workers(1);
  CullerOptions options = with_points();
  options.exact = false;
  EXPECT_THROW(Culler(world.types, options, workers), InputError);
  options = with_points();
  EXPECT_THROW(PaperCuller(world.types, Strategy::kTwoPass, options), InputError);
}

}  // namespace
}  // namespace throng::contact_points_test
