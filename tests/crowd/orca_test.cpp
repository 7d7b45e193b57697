// Tests of ORCA: the linear program against dense sampling, and avoidance against moving discs.
#include "crowd/steering/orca.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/crowd/steering_draws.h"

namespace throng::orca_test {
namespace {

constexpr float kMaxSpeed_mps = 1.6f;
/// Rounding of single precision and kTiny_mps.
constexpr float kRounding_mps = 3e-5f;
constexpr int kRings = 120;
constexpr int kSpokes = 240;
/// Largest distance of a velocity in the disc from the nearest sample.
constexpr float kSpacing_mps = 0.5f * (kMaxSpeed_mps / kRings + 6.3f * kMaxSpeed_mps / kSpokes);

struct Case {
  std::vector<HalfPlane> planes;
  int hard = 0;
  Eigen::Vector2f preferred_mps;
};

Case random_case(uint64_t seed, double tightest_mps, double loosest_mps) {
  Case c;
  uint64_t id = 0;
  c.hard = static_cast<int>(uniform(seed, id++, 0, 4));
  const int soft = static_cast<int>(uniform(seed, id++, 0, 11));
  for (int i = 0; i < c.hard + soft; ++i) {
    HalfPlane plane;
    plane.normal = polar(1, uniform(seed, id++, -3.14, 3.14));
    plane.offset_mps =
        i < c.hard ? uniform(seed, id++, -1.2, 0) : uniform(seed, id++, loosest_mps, tightest_mps);
    c.planes.push_back(plane);
  }
  c.preferred_mps = polar(uniform(seed, id, 0, 1.5), uniform(seed, id + 1, -3.14, 3.14));
  return c;
}

float worst(std::span<const HalfPlane> planes, const Eigen::Vector2f& v) {
  float value = 0;
  for (const HalfPlane& plane : planes) value = std::max(value, plane.violation_mps(v));
  return value;
}

/// Results of sampling: the feasible velocity nearest to the preferred one, and the least worst
/// violation of soft planes within the hard ones.
struct Sampled {
  bool feasible = false;
  float nearest_mps = 1e9f;
  float min_violation_mps = 1e9f;
};

Sampled sample(const Case& c) {
  Sampled out;
  const std::span<const HalfPlane> planes(c.planes);
  const auto hard = static_cast<size_t>(c.hard);
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int spoke = 0; spoke < (ring == 0 ? 1 : kSpokes); ++spoke) {
      const Eigen::Vector2f v = polar(kMaxSpeed_mps * static_cast<float>(ring) / kRings,
                                      6.2831853f * static_cast<float>(spoke) / kSpokes);
      if (worst(planes.first(hard), v) > 0) continue;
      const float soft = worst(planes.subspan(hard), v);
      out.min_violation_mps = std::min(out.min_violation_mps, soft);
      if (soft > 0) continue;
      out.feasible = true;
      out.nearest_mps = std::min(out.nearest_mps, (v - c.preferred_mps).norm());
    }
  }
  return out;
}

TEST(Orca, ChoosesTheNearestFeasibleVelocity) {
  int feasible = 0;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case c = random_case(seed, 0.4, -1.5);
    const Sampled oracle = sample(c);
    if (!oracle.feasible) continue;
    ++feasible;
    const Eigen::Vector2f v = choose_velocity(c.planes, c.hard, c.preferred_mps, kMaxSpeed_mps);
    EXPECT_LE(worst(c.planes, v), kRounding_mps);
    EXPECT_LE(v.norm(), kMaxSpeed_mps + kRounding_mps);
    const float found_mps = (v - c.preferred_mps).norm();
    // No sample may be nearer. Samples come near unless the feasible set is a sliver.
    EXPECT_LE(found_mps, oracle.nearest_mps + kRounding_mps)
        << "a sample is nearer by " << found_mps - oracle.nearest_mps << " m/s";
  }
  EXPECT_GT(feasible, 150) << "the cases no longer exercise the feasible branch";
}

