// The gait as a whole: limits, symmetry, stride, standing still, batches, the sphere.
#include "avatars/gait/gait.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>

#include "base/random.h"
#include "tests/avatars/gait_fixture.h"

namespace throng::gait_test {
namespace {

using test::Walking;

constexpr float kDegree = std::numbers::pi_v<float> / 180;
constexpr uint64_t kSeed = 20240611;

float random_float(uint32_t index, float low, float high) {
  return static_cast<float>(random_uniform({kSeed, index, 0, Purpose::kGaitPhase}, low, high));
}

TEST(Gait, StaysInsideTheJointLimits) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    const std::vector<JointColumn>& columns = walking.model->kinematics.columns();
    for (int faster = 0; faster < 100; ++faster)
      for (int i = 0; i < 211; ++i) {
        const float speed = 0.04f * static_cast<float>(faster);
        const float phase = static_cast<float>(i) / 211;
        const std::vector<float> row = walking.posture(phase, speed);
        for (size_t c = 0; c < row.size(); ++c) {
          ASSERT_GE(row[c], columns[c].lower)
              << columns[c].name << " at " << speed << ", " << phase;
          ASSERT_LE(row[c], columns[c].upper)
              << columns[c].name << " at " << speed << ", " << phase;
        }
      }
  }
}

TEST(Gait, MirrorsTheSidesHalfACycleApart) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    for (const float speed : {0.3f, 1.0f, 1.34f, 2.0f})
      for (int i = 0; i < 64; ++i) {
        const float phase = static_cast<float>(i) / 64;
        const std::vector<float> now = walking.posture(phase, speed);
        const std::vector<float> later = walking.posture(phase + (i < 32 ? 0.5f : -0.5f), speed);
        for (const char* joint :
             {"_hip_flexion", "_hip_adduction", "_hip_rotation", "_knee_flexion", "_ankle_flexion",
              "_shoulder_flexion", "_elbow_flexion"}) {
          const std::string name = joint;
          // About one axis on both sides, or mirrored ones: internal positive.
          EXPECT_NEAR(later[walking.column("left" + name)], now[walking.column("right" + name)],
                      2e-4)
              << joint << " at " << speed << " m/s, phase " << phase;
        }
      }
  }
}

TEST(Gait, StandsStillAndUprightAtSpeedZero) {
  const Walking& walking = Walking::adult();
  const std::vector<float> standing = walking.posture(0, 0);
  for (int i = 0; i < 97; ++i) EXPECT_EQ(walking.posture(static_cast<float>(i) / 97, 0), standing);
  for (const char* joint : {"pelvis_yaw", "pelvis_pitch", "pelvis_roll", "thorax_yaw", "head_yaw"})
    EXPECT_NEAR(standing[walking.column(joint)], 0, 1e-6) << joint;
  for (const std::string side : {"left", "right"}) {
    EXPECT_NEAR(standing[walking.column(side + "_knee_flexion")], 2 * kDegree, 3 * kDegree);
    EXPECT_NEAR(standing[walking.column(side + "_hip_flexion")], 0, 3 * kDegree);
  }
  EXPECT_NEAR(standing[walking.column("pelvis_vertical")], 0, 0.005);
}

TEST(Gait, IsPeriodicAndContinuous) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    // 12 radians per cycle occur: 60 degrees of a swinging knee in a tenth of it.
    constexpr float kMaxRate = 15, kStep = 1.0f / 2000;
    for (const float speed : {0.1f, 0.5f, 1.34f, 2.2f}) {
      std::vector<float> before = walking.posture(1 - kStep, speed);
      for (int i = 0; i < 2000; ++i) {
        const std::vector<float> now = walking.posture(static_cast<float>(i) * kStep, speed);
        for (size_t c = 0; c < now.size(); ++c)
          ASSERT_NEAR(now[c], before[c], kMaxRate * kStep)
              << walking.model->kinematics.columns()[c].name << " at " << speed << " m/s, step "
              << i;
        before = now;
      }
    }
  }
}

