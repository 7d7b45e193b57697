// Culler never misses a touching pair, on random worlds of mixed bodies.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/errors.h"
#include "culling/culling.h"
#include "tests/culling/random_bodies.h"
#include "tests/culling/truth.h"
#include "tests/error_of.h"

namespace throng::culler_test {
namespace {

using test::RandomBodies;
using test::Subset;
using test::touching_by_brute_force;

std::vector<PairKey> pairs_of(const RandomBodies& world, const CullerOptions& options,
                              int threads) {
  Workers workers(threads);
  Culler culler(world.types, options, workers);
  culler.step(world.view(), world);
  return {culler.pairs().begin(), culler.pairs().end()};
}

struct Place {
  const char* name;
  double extent_m;
  Eigen::Vector3d centre_m;
};
const Place kPlaces[] = {{"dense", 3, {0, 0, 0}},
                         {"sparse", 25, {0, 0, 0}},
                         {"far from the origin", 4, {10'000, -7'000, 100}},
                         {"all at one point", 0, {1, 2, 3}}};

TEST(Culler, NeverMissesATouchingPair) {
  for (const Place& place : kPlaces) {
    for (uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(::testing::Message() << place.name << ", seed " << seed);
      const RandomBodies world(seed, place.extent_m == 0 ? 12 : 60, place.extent_m, place.centre_m);
      const std::vector<PairKey> truth = touching_by_brute_force(world);
      if (place.extent_m < 10) {
        ASSERT_GT(truth.size(), 20u);
      }
      for (const VolumeKind volume : kAllVolumes) {
        const std::vector<PairKey> found = pairs_of(world, {.part_volume = volume}, 1);
        size_t missed = 0;
        for (const PairKey& pair : truth)
          missed += !std::binary_search(found.begin(), found.end(), pair);
        EXPECT_EQ(missed, 0u) << name_of(volume) << " misses " << missed << " of " << truth.size();
      }
      EXPECT_EQ(pairs_of(world, {.exact = true}, 1), truth) << "triangles give the reference";
    }
  }
}

TEST(Culler, GivesTheSamePairsForSearchesTargetsAndThreads) {
  for (const Place& place : kPlaces) {
    for (uint64_t seed = 11; seed <= 14; ++seed) {
      const RandomBodies world(seed, place.extent_m == 0 ? 12 : 700, place.extent_m * 2,
                               place.centre_m);
      for (const VolumeKind volume :
           {VolumeKind::kOrdop14, VolumeKind::kOrdop18, VolumeKind::kOrdop26}) {
        const auto reference = pairs_of(
            world,
            {.part_volume = volume, .pair_search = PairSearch::kBrute, .simd = SimdTarget::kScalar},
            1);
        ASSERT_FALSE(reference.empty());
        for (const PairSearch search :
             {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute}) {
          for (const SimdTarget target : simd_targets_of_this_machine()) {
            for (const int threads : {1, 3}) {
              const auto found = pairs_of(
                  world, {.part_volume = volume, .pair_search = search, .simd = target}, threads);
              EXPECT_TRUE(found == reference)
                  << place.name << ", seed " << seed << ", " << name_of(volume) << ", search "
                  << static_cast<int>(search) << ", " << name_of(target) << ", " << threads
                  << " threads: " << found.size() << " pairs instead of " << reference.size();
            }
          }
        }
      }
    }
  }
}

TEST(Culler, FindsNeighboursInAllCellsOfMemory) {
  // Large enough for several strips of cells: a neighbour's slot may then precede a body's own.
  for (uint64_t seed = 15; seed <= 22; ++seed) {
    const RandomBodies world(seed, 6000, 30, Eigen::Vector3d::Zero());
    const auto reference = pairs_of(world, {.pair_search = PairSearch::kSweep}, 1);
    ASSERT_GT(reference.size(), 10000u);
    for (const SimdTarget target : simd_targets_of_this_machine())
      EXPECT_TRUE(pairs_of(world, {.simd = target}, 2) == reference)
          << "seed " << seed << ", " << name_of(target);
  }
}

TEST(Culler, ReportsSortedPairsOfDifferentBodiesOnce) {
  const RandomBodies world(21, 300, 5, Eigen::Vector3d::Zero());
  const auto found = pairs_of(world, {}, 2);
  ASSERT_GT(found.size(), 100u);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  for (const PairKey& pair : found) EXPECT_LT(pair.a(), pair.b());
}

TEST(Culler, NeverTestsStaticBodiesAgainstEachOther) {
  const RandomBodies world(22, 300, 5, Eigen::Vector3d::Zero());
  std::map<uint32_t, bool> is_static;
  for (size_t i = 0; i < world.ids.size(); ++i)
    is_static[world.ids[i]] = world.types[world.type_of[i]]->is_static();
  for (const PairKey& pair : pairs_of(world, {}, 1))
    EXPECT_FALSE(is_static[pair.a()] && is_static[pair.b()]);
}

TEST(Culler, PairsBeginAndEndEventsWhileBodiesChange) {
  const RandomBodies world(31, 200, 4, Eigen::Vector3d::Zero());
  Workers workers(2);
  Culler culler(world.types, {}, workers);
  std::set<PairKey> open;
  uint64_t begins = 0;
  const auto take = [&] {
    for (const PairEvent& event : culler.events()) {
      if (event.kind == EventKind::kBegin) {
        EXPECT_TRUE(open.insert(event.pair).second) << "begun twice";
        ++begins;
      } else {
        EXPECT_EQ(open.erase(event.pair), 1u) << "end without begin";
      }
    }
  };
  for (uint64_t frame = 0; frame < 20; ++frame) {
    const Subset subset(world, 100 + frame);
    culler.step(subset.view(), Subset::Source(subset));
    take();
    EXPECT_TRUE(std::equal(open.begin(), open.end(), culler.pairs().begin(), culler.pairs().end()))
        << "open contacts differ from touching pairs in frame " << frame;
  }
  EXPECT_GT(begins, 1000u);
  culler.finish();
  take();
  EXPECT_TRUE(open.empty());
}

/// World whose source also gives the bounds of each body, as tight as its points allow.
struct Bounded : PoseSource {
  explicit Bounded(const RandomBodies& w) : world(w) {}
  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    world.poses(bodies, out);
  }
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i) {
      const uint32_t body = bodies[i];
      const BodyType& type = *world.types[world.type_of[body]];
      Eigen::AlignedBox3f box;
      for (size_t part = 0; part < type.parts().size(); ++part) {
        const Eigen::Isometry3d pose = to_isometry(world.pose(body, part));
        for (const Eigen::Vector3f& point : type.parts()[part].points) {
          const Eigen::Vector3d placed =
              pose * (static_cast<double>(world.scales[body]) * point.cast<double>());
          // Rotated back into the root's frame, as a gait gives it.
          box.extend(world.roots[body].world_from_root.conjugate() *
                     Eigen::Vector3f(placed.cast<float>()));
        }
      }
      for (int axis = 0; axis < 3; ++axis) {
        out[i].min_m[axis] = box.min()[axis] - 1e-5f;
        out[i].max_m[axis] = box.max()[axis] + 1e-5f;
      }
    }
  }
  const RandomBodies& world;
};

