// A few points of a part, spread evenly over it: how near another part is at most can be read off
// them.
// One rule: each is one of the points that were given, so no distance to it is too short.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

namespace throng {

/// In the part's own frame, metres; rows for kernels.
struct alignas(64) SpreadPoints {
  static constexpr size_t kCount = 32;
  static constexpr size_t kFew = 8;  ///< the first of them are spread, too: where to begin
  float x[kCount], y[kCount], z[kCount];

  /// Each the farthest from those before; at least one point, repeated where there are too few.
  explicit SpreadPoints(std::span<const Eigen::Vector3f> points);
};

}  // namespace throng
