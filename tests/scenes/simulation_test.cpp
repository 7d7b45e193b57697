// Simulation and Runner: independence of threads, complete reports to all sinks.
#include "scenes/run/simulation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/checksum.h"
#include "scenes/run/runner.h"
#include "tests/crowd/crowd_world.h"
#include "tests/scenes/scene_file.h"

namespace throng::simulation_test {
namespace {

Scene small_plaza(int people, double duration_s) {
  Scene scene = load_scene("plaza");
  std::vector<std::string> notes;
  scale_to(scene, people, notes);
  scene.duration_s = duration_s;
  return scene;
}

/// Hash of a frame's contents.
uint64_t hash_of(const Frame& frame) {
  Hasher hash;
  hash.add(static_cast<uint64_t>(frame.number)).add(static_cast<uint64_t>(frame.utime_us));
  for (const RootPose& root : frame.roots) {
    for (int axis = 0; axis < 3; ++axis) hash.add(root.position_m[axis]);
    for (int i = 0; i < 4; ++i) hash.add(static_cast<double>(root.world_from_root.coeffs()[i]));
  }
  for (const float value : frame.postures) hash.add(static_cast<double>(value));
  for (const PairKey& pair : frame.pairs) hash.add(pair.bits());
  for (const PairEvent& event : frame.events)
    hash.add(event.pair.bits()).add(static_cast<uint64_t>(event.kind));
  return hash.value();
}

TEST(Simulation, IsIndependentOfTheThreadCount) {
  std::vector<uint64_t> expected;
  uint64_t expected_id = 0;
  for (const int threads : {1, 2, 3, 8}) {
    SimulationOptions options;
    options.threads = threads;
    Simulation simulation(small_plaza(700, 5), options);
    std::vector<uint64_t> found;
    for (int i = 0; i < 300; ++i) found.push_back(hash_of(simulation.step()));
    found.push_back(simulation.finish().hash);
    if (threads == 1) {
      expected = found;
      expected_id = simulation.info().run_id;
    }
    for (size_t i = 0; i < found.size(); ++i)
      ASSERT_EQ(found[i], expected[i]) << threads << " threads, frame " << i << ", seed 1";
    EXPECT_EQ(simulation.info().run_id, expected_id);
  }
}

TEST(Simulation, EventsDoNotDependOnPostures) {
  uint64_t hashes[2];
  for (const bool postures : {false, true}) {
    SimulationOptions options;
    options.postures = postures;
    Simulation simulation(small_plaza(500, 2), options);
    for (int i = 0; i < 120; ++i) EXPECT_EQ(simulation.step().postures.empty(), !postures);
    hashes[postures] = simulation.finish().hash;
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Simulation, StartsAtZeroAndAdvancesByStep) {
  Simulation simulation(small_plaza(50, 1), {});
  const std::vector<RootPose> start(simulation.step().roots.begin(), simulation.step().roots.end());
  Simulation again(small_plaza(50, 1), {});
  const Frame& first = again.step();
  EXPECT_EQ(first.number, 0);
  EXPECT_EQ(first.utime_us, 0);
  for (int i = 1; i <= 60; ++i) EXPECT_EQ(again.step().utime_us, std::llround(i * 1e6 / 60));
}

TEST(Simulation, HeadsInTheDirectionOfWalking) {
  Simulation simulation(small_plaza(200, 1), {});
  std::vector<RootPose> before(simulation.step().roots.begin(), simulation.step().roots.end());
  for (int i = 0; i < 3; ++i) {
    const Frame& frame = simulation.step();
    for (size_t id = 0; id < before.size(); ++id) {
      const Eigen::Vector3d way = frame.roots[id].position_m - before[id].position_m;
      const Eigen::Vector3d ahead =
          (frame.roots[id].world_from_root * Eigen::Vector3f::UnitX()).cast<double>();
      EXPECT_NEAR(frame.roots[id].world_from_root.norm(), 1, 1e-6f);
      EXPECT_EQ(way.z(), 0);
      if (way.norm() > 0.01) {
        EXPECT_GT(ahead.dot(way.normalized()), 0.5) << "person " << id;
      }
      before[id] = frame.roots[id];
    }
  }
}

TEST(Simulation, RunIdDependsOnResultOptionsOnly) {
  const auto id_of = [](Scene scene, const SimulationOptions& options) {
    return Simulation(std::move(scene), options).info().run_id;
  };
  const uint64_t id = id_of(small_plaza(20, 1), {});
  SimulationOptions other;
  other.threads = 3;
  other.culler.pair_search = PairSearch::kBrute;
  other.culler.simd = SimdTarget::kScalar;
  other.postures = false;
  EXPECT_EQ(id_of(small_plaza(20, 1), other), id);
  EXPECT_EQ(id_of(small_plaza(20, 30), {}), id) << "a longer run begins with the same frames";
  EXPECT_NE(id_of(small_plaza(21, 1), {}), id);
  Scene seeded = small_plaza(20, 1);
  seeded.seed = 2;
  EXPECT_NE(id_of(seeded, {}), id);
  Scene volume = small_plaza(20, 1);
  volume.part_volume = VolumeKind::kObb;
  EXPECT_NE(id_of(volume, {}), id);
  Scene exact = small_plaza(20, 1);
  exact.exact = true;
  EXPECT_NE(id_of(exact, {}), id);
}

TEST(Simulation, AssignsEveryAvatarANamedGroup) {
  const Simulation plaza(small_plaza(60, 1), {});
  const RunInfo& info = plaza.info();
  ASSERT_EQ(info.group_of_avatar.size(), 60u);
  ASSERT_EQ(info.groups.size(), plaza.scene().groups.size());
  EXPECT_EQ(info.control_channels, std::vector<std::string>(info.groups.size()));
  std::vector<int> members(info.groups.size());
  for (const uint16_t group : info.group_of_avatar) ++members.at(group);
  for (size_t i = 0; i < members.size(); ++i) {
    EXPECT_EQ(info.groups[i], plaza.scene().groups[i].name);
    EXPECT_EQ(members[i], plaza.scene().groups[i].count) << info.groups[i];
  }
}

TEST(Simulation, RunIdIgnoresTheLocationOfTheScene) {
  const std::filesystem::path bundled = load_scene("plaza").file.parent_path();
  const std::filesystem::path copy =
      std::filesystem::temp_directory_path() / fmt::format("throng_copy_{}", ::getpid());
  std::filesystem::copy(bundled, copy, std::filesystem::copy_options::recursive);
  const Simulation here(load_scene("plaza"), {});
  const Simulation there(load_scene((copy / "plaza.yaml").string()), {});
  std::filesystem::remove_all(copy);
  EXPECT_EQ(here.info().run_id, there.info().run_id);
  EXPECT_NE(here.info().instance, there.info().instance);
}

/// Counts calls and checks their order.
class Counting : public Sink {
 public:
  void begin(const RunInfo& run) override {
    EXPECT_EQ(frames, 0);
    avatars = run.avatar_count();
    ++begun;
  }
  void frame(const RunInfo&, const Frame& frame) override {
    EXPECT_EQ(frame.number, frames);
    EXPECT_EQ(frame.roots.size(), static_cast<size_t>(avatars));
    for (const PairEvent& event : frame.events) ++(event.kind == EventKind::kBegin ? begins : ends);
    ++frames;
  }
  void end(const RunInfo&, const RunEnd& end) override {
    ends += end.events.size();
    EXPECT_EQ(end.begins, begins);
    EXPECT_EQ(end.ends, ends);
    ++ended;
  }
  int begun = 0;
  int ended = 0;
  int avatars = 0;
  int64_t frames = 0;
  uint64_t begins = 0;
  uint64_t ends = 0;
};

TEST(Runner, FeedsAllSinksAndSummarises) {
  Simulation simulation(small_plaza(500, 3), {});
  Counting first;
  Counting second;
  Sink* sinks[] = {&first, &second};
  const RunSummary summary = run(simulation, sinks);
  EXPECT_EQ(summary.frames, 180);
  EXPECT_EQ(first.frames, 180);
  EXPECT_EQ(second.frames, 180);
  EXPECT_EQ(first.begun * second.begun * first.ended * second.ended, 1);
  EXPECT_EQ(summary.begins, first.begins);
  EXPECT_EQ(summary.begins, summary.ends) << "every begin has its end";
  EXPECT_GT(summary.begins, 0u) << "no contacts among 500 people on a plaza";
  EXPECT_EQ(summary.avatars + summary.unplaced, 500);
  EXPECT_EQ(summary.parts, 15 * summary.avatars);
  EXPECT_GT(summary.frame_ms.median, 0);
  EXPECT_LE(summary.frame_ms.median, summary.frame_ms.p95);
  EXPECT_LE(summary.frame_ms.p95, summary.frame_ms.max);
  EXPECT_FALSE(summary.stopped_early);
}

TEST(Runner, StopsEarlyAndEndsAllPairs) {
  Simulation simulation(small_plaza(500, 3), {});
  Counting sink;
  Sink* sinks[] = {&sink};
  const RunSummary summary =
      run(simulation, sinks, [](const Frame& frame) { return frame.number < 59; });
  EXPECT_EQ(summary.frames, 60);
  EXPECT_TRUE(summary.stopped_early);
  EXPECT_EQ(summary.begins, summary.ends);
  EXPECT_EQ(sink.ended, 1);
}

TEST(Runner, ComputesQuantilesByRank) {
  std::vector<float> samples;
  for (int i = 100; i >= 1; --i) samples.push_back(static_cast<float>(i));
  const Quantiles found = quantiles_of(samples);
  EXPECT_EQ(found.median, 50);
  EXPECT_EQ(found.p95, 95);
  EXPECT_EQ(found.max, 100);
  EXPECT_EQ(quantiles_of({}).max, 0);
}

/// An obstacle over the whole ground, 0.1 m above people of 2 m.
TEST_F(SceneFile, LetsPeopleWalkUnderALintel) {
  const Scene scene = load(
      kGround +
      "proximity_m: 0.3\n"
      "groups:\n"
      "  - {name: a, count: 30, height_m: 2.0, on_arrival: leave, spawn: {min_m: [1, 1], max_m: "
      "[6, "
      "9]}, goals: [{min_m: [15, 1], max_m: [19, 9]}]}\n"
      "obstacles: [{name: lintel, kind: box, position_m: [10, 5], bottom_m: 2.1, size_m: [20, 10, "
      "0.4]}]\n");
  Simulation simulation(scene, {});
  const auto people = static_cast<uint32_t>(simulation.info().avatar_count());
  ASSERT_EQ(people, 30u);
  size_t near = 0;
  const Frame* frame = nullptr;
  for (int i = 0; i < 60 * 30; ++i) {
    frame = &simulation.step();
    for (const PairKey& pair : frame->pairs)
      ASSERT_LT(pair.b(), people) << "touches the lintel in frame " << i;
    for (const ProximityPair row : frame->proximity_pairs) near += row.pair.b() >= people;
  }
  EXPECT_GT(near, 0u) << "the lintel is looked at";
  EXPECT_EQ(std::count(frame->present.begin(), frame->present.end(), 1), 0) << "all arrived";
}

}  // namespace
}  // namespace throng::simulation_test
