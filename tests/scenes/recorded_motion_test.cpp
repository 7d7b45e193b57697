// Runs of recordings: recorded positions are kept, bodies walk, other groups keep clear, and
// results are independent of threads, SIMD and checkpoints.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "base/checksum.h"
#include "base/random.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/retargeting/retarget.h"
#include "scenes/retargeting/tracks.h"
#include "scenes/run/simulation.h"
#include "tests/recordings/recording_folder.h"
#include "tests/scenes/slide_meter.h"
#include "tests/scenes/walking_heads.h"

namespace throng::recorded_motion_test {
namespace {

double uniform(uint64_t seed, uint64_t id, uint32_t number, double low, double high) {
  return random_uniform({seed, id, number, Purpose::kSpawnPosition}, low, high);
}

/// Archive text of people who wander, stop, turn, and are absent at various times; heads sway.
std::string wandering(uint64_t seed, int people, int frames, double fps) {
  std::string text = fmt::format("# framerate: {} fps\n# id frame x/m y/m z/m\n", fps);
  for (int person = 0; person < people; ++person) {
    const auto id = static_cast<uint64_t>(person);
    Eigen::Vector2d at(uniform(seed, id, 0, -6, 6), uniform(seed, id, 1, -6, 6));
    double heading = uniform(seed, id, 2, -3, 3), walked = 0;
    const auto first = static_cast<int>(uniform(seed, id, 3, 0, 0.3 * frames));
    for (int frame = first; frame < frames; ++frame) {
      const auto stage = static_cast<uint32_t>(frame / 40);
      const double speed = std::max(0.0, uniform(seed, id, 10 + stage, -0.5, 1.7));
      heading += uniform(seed, id, 1000 + stage, -0.8, 0.8) / fps;
      at += speed / fps * Eigen::Vector2d(std::cos(heading), std::sin(heading));
      walked += speed / fps;
      if (stage % 7 == 3 && person % 5 == 0) continue;  // absent
      const double sway = 0.03 * std::sin(walked * 2 * std::numbers::pi / 1.3);
      const Eigen::Vector2d head =
          at + sway * Eigen::Vector2d(-std::sin(heading), std::cos(heading));
      text += fmt::format("{} {} {:.4f} {:.4f} {:.3f}\n", 100 + 3 * person, 500 + frame, head.x(),
                          head.y(), 1.6 + 0.02 * (person % 10));
    }
  }
  return text;
}

class RecordedMotionTest : public RecordingTest {
 protected:
  Scene scene(const std::string& text, TrackedPoint tracks) const {
    RecordingOptions options;
    options.file = write("walks.txt", text);
    options.tracked_point = tracks;
    Scene scene = recorded_scene(options);
    scene.groups.back().gait_styles = StyleShares{1};  // tabulating a gait takes 0.1 s
    return scene;
  }
};

/// Distance between the tracked point and the record, at every recorded instant.
std::vector<double> errors_m(
    const Scene& scene,
    const std::function<Eigen::Vector2d(const Frame&, const BodyStates&, size_t)>& place) {
  const Recording& recording = *scene.recorded->recording;
  std::vector<std::vector<Sample>> tracks(recording.people().size());
  for (size_t id = 0; id < tracks.size(); ++id) recording.read(id, tracks[id]);
  std::vector<size_t> next(tracks.size(), 0);
  std::vector<double> errors;
  Simulation simulation(scene, {});
  const auto frames = static_cast<int64_t>(scene.duration_s / scene.step_s + 1.5);
  for (int64_t number = 0; number < frames; ++number) {
    const Frame& frame = simulation.step();
    const double now_s = static_cast<double>(number) * scene.step_s;
    for (size_t id = 0; id < tracks.size(); ++id) {
      if (next[id] == tracks[id].size()) continue;
      const Sample& sample = tracks[id][next[id]];
      if (std::abs(sample.time_s - now_s) > 1e-6) continue;
      ++next[id];
      EXPECT_EQ(frame.present[id], 1) << "person " << id << " at " << now_s << " s";
      errors.push_back((place(frame, simulation.bodies(), id) - sample.position_m).norm());
    }
  }
  for (size_t id = 0; id < tracks.size(); ++id)
    EXPECT_EQ(next[id], tracks[id].size()) << "instants of person " << id << " that no frame had";
  return errors;
}

Eigen::Vector2d root_of(const Frame& frame, const BodyStates&, size_t id) {
  return frame.roots[id].position_m.head<2>();
}

/// Fraction of heads within 2 cm of the record.
double share_within_2_cm(const Scene& scene) {
  const std::shared_ptr<const Model> model = load_model(adult_urdf());
  const std::vector<double> errors =
      errors_m(scene, [&](const Frame& frame, const BodyStates& bodies, size_t id) {
        return head_of(*model, frame, bodies, id);
      });
  const auto near = std::count_if(errors.begin(), errors.end(), [](double e) { return e <= 0.02; });
  return static_cast<double>(near) / static_cast<double>(errors.size());
}

TEST_F(RecordedMotionTest, AnnouncesEnteringPeople) {
  constexpr int kComesIn = 91;
  const auto expected_from = static_cast<int>(std::ceil(kComesIn - 60 * kExpected_s));
  for (const bool was_there_before : {false, true}) {
    std::string text = "# framerate: 60 fps\n# id frame x/m y/m z/m\n";
    for (int frame = 0; frame < 130; ++frame)
      for (int person = 0; person < 3; ++person) {
        const bool is_elsewhere = person == 2 && frame < kComesIn;
        if (is_elsewhere && !(was_there_before && frame < 3)) continue;
        const double x_m = 1.3 * frame / 60 + (is_elsewhere ? 20 : 0);
        text += fmt::format("{} {} {:.4f} {:.4f} 1.75\n", person, frame, x_m,
                            person == 2 ? 0.4 : 4.0 * person);
      }
    Simulation simulation(scene(text, TrackedPoint::kCentre), {});
    const std::vector<AvoidancePosture>& avoidance = simulation.bodies().avoidance;
    for (int number = 0; number < kComesIn + 8; ++number) {
      const Frame& frame = simulation.step();
      const bool is_there = number >= kComesIn || (was_there_before && number < 3);
      EXPECT_EQ(frame.present[2], is_there ? 1 : 0) << number;
      EXPECT_TRUE(number >= expected_from || avoidance[0].is_none()) << number;
      EXPECT_TRUE(avoidance[1].is_none()) << "too far away";
      if (number != kComesIn) continue;
      for (const size_t id : {0, 2})
        EXPECT_GT(std::abs(avoidance[id].trunk_rad), 0.3f) << "two who pass at 0.4 m are turned";
    }
  }
}

TEST_F(RecordedMotionTest, MovesRootsThroughRecordedCentres) {
  for (const auto& [seed, fps] : {std::pair{1, 25.0}, {2, 16.0}, {3, 2.5}, {4, 60.0}, {5, 1.0}}) {
    const Scene made =
        scene(wandering(static_cast<uint64_t>(seed), 12, 160, fps), TrackedPoint::kCentre);
    EXPECT_LE(made.step_s, 1.0 / 60 + 1e-12);
    const std::vector<double> errors = errors_m(made, root_of);
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 1e-6) << "seed " << seed;
  }
}

TEST_F(RecordedMotionTest, KeepsHeadsWithinTwoCentimetres) {
  for (const auto& [seed, fps] : {std::pair{1, 25.0}, {2, 16.0}, {3, 50.0}})
    EXPECT_GE(share_within_2_cm(
                  scene(wandering(static_cast<uint64_t>(seed), 20, 400, fps), TrackedPoint::kHead)),
              0.999)
        << "seed " << seed;
}

/// As for the agents of a crowd.
void expect_planted_feet(const Scene& scene, const std::string& name) {
  Simulation simulation(scene, {});
  SlideMeter meter(simulation);
  const auto frames = static_cast<int64_t>(std::min(scene.duration_s, 60.0) / scene.step_s);
  for (int64_t i = 0; i < frames; ++i) meter.watch(simulation.step());
  ASSERT_GT(meter.slides.all_m.size(), 100u) << name;
  fmt::print("{}: {} steps slide {:.1f} mm in the median, {:.1f} mm at 95 %\n", name,
             meter.slides.all_m.size(), 1e3 * meter.slides.quantile_m(0.5),
             1e3 * meter.slides.quantile_m(0.95));
  EXPECT_LT(meter.slides.quantile_m(0.5), 0.002) << name;
}

TEST_F(RecordedMotionTest, KeepsPlantedFeetInPlace) {
  for (const TrackedPoint tracks : {TrackedPoint::kHead, TrackedPoint::kCentre})
    expect_planted_feet(scene(wandering(11, 20, 600, 25), tracks), "wandering");
}

/// Uses real recordings if available.
TEST_F(RecordedMotionTest, FollowsRealRecordings) {
  const char* folder = std::getenv("THRONG_RECORDINGS");
  if (folder == nullptr) GTEST_SKIP() << "THRONG_RECORDINGS names no folder of recordings";
  const auto run = [&](const std::string& name, RecordingOptions options) {
    options.file = std::filesystem::path(folder) / name;
    Scene made = recorded_scene(options);
    expect_planted_feet(made, name);
    if (made.recorded->recording->facts().tracked_point == TrackedPoint::kHead) {
      EXPECT_GE(share_within_2_cm(made), 0.999) << name;
    } else {
      const std::vector<double> errors = errors_m(made, root_of);
      EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 1e-6) << name;
    }
  };
  RecordingOptions at_16_fps_in_cm, at_25_fps;
  at_16_fps_in_cm.fps = 16;
  at_16_fps_in_cm.unit_m = 0.01;
  at_25_fps.fps = 25;
  run("040_c_56_h-.txt", {});
  run("uo-050-180-180.txt", at_16_fps_in_cm);
  run("uo-180-180-120.txt", at_16_fps_in_cm);
  run("n34_cam2.csv", at_25_fps);
  run("jupedsim_bottleneck.sqlite", {});
  run("crowdit.csv.gz", {});
  run("pathfinder.csv", {});
}

