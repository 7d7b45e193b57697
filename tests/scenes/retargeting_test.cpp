// Retargeting: recorded positions are kept, headings and gait phase follow the tracks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "avatars/gait/gait_curves.h"
#include "base/random.h"
#include "scenes/retargeting/head_offset.h"
#include "scenes/retargeting/retarget.h"
#include "scenes/run/posing.h"
#include "scenes/run/simulation.h"
#include "tests/scenes/walking_heads.h"

namespace throng::retargeting_test {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

double uniform(uint64_t seed, uint64_t id, uint32_t number, double low, double high) {
  return random_uniform({seed, id, number, Purpose::kSpawnPosition}, low, high);
}

/// Nearly normal, with standard deviation 1.
double noise(uint64_t seed, uint64_t id, uint32_t number) {
  double sum = 0;
  for (uint32_t i = 0; i < 12; ++i) sum += uniform(seed, id, 12 * number + i, -0.5, 0.5);
  return sum;
}

/// Tracks of people who wander, stop, jump and are absent for a while.
std::vector<Sample> wandering(uint64_t seed, double step_s, size_t count) {
  std::vector<Sample> track;
  Eigen::Vector2d at(uniform(seed, 1, 0, -5, 5), uniform(seed, 1, 1, -5, 5));
  double heading = uniform(seed, 1, 2, -3, 3), time_s = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t stage = i / 20;
    const double speed = std::max(0.0, uniform(seed, 2, stage, -0.6, 1.8));
    heading += step_s * uniform(seed, 3, stage, -1, 1);
    at += step_s * speed * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    if (uniform(seed, 4, i, 0, 1) < 0.01) at.x() += 30;
    if (uniform(seed, 5, i, 0, 1) < 0.01) time_s += 5;
    track.push_back({time_s, at, kNone, kNone});
    time_s += step_s;
  }
  return track;
}

class Retargeting : public testing::Test {
 protected:
  // NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
  static void SetUpTestSuite() {
    adult_model = load_model(adult_urdf());
    adult_gait = std::make_unique<Gait>(*adult_model);
    adult_head = std::make_unique<HeadOffset>(*adult_model, *adult_gait);
  }
  // NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
  static void TearDownTestSuite() {
    adult_head.reset();
    adult_gait.reset();
    adult_model.reset();
  }
  static RetargetBody body_of(TrackedPoint tracked, float scale = 1) {
    return {tracked, adult_gait.get(), adult_head.get(), scale};
  }

  static inline std::shared_ptr<const Model> adult_model;
  static inline std::unique_ptr<Gait> adult_gait;
  static inline std::unique_ptr<HeadOffset> adult_head;
};

TEST_F(Retargeting, KeepsTrackedPoints) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<Sample> track = wandering(seed, seed % 2 == 0 ? 0.04 : 0.5, 300);
    const std::vector<TrackSample> centres = retarget(track, body_of(TrackedPoint::kCentre));
    const std::vector<TrackSample> heads = retarget(track, body_of(TrackedPoint::kHead));
    ASSERT_EQ(centres.size(), track.size());
    for (size_t i = 0; i < track.size(); ++i) {
      const Eigen::Vector2d& at = track[i].position_m;
      EXPECT_EQ(Eigen::Vector2d(centres[i].x_m, centres[i].y_m), at) << "seed " << seed;
      EXPECT_LE((Eigen::Vector2d(heads[i].x_m, heads[i].y_m) - at).norm(), 0.01 + 1e-12)
          << "seed " << seed << ", sample " << i;
      EXPECT_EQ(centres[i].time_s, track[i].time_s);
    }
  }
}

TEST_F(Retargeting, InterpolatesWithinTheRectangleOfNeighbours) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<TrackSample> samples =
        retarget(wandering(seed, 0.4, 200), body_of(TrackedPoint::kCentre));
    for (size_t i = 0; i + 1 < samples.size(); ++i) {
      const TrackSample &from = samples[i], &to = samples[i + 1];
      if (from.next != TrackSample::Next::kMove) continue;
      const TrackSample* before = i > 0 ? &samples[i - 1] : nullptr;
      const TrackSample* after = i + 2 < samples.size() ? &samples[i + 2] : nullptr;
      for (int part = 0; part <= 10; ++part) {
        const double time_s = from.time_s + 0.1 * part * (to.time_s - from.time_s);
        const Eigen::Vector2d at = position_between(before, from, to, after, time_s);
        EXPECT_GE(at.x(), std::min(from.x_m, to.x_m) - 1e-12) << "seed " << seed;
        EXPECT_LE(at.x(), std::max(from.x_m, to.x_m) + 1e-12) << "seed " << seed;
        EXPECT_GE(at.y(), std::min(from.y_m, to.y_m) - 1e-12) << "seed " << seed;
        EXPECT_LE(at.y(), std::max(from.y_m, to.y_m) + 1e-12) << "seed " << seed;
      }
    }
  }
}