TEST(Culler, PosesFewerBodiesWithBoundsAndMissesNothing) {
  for (uint64_t seed = 51; seed <= 54; ++seed) {
    RandomBodies world(seed, 150, 4, Eigen::Vector3d(5'000, -3'000, 0));
    // Half of them upright, like people: only then does a rectangle rotate with its body.
    for (size_t i = 0; i < world.roots.size(); i += 2)
      world.roots[i].world_from_root =
          Eigen::AngleAxisf(static_cast<float>(i), Eigen::Vector3f::UnitZ());
    const std::vector<PairKey> truth = touching_by_brute_force(world);
    Workers workers(1);
    std::vector<PairKey> reference;
    for (const PairSearch search : {PairSearch::kBrute, PairSearch::kGrid, PairSearch::kSweep}) {
      for (const SimdTarget target : simd_targets_of_this_machine()) {
        Culler bounded(world.types, {.pair_search = search, .simd = target}, workers);
        bounded.step(world.view(), Bounded(world));
        const std::vector<PairKey> found(bounded.pairs().begin(), bounded.pairs().end());
        EXPECT_TRUE(std::includes(found.begin(), found.end(), truth.begin(), truth.end()))
            << "seed " << seed << ", " << name_of(target);
        if (reference.empty()) reference = found;
        EXPECT_EQ(found, reference) << "seed " << seed << ", " << name_of(target);
        Culler free(world.types, {.pair_search = search, .simd = target}, workers);
        free.step(world.view(), world);
        EXPECT_LT(bounded.counters().body_box.passed, free.counters().body_box.passed);
      }
    }
  }
}

