// The no-miss guarantee on the adult body: parts whose triangles touch overlap in every volume.
// Tests random and walking postures, all pairs of parts, random scales, from just touching to just
// apart. Prints the false positives of the volumes.
#include <fcl/fcl.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <tuple>

#include "avatars/avatars.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/volumes/pose_math.h"
#include "culling/volumes/volume_list.h"
#include "shapes.h"

namespace throng::test::no_miss_test {
namespace {

constexpr uint64_t kSeed = 20264;
using FclMesh = fcl::BVHModel<fcl::OBBRSSd>;

/// One part with all fitted volumes.
struct FittedPart {
  explicit FittedPart(const Part& part)
      : name(part.name),
        points(part.mesh.vertices),
        reach_m(static_cast<float>(reach_of(part.mesh.vertices))),
        tree(part.mesh.vertices, part.mesh.triangles) {
    for_each_volume(
        [&]<typename V>(VolumeKind) { std::get<kVolumeIndex<V>>(fitted) = V::fit(points); });
    std::vector<Eigen::Vector3d> exact;
    for (const Eigen::Vector3f& p : points) exact.push_back(p.cast<double>());
    std::vector<fcl::Triangle> faces;
    for (const Eigen::Vector3i& t : part.mesh.triangles)
      faces.emplace_back(static_cast<size_t>(t[0]), static_cast<size_t>(t[1]),
                         static_cast<size_t>(t[2]));
    fcl_mesh.beginModel();
    fcl_mesh.addSubModel(exact, faces);
    fcl_mesh.endModel();
  }
  std::string name;
  std::vector<Eigen::Vector3f> points;
  float reach_m;
  TriangleBvh tree;
  decltype([]<size_t... kPlaces>(std::index_sequence<kPlaces...>) {
    return std::tuple<typename VolumeAt<kPlaces>::Fitted...>();
  }(std::make_index_sequence<kVolumeCount>{})) fitted;  ///< ordered as kVolumeList
  FclMesh fcl_mesh;
};

struct PlacedPart {
  const FittedPart* part;
  PartPose pose;
  float scale;
};

/// Result of every volume for two placed parts, by name.
std::map<std::string, bool> verdicts(const PlacedPart& a, const PlacedPart& b,
                                     const Eigen::Vector3f& a_to_b) {
  const float reach = a_to_b.norm() + translation_m(a.pose).norm() + translation_m(b.pose).norm() +
                      a.scale * a.part->reach_m + b.scale * b.part->reach_m;
  const float margin = rounding_margin_m(reach);
  std::map<std::string, bool> out;
  for_each_volume([&]<typename V>(VolumeKind kind) {
    const std::string name(name_of(kind));
    out[name] = V::overlaps(V::place(std::get<kVolumeIndex<V>>(a.part->fitted), a.pose, a.scale),
                            V::place(std::get<kVolumeIndex<V>>(b.part->fitted), b.pose, b.scale),
                            a_to_b, margin);
    if constexpr (RefittedVolume<V>)
      out[name + "_refit"] = V::overlaps(V::refit(a.part->points, a.pose, a.scale),
                                         V::refit(b.part->points, b.pose, b.scale), a_to_b, margin);
  });
  return out;
}

class Body {
 public:
  Body() : model_(load_model(adult_urdf())), gait_(*model_) {
    for (const Part& part : model_->parts) parts_.emplace_back(part);
  }
  const std::vector<FittedPart>& parts() const { return parts_; }
  const Gait& gait() const { return gait_; }

  /// Poses of all parts: random joints within their limits, or a random gait phase.
  std::vector<PartPose> poses(Draw& draw, bool walking, const RootFrame& root) const {
    std::vector<float> posture(static_cast<size_t>(model_->kinematics.column_count()));
    if (walking) {
      const float phase[] = {static_cast<float>(draw.uniform(0, 1))};
      const float speed[] = {static_cast<float>(draw.uniform(0, 2))};
      const float scale[] = {root.scale};
      gait_.postures(phase, speed, scale, posture);
    } else {
      for (size_t i = 0; i < posture.size(); ++i) {
        const JointColumn& column = model_->kinematics.columns()[i];
        posture[i] = static_cast<float>(
            draw.uniform(static_cast<double>(column.lower), static_cast<double>(column.upper)));
      }
    }
    std::vector<PartPose> out(parts_.size());
    forward_kinematics(model_->kinematics, posture, {&root, 1}, out);
    return out;
  }

