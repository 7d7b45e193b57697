// Runs on grounds of any shape: no contact with an obstacle is missed, and threads, SIMD targets
// and a resumed run change nothing. Oracle: every part against every obstacle, by triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "base/simd.h"
#include "culling/triangles/triangle_bvh.h"
#include "scenes/run/postures.h"
#include "scenes/run/simulation.h"
#include "tests/crowd/random_worlds.h"
#include "tests/nightly.h"

namespace throng::polygon_worlds_test {
namespace {

constexpr int kFrames = 40;

/// Random world with adults, who start as dense as they find places.
std::optional<Scene> scene_of(uint64_t seed) {
  static const std::shared_ptr<const Model> adult = load_model(adult_urdf());
  Scene scene = test::random_world(seed).scene;
  if (scene.groups.empty()) return std::nullopt;
  scene.exact = true;
  for (Group& group : scene.groups) {
    group.model = adult_urdf();
    group.body = adult;
    group.count = 12;
  }
  return scene;
}

/// Every touching pair of a person's part and an obstacle.
class ObstacleOracle {
 public:
  explicit ObstacleOracle(const Simulation& run) : run_(run) {
    for (const Part& part : run.info().models[0]->parts)
      parts_.emplace_back(part.mesh.vertices, part.mesh.triangles);
    for (const Obstacle& obstacle : run.scene().obstacles)
      obstacles_.emplace_back(obstacle.mesh.vertices, obstacle.mesh.triangles);
  }

  void check(const Frame& frame) {
    std::vector<PartPose> poses(parts_.size());
    const BodyStates& bodies = run_.bodies();
    const auto people = static_cast<uint32_t>(frame.roots.size());
    for (uint32_t id = 0; id < people; ++id) {
      if (!frame.present.empty() && frame.present[id] == 0) continue;
      part_poses(run_.info(), frame, id, poses);
      for (uint32_t i = 0; i < obstacles_.size(); ++i) {
        const RootPose& root = bodies.roots[people + i];
        const Eigen::Vector3f shift_m =
            (root.position_m - frame.roots[id].position_m).cast<float>();
        // Obstacles are at most 3 m wide, arms reach 1.2 m.
        if (shift_m.head<2>().norm() > 4.5f) continue;
        const Eigen::Isometry3d turned(root.world_from_root.cast<double>());
        const PartPose placed = to_part_pose(turned);
        for (uint32_t part = 0; part < parts_.size(); ++part) {
          ++tested;
          if (!solids_touch(parts_[part], poses[part], bodies.scales[id], obstacles_[i], placed, 1,
                            shift_m, counters_))
            continue;
          ++touching;
          missed += !std::binary_search(frame.pairs.begin(), frame.pairs.end(),
                                        PairKey(id, people + i, part, 0));
        }
      }
    }
  }

  uint64_t tested = 0, touching = 0, missed = 0;

 private:
  const Simulation& run_;
  std::vector<TriangleBvh> parts_, obstacles_;
  TriangleCounters counters_;
};

uint64_t hash_with(const Scene& scene, int threads, SimdTarget simd) {
  SimulationOptions options;
  options.threads = threads;
  options.culler.simd = simd;
  Simulation run(scene, options);
  for (int i = 0; i < kFrames; ++i) run.step();
  return run.finish().hash;
}

TEST(PolygonWorlds, MissNoContactWithAnObstacleAndGiveOneResult) {
  uint64_t worlds = 0, tested = 0, touching = 0;
  const std::vector<SimdTarget> targets = simd_targets_of_this_machine();
  for (uint64_t seed = 1; seed <= test::part_of(test::is_nightly() ? 2000u : 60u); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::optional<Scene> scene = scene_of(seed);
    if (!scene) continue;
    ++worlds;
    Simulation whole(*scene, {});
    ObstacleOracle oracle(whole);
    std::vector<uint8_t> saved;
    const int stop = static_cast<int>(seed % kFrames);
    for (int i = 0; i < kFrames; ++i) {
      oracle.check(whole.step());
      if (i == stop) saved = whole.saved();
    }
    ASSERT_EQ(oracle.missed, 0u);
    tested += oracle.tested;
    touching += oracle.touching;
    const uint64_t hash = whole.finish().hash;
    ASSERT_EQ(hash_with(*scene, 3, targets[seed % targets.size()]), hash);

    Simulation rest(*scene, {});
    rest.resume(saved, "test");
    for (int i = stop + 1; i < kFrames; ++i) rest.step();
    ASSERT_EQ(rest.finish().hash, hash) << "resumed after frame " << stop;
  }
  std::printf("%llu worlds: %llu pairs of part and obstacle, %llu of them touching\n",
              static_cast<unsigned long long>(worlds), static_cast<unsigned long long>(tested),
              static_cast<unsigned long long>(touching));
  EXPECT_GT(touching, worlds);
}

}  // namespace
}  // namespace throng::polygon_worlds_test
