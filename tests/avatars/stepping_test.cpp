// Planted feet stay fixed on curves, on the spot, sideways, starting and stopping, within bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "avatars/gait/gait_curves.h"
#include "avatars/stepping/standing.h"
#include "base/random.h"
#include "tests/avatars/gait_fixture.h"
#include "tests/same_bits.h"

namespace throng::stepping_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::Walking;

/// A walker's velocity and turn rate, in its own axes.
struct Pace {
  float forward_mps = 0;
  float left_mps = 0;
  float turn_radps = 0;
};

/// One adult who walks at changing paces, and the motion of its feet on the ground.
class Path {
 public:
  explicit Path(float start_mps = 0, float step_s = 1.0f / 60) {
    batch_.count = 1;
    batch_.step_s = step_s;
    batch_.scales[0] = batch_.present[0] = batch_.stride_scale[0] = batch_.w_before[0] =
        batch_.w_after[0] = 1;
    batch_.gait_mps[0] = kNotEntered;
    batch_.ahead_mps[0] = start_mps;
    walk();
  }

  void step(const Pace& pace, const QuietStanding& standing = {}) {
    standing_ = standing;
    const double step_s = static_cast<double>(batch_.step_s);
    const double turn = static_cast<double>(pace.turn_radps) * step_s;
    // The chord of an arc.
    const Eigen::Vector2d displacement =
        Eigen::Rotation2Dd(heading_rad_ + 0.5 * turn) *
        Eigen::Vector2d(static_cast<double>(pace.forward_mps) * step_s,
                        static_cast<double>(pace.left_mps) * step_s);
    batch_.displacement_x_m[0] = static_cast<float>(displacement.x());
    batch_.displacement_y_m[0] = static_cast<float>(displacement.y());
    set_turn(batch_.w_before[0], batch_.z_before[0]);
    heading_rad_ += turn;
    set_turn(batch_.w_after[0], batch_.z_after[0]);
    batch_.ahead_mps[0] = pace.forward_mps;
    position_m_ += displacement;
    walk();
  }
  void steps(const Pace& pace, double seconds) {
    for (int i = 0; i < seconds / static_cast<double>(batch_.step_s); ++i) step(pace);
  }
  /// Reaches a pace within a second, because no one turns or goes sideways at once.
  void ease_into(const Pace& pace) {
    const auto steps = static_cast<int>(std::lround(1 / batch_.step_s));
    for (int i = 0; i < steps; ++i) {
      const float share = static_cast<float>(i) * batch_.step_s;
      step({pace.forward_mps, share * pace.left_mps, share * pace.turn_radps});
    }
  }

  /// Returns how far a foot's contact moved on the ground in each stance.
  const std::vector<double>& slides_m() const { return slides_m_; }
  double worst_slide_m() const {
    return std::max(
        {*std::max_element(slid_m_.begin(), slid_m_.end()),
         slides_m_.empty() ? 0 : *std::max_element(slides_m_.begin(), slides_m_.end())});
  }
  int stances() const { return static_cast<int>(slides_m_.size()); }
  double deepest_m() const { return deepest_m_; }
  double highest_planted_m() const { return highest_m_; }
  int out_of_reach() const { return out_of_reach_; }
  const std::vector<float>& row() const { return row_; }
  const std::vector<PartPose>& poses() const { return poses_; }
  /// Returns the maximum offset of a foot from its place in the gait.
  float shift_m() const {
    return std::max(std::hypot(batch_.feet[0][0], batch_.feet[1][0]),
                    std::hypot(batch_.feet[3][0], batch_.feet[4][0]));
  }
  RootBox bounds() const {
    return walking_.gait.box_of({batch_.bounds_x[0], batch_.bounds_y[0]}, 1);
  }

 private:
  void set_turn(float& w, float& z) const {
    w = static_cast<float>(std::cos(0.5 * heading_rad_));
    z = static_cast<float>(std::sin(0.5 * heading_rad_));
  }

  void walk() {
    std::array<WalkPosture, WalkBatch::kCapacity> postures;
    batch_.postures = postures.data();
    batch_.gaits[0] = &walking_.gait;
    batch_.shift_m[0] = standing_.shift_m;
    batch_.breath[0] = standing_.breath;
    Gait::walk(batch_, SimdTarget::kScalar);
    out_of_reach_ += batch_.out_of_reach[0] != 0;
    row_.resize(static_cast<size_t>(walking_.gait.column_count()));
    const uint32_t me = 0;
    Gait::postures({&batch_.gaits[0], 1}, postures, {&me, 1}, row_);
    poses_ = walking_.poses(row_);
    for (size_t side = 0; side < 2; ++side) watch_foot(side);
  }