TEST_F(Retargeting, DoesNotInterpolateAbsencesAndJumps) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const std::vector<Sample> track = wandering(seed, 0.04, 600);
    const std::vector<TrackSample> samples = retarget(track, body_of(TrackedPoint::kCentre));
    for (size_t i = 0; i + 1 < track.size(); ++i) {
      const double time_s = track[i + 1].time_s - track[i].time_s;
      const double moved_m = (track[i + 1].position_m - track[i].position_m).norm();
      const TrackSample::Next expected = time_s > 1     ? TrackSample::Next::kAbsent
                                         : moved_m > 20 ? TrackSample::Next::kJump
                                                        : TrackSample::Next::kMove;
      EXPECT_EQ(samples[i].next, expected) << "seed " << seed << ", sample " << i;
    }
    EXPECT_EQ(samples.back().next, TrackSample::Next::kAbsent);
  }
}

double apart_rad(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * std::numbers::pi));
}

TEST_F(Retargeting, TurnsHeadingsAlongThePath) {
  // East for 4 s, standing for 4 s with a head that moves by 5 cm, then north.
  std::vector<Sample> track;
  for (int i = 0; i < 300; ++i) {
    const double time_s = 0.04 * i, east_s = std::min(time_s, 4.0),
                 north_s = std::max(time_s - 8, 0.0);
    const Eigen::Vector2d fidget(0.05 * std::sin(3 * time_s), 0.05 * std::cos(2 * time_s));
    track.push_back({time_s, Eigen::Vector2d(1.2 * east_s, 1.2 * north_s) + fidget, kNone, kNone});
  }
  const std::vector<TrackSample> samples = retarget(track, body_of(TrackedPoint::kHead));
  const auto heading = [&](double time_s) {
    return static_cast<double>(samples[static_cast<size_t>(time_s / 0.04)].heading_rad);
  };
  const double north = std::numbers::pi / 2;
  EXPECT_LT(apart_rad(heading(2), 0), 0.1);
  EXPECT_LT(apart_rad(heading(4.2), 0), 0.5);
  EXPECT_LT(apart_rad(heading(7.8), north), 0.5);
  EXPECT_LT(apart_rad(heading(10), north), 0.1);
  for (size_t i = 0; i + 1 < samples.size(); ++i)
    EXPECT_LT(std::abs(samples[i + 1].heading_rad - samples[i].heading_rad), 0.04 * 2.5)
        << "at " << samples[i].time_s << " s";
}

TEST_F(Retargeting, DoesNotTurnForAStepBack) {
  // North, 25 cm back within 0.5 s, and north again.
  std::vector<Sample> track;
  double y = 0;
  for (int i = 0; i < 200; ++i) {
    y += i >= 100 && i < 113 ? -0.02 : 0.03;
    track.push_back({0.04 * i, {0, y}, kNone, kNone});
  }
  const std::vector<TrackSample> samples = retarget(track, body_of(TrackedPoint::kHead));
  for (const TrackSample& sample : samples)
    EXPECT_LT(apart_rad(static_cast<double>(sample.heading_rad), std::numbers::pi / 2), 0.2)
        << "at " << sample.time_s << " s";
}

TEST_F(Retargeting, AveragesTheNextVelocity) {
  const double step_s = 0.05;
  const Eigen::Vector2d begins_mps(0.3, -0.1), harder_mps2(0.4, 0.2);
  std::vector<Sample> track;
  for (int i = 0; i < 60; ++i) {
    const double time_s = i * step_s;
    track.push_back(
        {time_s, time_s * begins_mps + 0.5 * time_s * time_s * harder_mps2, kNone, kNone});
  }
  const std::vector<TrackSample> samples = retarget(track, body_of(TrackedPoint::kCentre));
  for (size_t i = 10; i < 44; ++i) {  // without the ends, which lack samples
    const Eigen::Vector2d next_mps = begins_mps + (track[i].time_s + 0.15) * harder_mps2;
    EXPECT_NEAR(static_cast<double>(samples[i].next_x_mps), next_mps.x(), 1e-4) << i;
    EXPECT_NEAR(static_cast<double>(samples[i].next_y_mps), next_mps.y(), 1e-4) << i;
  }
}