TEST(Gait, BlendsFromStandingToWalking) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    // Amplitudes grow with the root of the speed; postures are smooth in that root. The knee's
    // radian of swing is reached at 0.5 m/s, and is three times as steep where toe-off moves
    // through a phase.
    constexpr float kRootStep = 1e-3f, kMaxSlope = 5;
    for (const float phase : {0.0f, 0.1f, 0.37f, 0.62f, 0.85f}) {
      std::vector<float> before = walking.posture(phase, 0);
      for (float root = kRootStep; root * root < 2.4f; root += kRootStep) {
        const std::vector<float> now = walking.posture(phase, root * root);
        for (size_t c = 0; c < now.size(); ++c)
          ASSERT_NEAR(now[c], before[c], kMaxSlope * kRootStep)
              << walking.model->kinematics.columns()[c].name << " at " << root * root << " m/s";
        before = now;
      }
    }
  }
}

TEST(Gait, HasTheStridesAndCadencesOfAnAdult) {
  const Walking& walking = Walking::adult();
  const float scale = 1.75f / walking.model->height_m;
  struct Row {
    float speed, stride, cadence_per_min;
  };
  for (const Row row : {Row{0.5f, 0.88f, 68},
                        {1.0f, 1.25f, 96},
                        {1.34f, 1.44f, 111},
                        {1.6f, 1.58f, 122},
                        {2.0f, 1.76f, 136}}) {
    const float stride = walking.gait.stride_length_m(row.speed, scale);
    EXPECT_NEAR(stride, row.stride, 0.01) << row.speed << " m/s";
    EXPECT_NEAR(120 * row.speed / stride, row.cadence_per_min, 1) << row.speed << " m/s";
  }
}

// Recorded heads surge by 0.6 to 0.7 cm, once per step; the body's centre by about 1 cm.
TEST(Gait, KeepsTheHeadSteadierThanThePelvis) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    size_t head = 0, pelvis = 0;
    for (size_t i = 0; i < walking.model->parts.size(); ++i) {
      if (walking.model->parts[i].name == "head") head = i;
      if (walking.model->parts[i].name == "pelvis") pelvis = i;
    }
    // Surge of a point of a part, once per step, along the path.
    const auto surge_m = [&](float speed, size_t part) {
      constexpr int kPhases = 64;
      std::complex<double> wave = 0;
      for (int i = 0; i < kPhases; ++i) {
        const float phase = static_cast<float>(i) / kPhases;
        const double forward_m =
            to_isometry(walking.poses(walking.posture(phase, speed))[part]).translation().x();
        wave += forward_m * std::polar(2.0 / kPhases, -4 * std::numbers::pi * i / kPhases);
      }
      return std::abs(wave);
    };
    for (const float speed : {0.5f, 0.9f, 1.34f, 1.8f}) {
      EXPECT_NEAR(surge_m(speed, head), 0.0065, 0.0025) << speed << " m/s";
      EXPECT_NEAR(surge_m(speed, pelvis), 0.010, 0.002) << speed << " m/s";
    }
  }
}

TEST(Gait, HasContinuousPositiveStrides) {
  const Gait& gait = Walking::adult().gait;
  float before = gait.stride_length_m(0, 1);
  EXPECT_GT(before, 0);
  for (float root = 0; root * root < 4; root += 1e-3f) {
    const float now = gait.stride_length_m(root * root, 1);
    ASSERT_GE(now, before) << root * root << " m/s";
    ASSERT_LT(now - before, 2e-3f) << root * root << " m/s";
    before = now;
  }
}

TEST(Gait, ScalesWithTheBody) {
  const Walking& walking = Walking::adult();
  for (const float scale : {0.5f, 0.8f, 1.2f})
    for (const float phase : {0.05f, 0.4f, 0.9f}) {
      const std::vector<float> adult = walking.posture(phase, 1.3f);
      const std::vector<float> child = walking.posture(phase, 1.3f * scale, scale);
      for (size_t c = 0; c < adult.size(); ++c) EXPECT_NEAR(child[c], adult[c], 1e-5);
      EXPECT_NEAR(walking.gait.stride_length_m(1.3f * scale, scale),
                  scale * walking.gait.stride_length_m(1.3f, 1), 1e-5);
    }
}

TEST(Gait, SwingsArmsAgainstLegsAndBendsKneesForwardOnly) {
  const Walking& walking = Walking::adult();
  for (const float speed : {0.5f, 1.34f, 2.0f}) {
    double same_side = 0, other_side = 0;
    for (int i = 0; i < 128; ++i) {
      const std::vector<float> row = walking.posture(static_cast<float>(i) / 128, speed);
      const float right =
          row[walking.column("right_hip_flexion")] - row[walking.column("left_hip_flexion")];
      same_side += static_cast<double>(right * row[walking.column("right_shoulder_flexion")]);
      other_side += static_cast<double>(right * row[walking.column("left_shoulder_flexion")]);
      EXPECT_GT(row[walking.column("right_knee_flexion")], 1 * kDegree);
      EXPECT_GT(row[walking.column("left_knee_flexion")], 1 * kDegree);
    }
    EXPECT_LT(same_side, 0) << "right arm forward with right leg at " << speed << " m/s";
    EXPECT_GT(other_side, 0) << "left arm back with right leg at " << speed << " m/s";
  }
}