  bool is_planted(size_t side) const {
    const float speed = batch_.gait_mps[0], phase = batch_.phases[0];
    const double stride = static_cast<double>(walking_.gait.stride_length_m(speed, 1));
    const double mps = static_cast<double>(speed);
    double stance = stance_fraction(0);
    if (mps > 0.01) {
      const double leg = stride * stride / (kStridePerSqrtSpeed * kStridePerSqrtSpeed * mps);
      stance = stance_fraction(mps / leg);
    }
    const float own = side == 0 ? phase : phase + (phase < 0.5f ? 0.5f : -0.5f);
    return static_cast<double>(own) < stance;
  }

  void watch_foot(size_t side) {
    const size_t foot = side == 0 ? walking_.right_foot : walking_.left_foot;
    const auto [lowest, vertex] = walking_.lowest(foot, poses_[foot]);
    deepest_m_ = std::min(deepest_m_, lowest.z());
    if (!is_planted(side)) {
      if (was_planted_[side]) slides_m_.push_back(slid_m_[side]);
      slid_m_[side] = 0;
      was_planted_[side] = false;
      return;
    }
    highest_m_ = std::max(highest_m_, lowest.z());
    Isometry3d root = Isometry3d::Identity();
    root.translate(Vector3d(position_m_.x(), position_m_.y(), 0));
    root.rotate(Eigen::AngleAxisd(heading_rad_, Vector3d::UnitZ()));
    if (was_planted_[side]) {
      const Vector3d is =
          root * (to_isometry(poses_[foot]) *
                  walking_.model->parts[foot].mesh.vertices[contact_[side]].cast<double>());
      slid_m_[side] += (is - was_[side]).head<2>().norm();
    }
    was_planted_[side] = true;
    contact_[side] = vertex;
    was_[side] = root * lowest;
  }

  // Ordered to avoid padding.
  WalkBatch batch_{};
  Eigen::Vector2d position_m_ = Eigen::Vector2d::Zero();
  const Walking& walking_ = Walking::adult();
  double heading_rad_ = 0;
  double deepest_m_ = 0;
  double highest_m_ = 0;
  std::array<size_t, 2> contact_{};
  std::array<double, 2> slid_m_{};
  std::vector<float> row_;
  std::vector<PartPose> poses_;
  std::vector<double> slides_m_;
  std::array<Vector3d, 2> was_;
  int out_of_reach_ = 0;
  QuietStanding standing_;
  std::array<bool, 2> was_planted_{};
};

void expect_firm(const Path& path, const Pace& pace) {
  SCOPED_TRACE(testing::Message() << pace.forward_mps << " m/s ahead, " << pace.left_mps
                                  << " m/s left, " << pace.turn_radps << " rad/s");
  std::printf(
      "%5.2f m/s ahead, %5.2f m/s left, %5.2f rad/s: a foot slides %4.1f mm a step at most\n",
      static_cast<double>(pace.forward_mps), static_cast<double>(pace.left_mps),
      static_cast<double>(pace.turn_radps), 1000 * path.worst_slide_m());
  EXPECT_LT(path.worst_slide_m(), 0.01);
  EXPECT_GT(path.stances(), 4);
  EXPECT_GT(path.deepest_m(), -0.01) << "a foot sinks into the ground";
  EXPECT_LT(path.highest_planted_m(), 0.012) << "a planted foot hovers";
  EXPECT_EQ(path.out_of_reach(), 0);
}

TEST(Stepping, SlidesLessThan1CmOnCurves) {
  for (const float speed : {0.4f, 0.8f, 1.34f, 1.8f})
    for (const float radius_m : {1e6f, 20.0f, 5.0f, 2.0f, 1.0f}) {
      if (speed * speed / radius_m > 2) continue;  // no one leans into so tight a curve
      for (const float side : {1.0f, -1.0f}) {
        const Pace pace{speed, 0, side * speed / radius_m};
        Path path(speed);
        path.ease_into(pace);
        path.steps(pace, 8);
        expect_firm(path, pace);
      }
    }
}