TEST(Orca, MinimisesViolationsOfInfeasiblePlanes) {
  int infeasible = 0;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case c = random_case(seed, 1.2, -0.3);
    const Sampled oracle = sample(c);
    if (oracle.feasible || oracle.min_violation_mps < kSpacing_mps) continue;
    ++infeasible;
    const Eigen::Vector2f v = choose_velocity(c.planes, c.hard, c.preferred_mps, kMaxSpeed_mps);
    const std::span<const HalfPlane> planes(c.planes);
    const auto hard = static_cast<size_t>(c.hard);
    EXPECT_LE(worst(planes.first(hard), v), kRounding_mps) << "a wall was given up";
    EXPECT_LE(v.norm(), kMaxSpeed_mps + kRounding_mps);
    const float found_mps = worst(planes.subspan(hard), v);
    EXPECT_LE(found_mps, oracle.min_violation_mps + kRounding_mps)
        << "a sample violates less by " << found_mps - oracle.min_violation_mps << " m/s";
    EXPECT_GE(found_mps, oracle.min_violation_mps - kSpacing_mps);
  }
  EXPECT_GT(infeasible, 150) << "the cases no longer exercise the infeasible branch";
}

/// Two discs that choose on the border of avoidance_plane() do not meet within the horizon.
TEST(Orca, AvoidsCollisionsWithinTheHorizon) {
  int collisions_if_ignored = 0;
  for (uint64_t seed = 1; seed <= 5000; ++seed) {
    Encounter a;
    a.offset_m = polar(uniform(seed, 0, 0.5, 4), uniform(seed, 1, -3.14, 3.14));
    a.own_velocity_mps = polar(uniform(seed, 2, 0, 1.5), uniform(seed, 3, -3.14, 3.14));
    a.other_velocity_mps = polar(uniform(seed, 4, 0, 1.5), uniform(seed, 5, -3.14, 3.14));
    a.radius_m = 0.44f;
    Encounter b = a;
    b.offset_m = -a.offset_m;
    std::swap(b.own_velocity_mps, b.other_velocity_mps);
    const auto obey = [](const Encounter& e) -> Eigen::Vector2f {
      const HalfPlane plane = avoidance_plane(e);
      const float violation = plane.violation_mps(e.own_velocity_mps);
      return violation > 0 ? Eigen::Vector2f(e.own_velocity_mps + violation * plane.normal)
                           : e.own_velocity_mps;
    };
    const auto closest_m = [&](const Eigen::Vector2f& velocity) {
      float closest = 1e9f;
      for (int i = 0; i <= 400; ++i) {
        const float t = a.horizon_s * static_cast<float>(i) / 400;
        closest = std::min(closest, (a.offset_m - t * velocity).norm());
      }
      return closest;
    };
    collisions_if_ignored += closest_m(a.own_velocity_mps - a.other_velocity_mps) < a.radius_m;
    const float closest = closest_m(obey(a) - obey(b));
    EXPECT_GE(closest, a.radius_m - 1e-4f)
        << "seed " << seed << ": closer by " << a.radius_m - closest << " m";
  }
  EXPECT_GT(collisions_if_ignored, 100) << "too few cases would have collided at all";
}

TEST(Orca, SeparatesOverlappingDiscsWithinAStep) {
  Encounter e;
  e.offset_m = {0.3f, 0};
  e.own_velocity_mps = e.other_velocity_mps = Eigen::Vector2f::Zero();
  e.radius_m = 0.44f;
  e.step_s = 0.1f;
  const HalfPlane plane = avoidance_plane(e);
  EXPECT_NEAR(plane.normal.x(), -1, 1e-6);
  // Half of the missing 0.14 m, in 0.1 s.
  EXPECT_NEAR(plane.offset_mps, 0.7, 1e-5);
}

TEST(Orca, AllowsStandingStillAtEveryWall) {
  for (const float clearance_m : {-0.2f, 0.0f, 0.1f, 2.0f}) {
    const HalfPlane wall = wall_plane(Eigen::Vector2f::UnitY(), clearance_m, 0.5f);
    EXPECT_LE(wall.violation_mps(Eigen::Vector2f::Zero()), 0)
        << "clearance " << clearance_m << " m";
  }
}

}  // namespace
}  // namespace throng::orca_test
