// Replaying logs: streamed, torn, damaged, with several runs, with fewer states than frames.
#include "lcm_io/replay/log_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/errors.h"
#include "culled_again.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_reader.h"
#include "lcm_io/replay/log_survey.h"
#include "nearly_touching.h"

namespace throng::log_motion_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

TEST(LogMotion, IsIndependentOfThreadsAndSimdTarget) {
  const ScratchFile log;
  logged(small_scene("plaza", 4, 150), 60, log.path());
  const LogRun run = read_log_run(log.path());
  std::map<uint64_t, int> hashes;
  for (const int threads : {1, 2, 5})
    for (const SimdTarget simd : {SimdTarget::kScalar, SimdTarget::kBest}) {
      SimulationOptions options = options_of(run, threads);
      options.culler.simd = simd;
      Simulation simulation(run.scene, options);
      for (int i = 0; i < 60; ++i) simulation.step();
      ++hashes[simulation.finish().hash];
    }
  EXPECT_EQ(hashes.size(), 1u);
}

TEST(LogMotion, ResumesFromACheckpoint) {
  for (const char* name : {"rush_hour", "paper_50"}) {
    const ScratchFile log;
    logged(small_scene(name, 5), 80, log.path());
    const LogRun run = read_log_run(log.path());
    Simulation whole(run.scene, options_of(run));
    std::vector<uint64_t> expected;
    std::vector<std::vector<uint8_t>> saved;
    for (int i = 0; i < 80; ++i) {
      expected.push_back(whole.step().hash);
      saved.push_back(whole.saved());
    }
    for (const size_t stop : {0u, 7u, 78u}) {
      Simulation rest(run.scene, options_of(run, 2));
      rest.resume(saved[stop], "test");
      EXPECT_EQ(rest.saved(), saved[stop]);
      for (size_t i = stop + 1; i < 80; ++i)
        ASSERT_EQ(rest.step().hash, expected[i]) << name << ", stopped after frame " << stop;
    }
  }
}

TEST(LogMotion, HasARunIdThatDependsOnItsPoses) {
  const ScratchFile one, same, other;
  logged(small_scene("plaza", 1, 20), 10, one.path());
  logged(small_scene("plaza", 1, 20), 10, same.path());
  logged(small_scene("plaza", 1, 20), 11, other.path());
  const auto id = [](const ScratchFile& log, VolumeKind volume) {
    LogRun run = read_log_run(log.path());
    run.scene.part_volume = volume;
    return Simulation(run.scene, options_of(run)).info().run_id;
  };
  EXPECT_EQ(id(one, VolumeKind::kObb), id(same, VolumeKind::kObb));
  EXPECT_NE(id(one, VolumeKind::kObb), id(one, VolumeKind::kOrdop26));
  EXPECT_NE(id(one, VolumeKind::kObb), id(other, VolumeKind::kObb));
}

/// Pairs of `run` at the frames with states, by the rule of the encoder.
std::vector<size_t> frames_with_states(int frames, double every) {
  std::vector<size_t> out;
  int64_t last = -1;
  for (int f = 0; f < frames; ++f)
    if (const auto k = static_cast<int64_t>(std::floor(f / every + 1e-6)); k > last) {
      out.push_back(static_cast<size_t>(f));
      last = k;
    }
  return out;
}

TEST(LogMotion, CullsALogWithFewStatesAtThose) {
  for (const double every : {6.0, 2.4, 1.2}) {
    SCOPED_TRACE(testing::Message() << "every " << every);
    const ScratchFile log;
    const Scene scene = small_scene("plaza", 6);
    LogOptions options;
    options.state_every = every;
    const std::vector<CulledFrame> run = logged(scene, 97, log.path(), options);
    const std::vector<size_t> frames = frames_with_states(97, every);
    const LogRun source = read_log_run(log.path());
    EXPECT_NEAR(source.scene.step_s, every * scene.step_s, 0.03 * every * scene.step_s);
    EXPECT_EQ(source.facts.anomalies.size(), 0u);
    const Simulation shape(scene, {});
    EXPECT_THAT(Simulation(source.scene, options_of(source)).notes(),
                Contains(HasSubstr("frames apart: culled at these")));
    const std::vector<CulledFrame> again = culled_again(log.path());
    ASSERT_EQ(again.size(), frames.size());
    const Placed placed(shape);
    for (size_t i = 0; i < frames.size(); ++i) expect_near(placed, run[frames[i]], again[i]);
  }
}