 private:
  std::shared_ptr<const Model> model_;
  Gait gait_;
  std::vector<FittedPart> parts_;
};

const Body& body() {
  static const Body the_body;
  return the_body;
}

RootFrame random_root(Draw& draw, bool upright) {
  RootFrame root;
  root.scale = static_cast<float>(draw.uniform(0.6, 1.2));
  const double turn = draw.uniform(-std::numbers::pi, std::numbers::pi);
  root.world_from_root =
      upright
          ? Eigen::Quaternionf(
                Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())).cast<float>())
          : draw.rotation().cast<float>();
  return root;
}

/// Counts the pairs that each volume reports. Fails if a volume separates touching parts.
struct Tally {
  int pairs = 0, touching = 0;
  std::map<std::string, int> reported;

  void add(const PlacedPart& a, const PlacedPart& b, const Eigen::Vector3f& a_to_b) {
    TriangleCounters counters;
    const bool truth = solids_touch(a.part->tree, a.pose, a.scale, b.part->tree, b.pose, b.scale,
                                    a_to_b, counters);
    ++pairs;
    touching += truth;
    for (const auto& [volume, overlap] : verdicts(a, b, a_to_b)) {
      reported[volume] += overlap;
      EXPECT_TRUE(overlap || !truth) << volume << " misses " << a.part->name << " against "
                                     << b.part->name << ", pair " << pairs << ", seed " << kSeed;
    }
  }
  void print(const char* what) const {
    std::printf("%s: %d pairs, %d touch; reported per true pair:", what, pairs, touching);
    for (const auto& [volume, count] : reported)
      std::printf(" %s %.2f", volume.c_str(), static_cast<double>(count) / touching);
    std::printf(" (seed %d)\n", static_cast<int>(kSeed));
  }
};

/// Every part against every part, a vertex of one near a vertex of the other.
Tally near_contacts(bool walking, int rounds, uint64_t id) {
  Draw draw(kSeed, id);
  Tally tally;
  const std::vector<FittedPart>& parts = body().parts();
  for (int round = 0; round < rounds; ++round) {
    const RootFrame root_a = random_root(draw, walking), root_b = random_root(draw, walking);
    const std::vector<PartPose> poses_a = body().poses(draw, walking, root_a);
    const std::vector<PartPose> poses_b = body().poses(draw, walking, root_b);
    for (size_t i = 0; i < parts.size(); ++i) {
      for (size_t j = 0; j < parts.size(); ++j) {
        const auto any = [&](const FittedPart& part) {
          return part.points[static_cast<size_t>(
              draw.integer(0, static_cast<int>(part.points.size()) - 1))];
        };
        const Eigen::Vector3d meeting = placed_exactly(poses_a[i], root_a.scale, any(parts[i])) -
                                        placed_exactly(poses_b[j], root_b.scale, any(parts[j]));
        const Eigen::Vector3d from_a_to_b =
            meeting + to_isometry(poses_b[j]).translation() - to_isometry(poses_a[i]).translation();
        // From 1 cm overlap to 12 cm apart.
        const Eigen::Vector3d pull = draw.uniform(-0.01, 0.12) * from_a_to_b.normalized();
        tally.add({&parts[i], poses_a[i], root_a.scale}, {&parts[j], poses_b[j], root_b.scale},
                  (meeting + pull).cast<float>());
      }
    }
  }
  return tally;
}

TEST(NoMiss, HoldsForNearContactsInRandomPostures) {
  const Tally tally = near_contacts(false, 30, 1);
  tally.print("random postures");
  EXPECT_GT(tally.touching, tally.pairs / 10);
  EXPECT_LT(tally.touching, tally.pairs * 9 / 10);
}

TEST(NoMiss, HoldsForNearContactsWhileWalking) {
  const Tally tally = near_contacts(true, 30, 2);
  tally.print("walking postures");
  EXPECT_GT(tally.touching, tally.pairs / 10);
  EXPECT_LT(tally.touching, tally.pairs * 9 / 10);
}

