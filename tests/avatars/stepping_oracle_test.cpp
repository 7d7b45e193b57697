// Stepping against an independent oracle: feet, and the ankles computed by forward kinematics.
#include "tests/avatars/stepping_oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "tests/avatars/gait_fixture.h"

namespace throng::stepping_oracle_test {
namespace {

using test::OracleFoot;
using test::OracleMotion;
using test::OracleState;
using test::SteppingOracle;
using test::Walking;

constexpr uint64_t kSeeds = 24;
constexpr uint64_t kFrames = 150;
constexpr size_t kPeople = WalkBatch::kCapacity;

// Three times the measured errors. At the end of a swing, the remaining change is a quotient of
// small numbers.
constexpr double kFootBound_m = 1e-4;
constexpr double kTurnBound_rad = 1e-4;
constexpr double kCyclesBound_ps = 1.2e-3;
constexpr double kPhaseBound = kCyclesBound_ps / 30;  // the longest step
// Relative to the remaining change of a foot's number until landing.
constexpr double kSwingBound = 1e-4;
constexpr double kHeadingBound_rad = 5e-5;
// The ankle is over the same point; heights of a rolling foot are interpolated.
constexpr double kAsideBound_m = 5e-5;
constexpr double kHeightBound_m = 2e-3;

double turned_by(float w, float z) {
  return 2 * std::atan2(static_cast<double>(z), static_cast<double>(w));
}

OracleState state_of(const WalkBatch& batch, size_t i) {
  OracleState state;
  state.gait_mps = static_cast<double>(batch.gait_mps[i]);
  state.phase = static_cast<double>(batch.phases[i]);
  state.cadence_hz = static_cast<double>(batch.gait_rates[WalkBatch::kCadence][i]);
  for (size_t side = 0; side < 2; ++side) {
    const auto number = [&](const WalkBatch::Numbers* of, size_t n) {
      return static_cast<double>(of[3 * side + n][i]);
    };
    state.feet[side] = {
        {number(batch.feet, 0), number(batch.feet, 1)},
        number(batch.feet, 2),
        static_cast<double>(batch.lift_m[side][i]),
        {number(batch.gait_rates, 0), number(batch.gait_rates, 1), number(batch.gait_rates, 2)}};
  }
  return state;
}

OracleMotion motion_of(const WalkBatch& batch, size_t i) {
  const auto landing_m = [&](size_t side) {
    return Eigen::Vector2d(static_cast<double>(batch.landing[2 * side][i]),
                           static_cast<double>(batch.landing[2 * side + 1][i]));
  };
  return {{static_cast<double>(batch.displacement_x_m[i]),
           static_cast<double>(batch.displacement_y_m[i])},
          turned_by(batch.w_before[i], batch.z_before[i]),
          turned_by(batch.w_after[i], batch.z_after[i]),
          static_cast<double>(batch.ahead_mps[i]),
          static_cast<double>(batch.scales[i]),
          static_cast<double>(batch.step_s),
          batch.present[i] != 0,
          static_cast<double>(batch.stride_scale[i]),
          {landing_m(0), landing_m(1)}};
}

/// People who walk, turn, step aside, stop, jump and are absent for a while, each differently.
class Walkers {
 public:
  Walkers(uint64_t seed, const Gait& gait, bool stride_scales = false)
      : seed_(seed), varies_strides_(stride_scales) {
    batch_.count = kPeople;
    batch_.step_s = seed % 2 == 0 ? 1.0f / 60 : 1.0f / 30;
    batch_.postures = postures_.data();
    for (size_t i = 0; i < kPeople; ++i) {
      batch_.scales[i] = draw(i, 0, 9, 0.7, 1.2);
      batch_.phases[i] = draw(i, 0, 8, 0, 1);
      batch_.gait_mps[i] = kNotEntered;
      batch_.w_after[i] = 1;
      batch_.gaits[i] = &gait;
    }
  }