/// Hash of a frame's contents, except for times.
uint64_t hash_of(const Frame& frame) {
  Hasher hash;
  hash.add(frame.hash);
  for (const RootPose& root : frame.roots) {
    for (int axis = 0; axis < 3; ++axis) hash.add(root.position_m[axis]);
    for (int i = 0; i < 4; ++i) hash.add(static_cast<double>(root.world_from_root.coeffs()[i]));
  }
  for (const uint8_t there : frame.present) hash.add(uint64_t{there});
  for (const float value : frame.postures) hash.add(static_cast<double>(value));
  return hash.value();
}

/// Recorded people, and ten agents of a group who cross them.
Scene mixed(const Scene& recorded) {
  Scene scene = recorded;
  Group group;
  group.name = "own";
  group.gait_styles = StyleShares{1};
  group.model = adult_urdf();
  group.count = 10;
  group.spawn = {scene.ground.min_m, scene.ground.min_m + Eigen::Vector2d(2.5, 6)};
  group.goals = {Rectangle{scene.ground.max_m - Eigen::Vector2d(2.5, 6), scene.ground.max_m}};
  scene.groups.insert(scene.groups.begin(), group);
  return scene;
}

TEST_F(RecordedMotionTest, IsIndependentOfThreadsAndSimd) {
  for (const bool with_own : {false, true}) {
    Scene made = scene(wandering(7, 70, 60, 25), TrackedPoint::kHead);
    if (with_own) made = mixed(made);
    std::vector<uint64_t> expected;
    for (const int threads : {1, 3})
      for (const SimdTarget simd : {SimdTarget::kScalar, SimdTarget::kBest}) {
        SimulationOptions options;
        options.threads = threads;
        options.culler.simd = simd;
        Simulation simulation(made, options);
        std::vector<uint64_t> found;
        for (int frame = 0; frame < 120; ++frame) found.push_back(hash_of(simulation.step()));
        if (expected.empty()) expected = found;
        EXPECT_EQ(found, expected) << threads << " threads, " << name_of(simd);
      }
  }
}

