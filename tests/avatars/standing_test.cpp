// Quiet standing: people breathe and shift their weight over fixed feet, within precomputed bounds.
#include "avatars/stepping/standing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "tests/avatars/gait_fixture.h"

namespace throng::standing_test {
namespace {

using test::Walking;

constexpr double kStep_s = 1.0 / 30;
constexpr size_t kPeople = 16;

TEST(QuietStanding, ShiftsWeightSmoothlyAndBreathesSteadily) {
  double fastest_mps = 0, hardest_mps2 = 0, min_shifts = 1e9, max_shifts = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed)
    for (uint64_t id = 0; id < 8; ++id) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", person " << id);
      constexpr int kFrames = 18000, kAfter = 75;  // ten minutes, and 2.5 s
      std::vector<double> places_m;
      int breaths = 0, shifts = 0, last_shift = 0, shortest = kFrames, longest = 0;
      bool breathed_in = false;
      for (int frame = 0; frame < kFrames; ++frame) {
        const QuietStanding now = quiet_standing(seed, id, 1e4 + frame * kStep_s);
        ASSERT_LE(std::abs(now.shift_m), kMaxShift_m);
        ASSERT_GE(now.breath, 0);
        ASSERT_LE(now.breath, 1);
        breaths += now.breath > 0.9f && !breathed_in;
        breathed_in = now.breath > 0.9f || (breathed_in && now.breath > 0.1f);
        places_m.push_back(static_cast<double>(now.shift_m));
        if (frame >= 2) {
          const double before = places_m[places_m.size() - 2], now_m = places_m.back();
          fastest_mps = std::max(fastest_mps, std::abs(now_m - before) / kStep_s);
          hardest_mps2 =
              std::max(hardest_mps2, std::abs(now_m - 2 * before + places_m[places_m.size() - 3]) /
                                         (kStep_s * kStep_s));
        }
        if (frame < kAfter || frame - last_shift < 2 * kAfter) continue;
        if (std::abs(places_m.back() - places_m[places_m.size() - 1 - kAfter]) < 0.02) continue;
        if (shifts > 0) {
          shortest = std::min(shortest, frame - last_shift);
          longest = std::max(longest, frame - last_shift);
        }
        last_shift = frame;
        ++shifts;
      }
      EXPECT_GE(breaths, 118);
      EXPECT_LE(breaths, 181);
      min_shifts = std::min(min_shifts, shifts / 10.0);
      max_shifts = std::max(max_shifts, shifts / 10.0);
      EXPECT_LT(shortest + 300, longest) << "as regular as a clock";
      EXPECT_GT(*std::max_element(places_m.begin(), places_m.end()), 0.02) << "never on the left";
      EXPECT_LT(*std::min_element(places_m.begin(), places_m.end()), -0.02) << "or on the right";
    }
  std::printf("%.1f to %.1f weight shifts per minute, at most %.3f m/s and %.2f m/s2\n", min_shifts,
              max_shifts, fastest_mps, hardest_mps2);
  EXPECT_GE(min_shifts, 1);
  EXPECT_LE(max_shifts, 4);
  EXPECT_LT(fastest_mps, 0.15);
  EXPECT_LT(hardest_mps2, 0.6);
}

TEST(QuietStanding, StartsAfterASecondAndEndsWithinASecond) {
  float standing_time_s = 0, before = 0;
  for (int frame = 0; frame < 120; ++frame) {
    standing_time_s = advance_standing_time(standing_time_s, true, static_cast<float>(kStep_s));
    const float share = standing_share(standing_time_s);
    EXPECT_TRUE(frame >= 28 || share == 0) << "frame " << frame;
    EXPECT_LE(std::abs(share - before), 0.06f);
    before = share;
  }
  EXPECT_EQ(before, 1);
  int frames = 0;
  for (; standing_share(standing_time_s) > 0; ++frames) {
    standing_time_s = advance_standing_time(standing_time_s, false, static_cast<float>(kStep_s));
    EXPECT_LE(std::abs(standing_share(standing_time_s) - before), 0.16f);
    before = standing_share(standing_time_s);
  }
  EXPECT_LE(frames, 16);
  EXPECT_EQ(standing_time_s, 0) << "standing restarts after a walk";
}

