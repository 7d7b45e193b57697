// Tests the workbench: project volumes have no misses, a miss is reported with its pair, and
// missing functions of a volume are replaced.
#include "bench/workbench/workbench.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "culling/triangles/triangle_bvh.h"
#include "culling/volumes/volume_list.h"

namespace throng::workbench_test {
namespace {

using bench::NoMissResult;
using bench::TestedVolumeOf;

constexpr uint64_t kSeed = 20266;

/// Radius too small by a tenth.
struct ThinSphere : Sphere {
  static Fitted fit(std::span<const Eigen::Vector3f> points) {
    Fitted sphere = Sphere::fit(points);
    sphere.radius_m *= 0.9f;
    return sphere;
  }
};

/// Has only a fit and a test.
struct BareSphere {
  static Sphere::Fitted fit(std::span<const Eigen::Vector3f> points) { return Sphere::fit(points); }
  static bool overlaps(const bench::PosedPart<Sphere::Fitted>& a,
                       const bench::PosedPart<Sphere::Fitted>& b, const Eigen::Vector3f& a_to_b_m,
                       float margin_m) {
    return Sphere::overlaps(Sphere::place(*a.fitted, a.pose, a.scale),
                            Sphere::place(*b.fitted, b.pose, b.scale), a_to_b_m, margin_m);
  }
};

/// Tests many pairs at once; for every seventh pair it returns `kWrong`.
template <bool kWrong>
struct KernelSphere : Sphere {
  static void overlaps_many(std::span<const Placed> placed,
                            std::span<const bench::PlacedPair> pairs, std::span<uint8_t> out) {
    for (size_t i = 0; i < pairs.size(); ++i)
      out[i] = (kWrong && i % 7 == 0) || Sphere::overlaps(placed[pairs[i].a], placed[pairs[i].b],
                                                          pairs[i].a_to_b_m, pairs[i].margin_m);
  }
};

NoMissResult law_of(const bench::TestedVolume& volume, uint64_t pairs, int threads) {
  Workers workers(threads);
  NoMissResult sum;
  for (const NoMissResult& row : bench::check_no_misses(volume, pairs, kSeed, workers)) {
    EXPECT_GT(row.tested, pairs / 10) << row.family;
    EXPECT_GT(row.touching, row.tested / 100) << row.family;
    sum.add(row);
  }
  return sum;
}

TEST(Workbench, FindsNoMissInProjectVolumes) {
  for (const bench::TestedVolume* volume : bench::project_volumes()) {
    const NoMissResult sum = law_of(*volume, 1000, 1);
    EXPECT_EQ(sum.missed, 0u) << volume->name() << ": " << sum.first_miss->where;
    EXPECT_GE(sum.reported, sum.touching) << volume->name();
    EXPECT_LT(sum.touching, sum.tested) << volume->name();
  }
}

TEST(Workbench, ReportsTheMissedPairOfASmallVolume) {
  const NoMissResult sum = law_of(TestedVolumeOf<ThinSphere>("thin"), 20'000, 2);
  EXPECT_GT(sum.missed, 0u);
  ASSERT_TRUE(sum.first_miss);
  // The pair reproduces the miss: its triangles touch, and the volume reports it as apart.
  const bench::Miss& miss = *sum.first_miss;
  TriangleCounters counters;
  EXPECT_TRUE(solids_touch({miss.shape_a.points, miss.shape_a.triangles}, miss.a.pose, miss.a.scale,
                           {miss.shape_b.points, miss.shape_b.triangles}, miss.b.pose, miss.b.scale,
                           miss.test.a_to_b_m, counters));
  const auto placed = [](const PartShape& shape, const bench::PartPlace& place) {
    return ThinSphere::place(ThinSphere::fit(shape.points), place.pose, place.scale);
  };
  EXPECT_FALSE(ThinSphere::overlaps(placed(miss.shape_a, miss.a), placed(miss.shape_b, miss.b),
                                    miss.test.a_to_b_m, miss.test.margin_m));
  EXPECT_NE(bench::to_text(miss).find("seed 20266"), std::string::npos);
}

TEST(Workbench, DrawsTheSamePairsForAnyThreadCount) {
  const TestedVolumeOf<ThinSphere> thin("thin");
  const NoMissResult one = law_of(thin, 5000, 1), three = law_of(thin, 5000, 3);
  EXPECT_EQ(one.tested, three.tested);
  EXPECT_EQ(one.touching, three.touching);
  EXPECT_EQ(one.reported, three.reported);
  EXPECT_EQ(one.missed, three.missed);
  EXPECT_EQ(bench::to_text(*one.first_miss), bench::to_text(*three.first_miss));
}

TEST(Workbench, NeedsOnlyFitAndTest) {
  const NoMissResult bare = law_of(TestedVolumeOf<BareSphere>("bare"), 5000, 1);
  const NoMissResult whole = law_of(TestedVolumeOf<Sphere>("sphere"), 5000, 1);
  EXPECT_EQ(bare.tested, whole.tested);
  EXPECT_EQ(bare.reported, whole.reported);
  EXPECT_EQ(bare.missed, 0u);
}

TEST(Workbench, DetectsADifferingKernel) {
  EXPECT_EQ(law_of(TestedVolumeOf<KernelSphere<false>>("kernel"), 5000, 1).differing, 0u);
  EXPECT_GT(law_of(TestedVolumeOf<KernelSphere<true>>("kernel"), 5000, 1).differing, 0u);
}

TEST(Workbench, ComparesAVolumeWithProjectVolumes) {
  WorkbenchOptions options{.no_miss_pairs = 2000, .seed = kSeed, .walkers = 40, .frames = 40};
  const WorkbenchResult result = try_volume(TestedVolumeOf<BareSphere>("bare"), options);
  EXPECT_TRUE(result.has_no_misses());
  ASSERT_EQ(result.figure_3.size(), bench::project_volumes().size() + 1);
  const auto& bare = result.figure_3.back();
  const auto& sphere = result.figure_3.front();
  EXPECT_EQ(bare.name, "bare");
  EXPECT_EQ(bare.found, sphere.found);
  EXPECT_EQ(bare.true_share, sphere.true_share);
  for (const bench::FalsePositives& counted : result.false_positives) {
    uint64_t passed = 0;
    for (const bench::PartCell& cell : counted.matrix) passed += cell.passed;
    EXPECT_EQ(counted.matrix_volume, "bare");
    EXPECT_EQ(passed, counted.volumes.front().reported);  // those of the sphere, an equal volume
  }
  const std::string text = to_text(result);
  EXPECT_NE(text.find("bare: 0 of "), std::string::npos);
  EXPECT_NE(text.find("> bare"), std::string::npos);
}

}  // namespace
}  // namespace throng::workbench_test
