// RandomBodies is a random world of articulated bodies: blobs as parts, and walls.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <vector>

#include "base/random.h"
#include "culling/culling.h"

namespace throng::test {

/// Counter-based random numbers of a world.
class BodyDraw {
 public:
  explicit BodyDraw(uint64_t seed) : seed_(seed) {}
  double uniform(double low, double high) {
    return random_uniform({.seed = seed_, .id = next_++, .purpose = Purpose::kBoxWorld}, low, high);
  }
  int integer(int low, int high) { return low + static_cast<int>(uniform(0, high - low + 1)); }
  Eigen::Vector3d vector(double extent) {
    return {uniform(-extent, extent), uniform(-extent, extent), uniform(-extent, extent)};
  }
  Eigen::Quaterniond rotation() {
    Eigen::Quaterniond q(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    return q.norm() < 1e-3 ? Eigen::Quaterniond::Identity() : q.normalized();
  }

 private:
  uint64_t seed_;
  uint64_t next_ = 0;
};

/// Closed ellipsoid-like solid (subdivided octahedron) around `centre`.
inline PartShape blob(const Eigen::Vector3f& centre, const Eigen::Vector3f& half) {
  PartShape shape;
  constexpr int kRings = 5, kSegments = 8;
  shape.points.push_back(centre + Eigen::Vector3f(0, 0, half.z()));
  for (int ring = 1; ring < kRings; ++ring) {
    for (int segment = 0; segment < kSegments; ++segment) {
      const float theta = 3.14159265f * static_cast<float>(ring) / kRings;
      const float phi = 2 * 3.14159265f * static_cast<float>(segment) / kSegments;
      shape.points.push_back(centre + Eigen::Vector3f(half.x() * std::sin(theta) * std::cos(phi),
                                                      half.y() * std::sin(theta) * std::sin(phi),
                                                      half.z() * std::cos(theta)));
    }
  }
  shape.points.push_back(centre - Eigen::Vector3f(0, 0, half.z()));
  const int last = static_cast<int>(shape.points.size()) - 1;
  for (int s = 0; s < kSegments; ++s) {
    const int next = (s + 1) % kSegments;
    shape.triangles.emplace_back(0, 1 + s, 1 + next);
    for (int ring = 0; ring + 2 < kRings; ++ring) {
      const int a = 1 + ring * kSegments, b = a + kSegments;
      shape.triangles.emplace_back(a + s, b + s, b + next);
      shape.triangles.emplace_back(a + s, b + next, a + next);
    }
    const int bottom = 1 + (kRings - 2) * kSegments;
    shape.triangles.emplace_back(bottom + s, last, bottom + next);
  }
  return shape;
}

/// Body type of `parts` blobs; part i is at a random reachable position on the root's axis.
inline std::shared_ptr<const BodyType> random_type(BodyDraw& draw, int parts, float size,
                                                   bool is_static) {
  std::vector<PartShape> shapes;
  for (int i = 0; i < parts; ++i) {
    const Eigen::Vector3f half =
        (draw.vector(0.1).cwiseAbs().cast<float>() + Eigen::Vector3f::Constant(0.02f)) * size;
    shapes.push_back(blob((draw.vector(0.1) * double{size}).cast<float>(), half));
  }
  // Parts are posed within 0.6 of the root, and all points are within 0.4 of their part's origin.
  return std::make_shared<BodyType>(std::move(shapes), RootSphere{{0, 0, 0}, 1.1f * size},
                                    is_static);
}

/// Bodies and their part poses in one frame; poses are random within the types' spheres.
class RandomBodies : public PoseSource {
 public:
  RandomBodies(uint64_t seed, int bodies, double extent_m, const Eigen::Vector3d& centre_m) {
    BodyDraw draw(seed);
    types = {random_type(draw, 15, 1, false), random_type(draw, 1, 1, false),
             random_type(draw, 37, 1, false), random_type(draw, 1, 6, true),
             random_type(draw, 2, 0.8f, true)};
    for (int i = 0; i < bodies; ++i) {
      ids.push_back(static_cast<uint32_t>(3 * i + 1));
      const int kind = draw.integer(0, 19);
      type_of.push_back(static_cast<uint16_t>(kind < 12   ? 0
                                              : kind < 15 ? 1
                                              : kind < 17 ? 2
                                              : kind < 18 ? 3
                                                          : 4));
      scales.push_back(static_cast<float>(draw.uniform(0.8, 1.2)));
      const Eigen::Vector3d where = draw.vector(1);
      roots.push_back(
          {centre_m + Eigen::Vector3d(extent_m * where.x(), extent_m * where.y(), 0.3 * where.z()),
           draw.rotation().cast<float>()});
      first_pose.push_back(all_poses.size());
      const float size = type_of.back() == 3 ? 6.0f : type_of.back() == 4 ? 0.8f : 1.0f;
      for (int part = 0; part < types[type_of.back()]->part_count(); ++part) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.linear() = draw.rotation().toRotationMatrix();
        const Eigen::Vector3d offset = draw.vector(1);
        pose.translation() =
            offset.normalized() * (0.6 * draw.uniform(0, 1) * double{size} * double{scales.back()});
        all_poses.push_back(to_part_pose(pose));
      }
    }
  }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    size_t next = 0;
    for (const uint32_t body : bodies)
      for (int part = 0; part < types[type_of[body]]->part_count(); ++part)
        out[next++] = all_poses[first_pose[body] + static_cast<size_t>(part)];
  }

  BodiesView view() const { return {ids, type_of, scales, roots}; }
  const PartPose& pose(size_t body, size_t part) const {
    return all_poses[first_pose[body] + part];
  }

  std::vector<std::shared_ptr<const BodyType>> types;
  std::vector<uint32_t> ids;
  std::vector<uint16_t> type_of;
  std::vector<float> scales;
  std::vector<RootPose> roots;
  std::vector<size_t> first_pose;
  std::vector<PartPose> all_poses;
};

/// View of a world with a random subset of its bodies.
struct Subset {
  Subset(const RandomBodies& world, uint64_t seed) : world_(world) {
    for (size_t i = 0; i < world.ids.size(); ++i) {
      if (random_uniform({.seed = seed, .id = i}) < 0.3) continue;
      index.push_back(static_cast<uint32_t>(i));
      ids.push_back(world.ids[i]);
      types.push_back(world.type_of[i]);
      scales.push_back(world.scales[i]);
      roots.push_back(world.roots[i]);
    }
  }
  struct Source : PoseSource {
    explicit Source(const Subset& s) : subset(s) {}
    void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
      std::vector<uint32_t> mapped;
      for (const uint32_t body : bodies) mapped.push_back(subset.index[body]);
      subset.world_.poses(mapped, out);
    }
    const Subset& subset;
  };
  BodiesView view() const { return {ids, types, scales, roots}; }

  const RandomBodies& world_;
  std::vector<uint32_t> index, ids;
  std::vector<uint16_t> types;
  std::vector<float> scales;
  std::vector<RootPose> roots;
};

}  // namespace throng::test
