// The triangles of a surface that are foremost along a direction: all that can be near to what lies
// beyond.
// One rule: whoever is left out lies farther behind the foremost point than asked.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "culling/exact/triangle_bvh.h"

namespace throng {

struct SurfaceFront {
  struct Triangle {
    uint32_t index;
    double behind;  ///< its foremost corner, behind the foremost of all
  };
  static constexpr size_t kMost = 256;
  std::array<Triangle, kMost> triangles;  ///< the foremost first
  size_t count = 0;

  /// Those at most `behind` behind `ends`, where the surface ends along the direction; false where
  /// they are too many. No allocation.
  bool gather(const TriangleBvh& surface, const Eigen::Vector3d& direction, double ends,
              double behind);
};

}  // namespace throng