TEST(Stepping, SlidesLessThan1CmOnAnSCurve) {
  for (const float speed : {0.8f, 1.34f})
    for (const float radius_m : {5.0f, 2.0f, 1.0f}) {
      Path path(speed);
      const float turn_radps = speed / radius_m;
      // From one side to the other within half a second, every two seconds.
      for (int i = 0; i < 720; ++i) {
        const float wave = std::sin(static_cast<float>(i) / 240 * 6.2831853f);
        path.step({speed, 0, turn_radps * std::clamp(1.5f * wave, -1.0f, 1.0f)});
      }
      expect_firm(path, {speed, 0, turn_radps});
    }
}

/// A foot is dragged no farther than necessary. Hips follow 1.2 rad/s on the spot.
TEST(Stepping, KeepsTheFeetNearTheirPlaceWhenSpun) {
  Path path(1.2f);
  path.steps({1.2f, 0, 0}, 2);
  path.steps({1.2f, 0, 3}, 6);
  EXPECT_LT(path.worst_slide_m(), 0.2);
  EXPECT_GT(path.stances(), 8);
  Path on_the_spot;
  on_the_spot.ease_into({0, 0, 2});
  on_the_spot.steps({0, 0, 2}, 8);
  EXPECT_LT(on_the_spot.worst_slide_m(), 0.035);
}

TEST(Stepping, StepsOnTheSpotSidewaysAndBackwards) {
  for (const Pace& pace : {Pace{0, 0, 0.5f}, Pace{0, 0, -1}, Pace{0, 0, 1.2f}, Pace{0, 0.2f, 0},
                           Pace{0, -0.5f, 0}, Pace{-0.3f, 0, 0}}) {
    Path path;
    path.ease_into(pace);
    path.steps(pace, 8);
    expect_firm(path, pace);
  }
}

TEST(Stepping, SetsBothFeetDownWhenItStops) {
  Path path;
  for (int round = 0; round < 6; ++round) {
    for (int i = 0; i < 90; ++i)
      path.step({1.3f * std::min(1.0f, static_cast<float>(i) / 60), 0, 0});
    for (int i = 60; i > 0; --i) path.step({1.3f * static_cast<float>(i) / 60, 0, 0});
    path.steps({}, 4);
    const std::vector<float> standing = path.row();
    path.steps({}, 0.3);
    EXPECT_EQ(path.row(), standing) << "a standing person moves";
  }
  expect_firm(path, {1.3f, 0, 0});
}

TEST(Stepping, EqualsTheGaitOnAStraightPathAtConstantSpeed) {
  for (const float speed : {0.3f, 0.5f, 1.0f, 1.34f, 1.8f, 2.2f}) {
    Path path(speed);
    for (int i = 0; i < 600; ++i) {
      path.step({speed, 0, 0});
      ASSERT_LT(path.shift_m(), 2e-4f) << speed << " m/s, step " << i;
    }
  }
}

/// No-miss guarantee: the precomputed bounds contain every pose of stepping.
TEST(Stepping, StaysWithinBoundsAndJointLimitsOnAWildWalk) {
  const Walking& walking = Walking::adult();
  const std::vector<JointColumn>& columns = walking.model->kinematics.columns();
  const Eigen::Vector3f centre = walking.gait.sphere_centre_m();
  int shifted = 0, rejected = 0;
  for (uint64_t seed = 1; seed <= 24; ++seed) {
    Path path(0, 1.0f / 30);
    for (uint64_t i = 0; i < 150; ++i) {
      const auto draw = [&](uint32_t index, double low, double high) {
        return static_cast<float>(
            random_uniform({seed, i / 9, 0, Purpose::kBoxWorld}, low, high, index));
      };
      const bool strolls = draw(5, 0, 1) < 0.3f;
      const QuietStanding standing{draw(3, -kMaxShift_m, kMaxShift_m), draw(4, 0, 1)};
      path.step({draw(0, -0.5, strolls ? 0.5 : 2.6), draw(1, -0.8, 0.8), draw(2, -3, 3)}, standing);
      shifted += path.shift_m() > 0.01f;
      for (size_t c = 0; c < columns.size(); ++c) {
        ASSERT_GE(path.row()[c], columns[c].lower) << columns[c].name << ", seed " << seed;
        ASSERT_LE(path.row()[c], columns[c].upper) << columns[c].name << ", seed " << seed;
      }
      const RootBox box = path.bounds();
      for (size_t part = 0; part < path.poses().size(); ++part) {
        const Eigen::Isometry3f pose = to_isometry(path.poses()[part]).cast<float>();
        for (const Eigen::Vector3f& vertex : walking.model->parts[part].mesh.vertices) {
          const Eigen::Vector3f p = pose * vertex;
          const std::string where = walking.model->parts[part].name + ", seed " +
                                    std::to_string(seed) + ", step " + std::to_string(i);
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GE(p[axis], box.min_m[axis]) << where << ", axis " << axis;
            ASSERT_LE(p[axis], box.max_m[axis]) << where << ", axis " << axis;
          }
          ASSERT_LE(p.head<2>().norm(), walking.gait.upright_radius_m()) << where;
          ASSERT_LE((p - centre).norm(), walking.gait.sphere_radius_m()) << where;
        }
      }
    }
    rejected += path.out_of_reach();
  }
  EXPECT_GT(shifted, 3000) << "the walk was not wild";
  EXPECT_LT(rejected, shifted / 20);
}

