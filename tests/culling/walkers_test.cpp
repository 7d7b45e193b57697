// Culling of walking people: the adult body and gait, in dense crowds.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/crowd.h"
#include "culling/culling.h"
#include "culling/triangles/triangle_bvh.h"

namespace throng::walkers_test {
namespace {

std::shared_ptr<const Model> adult() {
  static const std::shared_ptr<const Model> model = load_model(adult_urdf());
  return model;
}

/// Pairs of parts of different people whose solids touch, by testing all.
std::vector<PairKey> touching_by_brute_force(const bench::Crowd& crowd, const BodyType& type) {
  const size_t parts = type.parts().size();
  std::vector<TriangleBvh> surfaces;
  for (const PartShape& part : type.parts()) surfaces.emplace_back(part.points, part.triangles);
  const BodiesView bodies = crowd.view();
  std::vector<PartPose> poses(bodies.ids.size() * parts);
  for (uint32_t i = 0; i < bodies.ids.size(); ++i)
    crowd.poses({&i, 1}, {poses.data() + i * parts, parts});
  std::vector<PairKey> out;
  TriangleCounters counters;
  for (size_t a = 0; a < bodies.ids.size(); ++a)
    for (size_t b = a + 1; b < bodies.ids.size(); ++b) {
      const Eigen::Vector3f shift =
          (bodies.roots[b].position_m - bodies.roots[a].position_m).cast<float>();
      for (size_t pa = 0; pa < parts; ++pa)
        for (size_t pb = 0; pb < parts; ++pb)
          if (solids_touch(surfaces[pa], poses[a * parts + pa], bodies.scales[a], surfaces[pb],
                           poses[b * parts + pb], bodies.scales[b], shift, counters))
            out.emplace_back(bodies.ids[a], bodies.ids[b], static_cast<uint32_t>(pa),
                             static_cast<uint32_t>(pb));
    }
  return out;
}

TEST(Walkers, HaveNoMissedContactsWithAnyVolume) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    bench::Crowd crowd(adult(), {.avatars = 36, .per_m2 = 4, .seed = seed});
    const auto type = crowd.body_type();
    Workers workers(1);
    for (int frame = 0; frame < 3; ++frame) {
      for (int step = 0; step < 20; ++step) crowd.advance();
      const std::vector<PairKey> truth = touching_by_brute_force(crowd, *type);
      ASSERT_GT(truth.size(), 20u);
      for (const VolumeKind volume : kAllVolumes) {
        Culler culler({type}, {.part_volume = volume}, workers);
        culler.step(crowd.view(), crowd);
        size_t missed = 0;
        for (const PairKey& pair : truth)
          missed += !std::binary_search(culler.pairs().begin(), culler.pairs().end(), pair);
        EXPECT_EQ(missed, 0u) << name_of(volume) << " misses " << missed << " of " << truth.size()
                              << ", seed " << seed << ", frame " << frame;
      }
      Culler exact({type}, {.exact = true}, workers);
      exact.step(crowd.view(), crowd);
      EXPECT_TRUE(
          std::equal(truth.begin(), truth.end(), exact.pairs().begin(), exact.pairs().end()))
          << "seed " << seed << ", frame " << frame;
    }
  }
}

TEST(Walkers, GiveTheSameHashForSearchesTargetsAndThreads) {
  const auto hash = [](const CullerOptions& options, int threads) {
    bench::Crowd crowd(adult(), {.avatars = 600, .per_m2 = 2, .seed = 7});
    crowd.simd = options.simd;
    Workers workers(threads);
    Culler culler({crowd.body_type()}, options, workers);
    for (int frame = 0; frame < 30; ++frame) {
      crowd.advance();
      culler.step(crowd.view(), crowd);
    }
    culler.finish();
    return culler.hash();
  };
  const uint64_t reference =
      hash({.pair_search = PairSearch::kBrute, .simd = SimdTarget::kScalar}, 1);
  for (const SimdTarget target : simd_targets_of_this_machine())
    for (const int threads : {1, 2, 3, 8})
      EXPECT_EQ(hash({.simd = target}, threads), reference)
          << name_of(target) << ", " << threads << " threads";
  EXPECT_EQ(hash({.pair_search = PairSearch::kSweep}, 2), reference);
}

TEST(Walkers, GiveEqualCountsWithAnAgedGrid) {
  bench::Crowd crowd(adult(), {.avatars = 500, .per_m2 = 2, .seed = 9});
  const auto type = crowd.body_type();
  Workers workers(1);
  Culler old({type}, {}, workers);
  for (int frame = 0; frame < 300; ++frame) {
    crowd.advance();
    old.step(crowd.view(), crowd);
  }
  Culler fresh({type}, {}, workers);
  fresh.step(crowd.view(), crowd);
  EXPECT_EQ(old.counters().body_sphere.tests, fresh.counters().body_sphere.tests);
  EXPECT_EQ(old.counters().part_box.tests, fresh.counters().part_box.tests);
  EXPECT_EQ(old.counters().part_volume.tests, fresh.counters().part_volume.tests);
}

}  // namespace
}  // namespace throng::walkers_test
