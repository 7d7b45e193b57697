// PersonPairs compares the contacts and proximity rows of a run with exact triangle tests.
// It tests pairs whose axis-aligned boxes overlap when widened by 1 cm plus the margin; all other
// pairs are proven farther apart.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "culling/triangles/triangle_bvh.h"
#include "kinematics/kinematics.h"
#include "scenes/run/simulation.h"
#include "tests/culling/proximity_oracle.h"

namespace throng::test {

class PersonPairs {
 public:
  /// `run`: with postures, and with this margin if it is not 0; it has to outlive this object.
  explicit PersonPairs(const Simulation& run, float proximity_m = 0);
  /// Compares all avatars after a step.
  void check(const Frame& frame);

  uint64_t tested = 0, touching = 0, missed = 0;
  std::string first_miss;
  ProximityTally rows;  ///< only for runs with a margin

 private:
  struct Box {
    Eigen::Vector3f low, high;
    float gap_m(const Box& other, const Eigen::Vector3f& shift_m) const;
  };
  struct Avatar {
    std::vector<PartPose> poses;
    std::vector<Box> boxes;
    Box all;
  };

  void place(const Frame& frame, uint32_t id);
  void compare(const Frame& frame, uint32_t a, uint32_t b);
  bool touch(uint32_t a, uint32_t i, uint32_t b, uint32_t j, const Eigen::Vector3f& a_to_b);

  const Simulation& run_;
  float margin_m_;
  float reach_m_;                                   ///< maximum distance of compared boxes
  std::vector<std::vector<TriangleBvh>> surfaces_;  ///< indexed by model, then by part
  std::vector<std::vector<DistanceTree>> trees_;    ///< the same; only for runs with a margin
  std::vector<Avatar> avatars_;
};

}  // namespace throng::test
