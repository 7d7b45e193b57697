// Parts of people near each other in a run, held against triangles: whatever touches must be
// reported in that frame, and whatever is within the run's margin must have a row.
// One rule: only near pairs count, those whose axis-aligned boxes, widened by a centimetre (and the
// margin), overlap; of the others the boxes prove that they are farther apart.
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
  /// Of a run with postures and that margin, if any; `run` is to outlive this.
  explicit PersonPairs(const Simulation& run, float proximity_m = 0);
  /// Compares all avatars with each other, as they are after a step.
  void check(const Frame& frame);

  uint64_t tested = 0, touching = 0, missed = 0;
  std::string first_miss;
  ProximityTally rows;  ///< of a run with a margin

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
  float reach_m_;                                   ///< of boxes that are looked at
  std::vector<std::vector<TriangleBvh>> surfaces_;  ///< by model, then by part
  std::vector<std::vector<DistanceTree>> trees_;    ///< the same; of a run with a margin
  std::vector<Avatar> avatars_;
};

}  // namespace throng::test