  void step(uint64_t frame, SimdTarget target) {
    for (size_t i = 0; i < kPeople; ++i) {
      const uint64_t stage = frame / 20;
      const bool stands = draw(i, stage, 4, 0, 1) < 0.15f;
      const float ahead = stands ? 0 : draw(i, stage, 0, -0.4, 2.2);
      const float left = draw(i, stage, 5, 0, 1) < 0.6f ? 0 : draw(i, stage, 1, -0.5, 0.5);
      const float turn = draw(i, stage, 6, 0, 1) < 0.3f ? 0 : draw(i, stage, 2, -1.5, 1.5);
      const float jump = draw(i, frame, 7, 0, 1) < 0.002f ? 100.0f : 1.0f;
      batch_.present[i] = draw(i, stage, 3, 0, 1) < 0.95f;
      batch_.stride_scale[i] =
          varies_strides_ && draw(i, stage, 10, 0, 1) < 0.3f ? draw(i, stage, 11, 0.7, 1.5) : 1.0f;
      for (uint32_t n = 0; n < 4; ++n)
        batch_.landing[n][i] = varies_strides_ && draw(i, stage, 12, 0, 1) < 0.1f
                                   ? draw(i, stage, 13 + n, -0.06, 0.06)
                                   : 0;
      batch_.ahead_mps[i] = ahead;
      batch_.w_before[i] = batch_.w_after[i];
      batch_.z_before[i] = batch_.z_after[i];
      const double heading = turned_by(batch_.w_before[i], batch_.z_before[i]);
      const double after = heading + static_cast<double>(turn * batch_.step_s);
      batch_.w_after[i] = static_cast<float>(std::cos(0.5 * after));
      batch_.z_after[i] = static_cast<float>(std::sin(0.5 * after));
      const Eigen::Vector2d displacement =
          Eigen::Rotation2Dd(0.5 * (heading + after)) *
          Eigen::Vector2d(static_cast<double>(ahead), static_cast<double>(left)) *
          static_cast<double>(jump * batch_.step_s);
      batch_.displacement_x_m[i] = static_cast<float>(displacement.x());
      batch_.displacement_y_m[i] = static_cast<float>(displacement.y());
    }
    Gait::walk(batch_, target);
  }

  const WalkBatch& batch() const { return batch_; }

 private:
  float draw(size_t person, uint64_t stage, uint32_t what, double low, double high) const {
    return static_cast<float>(
        random_uniform({seed_, person, stage, Purpose::kBoxWorld}, low, high, what));
  }

  uint64_t seed_;
  bool varies_strides_;
  WalkBatch batch_{};
  std::array<WalkPosture, kPeople> postures_;
};

constexpr double kMaxHeelRaise_rad = 0.4;

/// Returns the pitch of a foot's rotation from the zero posture: toes up positive.
double pitch_of(const Eigen::Matrix3d& turn) {
  const Eigen::Vector3d left = turn.col(1);
  const Eigen::Vector3d forward = left.cross(Eigen::Vector3d::UnitZ()).normalized();
  return std::atan2(turn.col(0).dot(forward.cross(left)), turn.col(0).dot(forward));
}

/// Returns whether the ankle is at its limit with the toes down.
bool is_at_limit(const Walking& w, std::span<const float> row, size_t side) {
  const auto& kinematics = w.model->kinematics;
  const auto column = static_cast<size_t>(
      kinematics.column_of(side == 0 ? "right_ankle_flexion" : "left_ankle_flexion"));
  const JointColumn& limits = kinematics.columns()[column];
  return row[column] < limits.lower + 1e-4f || row[column] > limits.upper - 1e-4f;
}

struct Worst {
  double value = 0;
  uint64_t seed = 0, frame = 0;
  size_t person = 0;
  int compared = 0;
  void take(double found, uint64_t in_seed, uint64_t in_frame, size_t who) {
    ++compared;
    if (!(found <= value)) *this = {found, in_seed, in_frame, who, compared};
  }
  void expect_below(double bound, const char* what) const {
    std::printf("%s: off by %.2g at most, allowed %.2g; seed %llu, frame %llu, person %zu, of %d\n",
                what, value, bound, static_cast<unsigned long long>(seed),
                static_cast<unsigned long long>(frame), person, compared);
    EXPECT_LE(value, bound) << what << ": seed " << seed << ", frame " << frame << ", person "
                            << person;
  }
};

class SteppingOracleTest : public testing::TestWithParam<GaitStyle> {
 protected:
  const Walking& walking() const { return Walking::styles()[static_cast<size_t>(GetParam())]; }
  /// Alternates between SIMD and the reference.
  static SimdTarget target_of(uint64_t seed) {
    return seed % 3 == 0 ? SimdTarget::kScalar : resolved(SimdTarget::kBest);
  }

