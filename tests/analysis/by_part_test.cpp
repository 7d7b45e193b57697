// Part volumes per part and counts per pair of parts: mixtures are deterministic, sums equal the
// counters of the run, and counting changes no result.
#include "analysis/by_part.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/errors.h"
#include "base/simd.h"
#include "scenes/scenes.h"

namespace throng::by_part_test {
namespace {

constexpr const char* kMixture = "hands: sphere, torso: ordop18, legs: obb, default: ordop26";

struct Result {
  uint64_t hash = 0;
  CullingCounters sums;
  PartNameTally tally;
};

/// People packed more densely than they would walk, to make parts touch.
Scene pressed(const char* volumes, bool exact) {
  Scene scene = load_scene("robot_in_crowd");
  for (Group& group : scene.groups)
    if (group.control_channel.empty()) group.radius_m = 0.1;
  scene.part_volume = part_volumes_of(volumes, "test");
  scene.exact = exact;
  return scene;
}

Result run(const Scene& scene, int threads, const CullerOptions& culler, int frames = 90) {
  SimulationOptions options{.threads = threads, .culler = culler};
  Simulation simulation(scene, options);
  Result out;
  for (int frame = 0; frame < frames; ++frame) {
    const CullingCounters& counters = *simulation.step().counters;
    out.sums.part_box.tests += counters.part_box.tests;
    out.sums.part_box.passed += counters.part_box.passed;
    out.sums.part_volume.passed += counters.part_volume.passed;
    out.sums.part_volume.tests += counters.part_volume.tests;
    out.sums.triangles.passed += counters.triangles.passed;
  }
  const RunEnd end = simulation.finish();
  out.hash = end.hash;
  EXPECT_EQ(end.by_part != nullptr, culler.by_part);
  if (end.by_part != nullptr) out.tally = by_name(*end.by_part, simulation.info());
  return out;
}

PartPairCounts sum_of(const PartNameTally& tally) {
  PartPairCounts sum;
  for (const PartPairCounts& cell : tally.cells) sum.add(cell);
  return sum;
}

TEST(PartPairCounts, SumToTheCountersOfTheRun) {
  for (const char* volumes : {"ordop26", "kdop18", kMixture})
    for (const bool exact : {false, true}) {
      const Result found = run(pressed(volumes, exact), 2, {.by_part = true});
      const PartPairCounts sum = sum_of(found.tally);
      EXPECT_EQ(sum.box_tests, found.sums.part_box.tests) << volumes;
      EXPECT_EQ(sum.box_passed, found.sums.part_box.passed) << volumes;
      EXPECT_EQ(sum.box_passed, found.sums.part_volume.tests) << volumes;
      EXPECT_EQ(sum.part_passed, found.sums.part_volume.passed) << volumes;
      if (exact) {
        EXPECT_EQ(sum.touching, found.sums.triangles.passed) << volumes;
      }
      EXPECT_GT(sum.touching, 20u) << volumes;
      EXPECT_TRUE(found.tally.counts_touching);
      const size_t count = found.tally.names.size();
      for (size_t a = 0; a < count; ++a)
        for (size_t b = 0; b < a; ++b) EXPECT_EQ(found.tally.at(a, b).box_tests, 0u);
    }
}

TEST(PartPairCounts, AreEqualForAnyThreadsAndChangeNoResult) {
  const Scene scene = pressed("ordop26", false);
  const Result one = run(scene, 1, {.by_part = true}), three = run(scene, 3, {.by_part = true});
  EXPECT_EQ(one.hash, run(scene, 2, {}).hash);
  EXPECT_EQ(one.hash, three.hash);
  ASSERT_EQ(one.tally.names, three.tally.names);
  for (size_t i = 0; i < one.tally.cells.size(); ++i) {
    EXPECT_EQ(one.tally.cells[i].box_passed, three.tally.cells[i].box_passed);
    EXPECT_EQ(one.tally.cells[i].touching, three.tally.cells[i].touching);
  }
  // Touching pairs are decided by triangles even if the run is by volumes.
  const Result exact = run(pressed("ordop26", true), 1, {.by_part = true});
  EXPECT_EQ(sum_of(one.tally).touching, sum_of(exact.tally).touching);
}

TEST(PartPairCounts, AreRejectedWithABudgetOrTwoPasses) {
  const Scene scene = pressed("ordop26", false);
  EXPECT_THROW(Simulation(scene, {.culler = {.budget_tests = 100, .by_part = true}}), InputError);
  EXPECT_THROW(Simulation(scene, {.culler = {.by_part = true}, .strategy = Strategy::kTwoPass}),
               InputError);
  EXPECT_THROW(Simulation(pressed(kMixture, false), {.strategy = Strategy::kTwoPass}), InputError);
}

TEST(PartVolumes, GiveOneHashForAnySearchAndTarget) {
  const Scene scene = pressed(kMixture, false);
  const uint64_t hash = run(scene, 1, {}).hash;
  for (const SimdTarget target : simd_targets_of_this_machine())
    for (const PairSearch search : {PairSearch::kGrid, PairSearch::kSweep, PairSearch::kBrute})
      EXPECT_EQ(run(scene, 3, {.pair_search = search, .simd = target}).hash, hash)
          << name_of(target);
  EXPECT_NE(hash, run(pressed("ordop26", false), 1, {}).hash);
  const CullerOptions budget{.budget_tests = 3000};
  EXPECT_EQ(run(scene, 1, budget).hash, run(scene, 3, budget).hash);
}

TEST(PartVolumes, DoNotAffectResultsOfTriangles) {
  const uint64_t hash = run(pressed("sphere", true), 1, {}).hash;
  for (const char* volumes : {"ordop26", kMixture, "feet: kdop14, default: sphere"})
    EXPECT_EQ(run(pressed(volumes, true), 2, {}).hash, hash) << volumes;
}

TEST(PartVolumes, RoundTripAsTextAndMatchPartsByWords) {
  for (const char* text : {"ordop26", "sphere", kMixture, "leftHand: aabb, default: kdop26"})
    EXPECT_EQ(to_text(part_volumes_of(text, "test")), text);
  EXPECT_EQ(part_volumes_of("hand: sphere", "test").fallback, VolumeKind::kOrdop26);
  const PartVolumes volumes =
      part_volumes_of("left hands: obb, hands: sphere, upperArms: aabb", "t");
  EXPECT_EQ(volumes.of("leftHand"), VolumeKind::kObb);
  EXPECT_EQ(volumes.of("RightHand"), VolumeKind::kSphere);
  EXPECT_EQ(volumes.of("right_hand_2"), VolumeKind::kSphere);
  EXPECT_EQ(volumes.of("upperLeftArm"), VolumeKind::kAabb);
  EXPECT_EQ(volumes.of("lowerLeftArm"), VolumeKind::kOrdop26);
  EXPECT_EQ(volumes.of("handle"), VolumeKind::kOrdop26);
}

TEST(PartVolumes, ReportInvalidText) {
  const auto rejection = [](const char* text) -> std::string {
    try {
      Simulation(pressed(text, false), {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(rejection("hands: sphere, default: ordop27").substr(0, 40),
            "test: expected one of sphere, aabb, obb,");
  EXPECT_EQ(rejection("hands: sphere, hands: obb"),
            "test: expected each part named once, found 'hands' twice");
  EXPECT_EQ(rejection("hands: sphere, obb"),
            "test: expected a volume, or 'hands: sphere, default: ordop26', found 'obb'");
  EXPECT_EQ(rejection(": obb"),
            "test: expected words of the name of a part, as in 'hands: sphere', found ''");
  const std::string unknown = rejection("antennas: sphere");
  EXPECT_EQ(unknown.substr(0, 37), "part_volume: expected words of a part");
  EXPECT_NE(unknown.find("found 'antennas'"), std::string::npos) << unknown;
}

TEST(PartVolumes, AreReadFromAMapInAScene) {
  const std::string name = testing::TempDir() + "throng_part_volumes.yaml";
  const auto scene_with = [&](const std::string& culling) {
    std::ofstream(name) << "ground: {min_m: [-5, -5], max_m: [5, 5]}\nculling:\n" + culling +
                               "groups:\n  - {count: 2, spawn: {min_m: [-4, -4], max_m: [4, 4]}, "
                               "goals: [{min_m: [3, 3], max_m: [4, 4]}]}\n";
    return load_scene(name);
  };
  const Scene map = scene_with("  part_volume: {hands: sphere, default: obb}\n");
  EXPECT_EQ(to_text(map.part_volume), "hands: sphere, default: obb");
  const Scene word = scene_with("  part_volume: obb\n");
  EXPECT_EQ(word.part_volume, VolumeKind::kObb);
  EXPECT_NE(map.content_hash, word.content_hash);
  EXPECT_EQ(scene_with("  part_volume: {default: obb}\n").content_hash, word.content_hash);
  try {
    scene_with("  part_volume:\n    hands: spere\n");
    ADD_FAILURE() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              name +
                  ":4: expected one of sphere, aabb, obb, kdop14, kdop18, kdop26, ordop14, "
                  "ordop18, ordop26, found 'spere' (did you mean 'sphere'?)");
  }
}

}  // namespace
}  // namespace throng::by_part_test