TEST(LogMotion, CullsTheSoundPartOfATornLog) {
  const ScratchFile log, torn;
  logged(small_scene("plaza", 7, 40), 40, log.path());
  const std::vector<CulledFrame> whole = culled_again(log.path());
  const std::vector<uint8_t> bytes = bytes_of(log.path());
  int shorter = 0;
  for (size_t cut = 1; cut < 20; ++cut) {
    write_bytes(torn.path(), std::span(bytes).first(bytes.size() * cut / 20 + cut));
    std::vector<CulledFrame> found;
    try {
      found = culled_again(torn.path());
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("expected a log with"));
      continue;
    }
    ASSERT_LE(found.size(), whole.size());
    shorter += found.size() < whole.size();
    for (size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i].hash, whole[i].hash) << i;
    EXPECT_THAT(survey_log(torn.path()).notes, Contains(HasSubstr("ends inside a message")));
  }
  EXPECT_GT(shorter, 3);
}

std::pair<size_t, size_t> message_at(const std::filesystem::path& log, Channel channel, int n) {
  LogReader reader(log);
  LogEvent event;
  while (reader.next(event) == LogReader::Status::kEvent)
    if (event.channel == name_of(channel) && n-- == 0) return {event.offset, event.bytes};
  return {0, 0};
}

TEST(LogMotion, SkipsStatesWithWrongChecksums) {
  const ScratchFile log, hurt;
  logged(small_scene("plaza", 8, 40), 40, log.path());
  const std::vector<CulledFrame> whole = culled_again(log.path());
  std::vector<uint8_t> bytes = bytes_of(log.path());
  for (const int frame : {11, 12, 30}) {
    const auto [offset, size] = message_at(log.path(), Channel::kStates, frame);
    bytes[offset + size - 40] ^= 0x04;  // a joint of an avatar
  }
  write_bytes(hurt.path(), bytes);
  const LogRun run = read_log_run(hurt.path());
  ASSERT_EQ(run.facts.anomalies.size(), 1u);
  EXPECT_EQ(run.facts.anomalies[0].count, 3);
  EXPECT_EQ(run.facts.anomalies[0].first, "after frame 10");
  const std::vector<CulledFrame> found = culled_again(hurt.path());
  ASSERT_EQ(found.size(), whole.size());
  for (size_t i = 0; i < found.size(); ++i) {
    const size_t shown = i == 11 || i == 12 ? 10 : i == 30 ? 29 : i;
    EXPECT_EQ(found[i].pairs, whole[shown].pairs) << "frame " << i;
  }
  const auto [offset, size] = message_at(log.path(), Channel::kRun, 0);
  bytes[offset + size / 2] ^= 1;
  write_bytes(hurt.path(), bytes);
  EXPECT_THROW(read_log_run(hurt.path()), InputError) << "a damaged description";
}

TEST(LogMotion, ContinuesAfterInvalidBytes) {
  const ScratchFile log, hurt;
  logged(small_scene("plaza", 9, 40), 40, log.path());
  const std::vector<CulledFrame> whole = culled_again(log.path());
  std::vector<uint8_t> bytes = bytes_of(log.path());
  const size_t from = message_at(log.path(), Channel::kStates, 20).first;
  std::fill_n(bytes.begin() + static_cast<ptrdiff_t>(from), 100, uint8_t{0});
  write_bytes(hurt.path(), bytes);
  const std::vector<CulledFrame> found = culled_again(hurt.path());
  ASSERT_EQ(found.size(), whole.size());
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(found[i].pairs, whole[i == 20 ? 19 : i].pairs) << "frame " << i;
}

TEST(LogMotion, EndsAtALongGap) {
  const ScratchFile log, hurt;
  LogOptions options;
  options.state_every = 60;
  logged(small_scene("paper_50", 9, 5), 60 * 30, log.path(), options);
  EXPECT_EQ(read_log_run(log.path()).facts.frames, 30);
  std::vector<uint8_t> bytes = bytes_of(log.path());
  for (int second = 8; second < 20; ++second) {
    const auto [offset, size] = message_at(log.path(), Channel::kStates, second);
    bytes[offset + size - 40] ^= 0x04;
  }
  write_bytes(hurt.path(), bytes);
  const LogSurvey survey = survey_log(hurt.path());
  EXPECT_EQ(survey.steps, 8);
  EXPECT_THAT(survey.notes, Contains(HasSubstr("no states for 13 s after frame 420")));
}

