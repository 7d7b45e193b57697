// Parts of people near each other in a run, held against triangles: whatever touches must be
// reported in that frame.
// One rule: only near pairs count, those whose axis-aligned boxes, widened by a centimetre,
// overlap; of the others the boxes prove that they are apart.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "culling/exact/triangle_bvh.h"
#include "kinematics/kinematics.h"
#include "scenes/run/simulation.h"

namespace throng::test {

class NearPeople {
 public:
  /// Of a run with postures; `run` is to outlive this.
  explicit NearPeople(const Simulation& run);
  /// Compares all avatars with each other, as they are after a step.
  void check(const Frame& frame);

  uint64_t near = 0, touching = 0, missed = 0;
  std::string first_miss;

 private:
  struct Box {
    Eigen::Vector3f low, high;
    bool is_near(const Box& other, const Eigen::Vector3f& shift_m) const;
  };
  struct Avatar {
    std::vector<PartPose> poses;
    std::vector<Box> boxes;
    Box all;
  };

  void place(const Frame& frame, uint32_t id);
  void compare(const Frame& frame, uint32_t a, uint32_t b);

  const Simulation& run_;
  std::vector<std::vector<TriangleBvh>> surfaces_;  ///< by model, then by part
  std::vector<Avatar> avatars_;
};

}  // namespace throng::test