/// Two walking people side by side, as close as in a dense crowd: all 225 pairs of their parts.
TEST(NoMiss, HoldsForWalkersSideBySide) {
  Draw draw(kSeed, 3);
  Tally tally;
  const std::vector<FittedPart>& parts = body().parts();
  for (int round = 0; round < 100; ++round) {
    const RootFrame root_a = random_root(draw, true), root_b = random_root(draw, true);
    const std::vector<PartPose> poses_a = body().poses(draw, true, root_a);
    const std::vector<PartPose> poses_b = body().poses(draw, true, root_b);
    const double bearing = draw.uniform(0, 2 * std::numbers::pi), distance = draw.uniform(0.1, 0.6);
    const Eigen::Vector3f a_to_b(static_cast<float>(distance * std::cos(bearing)),
                                 static_cast<float>(distance * std::sin(bearing)), 0);
    for (size_t i = 0; i < parts.size(); ++i)
      for (size_t j = 0; j < parts.size(); ++j)
        tally.add({&parts[i], poses_a[i], root_a.scale}, {&parts[j], poses_b[j], root_b.scale},
                  a_to_b);
  }
  tally.print("walkers side by side");
  EXPECT_GT(tally.touching, 300);
}

/// The triangle tests that serve as reference agree with FCL on the same parts.
TEST(NoMiss, AgreesWithFclOnTheBody) {
  Draw draw(kSeed, 4);
  const std::vector<FittedPart>& parts = body().parts();
  int touching = 0, inside = 0;
  for (int round = 0; round < 12; ++round) {
    RootFrame root_a = random_root(draw, false), root_b = random_root(draw, false);
    root_a.scale = root_b.scale = 1;
    const std::vector<PartPose> poses_a = body().poses(draw, false, root_a);
    const std::vector<PartPose> poses_b = body().poses(draw, false, root_b);
    for (size_t i = 0; i < parts.size(); ++i) {
      for (size_t j = 0; j < parts.size(); ++j) {
        const Eigen::Vector3d between = to_isometry(poses_a[i]).translation() -
                                        to_isometry(poses_b[j]).translation() +
                                        draw.uniform(0, 0.4) * draw.direction();
        const Eigen::Vector3f a_to_b = between.cast<float>();
        Eigen::Isometry3d world_from_b = to_isometry(poses_b[j]);
        world_from_b.translation() += a_to_b.cast<double>();
        fcl::CollisionResultd result;
        const bool surfaces =
            fcl::collide(&parts[i].fcl_mesh, to_isometry(poses_a[i]), &parts[j].fcl_mesh,
                         world_from_b, fcl::CollisionRequestd(1, false), result) > 0;
        TriangleCounters counters;
        const bool found = solids_touch(parts[i].tree, poses_a[i], 1, parts[j].tree, poses_b[j], 1,
                                        a_to_b, counters);
        ASSERT_TRUE(found || !surfaces)
            << parts[i].name << " against " << parts[j].name << ", seed " << kSeed;
        touching += surfaces;
        inside += found && !surfaces;
      }
    }
  }
  std::printf("FCL: %d pairs of surfaces touch; %d more lie one inside the other\n", touching,
              inside);
  EXPECT_GT(touching, 500);
  EXPECT_LT(inside, touching / 10);
}

/// Broad phase: the sphere of a walking person contains all vertices.
TEST(NoMiss, HoldsForTheSphereOfAWalker) {
  Draw draw(kSeed, 5);
  const Gait& gait = body().gait();
  double closest = 1e30;
  for (int round = 0; round < 300; ++round) {
    const RootFrame root = random_root(draw, true);
    const std::vector<PartPose> poses = body().poses(draw, true, root);
    const double scale = static_cast<double>(root.scale);
    const Eigen::Vector3d centre = scale * gait.sphere_centre_m().cast<double>();  // on the z axis
    for (size_t i = 0; i < poses.size(); ++i)
      for (const Eigen::Vector3f& p : body().parts()[i].points) {
        const double clearance = scale * static_cast<double>(gait.sphere_radius_m()) -
                                 (placed_exactly(poses[i], root.scale, p) - centre).norm();
        closest = std::min(closest, clearance);
        ASSERT_GE(clearance, -1e-5)
            << body().parts()[i].name << ", round " << round << ", seed " << kSeed;
      }
  }
  std::printf("the walker's sphere leaves at least %.1f mm\n", 1000 * closest);
}

}  // namespace
}  // namespace throng::test::no_miss_test