TEST_F(RecordedMotionTest, ContinuesBitwiseEqual) {
  for (const bool with_own : {false, true}) {
    Scene made = scene(wandering(9, 30, 200, 25), TrackedPoint::kHead);
    if (with_own) made = mixed(made);
    std::vector<uint64_t> expected;
    std::vector<std::vector<uint8_t>> states;
    Simulation whole(made, {});
    for (int frame = 0; frame < 300; ++frame) {
      expected.push_back(hash_of(whole.step()));
      states.push_back(whole.saved());
    }
    for (const size_t stop : {size_t{0}, size_t{77}, size_t{250}}) {
      Simulation rest(made, {});
      rest.resume(states[stop], "state");
      for (size_t frame = stop + 1; frame < 300; ++frame)
        ASSERT_EQ(hash_of(rest.step()), expected[frame])
            << "stopped at " << stop << ", frame " << frame << ", own people: " << with_own;
    }
  }
}

TEST_F(RecordedMotionTest, OmitsPeopleOutsideTheirTracks) {
  const Scene made = scene(wandering(5, 20, 400, 25), TrackedPoint::kHead);
  Simulation simulation(made, {});
  bool was_away = false;
  for (int number = 0; number < 1200; ++number) {
    const Frame& frame = simulation.step();
    for (const PairKey& pair : frame.pairs) {
      EXPECT_EQ(frame.present[pair.a()], 1);
      EXPECT_EQ(frame.present[pair.b()], 1);
    }
    was_away |= number > 600 && std::count(frame.present.begin(), frame.present.end(), 0) > 0;
  }
  EXPECT_TRUE(was_away) << "no person was absent";
}

