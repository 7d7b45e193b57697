// Which corners of a convex hull can be the farthest along a direction: a few, looked up by the
// cell of a cube that the direction passes through.
// One rule: the farthest corner is always among them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace throng {

class SupportMap {
 public:
  SupportMap() = default;
  /// Of the first `corners` rows of `points`; kMostCorners at most, others have no map.
  SupportMap(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, Eigen::Index corners);

  static constexpr Eigen::Index kFewCorners = 8;  ///< looked at one by one as quickly
  static constexpr Eigen::Index kMostCorners = 0x10000;

  bool is_empty() const { return corners_.empty(); }
  /// Ascending. A direction of any length.
  std::span<const uint16_t> along(const Eigen::Vector3d& direction) const {
    const size_t cell = cell_of(direction);
    return {corners_.data() + start_[cell], start_[cell + 1] - start_[cell]};
  }

 private:
  static constexpr int kSide = 8;  ///< cells along an edge of the cube
  static constexpr size_t kCells = size_t{6} * kSide * kSide;

  static size_t cell_of(const Eigen::Vector3d& direction);
  void add_cell(const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, Eigen::Index corners,
                size_t cell);

  std::vector<uint32_t> start_;
  std::vector<uint16_t> corners_;
};

}  // namespace throng
