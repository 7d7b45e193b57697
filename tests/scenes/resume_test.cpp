// Checkpoints: a resumed run equals an uninterrupted one, and damaged checkpoints are rejected.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <set>

#include "base/checksum.h"
#include "base/errors.h"
#include "base/random.h"
#include "scenes/run/checkpoint.h"
#include "scenes/run/runner.h"
#include "scenes/run/simulation.h"
#include "tests/nightly.h"

namespace throng::resume_test {
namespace {

/// Bundled scene with few people.
Scene small(const std::string& name) {
  Scene scene = load_scene(name);
  std::vector<std::string> notes;
  scale_to(scene, scene.box ? 40 : 80, notes);
  return scene;
}

/// Hash of a frame's contents, except for times.
uint64_t hash_of(const Frame& frame) {
  Hasher hash;
  hash.add(static_cast<uint64_t>(frame.number)).add(static_cast<uint64_t>(frame.utime_us));
  hash.add(frame.persisting);
  for (const RootPose& root : frame.roots) {
    for (int axis = 0; axis < 3; ++axis) hash.add(root.position_m[axis]);
    for (int i = 0; i < 4; ++i) hash.add(static_cast<double>(root.world_from_root.coeffs()[i]));
  }
  for (const float value : frame.speeds_mps) hash.add(static_cast<double>(value));
  for (const float value : frame.postures) hash.add(static_cast<double>(value));
  for (const PairKey& pair : frame.pairs) hash.add(pair.bits());
  for (const PairEvent& event : frame.events)
    hash.add(event.pair.bits())
        .add(static_cast<uint64_t>(event.kind))
        .add(static_cast<uint64_t>(event.level));
  return hash.value();
}

class ResumeScenes : public testing::TestWithParam<std::string> {};

TEST_P(ResumeScenes, ContinueBitwiseEqual) {
  constexpr int kFrames = 100;  // 17 decisions of steering
  std::vector<uint64_t> expected;
  std::vector<std::vector<uint8_t>> states;
  Simulation whole(small(GetParam()), {});
  for (int i = 0; i < kFrames; ++i) {
    expected.push_back(hash_of(whole.step()));
    states.push_back(whole.saved());
  }
  const RunEnd end = whole.finish();
  // At the first frame, within and between decisions, late.
  for (const int stop : {0, 5, 64, 98}) {
    if (!test::is_nightly() && stop != 5 && stop != 64) continue;
    SCOPED_TRACE(testing::Message() << "stopped after frame " << stop);
    SimulationOptions options;
    options.threads = stop % 2 + 1;
    Simulation rest(small(GetParam()), options);
    rest.resume(states[static_cast<size_t>(stop)], "test");
    EXPECT_EQ(rest.saved(), states[static_cast<size_t>(stop)]);
    ASSERT_EQ(rest.next_frame(), stop + 1);
    for (int i = stop + 1; i < kFrames; ++i)
      ASSERT_EQ(hash_of(rest.step()), expected[static_cast<size_t>(i)]) << "frame " << i;
    const RunEnd rest_end = rest.finish();
    EXPECT_EQ(rest_end.hash, end.hash);
    EXPECT_EQ(rest_end.begins, end.begins);
    EXPECT_EQ(rest_end.ends, end.ends);
  }
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const SceneEntry& entry : bundled_scenes()) names.push_back(entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Bundled, ResumeScenes, testing::ValuesIn(scene_names()),
                         [](const auto& name) { return name.param; });

TEST(Resume, ContinuesBitwiseEqualWithABudget) {
  SimulationOptions options;
  options.culler.budget_tests = 2000;
  Simulation whole(small("plaza"), options);
  for (int i = 0; i < 40; ++i) whole.step();
  const std::vector<uint8_t> state = whole.saved();
  Simulation rest(small("plaza"), options);
  rest.resume(state, "test");
  for (int i = 0; i < 60; ++i) ASSERT_EQ(hash_of(rest.step()), hash_of(whole.step())) << i;
  EXPECT_EQ(rest.finish().hash, whole.finish().hash);
}

// Spheres of the paper report whole bodies; ends of pairs that began before the checkpoint keep
// that level.
TEST(Resume, KeepsTheLevelsOfAStrategy) {
  SimulationOptions options;
  options.strategy = Strategy::kSphere;
  options.culler.pair_search = PairSearch::kBrute;
  Simulation whole(small("plaza"), options);
  std::set<PairKey> before;
  for (int i = 0; i < 40; ++i) {
    const Frame& frame = whole.step();
    before = {frame.pairs.begin(), frame.pairs.end()};
  }
  const std::vector<uint8_t> state = whole.saved();
  Simulation rest(small("plaza"), options);
  rest.resume(state, "test");
  int ends_of_earlier = 0;
  for (int i = 0; i < 200; ++i) {
    const Frame& frame = rest.step();
    for (const PairEvent& event : frame.events) {
      ASSERT_EQ(event.level, PairLevel::kSphere) << "frame " << frame.number;
      if (event.kind == EventKind::kEnd && before.erase(event.pair) > 0) ++ends_of_earlier;
    }
    ASSERT_EQ(hash_of(frame), hash_of(whole.step())) << "frame " << frame.number;
  }
  EXPECT_GT(ends_of_earlier, 0) << "the test shows nothing";
  EXPECT_EQ(rest.finish().hash, whole.finish().hash);
}

class ScratchFile {
 public:
  ScratchFile()
      : path_(std::filesystem::temp_directory_path() /
              fmt::format("throng_{}.checkpoint", ::getpid())) {}
  ~ScratchFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Run of 4 s, stopped after 30 frames.
struct Stopped {
  Stopped() : simulation(scene(), {}) {
    for (int i = 0; i < 30; ++i) simulation.step();
    checkpoint = checkpoint_of(simulation);
  }
  static Scene scene() {
    Scene out = small("corridor");
    out.duration_s = 4;
    return out;
  }
  Simulation simulation;
  Checkpoint checkpoint;
};

TEST(CheckpointFile, RoundTrips) {
  Stopped stopped;
  const ScratchFile file;
  write_checkpoint(file.path(), {1, 2, {3}});  // replaces an existing file
  write_checkpoint(file.path(), stopped.checkpoint);
  Simulation rest(Stopped::scene(), {});
  resume(rest, file.path());
  EXPECT_EQ(rest.next_frame(), 30);
  EXPECT_EQ(run(rest, {}).hash, run(stopped.simulation, {}).hash);
}

TEST(CheckpointFile, RejectsOtherRuns) {
  const Stopped stopped;
  const ScratchFile file;
  write_checkpoint(file.path(), stopped.checkpoint);
  Scene other = Stopped::scene();
  other.seed = 77;
  Simulation rest(std::move(other), {});
  try {
    resume(rest, file.path());
    FAIL() << "took the checkpoint of another seed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("the same scene, seed"));
  }
}

TEST(CheckpointFile, RejectsTruncatedAndChangedFiles) {
  const Stopped stopped;
  const std::vector<uint8_t> whole = format_checkpoint(stopped.checkpoint);
  EXPECT_EQ(parse_checkpoint(whole, "test").state, stopped.checkpoint.state);
  const size_t step = whole.size() / 300;
  for (size_t i = 0; i < whole.size(); i += i < 60 ? 1 : step) {
    EXPECT_THROW(parse_checkpoint(std::span(whole).first(i), "test"), InputError) << "cut at " << i;
    auto changed = whole;
    changed[i] ^= 0x10;
    EXPECT_THROW(parse_checkpoint(changed, "test"), InputError) << "byte " << i << " changed";
  }
}

/// With a valid checksum, resume() rejects or accepts any state without crashing.
TEST(CheckpointFile, RejectsOrResumesAnyState) {
  constexpr uint64_t kSeed = 5;
  const Stopped stopped;
  int rejected = 0;
  for (uint64_t round = 0; round < 9; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", round " << round);
    const RandomKey key{kSeed, round, 0, Purpose::kStyle};
    auto state = stopped.checkpoint.state;
    if (round % 3 == 0) {
      state.resize(random_bits(key, 0) % state.size());
    } else {
      for (uint32_t hit = 0; hit < 1 + round % 4; ++hit)
        state[random_bits(key, 2 * hit + 1) % state.size()] =
            static_cast<uint8_t>(random_bits(key, 2 * hit + 2));
    }
    Simulation rest(Stopped::scene(), {});
    try {
      rest.resume(state, "test");
      for (int i = 0; i < 7; ++i) rest.step();
      rest.finish();
    } catch (const InputError&) {
      ++rejected;
    }
  }
  EXPECT_GE(rejected, 3) << "every cut";
}

TEST(CheckpointFile, KeepsTheOldFileIfWritingFails) {
  const Checkpoint small{1, 2, {3, 4, 5}};
  EXPECT_THROW(write_checkpoint("/proc/no_such_folder/file", small), EnvironmentError);
  const ScratchFile file;
  write_checkpoint(file.path(), small);
  // A file size limit simulates a full disk.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit most{10, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &most), 0);
  EXPECT_THROW(write_checkpoint(file.path(), {9, 9, {}}), EnvironmentError);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_checkpoint(file.path()).state, small.state);
}

}  // namespace
}  // namespace throng::resume_test