TEST_F(RecordedMotionTest, ShiftsMapCoordinates) {
  std::string text = "# framerate: 25 fps\n# id frame x/m y/m z/m\n";
  for (int frame = 0; frame < 50; ++frame)
    text += fmt::format("1 {} {:.4f} 5461234.5678 1.7\n", frame, 487'654.25 + 0.04 * frame);
  const Scene made = scene(text, TrackedPoint::kCentre);
  const Eigen::Vector2d shift_m = made.recorded->recording->facts().shift_m;
  EXPECT_EQ(std::remainder(shift_m.x(), 1000), 0);
  EXPECT_EQ(std::remainder(shift_m.y(), 1000), 0);
  Simulation simulation(made, {});
  ASSERT_EQ(simulation.notes().size(), 1u);
  EXPECT_NE(simulation.notes().front().find(fmt::format("{:.0f}", shift_m.y())), std::string::npos)
      << simulation.notes().front();
  const Frame& frame = simulation.step();
  EXPECT_LT(frame.roots[0].position_m.head<2>().norm(), 1500) << "near the origin";
  EXPECT_NEAR(frame.roots[0].position_m.x() + shift_m.x(), 487'654.25, 1e-6);
  EXPECT_NEAR(frame.roots[0].position_m.y() + shift_m.y(), 5'461'234.5678, 1e-6);
}

TEST_F(RecordedMotionTest, LetsOtherGroupsAvoidRecordedPeople) {
  // A row of people who stand for 30 s across the path of ten others.
  std::string text = "# framerate: 25 fps\n# id frame x/m y/m z/m\n";
  for (int person = 0; person < 6; ++person)
    for (int frame = 0; frame < 750; ++frame)
      text += fmt::format("{} {} 0 {:.1f} 1.7\n", person, frame, person - 2.5);
  Scene made = scene(text, TrackedPoint::kHead);
  made.ground = {{-10, -8}, {10, 8}};
  Group group;
  group.name = "own";
  group.gait_styles = StyleShares{1};
  group.model = adult_urdf();
  group.count = 10;
  group.spawn = {{-9, -3}, {-6, 3}};
  group.goals = {Rectangle{{6, -3}, {9, 3}}};
  group.on_arrival = OnArrival::kStay;
  made.groups.insert(made.groups.begin(), group);
  Simulation simulation(made, {});
  const size_t recorded = 6;
  double nearest_m = 10;
  size_t arrived = 0;
  for (int number = 0; number < 30 * 75; ++number) {
    const Frame& frame = simulation.step();
    arrived = 0;
    for (size_t own = recorded; own < frame.roots.size(); ++own) {
      const Eigen::Vector2d at = frame.roots[own].position_m.head<2>();
      arrived += at.x() > 5;
      for (size_t id = 0; id < recorded; ++id)
        nearest_m = std::min(nearest_m, (frame.roots[id].position_m.head<2>() - at).norm());
    }
  }
  EXPECT_EQ(simulation.info().avatar_count(), 16);
  EXPECT_GT(nearest_m, 0.38) << "two discs of 0.22 m minus the allowed overlap";
  EXPECT_EQ(arrived, 10u);
}

}  // namespace
}  // namespace throng::recorded_motion_test