  const SteppingOracle oracle_{*walking().model, GetParam(),
                               static_cast<double>(walking().gait.upright_radius_m())};
};

/// Each step starts from the last result of stepping; errors do not accumulate.
TEST_P(SteppingOracleTest, PlacesFeetLikeTheOracle) {
  Worst shift, turn, lift, phase, speed, cycles, swing;
  int taken_back = 0, turning_points = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Walkers walkers(seed, walking().gait, true);
    const WalkBatch& batch = walkers.batch();
    for (uint64_t frame = 0; frame < kFrames; ++frame) {
      std::array<OracleState, kPeople> before;
      for (size_t i = 0; i < kPeople; ++i) before[i] = state_of(batch, i);
      walkers.step(frame, target_of(seed));
      for (size_t i = 0; i < kPeople; ++i) {
        const OracleMotion motion = motion_of(batch, i);
        const OracleState expected = oracle_.step(before[i], motion), found = state_of(batch, i);
        speed.take(std::abs(expected.gait_mps - found.gait_mps), seed, frame, i);
        if (!motion.is_present) {
          EXPECT_EQ(expected.phase, found.phase);
          continue;
        }
        if (oracle_.is_at_a_turning_point(before[i], expected, motion)) {
          ++turning_points;
          continue;
        }
        cycles.take(std::abs(expected.cadence_hz - found.cadence_hz), seed, frame, i);
        phase.take(std::abs(std::remainder(expected.phase - found.phase, 1.0)), seed, frame, i);
        if (batch.out_of_reach[i] != 0) {  // unreachable shifts are reduced, never increased
          ++taken_back;
          for (size_t side = 0; side < 2; ++side)
            EXPECT_LE(found.feet[side].shift_m.norm(),
                      expected.feet[side].shift_m.norm() + kFootBound_m);
          continue;
        }
        for (size_t side = 0; side < 2; ++side) {
          const OracleFoot &is = found.feet[side], &should = expected.feet[side];
          shift.take((is.shift_m - should.shift_m).norm(), seed, frame, i);
          turn.take(std::abs(is.turn_rad - should.turn_rad), seed, frame, i);
          lift.take(std::abs(is.lift_m - should.lift_m), seed, frame, i);
          const double left = 1 - std::fmod(expected.phase + (side == 0 ? 0 : 0.5), 1.0);
          swing.take(left * (is.speed - should.speed).norm(), seed, frame, i);
        }
      }
    }
  }
  shift.expect_below(kFootBound_m, "shift of a foot, m");
  turn.expect_below(kTurnBound_rad, "turn of a foot, rad");
  lift.expect_below(kFootBound_m, "lift of a foot, m");
  phase.expect_below(kPhaseBound, "phase");
  cycles.expect_below(kCyclesBound_ps, "cycles per second");
  swing.expect_below(kSwingBound, "remaining change of a foot in the air, m or rad");
  speed.expect_below(1e-5, "gait's speed, m/s");
  std::printf("%d taken back, %d turning points\n", taken_back, turning_points);
  EXPECT_GT(shift.compared, 15 * (taken_back + turning_points)) << "too few comparisons";
}

/// Cadence and pelvis drop change within their limits for any motion.
TEST_P(SteppingOracleTest, LimitsChangesOfCadenceAndPelvisDrop) {
  constexpr double kCadenceChange_hz_ps = 14, kMaxDropSpeed_mps = 0.12,
                   kMaxDropAcceleration_mps2 = 1.5;
  Worst cycles, sinking, sunk;
  int sank = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Walkers walkers(seed, walking().gait, true);
    const WalkBatch& batch = walkers.batch();
    const auto now = [&](size_t what, size_t i) {
      return static_cast<double>(batch.gait_rates[what][i]);
    };
    for (uint64_t frame = 0; frame < kFrames; ++frame) {
      std::array<std::array<double, 3>, kPeople> before;
      for (size_t i = 0; i < kPeople; ++i)
        before[i] = {now(WalkBatch::kCadence, i), now(WalkBatch::kPelvisDrop, i),
                     now(WalkBatch::kPelvisDropSpeed, i)};
      walkers.step(frame, target_of(seed));
      const auto step_s = static_cast<double>(batch.step_s);
      for (size_t i = 0; i < kPeople; ++i) {
        // After entering there is no cadence yet; without valid legs, the gait's are used.
        const bool has_pace = before[i][0] >= 0 && now(WalkBatch::kCadence, i) >= 0;
        if (batch.present[i] == 0 || !has_pace || batch.out_of_reach[i] != 0) continue;
        cycles.take(std::abs(now(WalkBatch::kCadence, i) - before[i][0]) / step_s, seed, frame, i);
        sunk.take(std::abs(now(WalkBatch::kPelvisDrop, i) - before[i][1]) / step_s, seed, frame, i);
        sinking.take(std::abs(now(WalkBatch::kPelvisDropSpeed, i) - before[i][2]) / step_s, seed,
                     frame, i);
        sank += now(WalkBatch::kPelvisDrop, i) > 0;
      }
    }
  }
  constexpr double kRounding = 1e-3;
  cycles.expect_below(kCadenceChange_hz_ps + kRounding, "change of cadence, cycles/s2");
  sunk.expect_below(kMaxDropSpeed_mps + kRounding, "pelvis drop speed, m/s");
  sinking.expect_below(kMaxDropAcceleration_mps2 + kRounding, "pelvis drop acceleration, m/s2");
  EXPECT_GT(sank, 1000) << "too few pelvis drops";
}

