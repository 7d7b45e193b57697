// What a pass of culling did and how long it took: the terms of the paper's cost function.
// One rule: counts are the same for any number of threads; times are not.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "culling/pair.h"

namespace throng {

/// One stage's N and time: the paper's N_u, C_u, N_v, C_v (N_p, C_p for triangles).
struct StageCounters {
  std::string_view volume;  ///< "sphere", "aabb", "ordop26", "triangles"
  uint64_t updates = 0;
  uint64_t tests = 0;
  uint64_t passed = 0;
  double update_ns = 0;  ///< summed over threads
  double test_ns = 0;

  /// `volume` stays.
  StageCounters& operator+=(const StageCounters& other) {
    updates += other.updates;
    tests += other.tests;
    passed += other.passed;
    update_ns += other.update_ns;
    test_ns += other.test_ns;
    return *this;
  }
};

struct CullingCounters {
  StageCounters body_sphere;  ///< spheres over bodies
  StageCounters body_box;     ///< what bounds() says of a body, then its box in its pose
  StageCounters part_box;     ///< boxes over the parts of pairs whose body boxes overlap
  StageCounters part_volume;  ///< the part volume over surviving parts
  StageCounters triangles;    ///< triangles
  /// Distances, beside the pass and not in its times: pairs of parts that were asked, and listed.
  /// Where one test of or-DOPs answers for contacts and distances, the stages above count and time
  /// all boxes within the margin, and this one the time of the or-DOPs.
  StageCounters proximity;
  uint64_t primitive_tests = 0;  ///< boxes and triangles inside the exact stage: the paper's N_p
  std::array<uint64_t, kPairLevels> levels{};  ///< pairs reported at each PairLevel
  uint64_t posed_bodies = 0;
  double pose_ns = 0;  ///< time inside PoseSource, summed over threads
  double events_ns = 0;
  double wall_ns = 0;          ///< the whole pass
  uint64_t buffers_grown = 0;  ///< buffers that had to grow in this pass
};

}  // namespace throng