TEST(Culler, CountsEveryStage) {
  const RandomBodies world(41, 300, 5, Eigen::Vector3d::Zero());
  Workers workers(1);
  Culler culler(world.types, {.exact = true}, workers);
  culler.step(world.view(), world);
  const CullingCounters& c = culler.counters();
  EXPECT_EQ(c.body_sphere.updates, world.ids.size());
  EXPECT_EQ(c.body_box.tests, c.body_sphere.passed);
  EXPECT_EQ(c.part_volume.tests, c.part_box.passed);
  EXPECT_EQ(c.triangles.tests, c.part_volume.passed);
  EXPECT_EQ(c.triangles.passed, culler.pairs().size());
  EXPECT_GE(c.body_sphere.tests, c.body_sphere.passed);
  EXPECT_GE(c.part_box.tests, c.part_box.passed);
  EXPECT_GT(c.primitive_tests, c.triangles.tests);
}

TEST(Culler, TestsFewerPairsWithAGridThanByBruteForce) {
  const RandomBodies world(42, 2000, 60, Eigen::Vector3d::Zero());
  const auto tests = [&](PairSearch search) {
    Workers workers(1);
    Culler culler(world.types, {.pair_search = search}, workers);
    culler.step(world.view(), world);
    return culler.counters().body_sphere.tests;
  };
  const uint64_t grid = tests(PairSearch::kGrid), sweep = tests(PairSearch::kSweep),
                 brute = tests(PairSearch::kBrute);
  EXPECT_LT(grid, sweep);
  EXPECT_LT(sweep, brute);
  EXPECT_LT(grid * 20, brute);
}

TEST(Culler, RejectsScalesOutsideTheRangeOfFloats) {
  const RandomBodies whole(3, 20, 2, {0, 0, 0});
  Workers workers(1);
  const auto step = [&](float scale) {
    RandomBodies world = whole;
    world.scales[7] = scale;
    for (size_t pose = world.first_pose[7]; pose < world.first_pose[8]; ++pose)
      for (auto& row : world.all_poses[pose].rows) row[3] *= scale / whole.scales[7];
    Culler culler(world.types, {}, workers);
    return test::error_of([&] { culler.step(world.view(), world); });
  };
  for (const float scale : {1e-6F, 0.1F, 1.F, 1e3F, 1e6F}) EXPECT_EQ(step(scale), "") << scale;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float scale : {0.F, -1.F, 1e-37F, 9e-7F, 1.1e6F, kInfinity, -kInfinity, NAN})
    EXPECT_EQ(step(scale), fmt::format("scales[7]: expected a number from 1e-06 to 1e+06, found "
                                       "{:g}",
                                       scale));
}

TEST(Culler, RejectsPartsOutsideTheRangeOfFloats) {
  for (const float at_m : {1.1e6F, -1e30F, std::numeric_limits<float>::infinity(), NAN}) {
    const PartShape fine{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
    PartShape wrong = fine;
    wrong.points[2].y() = at_m;
    EXPECT_EQ(test::error_of([&] {
                BodyType({fine, wrong}, {}, false);
              }),
              fmt::format("parts[1]: expected coordinates of at most 1e+06 m, found {:g}", at_m));
  }
}

/// Two cubes of 0.4 m side that overlap; the second one's part is `lift_m` above its root.
struct Cubes : PoseSource {
  explicit Cubes(const RootSphere& sphere)
      : types{std::make_shared<BodyType>(std::vector{cube()}, sphere, false)} {
    roots[1].position_m.x() = 0.3;
  }
  static PartShape cube() {
    PartShape shape;
    for (int i = 0; i < 8; ++i)
      shape.points.emplace_back(i & 1 ? 0.2f : -0.2f, i & 2 ? 0.2f : -0.2f, i & 4 ? 0.2f : -0.2f);
    return shape;
  }
  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i)
      out[i] =
          to_part_pose(Eigen::Isometry3d(Eigen::Translation3d(0, 0, bodies[i] == 1 ? lift_m : 0)));
  }
  /// Number of pairs in contact.
  size_t contacts(const CullerOptions& options, float scale = 1) const {
    Workers workers(1);
    Culler culler(types, options, workers);
    const std::vector<float> scales{scale, scale};
    culler.step({ids, type_of, scales, roots}, *this);
    return culler.pairs().size();
  }

  double lift_m = 0;
  std::vector<std::shared_ptr<const BodyType>> types;
  std::vector<uint32_t> ids{4, 7};
  std::vector<uint16_t> type_of{0, 0};
  std::vector<RootPose> roots{2};
};

