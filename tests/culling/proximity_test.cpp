// Proximity rows of a crowd miss no pair within the margin and bound the distance. They are the
// same for any number of threads, SIMD target and pair search.
#include "culling/proximity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/errors.h"
#include "culling/strategies/paper_culler.h"
#include "tests/culling/distance_oracle.h"
#include "tests/culling/random_bodies.h"
#include "tests/culling/truth.h"
#include "tests/nightly.h"

namespace throng::proximity_test {
namespace {

using Eigen::Vector3d;
using test::RandomBodies;

constexpr float kMargin_m = 0.25f;

constexpr float kClosestMargin_m = 1.5f * kMargin_m;

/// How distances are computed.
struct Method {
  const char* name;
  bool exact, bodies;
};
const Method kMethods[] = {
    {"ByTriangles", true, true}, {"ByHulls", false, true}, {"ByVolumes", false, false}};

/// Every other world is far from the origin.
RandomBodies world_of(uint64_t seed) {
  return RandomBodies(seed, 20, 1.6, Vector3d::Constant(seed % 2 == 0 ? 40'000 : 0));
}

/// Distance of every pair of parts that may be within the margin; 0 if they touch.
std::map<PairKey, double> true_distances(const RandomBodies& world, double within_m) {
  struct PlacedPart {
    std::vector<Triangle> triangles;
    Vector3d middle = Vector3d::Zero();
    double radius = 0;
  };
  std::vector<std::vector<PlacedPart>> parts(world.ids.size());
  for (size_t body = 0; body < parts.size(); ++body) {
    const BodyType& type = *world.types[world.type_of[body]];
    for (size_t part = 0; part < static_cast<size_t>(type.part_count()); ++part) {
      PlacedPart placed;
      placed.triangles = test::placed_triangles(type.parts()[part], world.pose(body, part),
                                                world.scales[body], world.roots[body].position_m);
      const auto each = [&](const auto& visit) {
        for (const Triangle& t : placed.triangles)
          for (const Vector3d& corner : t.corner) visit(corner);
      };
      each([&](const Vector3d& corner) { placed.middle += corner; });
      placed.middle /= 3.0 * static_cast<double>(placed.triangles.size());
      each([&](const Vector3d& corner) {
        placed.radius = std::max(placed.radius, (corner - placed.middle).norm());
      });
      parts[body].push_back(std::move(placed));
    }
  }
  std::map<PairKey, double> out;
  for (const PairKey& key : test::touching_by_brute_force(world)) out[key] = 0;
  for (size_t a = 0; a < parts.size(); ++a)
    for (size_t b = a + 1; b < parts.size(); ++b) {
      if (world.types[world.type_of[a]]->is_static() && world.types[world.type_of[b]]->is_static())
        continue;
      for (size_t pa = 0; pa < parts[a].size(); ++pa)
        for (size_t pb = 0; pb < parts[b].size(); ++pb) {
          const PlacedPart &p = parts[a][pa], &q = parts[b][pb];
          if ((p.middle - q.middle).norm() - p.radius - q.radius > within_m) continue;
          const PairKey key(world.ids[a], world.ids[b], static_cast<uint32_t>(pa),
                            static_cast<uint32_t>(pb));
          if (out.count(key) == 0)
            out[key] = test::surface_distance_by_brute_force(p.triangles, q.triangles);
        }
    }
  return out;
}

CullerOptions with_margins(bool exact, bool bodies = true) {
  CullerOptions options;
  options.exact = exact;
  options.proximity.margin_m = kMargin_m;
  options.proximity.closest_margin_m = bodies ? kClosestMargin_m : 0;
  options.proximity.step_s = 0.1;
  return options;
}

/// Computed once per world, because it takes seconds.
const std::map<PairKey, double>& truth_of(uint64_t seed) {
  static std::map<uint64_t, std::map<PairKey, double>> known;
  const auto found = known.find(seed);
  if (found != known.end()) return found->second;
  return known[seed] = true_distances(world_of(seed), static_cast<double>(kClosestMargin_m) + 0.01);
}

class ProximityBounds : public ::testing::TestWithParam<Method> {};

TEST_P(ProximityBounds, MissNoPairAndContainTheDistance) {
  const bool exact = GetParam().exact;
  const CullerOptions options = with_margins(exact, GetParam().bodies);
  uint64_t near = 0, listed = 0, touching = 0, of_two = 0;
  for (uint64_t seed = 1; seed <= test::part_of(8u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const RandomBodies world = world_of(seed);
    Workers workers(1);
    Culler culler(world.types, options, workers);
    culler.step(world.view(), world);
    const std::map<PairKey, double>& truth = truth_of(seed);
    const double rounding_m = seed % 2 == 0 ? 2e-5 : 1e-6;

    std::map<PairKey, ProximityPair> rows;
    PairKey last;
    for (const ProximityPair& row : culler.proximity_pairs()) {
      ASSERT_TRUE(rows.empty() || last < row.pair) << "sorted, without duplicates";
      last = row.pair;
      rows[row.pair] = row;
      ASSERT_EQ(row.level, exact ? PairLevel::kTriangles : PairLevel::kPartVolume);
      ASSERT_LE(row.lo_m, kMargin_m);
      const auto found = truth.find(row.pair);
      if (found == truth.end()) {
        ASSERT_FALSE(exact);
        continue;
      }
      ASSERT_LE(static_cast<double>(row.lo_m), found->second + rounding_m);
      ASSERT_GE(static_cast<double>(row.hi_m), found->second - rounding_m);
      if (!exact) continue;
      ASSERT_LE(row.hi_m - row.lo_m, 1e-3f);
      ASSERT_EQ(row.hi_m == 0, found->second == 0);
      ASSERT_EQ(row.depth_m > 0, found->second == 0) << "hulls of convex parts";
      if (row.hi_m == 0) continue;
      const Vector3d a(row.point_a_m.data()), b(row.point_b_m.data());
      ASSERT_NEAR((b - a).norm(), static_cast<double>(row.hi_m), 1e-6 + rounding_m);
    }
    for (const auto& [key, distance] : truth) {
      if (distance > static_cast<double>(kMargin_m)) continue;
      ++near;
      ASSERT_TRUE(rows.count(key) == 1) << "missed at " << distance << " m";
    }
    for (const PairKey& key : culler.pairs()) ASSERT_TRUE(rows.count(key) == 1);
    touching += culler.pairs().size();
    listed += rows.size();

    // Closest parts of each pair of bodies.
    std::map<std::pair<uint32_t, uint32_t>, double> nearest;
    const auto is_static = [&](uint32_t id) {
      return world.types[world.type_of[(id - 1) / 3]]->is_static();
    };
    for (const auto& [key, distance] : truth) {
      if (is_static(key.a()) || is_static(key.b())) continue;
      double& min_distance = nearest.try_emplace({key.a(), key.b()}, distance).first->second;
      min_distance = std::min(min_distance, distance);
    }
    std::map<std::pair<uint32_t, uint32_t>, ProximityPair> of_bodies;
    for (const ProximityPair& row : culler.closest_parts()) {
      ASSERT_FALSE(is_static(row.pair.a()) || is_static(row.pair.b()));
      ASSERT_TRUE(of_bodies.insert({{row.pair.a(), row.pair.b()}, row}).second) << "one each";
    }
    for (const auto& [bodies, distance] : nearest) {
      if (distance > static_cast<double>(options.proximity.closest_margin_m) || !GetParam().bodies)
        continue;
      ++of_two;
      ASSERT_EQ(of_bodies.count(bodies), 1u) << "missed at " << distance << " m";
      const ProximityPair& row = of_bodies[bodies];
      ASSERT_LE(static_cast<double>(row.lo_m), distance + rounding_m);
      ASSERT_GE(static_cast<double>(row.hi_m), distance - rounding_m);
      if (!exact) continue;
      ASSERT_LE(row.hi_m - row.lo_m, 1e-3f);
      ASSERT_NEAR(truth.at(row.pair), distance, rounding_m) << "closest parts";
    }
  }
  EXPECT_GT(near, test::part_of(4000u));
  EXPECT_GT(touching, test::part_of(200u));
  EXPECT_EQ(of_two > test::part_of(200u), GetParam().bodies);
  std::printf("%llu pairs within %.2f m, %llu listed\n", static_cast<unsigned long long>(near),
              static_cast<double>(kMargin_m), static_cast<unsigned long long>(listed));
}

INSTANTIATE_TEST_SUITE_P(Distances, ProximityBounds, ::testing::ValuesIn(kMethods),
                         [](const auto& by) { return std::string(by.param.name); });

uint64_t hash_by(const CullerOptions& options, int threads, uint64_t seed,
                 uint64_t* events = nullptr) {
  Workers workers(threads);
  const RandomBodies first(seed, 60, 3, Vector3d::Zero());
  Culler culler(first.types, options, workers);
  for (uint64_t frame = 0; frame < 4; ++frame) {
    const RandomBodies world(seed + frame, 60, 3, Vector3d::Zero());
    culler.step(world.view(), world);
  }
  if (events != nullptr) *events = culler.hash();
  return culler.proximity_hash();
}

TEST(ProximityRows, AreTheSameForThreadsTargetsAndSearches) {
  for (const Method& by : kMethods) {
    CullerOptions options = with_margins(by.exact, by.bodies);
    options.simd = SimdTarget::kScalar;
    options.pair_search = PairSearch::kBrute;
    const uint64_t expected = hash_by(options, 1, 7);
    EXPECT_NE(expected, 0u);
    for (const SimdTarget target : simd_targets_of_this_machine())
      for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep}) {
        options.simd = target;
        options.pair_search = search;
        EXPECT_EQ(hash_by(options, 3, 7), expected) << by.name << ' ' << name_of(target);
      }
  }
}

TEST(ProximityRows, ChangeNoEvents) {
  for (const Method& by : kMethods) {
    CullerOptions with = with_margins(by.exact, by.bodies), without = with;
    without.proximity = {};
    uint64_t events_with = 0, events_without = 0;
    hash_by(with, 2, 3, &events_with);
    EXPECT_EQ(hash_by(without, 2, 3, &events_without), 0u);
    EXPECT_EQ(events_with, events_without);
  }
}

/// If part volumes also bound distances, one test serves both: events must be the same.
TEST(ProximityRows, ChangeNoEventsForAnyVolumeAndMargin) {
  const auto events_of = [](const CullerOptions& options, uint64_t seed) {
    uint64_t events = 0;
    hash_by(options, 2, 100 * seed, &events);
    return events;
  };
  // The sixth world has every volume.
  for (uint64_t seed = test::is_nightly() ? 1 : 4; seed <= (test::is_nightly() ? 12u : 6u);
       ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    for (const VolumeKind volume : kAllVolumes) {
      CullerOptions without;
      without.part_volume = volume;
      without.by_part = seed % 4 == 0;
      if (volume != VolumeKind::kOrdop26 && seed % 6 != 0) continue;
      const uint64_t expected = events_of(without, seed);
      for (const float margin_m : {1e-9f, 1e-4f, 0.02f, 0.5f}) {
        CullerOptions with = without;
        with.proximity.margin_m = margin_m;
        for (const SimdTarget target : simd_targets_of_this_machine()) {
          with.simd = target;
          ASSERT_EQ(events_of(with, seed), expected)
              << name_of(volume) << ' ' << margin_m << ' ' << name_of(target);
        }
      }
    }
  }
}

/// Undecided pairs keep the bounds of their volumes, and none is missing.
TEST(ProximityRows, AreCompleteAndRepeatableWithABudget) {
  CullerOptions options = with_margins(true);
  const RandomBodies world(5, 60, 3, Vector3d::Zero());
  Workers one(1), three(3);
  Culler whole(world.types, options, one);
  whole.step(world.view(), world);
  for (const uint64_t tests : {0, 100, 1000}) {
    options.budget_tests = tests;
    Culler cut(world.types, options, one), again(world.types, options, three);
    cut.step(world.view(), world);
    again.step(world.view(), world);
    EXPECT_EQ(cut.proximity_hash(), again.proximity_hash()) << tests;
    EXPECT_LE(cut.counters().proximity.tests, tests);
    std::map<PairKey, ProximityPair> rows;
    uint64_t undecided = 0;
    for (const ProximityPair& row : cut.proximity_pairs()) {
      rows[row.pair] = row;
      undecided += row.level == PairLevel::kPartVolume;
    }
    EXPECT_GT(undecided, 0u);
    for (const ProximityPair& row : whole.proximity_pairs()) {
      ASSERT_EQ(rows.count(row.pair), 1u);
      EXPECT_LE(rows[row.pair].lo_m, row.hi_m);
      EXPECT_GE(rows[row.pair].hi_m, row.lo_m);
    }
  }
}

/// Two balls on a line.
struct Line : PoseSource {
  Line() {
    types = {
        std::make_shared<BodyType>(std::vector<PartShape>{test::blob(
                                       Eigen::Vector3f::Zero(), Eigen::Vector3f::Constant(0.1f))},
                                   RootSphere{{0, 0, 0}, 0.11f}, false)};
  }
  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i) out[i] = to_part_pose(Eigen::Isometry3d::Identity());
  }
  void place(double gap_m) {
    roots = {RootPose{{0, 0, 0}, Eigen::Quaternionf::Identity()},
             RootPose{{0, 0, 0.2 + gap_m}, Eigen::Quaternionf::Identity()}};
  }
  BodiesView view() const { return {ids, type_of, scales, roots}; }