TEST(LogMotion, CullsTheFirstOfSeveralRuns) {
  const ScratchFile first, second, both;
  logged(small_scene("plaza", 1, 20), 20, first.path());
  logged(small_scene("plaza", 2, 20), 50, second.path());
  const uint64_t hash = culled_again(first.path()).back().hash;
  for (const ScratchFile* other : {&second, &first}) {
    std::vector<uint8_t> bytes = bytes_of(first.path());
    const std::vector<uint8_t> more = bytes_of(other->path());
    bytes.insert(bytes.end(), more.begin(), more.end());
    write_bytes(both.path(), bytes);
    const std::vector<CulledFrame> found = culled_again(both.path());
    EXPECT_EQ(found.size(), 20u);
    EXPECT_EQ(found.back().hash, hash);
    EXPECT_THAT(survey_log(both.path()).notes, Contains(HasSubstr("several runs")));
  }
}

TEST(LogMotion, StartsAResumedRunAtItsFirstFrame) {
  const ScratchFile log;
  const Scene scene = small_scene("plaza", 3);
  Simulation before(scene, {});
  for (int i = 0; i < 30; ++i) before.step();
  Simulation rest(scene, {});
  rest.resume(before.saved(), "test");
  std::vector<CulledFrame> run;
  {
    LogSink sink(log.path());
    sink.begin(rest.info());
    for (int i = 30; i < 60; ++i) {
      const Frame& frame = rest.step();
      sink.frame(rest.info(), frame);
      run.push_back(culled_frame_of(frame));
    }
    sink.end(rest.info(), rest.finish());
  }
  const std::vector<CulledFrame> again = culled_again(log.path());
  ASSERT_EQ(again.size(), run.size());
  const Simulation shape(scene, {});
  const Placed placed(shape);
  for (size_t i = 0; i < run.size(); ++i) expect_near(placed, run[i], again[i]);
  EXPECT_THAT(survey_log(log.path()).notes,
              Contains(HasSubstr("first states are those of frame 30")));
}

TEST(LogMotion, GivesEqualPairsForALogOfALog) {
  const ScratchFile log, twice;
  const Scene scene = small_scene("station_platform", 4);
  const std::vector<CulledFrame> run = logged(scene, 60, log.path());
  const LogRun first = read_log_run(log.path());
  {
    Simulation simulation(first.scene, options_of(first));
    LogSink sink(twice.path());
    sink.begin(simulation.info());
    for (int i = 0; i < 60; ++i) sink.frame(simulation.info(), simulation.step());
    sink.end(simulation.info(), simulation.finish());
  }
  EXPECT_TRUE(check_log(twice.path()).is_sound());
  const std::vector<CulledFrame> once = culled_again(log.path()),
                                 again = culled_again(twice.path());
  const Simulation shape(scene, {});
  const Placed placed(shape);
  for (size_t i = 0; i < run.size(); ++i) {
    expect_near(placed, once[i], again[i]);
    EXPECT_EQ(absent(again[i]), absent(run[i]));
  }
}

TEST(LogMotion, BoundsEveryPostureBySpheres) {
  // A synthetic crowd bends its joints in any way.
  for (const uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const ScratchFile log;
    SyntheticRun made_up({.avatars = 30, .seed = seed});
    {
      LogSink sink(log.path());
      made_up.play(sink, 20);
    }
    const LogRun run = read_log_run(log.path());
    Simulation simulation(run.scene, options_of(run));
    const RunInfo& info = simulation.info();
    const LogSurvey survey = survey_log(log.path());
    for (int f = 0; f < 20; ++f) {
      const Frame& frame = simulation.step();
      for (size_t id = 0; id < frame.roots.size(); ++id) {
        const Model& model = *info.models[info.model_of_avatar[id]];
        const RootSphere sphere = sphere_around(model, survey.spans[info.model_of_avatar[id]]);
        std::vector<PartPose> poses(model.parts.size());
        const RootFrame root;
        forward_kinematics(
            model.kinematics,
            frame.postures.subspan(frame.posture_offsets[id],
                                   frame.posture_offsets[id + 1] - frame.posture_offsets[id]),
            {&root, 1}, poses);
        for (size_t part = 0; part < poses.size(); ++part)
          for (const Eigen::Vector3f& vertex : model.parts[part].mesh.vertices) {
            const Eigen::Vector3d p = to_isometry(poses[part]) * vertex.cast<double>();
            ASSERT_LE((p - sphere.centre_m.cast<double>()).norm(),
                      static_cast<double>(sphere.radius_m));
            ASSERT_LE(p.head<2>().norm(), static_cast<double>(sphere.upright_radius_m));
          }
      }
    }
  }
}

}  // namespace
}  // namespace throng::log_motion_test
