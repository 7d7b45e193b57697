// Two custom boxes: apart in the first frame, overlapping in the second.
#include <cstdio>

#include "culling/culling.h"

namespace {

struct Boxes : throng::PoseSource {
  void poses(std::span<const uint32_t> bodies, std::span<throng::PartPose> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i)
      out[i] = throng::to_part_pose(Eigen::Isometry3d::Identity());
  }
};

}  // namespace

int main() {
  throng::PartShape box;
  for (int corner = 0; corner < 8; ++corner)
    box.points.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
  const throng::RootSphere sphere{{0.5f, 0.5f, 0.5f}, 0.9f};
  throng::Workers workers(1);
  throng::Culler culler({std::make_shared<throng::BodyType>(std::vector{box}, sphere, false)}, {},
                        workers);
  const std::vector<uint32_t> ids{0, 1};
  const std::vector<uint16_t> types{0, 0};
  const std::vector<float> scales{1, 1};
  std::vector<throng::RootPose> roots(2);
  for (const double apart_m : {3.0, 0.5}) {
    roots[1].position_m.x() = apart_m;
    culler.step({ids, types, scales, roots}, Boxes());
    std::printf("%g m: %zu pairs\n", apart_m, culler.pairs().size());
  }
  return culler.pairs().size() == 1 ? 0 : 1;
}