  std::vector<std::shared_ptr<const BodyType>> types;
  std::vector<uint32_t> ids = {4, 9};
  std::vector<uint16_t> type_of = {0, 0};
  std::vector<float> scales = {1, 1};
  std::vector<RootPose> roots;
};

TEST(ProximityRows, GiveClosingSpeedAndTimeToContact) {
  Line line;
  Workers workers(1);
  Culler culler(line.types, with_margins(true), workers);
  line.place(0.2);
  culler.step(line.view(), line);
  ASSERT_EQ(culler.proximity_pairs().size(), 1u);
  EXPECT_TRUE(std::isnan(culler.proximity_pairs()[0].closing_speed_mps)) << "no previous poses";
  line.place(0.15);
  culler.step(line.view(), line);
  const ProximityPair closer = culler.proximity_pairs()[0];
  EXPECT_EQ(closer.pair, PairKey(4, 9, 0, 0));
  EXPECT_NEAR(closer.hi_m, 0.15f, 1e-6f);
  EXPECT_NEAR(closer.closing_speed_mps, 0.5f, 1e-5f);
  EXPECT_NEAR(closer.time_to_contact_s(), 0.3f, 1e-4f);
  EXPECT_NEAR(closer.normal[2], 1, 1e-6f);
  line.place(0.16);
  culler.step(line.view(), line);
  EXPECT_NEAR(culler.proximity_pairs()[0].closing_speed_mps, -0.1f, 1e-5f);
  EXPECT_TRUE(std::isinf(culler.proximity_pairs()[0].time_to_contact_s()));
  line.place(-0.05);
  culler.step(line.view(), line);
  const ProximityPair touching = culler.proximity_pairs()[0];
  EXPECT_EQ(touching.hi_m, 0);
  EXPECT_EQ(touching.time_to_contact_s(), 0);
  EXPECT_GT(touching.depth_m, 0.045f);  // of polyhedra: through a face
  EXPECT_LE(touching.depth_m, 0.0501f);
  EXPECT_GT(touching.normal[2], 0.9f);
  EXPECT_NEAR(touching.point_a_m[2], 0.075, 0.02);
}

TEST(ProximityRows, ContinueFromACheckpoint) {
  Line line;
  Workers workers(1);
  Culler whole(line.types, with_margins(true), workers),
      rest(line.types, with_margins(true), workers);
  line.place(0.2);
  whole.step(line.view(), line);
  Archive saved;
  whole.archive(saved);
  Archive read(saved.bytes(), "test");
  rest.archive(read);
  read.expect_end();
  line.place(0.15);
  whole.step(line.view(), line);
  rest.step(line.view(), line);
  EXPECT_EQ(rest.proximity_hash(), whole.proximity_hash());
  EXPECT_EQ(rest.proximity_pairs()[0].closing_speed_mps,
            whole.proximity_pairs()[0].closing_speed_mps);
}

TEST(ProximityOptions, RejectStrategiesAndInvalidMargins) {
  Line line;
  Workers workers(1);
  CullerOptions options = with_margins(false);
  EXPECT_THROW(PaperCuller(line.types, Strategy::kTwoPass, options), InputError);
  for (const float margin : {-1.0f, NAN, INFINITY, 1000.0f}) {
    options = {};
    options.proximity.margin_m = margin;
    EXPECT_THROW(Culler(line.types, options, workers), InputError) << margin;
  }
}

}  // namespace
}  // namespace throng::proximity_test
