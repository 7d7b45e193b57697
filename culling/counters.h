// CullingCounters counts the tests of a culling pass and measures its time: the terms of the
// paper's cost function.
// Invariant: counts are the same for any number of threads; times are not.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "culling/pair.h"

namespace throng {

/// Counts and times of one stage: the paper's N_u, C_u, N_v, C_v (N_p, C_p for triangles).
struct StageCounters {
  std::string_view volume;  ///< "sphere", "aabb", "ordop26", "triangles"
  uint64_t updates = 0;
  uint64_t tests = 0;
  uint64_t passed = 0;
  double update_ns = 0;  ///< summed over threads
  double test_ns = 0;

  /// Adds counts and times. `volume` stays.
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
  StageCounters body_sphere;  ///< spheres of bodies
  StageCounters body_box;     ///< boxes from bounds() of bodies, then boxes of posed bodies
  StageCounters part_box;     ///< boxes of the parts of pairs whose body boxes overlap
  StageCounters part_volume;  ///< part volumes of surviving parts
  StageCounters triangles;    ///< triangles of surviving parts
  /// Distances, in addition to the pass and not in its times: pairs of parts tested and listed. If
  /// one or-DOP test serves contacts and distances, the stages above count all boxes within the
  /// margin. This stage then holds the time of the or-DOPs.
  StageCounters proximity;
  /// tests of boxes and triangles in the narrow phase: the paper's N_p
  uint64_t primitive_tests = 0;
  std::array<uint64_t, kPairLevels> levels{};  ///< pairs reported at each PairLevel
  uint64_t posed_bodies = 0;
  double pose_ns = 0;  ///< time inside PoseSource, summed over threads
  double events_ns = 0;
  double wall_ns = 0;          ///< time of the whole pass
  uint64_t buffers_grown = 0;  ///< number of buffers that grew in this pass
};

}  // namespace throng
