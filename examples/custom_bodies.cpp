// Custom bodies and poses with culling alone. A body with a swinging arm passes another one.
#include <cstdio>

#include "culling/culling.h"

using namespace throng;

PartShape box(float x, float y, float z) {
  PartShape shape;  // points suffice; exact contacts need triangles
  for (int i = 0; i < 8; ++i)
    shape.points.emplace_back(i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z);
  return shape;
}

struct Skeleton : PoseSource {
  std::vector<RootPose> roots{2};
  double swing_rad = 0;
  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    const Eigen::Isometry3d trunk(Eigen::Translation3d(0, 0, 1.2));
    const Eigen::Isometry3d shoulder(Eigen::Translation3d(0, 0.3, 0.3));
    const Eigen::AngleAxisd swing(swing_rad, Eigen::Vector3d::UnitY());
    for (size_t i = 0; i < bodies.size(); ++i) {  // in world axes, relative to the root
      const Eigen::Isometry3d root(roots[bodies[i]].world_from_root.cast<double>());
      out[2 * i] = to_part_pose(root * trunk);
      out[2 * i + 1] = to_part_pose(root * trunk * shoulder * swing);
    }
  }
};

int main() {
  const std::vector parts{box(0.15f, 0.25f, 0.4f), box(0.05f, 0.05f, 0.4f)};
  const RootSphere sphere{{0, 0, 1.2f}, 1};  // encloses all postures
  Workers workers(1);
  Culler culler({std::make_shared<BodyType>(parts, sphere, false)}, {}, workers);
  const std::vector<uint32_t> ids{0, 1};
  const std::vector<uint16_t> types{0, 0};
  const std::vector<float> scales{1, 1};
  Skeleton skeleton;
  skeleton.roots[1].position_m = {2, 0.55, 0};
  for (int frame = 0; frame < 60; ++frame) {
    skeleton.roots[0].position_m.x() = 0.06 * frame;
    skeleton.swing_rad = 0.02 * (frame % 40 < 20 ? frame % 40 : 40 - frame % 40);
    culler.step({ids, types, scales, skeleton.roots}, skeleton);
    for (const auto& [pair, kind, level] : culler.events())
      std::printf("frame %2d: part %u of %u %s part %u of %u\n", frame, pair.part_a(), pair.a(),
                  kind == EventKind::kBegin ? "touches" : "leaves", pair.part_b(), pair.b());
  }
}