TEST_F(Retargeting, KeepsRecordedHeadings) {
  std::vector<Sample> track;
  for (int i = 0; i < 100; ++i)
    track.push_back({0.04 * i, {0.04 * i, 0}, kNone, static_cast<float>(0.1 * i)});
  const std::vector<TrackSample> samples = retarget(track, body_of(TrackedPoint::kCentre));
  for (size_t i = 0; i < samples.size(); ++i)
    EXPECT_LT(apart_rad(static_cast<double>(samples[i].heading_rad), 0.1 * static_cast<double>(i)),
              1e-5);
}

constexpr std::array<double, 6> kSpeeds_mps = {0.6, 0.8, 1.0, 1.2, 1.4, 1.6};
constexpr size_t kPeopleASpeed = 10;

/// People who walk side by side in separate lanes, several per speed.
Scene lanes(double fps, const std::shared_ptr<const Model>& model) {
  Scene scene;
  scene.name = "lanes";
  scene.step_s = 1 / fps;
  scene.ground = {{-2, 0}, {60, 4 * kSpeeds_mps.size() * kPeopleASpeed + 4}};
  for (size_t lane = 0; lane < kSpeeds_mps.size() * kPeopleASpeed; ++lane) {
    Group group;
    group.name = fmt::format("lane {}", lane);
    group.model = adult_urdf();
    group.body = model;
    group.count = 1;
    const double y = 3 + 4.0 * static_cast<double>(lane),
                 speed_mps = kSpeeds_mps[lane / kPeopleASpeed];
    group.spawn = {{0, y}, {0.5, y + 0.5}};
    group.goals = {Rectangle{{58, y}, {59, y + 0.5}}};
    group.speed_mps = Distribution{speed_mps, 0, speed_mps, speed_mps};
    group.gait_styles = StyleShares{1};
    scene.groups.push_back(group);
  }
  return scene;
}

/// Supporting foot: 0: right, 1: left, -1: both.
int carrying(double phase, double stance) {
  const bool right = phase < stance, left = phase >= 0.5 || phase + 0.5 < stance;
  return right && left ? -1 : right ? 0 : 1;
}

TEST_F(Retargeting, FindsTheGaitPhaseFromHeadSway) {
  const double leg_m =
      std::pow(static_cast<double>(adult_gait->stride_length_m(1, 1)) / kStridePerSqrtSpeed, 2);
  for (const double fps : {25.0, 16.0}) {
    Simulation simulation(lanes(fps, adult_model), {});
    const size_t people = simulation.info().model_of_avatar.size();
    std::vector<std::vector<Sample>> tracks(people);
    std::vector<std::vector<double>> phases(people);
    const BodyStates& bodies = simulation.bodies();
    for (uint32_t number = 0; number < 20 * fps; ++number) {
      const Frame& frame = simulation.step();
      for (size_t id = 0; id < people; ++id) {
        const Eigen::Vector2d off(noise(1, id, 2 * number), noise(1, id, 2 * number + 1));
        tracks[id].push_back(
            {number / fps, head_of(*adult_model, frame, bodies, id) + 0.005 * off, kNone, kNone});
        phases[id].push_back(static_cast<double>(bodies.phases[id]));
      }
    }
    for (size_t speed = 0; speed < kSpeeds_mps.size(); ++speed) {
      int right = 0, all = 0;
      for (size_t id = speed * kPeopleASpeed; id < (speed + 1) * kPeopleASpeed; ++id) {
        const float scale = bodies.scales[id];
        const std::vector<TrackSample> samples =
            retarget(tracks[id], body_of(TrackedPoint::kHead, scale));
        const double stance =
            stance_fraction(kSpeeds_mps[speed] / (leg_m * static_cast<double>(scale)));
        for (size_t i = 0; i < samples.size(); ++i) {
          const int truth = carrying(phases[id][i], stance);
          if (truth < 0) continue;
          ++all;
          // Invisible phases are NaN and count as wrong.
          const auto seen = static_cast<double>(samples[i].phase);
          if (!std::isnan(seen) && carrying(seen, stance) == truth) ++right;
        }
      }
      EXPECT_GE(right, 0.95 * all) << fps << " fps, " << kSpeeds_mps[speed] << " m/s";
      RecordProperty(fmt::format("right_{}_{}", fps, speed), right);
    }
  }
}

}  // namespace
}  // namespace throng::retargeting_test