/// Standing people of one style and different sizes.
class Standers {
 public:
  explicit Standers(const Walking& walking, float ahead_mps = 0) : walking_(walking) {
    batch_.count = kPeople;
    batch_.step_s = static_cast<float>(kStep_s);
    batch_.postures = postures_.data();
    for (size_t i = 0; i < kPeople; ++i) {
      batch_.scales[i] = 0.7f + 0.03f * static_cast<float>(i);
      batch_.phases[i] = static_cast<float>(i) / kPeople;
      batch_.gait_mps[i] = kNotEntered;
      batch_.ahead_mps[i] = ahead_mps;
      batch_.present[i] = batch_.stride_scale[i] = batch_.w_before[i] = batch_.w_after[i] = 1;
      batch_.gaits[i] = &walking.gait;
    }
  }

  void step(const std::array<QuietStanding, kPeople>& adds, SimdTarget target = SimdTarget::kBest) {
    for (size_t i = 0; i < kPeople; ++i) {
      batch_.shift_m[i] = adds[i].shift_m;
      batch_.breath[i] = adds[i].breath;
    }
    Gait::walk(batch_, target);
  }
  /// Moves the people in turn to the maximum on either side, with and without a breath.
  void step_to_the_ends(uint64_t frame) {
    std::array<QuietStanding, kPeople> adds;
    for (size_t i = 0; i < kPeople; ++i)
      adds[i] = {(i + frame) % 2 == 0 ? kMaxShift_m : -kMaxShift_m,
                 (i / 2 + frame) % 2 == 0 ? 1.0f : 0.0f};
    step(adds);
  }

  std::vector<PartPose> poses(size_t person) const {
    std::vector<float> row(static_cast<size_t>(walking_.gait.column_count()));
    const Gait* gait = &walking_.gait;
    const auto me = static_cast<uint32_t>(person);
    Gait::postures({&gait, 1}, postures_, {&me, 1}, row);
    return walking_.poses(row);
  }
  const WalkBatch& batch() const { return batch_; }
  const std::array<WalkPosture, WalkBatch::kCapacity>& postures() const { return postures_; }
  /// Returns the box at scale 1.
  RootBox box(size_t i) const {
    return walking_.gait.box_of({batch_.bounds_x[i], batch_.bounds_y[i]}, 1);
  }

 private:
  const Walking& walking_;
  WalkBatch batch_{};
  std::array<WalkPosture, WalkBatch::kCapacity> postures_{};
};

TEST(QuietStanding, KeepsFeetFixedWhileWeightShifts) {
  for (const Walking& walking : Walking::styles()) {
    Standers standers(walking);
    std::array<std::vector<Eigen::Vector3d>, kPeople> first;
    double farthest_m = 0, highest_m = 0, max_shift_m = 0;
    for (int frame = 0; frame < 1800; ++frame) {
      std::array<QuietStanding, kPeople> adds;
      for (size_t i = 0; i < kPeople; ++i) adds[i] = quiet_standing(7, i, frame * kStep_s);
      standers.step(adds);
      if (frame % 6 != 0) continue;
      for (size_t i = 0; i < kPeople; ++i) {
        EXPECT_EQ(standers.batch().out_of_reach[i], 0);
        EXPECT_EQ(standers.batch().shift_m[i], adds[i].shift_m);
        max_shift_m = std::max(max_shift_m, static_cast<double>(std::abs(adds[i].shift_m)));
        const std::vector<PartPose> poses = standers.poses(i);
        size_t next = 0;
        for (const size_t foot : {walking.right_foot, walking.left_foot}) {
          double lowest_m = 1;
          for (const Eigen::Vector3f& vertex : walking.model->parts[foot].mesh.vertices) {
            const Eigen::Vector3d p = to_isometry(poses[foot]) * vertex.cast<double>();
            lowest_m = std::min(lowest_m, p.z());
            if (frame == 0) first[i].push_back(p);
            const Eigen::Vector3d& before_m = first[i][next++];
            if (before_m.z() < 0.005)
              farthest_m = std::max(farthest_m, (p - before_m).head<2>().norm());
          }
          highest_m = std::max(highest_m, std::abs(lowest_m));
        }
      }
    }
    std::printf("%s: soles move %.2f mm at most, and are %.2f mm above the ground or in it\n",
                walking.name().c_str(), 1e3 * farthest_m, 1e3 * highest_m);
    EXPECT_GT(max_shift_m, 0.035) << "no weight was shifted";
    EXPECT_LT(farthest_m, 0.002) << walking.name();
    EXPECT_LT(highest_m, 0.004) << walking.name();
  }
}