TEST(Gait, KeepsTheHeadFacingAhead) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    for (int i = 0; i < 50; ++i) {
      const std::vector<float> row = walking.posture(static_cast<float>(i) / 50, 1.34f);
      const float sum = row[walking.column("pelvis_yaw")] + row[walking.column("thorax_yaw")] +
                        row[walking.column("head_yaw")];
      EXPECT_NEAR(sum, 0, 1e-4);
    }
  }
}

// Every 5 % of a measured cycle from heel strike, degrees (OpenSim tutorial, normal.mot).
constexpr std::array<float, 20> kMeasuredHip = {
    24.6f,  23.9f,  21.8f,  17.4f, 11.9f, 6.0f,  0.3f,  -5.0f, -10.1f, -14.2f,
    -16.6f, -16.0f, -10.7f, -1.1f, 8.6f,  16.3f, 21.8f, 24.7f, 25.2f,  24.7f};
constexpr std::array<float, 20> kMeasuredKnee = {3.9f,  10.9f, 16.4f, 16.6f, 13.9f, 10.2f, 6.6f,
                                                 3.8f,  2.4f,  3.5f,  8.2f,  17.7f, 32.7f, 48.9f,
                                                 57.8f, 56.2f, 47.0f, 31.8f, 14.4f, 3.3f};

float rms_degrees(const std::string& joint, const std::array<float, 20>& measured) {
  const Walking& walking = Walking::adult();
  float sum = 0;
  for (size_t i = 0; i < measured.size(); ++i) {
    const std::vector<float> row = walking.posture(static_cast<float>(i) / 20, 1.34f);
    const float off = row[walking.column(joint)] / kDegree - measured[i];
    sum += off * off;
  }
  return std::sqrt(sum / 20);
}

TEST(Gait, MatchesMeasuredLegMotion) {
  // The rest is due to the rigid foot: without a toe joint the leg lags at lift-off.
  EXPECT_LT(rms_degrees("right_hip_flexion", kMeasuredHip), 8);
  EXPECT_LT(rms_degrees("right_knee_flexion", kMeasuredKnee), 10);
}

TEST(Gait, ComputesBatchesLikeSingleCalls) {
  const Walking& walking = Walking::adult();
  constexpr size_t kAvatars = 257;
  std::vector<float> phases, speeds, scales;
  for (uint32_t i = 0; i < kAvatars; ++i) {
    phases.push_back(random_float(3 * i, 0, 1));
    speeds.push_back(random_float(3 * i + 1, 0, 2.5f));
    scales.push_back(random_float(3 * i + 2, 0.8f, 1.2f));
  }
  const size_t columns = static_cast<size_t>(walking.gait.column_count());
  std::vector<float> rows(kAvatars * columns);
  walking.gait.postures(phases, speeds, scales, rows);
  for (size_t i = 0; i < kAvatars; ++i)
    EXPECT_EQ(walking.posture(phases[i], speeds[i], scales[i]),
              std::vector<float>(rows.begin() + static_cast<ptrdiff_t>(i * columns),
                                 rows.begin() + static_cast<ptrdiff_t>((i + 1) * columns)))
        << "avatar " << i << ", seed " << kSeed;
}

/// Returns a posture with the head turned half-way or fully to a side.
std::vector<float> looking(const Walking& walking, float phase, float speed, uint32_t draw) {
  std::vector<float> row = walking.posture(phase, speed);
  const float share = draw % 3 == 0 ? 1 : draw % 3 == 1 ? -1 : random_float(draw, -1, 1);
  walking.gait.apply_head_yaw(share * Gait::kMaxHeadYaw_rad, row);
  return row;
}