TEST(Culler, RejectsASphereSmallerThanAPart) {
  EXPECT_EQ(Cubes({{0, 0, 0}, 0.35f}).contacts({}), 1u);
  const Cubes small({{0, 0, 0}, 0.05f});
  EXPECT_EQ(small.contacts({.check_spheres = false}), 0u) << "the pair is lost";
  EXPECT_EQ(test::error_of([&] { small.contacts({}); }),
            "types[0]: expected a root sphere of at least 0.3464 m, which part 0 needs in any "
            "pose, found a radius of 0.05 m");
}

TEST(Culler, RejectsAPartOutsideTheSphereOfItsBody) {
  Cubes cubes({{0, 0, 0}, 0.35f});
  cubes.lift_m = 0.3;
  EXPECT_EQ(test::error_of([&] { cubes.contacts({}); }),
            "body 7: expected parts within 0.35 m of the centre of its sphere (RootSphere of type "
            "0), found part 0 at 0.5745 m");
  EXPECT_EQ(Cubes({{0.1f, 0, 0}, 0.4125f}).contacts({}, 2), 1u) << "spheres are scaled";
  EXPECT_EQ(test::error_of([&] {
              Cubes({{0.1f, 0, 0}, 0.4f}).contacts({});
            }),
            "body 4: expected parts within 0.4 m of the centre of its sphere (RootSphere of type "
            "0), found part 0 at 0.4123 m");
}

TEST(Culler, RejectsAPartOutsideTheCylinderOfAnUprightBody) {
  Cubes cubes({{0, 0, 0}, 1, 0.25f});
  EXPECT_EQ(test::error_of([&] { cubes.contacts({}); }),
            "body 4: expected parts within 0.25 m of the root's z axis (RootSphere of type 0), "
            "found part 0 at 0.2828 m");
  for (RootPose& root : cubes.roots)
    root.world_from_root = Eigen::AngleAxisf(0.1f, Eigen::Vector3f::UnitX());
  EXPECT_EQ(cubes.contacts({}), 1u) << "the cylinder is for upright bodies";
}

TEST(Culler, AcceptsSpheresThatFitExactly) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    test::BodyDraw draw(seed);
    PartShape shape;
    float radius_m = 0;
    for (int i = 0; i < 30; ++i) {
      shape.points.push_back(draw.vector(0.3).cast<float>());
      radius_m = std::max(radius_m, shape.points.back().norm());
    }
    Cubes cloud({{0, 0, 0}, radius_m, radius_m});
    cloud.types = {
        std::make_shared<BodyType>(std::vector{shape}, RootSphere{{0, 0, 0}, radius_m}, false)};
    cloud.roots[1].position_m = 1e4 * draw.vector(1);
    EXPECT_EQ(
        test::error_of([&] { cloud.contacts({}, static_cast<float>(draw.uniform(0.01, 100))); }),
        "");
  }
}

TEST(Culler, IsUnchangedByAStepWithAPartOutside) {
  Cubes cubes({{0, 0, 0}, 0.35f});
  Workers workers(1);
  Culler culler(cubes.types, {}, workers);
  const std::vector<float> scales{1, 1};
  culler.step({cubes.ids, cubes.type_of, scales, cubes.roots}, cubes);
  const uint64_t hash = culler.hash();
  cubes.lift_m = 0.3;
  EXPECT_THROW(culler.step({cubes.ids, cubes.type_of, scales, cubes.roots}, cubes), InputError);
  EXPECT_EQ(culler.hash(), hash);
  EXPECT_EQ(culler.pairs().size(), 1u);
}

TEST(Culler, HandlesAnEmptyFrameAndASingleBody) {
  const RandomBodies world(43, 1, 1, Eigen::Vector3d::Zero());
  Workers workers(1);
  Culler culler(world.types, {}, workers);
  culler.step({}, world);
  EXPECT_TRUE(culler.pairs().empty());
  culler.step(world.view(), world);
  EXPECT_TRUE(culler.pairs().empty());
}

}  // namespace
}  // namespace throng::culler_test