TEST(QuietStanding, StaysWithinBoundsAndJointLimits) {
  for (const Walking& walking : Walking::styles()) {
    const std::vector<JointColumn>& columns = walking.model->kinematics.columns();
    const Eigen::Vector3f centre = walking.gait.sphere_centre_m();
    int shifted = 0;
    // From standing to the fastest walk: the addition never exceeds what the bounds allow.
    for (const float ahead_mps : {0.0f, 0.1f, 0.3f, 0.6f, 0.8f, 0.9f, 1.0f, 1.2f, 1.6f, 2.4f}) {
      Standers standers(walking, ahead_mps);
      for (uint64_t frame = 0; frame < 4; ++frame) {
        standers.step_to_the_ends(frame);
        for (size_t i = 0; i < kPeople; ++i) {
          shifted += standers.batch().shift_m[i] != 0;
          std::vector<float> row(columns.size());
          const Gait* gait = &walking.gait;
          const auto me = static_cast<uint32_t>(i);
          Gait::postures({&gait, 1}, standers.postures(), {&me, 1}, row);
          for (size_t c = 0; c < columns.size(); ++c) {
            ASSERT_GE(row[c], columns[c].lower) << columns[c].name << " at " << ahead_mps;
            ASSERT_LE(row[c], columns[c].upper) << columns[c].name << " at " << ahead_mps;
          }
          const std::vector<PartPose> poses = walking.poses(row);
          const RootBox box = standers.box(i);
          for (size_t part = 0; part < poses.size(); ++part)
            for (const Eigen::Vector3f& vertex : walking.model->parts[part].mesh.vertices) {
              const Eigen::Vector3f p =
                  (to_isometry(poses[part]) * vertex.cast<double>()).cast<float>();
              for (int axis = 0; axis < 3; ++axis) {
                ASSERT_GE(p[axis], box.min_m[axis]) << walking.model->parts[part].name;
                ASSERT_LE(p[axis], box.max_m[axis]) << walking.model->parts[part].name;
              }
              ASSERT_LE(p.head<2>().norm(), walking.gait.upright_radius_m());
              ASSERT_LE((p - centre).norm(), walking.gait.sphere_radius_m());
            }
        }
      }
    }
    EXPECT_GT(shifted, 300) << walking.name() << ": no one stood";
  }
}

TEST(QuietStanding, HasNoEffectOnWalkers) {
  const Walking& walking = Walking::adult();
  Standers asked(walking, 1.6f), left_alone(walking, 1.6f);
  for (uint64_t frame = 0; frame < 30; ++frame) {
    asked.step_to_the_ends(frame);
    left_alone.step({});
    for (size_t i = 0; i < kPeople; ++i) {
      const auto &numbers = asked.postures()[i].numbers, &others = left_alone.postures()[i].numbers;
      EXPECT_TRUE(
          std::equal(std::begin(numbers), std::end(numbers), std::begin(others), std::end(others)))
          << "person " << i << ", frame " << frame;
      EXPECT_EQ(asked.batch().bounds_x[i], left_alone.batch().bounds_x[i]);
      EXPECT_EQ(asked.batch().bounds_y[i], left_alone.batch().bounds_y[i]);
    }
  }
}

}  // namespace
}  // namespace throng::standing_test