TEST(Gait, TurnsOnlyTheHeadWithinItsLimits) {
  const Walking& walking = Walking::adult();
  const size_t head = walking.column("head_yaw");
  for (const float look : {-Gait::kMaxHeadYaw_rad, -0.2f, 0.0f, 0.3f, Gait::kMaxHeadYaw_rad}) {
    const std::vector<float> ahead = walking.posture(0.3f, 1.34f);
    std::vector<float> row = ahead;
    walking.gait.apply_head_yaw(look, row);
    for (size_t c = 0; c < row.size(); ++c) {
      if (c == head) {
        EXPECT_NEAR(row[c], ahead[c] + look, 1e-6);
      } else {
        EXPECT_EQ(row[c], ahead[c]);
      }
    }
  }
  std::vector<float> row = walking.posture(0.3f, 1.34f);
  row[head] = walking.model->kinematics.columns()[head].upper - 0.1f;
  walking.gait.apply_head_yaw(0.4f, row);
  EXPECT_EQ(row[head], walking.model->kinematics.columns()[head].upper);
}

TEST(Gait, BoundsAllVerticesTightlyBySphereAndCylinder) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    const Eigen::Vector3f centre = walking.gait.sphere_centre_m();
    EXPECT_EQ(centre.x(), 0);
    EXPECT_EQ(centre.y(), 0);
    float farthest = 0, widest = 0;
    for (uint32_t i = 0; i < 1500; ++i) {
      const float phase = random_float(2 * i, 0, 1), speed = random_float(2 * i + 1, 0, 2.4f);
      const std::vector<PartPose> poses = walking.poses(looking(walking, phase, speed, i));
      for (size_t part = 0; part < poses.size(); ++part) {
        const Eigen::Isometry3f pose = to_isometry(poses[part]).cast<float>();
        for (const Eigen::Vector3f& vertex : walking.model->parts[part].mesh.vertices) {
          const Eigen::Vector3f placed = pose * vertex;
          farthest = std::max(farthest, (placed - centre).norm());
          widest = std::max(widest, placed.head<2>().norm());
        }
      }
      ASSERT_LE(farthest, walking.gait.sphere_radius_m())
          << "phase " << phase << ", " << speed << " m/s, seed " << kSeed;
      ASSERT_LE(widest, walking.gait.upright_radius_m())
          << "phase " << phase << ", " << speed << " m/s, seed " << kSeed;
    }
    EXPECT_LT(walking.gait.upright_radius_m() - widest, 0.015f) << "widest vertex " << widest;
    EXPECT_LT(walking.gait.sphere_radius_m() - farthest, 0.015f) << "farthest vertex " << farthest;
  }
}

TEST(Gait, BoundsEachPostureByABoxTighterThanTheSphere) {
  for (const Walking& walking : Walking::styles()) {
    SCOPED_TRACE(walking.name());
    float bounds_area = 0;
    for (uint32_t i = 0; i < 1500; ++i) {
      const float phase = random_float(3 * i, 0, 1), speed = random_float(3 * i + 1, 0, 2.4f);
      const std::vector<PartPose> poses = walking.poses(looking(walking, phase, speed, i));
      const float scale = 1;
      RootBox box;
      walking.gait.bounds({&phase, 1}, {&speed, 1}, {&scale, 1}, {&box, 1});
      ASSERT_TRUE(box.is_known());
      for (size_t part = 0; part < poses.size(); ++part) {
        const Eigen::Isometry3f pose = to_isometry(poses[part]).cast<float>();
        for (const Eigen::Vector3f& vertex : walking.model->parts[part].mesh.vertices) {
          const Eigen::Vector3f placed = pose * vertex;
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GE(placed[axis], box.min_m[axis])
                << walking.model->parts[part].name << ", axis " << axis << ", phase " << phase
                << ", " << speed << " m/s, seed " << kSeed;
            ASSERT_LE(placed[axis], box.max_m[axis])
                << walking.model->parts[part].name << ", axis " << axis << ", phase " << phase
                << ", " << speed << " m/s, seed " << kSeed;
          }
        }
      }
      bounds_area += (box.max_m[0] - box.min_m[0]) * (box.max_m[1] - box.min_m[1]) / 1500;
    }
    const float upright_m = walking.gait.upright_radius_m();
    EXPECT_LT(bounds_area, 0.5f * std::numbers::pi_v<float> * upright_m * upright_m);
  }
}