TEST(Stepping, IsEqualOnAllTargets) {
  const Walking& walking = Walking::adult();
  const Gait other(*walking.model, GaitStyle::kShortSteps);
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    WalkBatch start{};
    start.count = 1 + 9 * seed % WalkBatch::kCapacity;
    start.step_s = 1.0f / 30;
    std::vector<WalkBatch> chunks(simd_targets_of_this_machine().size(), start);
    std::vector<std::array<WalkPosture, WalkBatch::kCapacity>> postures(chunks.size());
    for (size_t target = 0; target < chunks.size(); ++target)
      chunks[target].postures = postures[target].data();
    for (uint64_t frame = 0; frame < 60; ++frame)
      for (size_t target = 0; target < chunks.size(); ++target) {
        WalkBatch& batch = chunks[target];
        for (size_t i = 0; i < batch.count; ++i) {
          const auto draw = [&](uint32_t index, double low, double high) {
            return static_cast<float>(
                random_uniform({seed, i, frame / 7, Purpose::kBoxWorld}, low, high, index));
          };
          if (frame == 0) {
            batch.scales[i] = draw(9, 0.6, 1.2);
            batch.phases[i] = draw(8, 0, 1);
            batch.gait_mps[i] = kNotEntered;
            batch.w_after[i] = 1;
            batch.gaits[i] = i % 3 == 0 ? &walking.gait : &other;
          }
          batch.present[i] = draw(7, 0, 1) < 0.95f;
          batch.stride_scale[i] = draw(10, 0.6, 1.7);
          batch.ahead_mps[i] = draw(0, -0.5, 2.5);
          batch.shift_m[i] = draw(11, -kMaxShift_m, kMaxShift_m);
          batch.breath[i] = draw(12, 0, 1);
          batch.w_before[i] = batch.w_after[i];
          batch.z_before[i] = batch.z_after[i];
          const Eigen::Quaternionf turn =
              Eigen::Quaternionf(batch.w_after[i], 0, 0, batch.z_after[i]) *
              Eigen::AngleAxisf(draw(1, -0.1, 0.1), Eigen::Vector3f::UnitZ());
          batch.w_after[i] = turn.w();
          batch.z_after[i] = turn.z();
          const float jump = draw(5, 0, 1) < 0.01f ? 40.0f : 1.0f;
          batch.displacement_x_m[i] = jump * draw(2, -0.06, 0.06);
          batch.displacement_y_m[i] = jump * draw(3, -0.06, 0.06);
        }
        Gait::walk(batch, simd_targets_of_this_machine()[target]);
        const WalkBatch& reference = chunks.front();
        for (size_t i = 0; i < batch.count; ++i) {
          ASSERT_TRUE(same_bits(batch.postures[i].numbers, reference.postures[i].numbers))
              << name_of(simd_targets_of_this_machine()[target]) << ", seed " << seed << ", lane "
              << i << ", frame " << frame;
          ASSERT_EQ(batch.feet_of(i), reference.feet_of(i));
          for (size_t n = 0; n < WalkBatch::kGaitRateCount; ++n)
            ASSERT_EQ(batch.gait_rates[n][i], reference.gait_rates[n][i]) << "momentum " << n;
          ASSERT_EQ(batch.bounds_x[i], reference.bounds_x[i]);
          ASSERT_EQ(batch.bounds_y[i], reference.bounds_y[i]);
          ASSERT_EQ(batch.phases[i], reference.phases[i]);
          ASSERT_EQ(batch.gait_mps[i], reference.gait_mps[i]);
        }
      }
  }
}

}  // namespace
}  // namespace throng::stepping_test