/// Uses forward kinematics of the whole row; independent of the leg solver.
TEST_P(SteppingOracleTest, PutsAnklesOverTheFeet) {
  const Walking& w = walking();
  std::vector<float> row(static_cast<size_t>(w.gait.column_count()));
  const std::array<size_t, 2> parts = {w.right_foot, w.left_foot};
  const std::vector<PartPose> zero = w.poses(std::vector<float>(row.size()));
  Worst aside, above, below, heading;
  int lowered = 0, too_far = 0, flat = 0, raised = 0, tilted = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Walkers walkers(seed, w.gait);
    const WalkBatch& batch = walkers.batch();
    for (uint64_t frame = 0; frame < kFrames; ++frame) {
      walkers.step(frame, target_of(seed));
      if (frame % 10 != 9) continue;
      for (uint32_t i = 0; i < kPeople; ++i) {
        if (batch.present[i] == 0 || batch.gait_mps[i] < 0 || batch.out_of_reach[i] != 0) continue;
        const Gait* gait = &w.gait;
        Gait::postures({&gait, 1}, {batch.postures, kPeople}, {&i, 1}, row);
        const std::vector<PartPose> poses = w.poses(row);
        const OracleState state = state_of(batch, i);
        const auto drop_m = static_cast<double>(batch.postures[i].numbers[WalkPosture::kDrop]);
        lowered += drop_m > 0;
        for (size_t side = 0; side < 2; ++side) {
          const auto scale = static_cast<double>(batch.scales[i]);
          const Eigen::Isometry3d foot = to_isometry(poses[parts[side]]);
          const Eigen::Matrix3d turn =
              foot.linear() * to_isometry(zero[parts[side]]).linear().transpose();
          const SteppingOracle::Ankle natural = oracle_.ankle(state, scale, side, 0);
          // A heel is raised only where the leg would be too short, and not farther.
          double raise_rad = natural.pitch_rad - pitch_of(turn);
          if (std::abs(raise_rad) < 1e-4) raise_rad = 0;
          const bool may_rise =
              natural.is_behind && natural.from_hip_m > oracle_.max_reach_m(side) - 1e-3;
          if (raise_rad != 0 && (!may_rise || is_at_limit(w, row, side))) {  // tilts the foot
            ++tilted;
            continue;
          }
          raised += raise_rad > 0;
          EXPECT_LE(raise_rad, kMaxHeelRaise_rad + 1e-4);
          const SteppingOracle::Ankle expected =
              oracle_.ankle(state, scale, side, drop_m, raise_rad);
          // A pelvis that is still sinking leaves the foot away from its place.
          if (expected.from_hip_m > oracle_.max_reach_m(side) - kHeightBound_m) {
            ++too_far;
            continue;
          }
          const Eigen::Vector3d off_m = foot.translation() - expected.at_m;
          const double higher_m = off_m.dot(expected.up);
          aside.take((off_m - higher_m * expected.up).norm(), seed, frame, i);
          above.take(higher_m - expected.too_high_m, seed, frame, i);
          below.take(-higher_m - expected.too_low_m, seed, frame, i);
          flat += expected.too_low_m == 0;
          const Eigen::Vector3d left = turn * Eigen::Vector3d::UnitY();
          heading.take(std::abs(std::remainder(
                           std::atan2(-left.x(), left.y()) - expected.heading_rad, 6.283185307)),
                       seed, frame, i);
        }
      }
    }
  }
  aside.expect_below(kAsideBound_m, "ankle aside of the foot, m");
  above.expect_below(kHeightBound_m, "ankle higher than the sole explains, m");
  below.expect_below(kHeightBound_m, "ankle lower than the sole explains, m");
  heading.expect_below(kHeadingBound_rad, "heading of a foot, rad");
  EXPECT_GT(flat, 1000) << "too few flat feet";
  EXPECT_GT(lowered, 0) << "no pelvis ever sank";
  EXPECT_GT(raised, 100) << "too few raised heels";
  EXPECT_GT(aside.compared, 10 * tilted);
  EXPECT_GT(aside.compared, 10 * too_far);
}

INSTANTIATE_TEST_SUITE_P(Styles, SteppingOracleTest,
                         testing::Values(GaitStyle::kPlain, GaitStyle::kShortSteps));

}  // namespace
}  // namespace throng::stepping_oracle_test