TEST(Gait, VariesStridesAndPosturesByStyle) {
  const std::span<const Walking> styles = Walking::styles();
  for (size_t a = 0; a < styles.size(); ++a) {
    SCOPED_TRACE(styles[a].name());
    const StyleParameters& parameters = parameters_of(styles[a].style);
    EXPECT_NEAR(styles[a].gait.stride_length_m(1.34f, 1) / styles[0].gait.stride_length_m(1.34f, 1),
                parameters.stride, 1e-5);
    for (size_t b = 0; b < a; ++b) {
      float max_rad = 0;
      for (int i = 0; i < 32; ++i) {
        const float phase = static_cast<float>(i) / 32;
        const std::vector<float> one = styles[a].posture(phase, 1.34f);
        const std::vector<float> other = styles[b].posture(phase, 1.34f);
        for (size_t c = 0; c < one.size(); ++c)
          max_rad = std::max(max_rad, std::abs(one[c] - other[c]));
      }
      EXPECT_GT(max_rad, 5 * kDegree) << "too similar to " << styles[b].name();
    }
  }
}

TEST(Gait, ComputesMixedStylesLikeSingleCalls) {
  constexpr size_t kAvatars = 77;
  std::vector<const Gait*> gaits;
  std::vector<float> phases, speeds, scales;
  for (uint32_t i = 0; i < kAvatars; ++i) {
    gaits.push_back(&Walking::styles()[(size_t{i} * 5) % kGaitStyleCount].gait);
    phases.push_back(random_float(3 * i, 0, 1));
    speeds.push_back(random_float(3 * i + 1, 0, 2.5f));
    scales.push_back(random_float(3 * i + 2, 0.8f, 1.2f));
  }
  const size_t columns = static_cast<size_t>(gaits.front()->column_count());
  std::vector<float> rows(kAvatars * columns), row(columns);
  Gait::postures(gaits, phases, speeds, scales, rows);
  for (size_t i = 0; i < kAvatars; ++i) {
    gaits[i]->postures({&phases[i], 1}, {&speeds[i], 1}, {&scales[i], 1}, row);
    EXPECT_TRUE(
        std::equal(row.begin(), row.end(), rows.begin() + static_cast<ptrdiff_t>(i * columns)))
        << "avatar " << i << ", seed " << kSeed;
  }
}

TEST(Gait, ScalesBoundsWithTheBody) {
  const Walking& walking = Walking::adult();
  const float phase = 0.3f, speed = 0, small = 0.5f, large = 1;
  RootBox half, whole;
  walking.gait.bounds({&phase, 1}, {&speed, 1}, {&small, 1}, {&half, 1});
  walking.gait.bounds({&phase, 1}, {&speed, 1}, {&large, 1}, {&whole, 1});
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(half.min_m[axis], 0.5f * whole.min_m[axis]);
    EXPECT_EQ(half.max_m[axis], 0.5f * whole.max_m[axis]);
  }
}

TEST(Gait, KeepsTheZeroPostureWithoutLegs) {
  const std::shared_ptr<const Model> cart =
      load_model(std::filesystem::path(THRONG_GAIT_FIXTURES) / "gait_cart.urdf");
  const Gait gait(*cart);
  ASSERT_EQ(gait.column_count(), 2);
  EXPECT_EQ(gait.stride_length_m(0, 1), 1);
  EXPECT_EQ(gait.stride_length_m(1.5f, 2), 1);
  const std::array<float, 3> phases = {0, 0.3f, 0.9f}, speeds = {0, 1, 2}, scales = {1, 1, 1};
  std::vector<float> rows(6, -1), of_batch(6, -1);
  gait.postures(phases, speeds, scales, rows);
  Gait::postures(std::array{&gait, &gait, &gait}, phases, speeds, scales, of_batch);
  EXPECT_EQ(of_batch, rows);
  gait.apply_head_yaw(0.4f, {rows.data(), 2});
  EXPECT_EQ(of_batch, rows) << "no head to turn";
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(rows[2 * i + static_cast<size_t>(cart->kinematics.column_of("wheel"))], 0);
    EXPECT_EQ(rows[2 * i + static_cast<size_t>(cart->kinematics.column_of("mast"))], 0.5f)
        << "zero is below the mast's limit";
  }
  // A box 1 x 0.6 x 0.4 m, and a ball up to 1 m above it: the sphere's centre is 0.33 m up.
  EXPECT_NEAR(gait.sphere_centre_m().z(), 0.33f, 0.005f);
  EXPECT_NEAR(gait.sphere_radius_m(), 0.67f, 0.005f);
}

}  // namespace
}  // namespace throng::gait_test
