// Rectangle is an area of the ground with edges along x and y, in metres; min below max.
#pragma once

#include <Eigen/Core>

namespace throng {

struct Rectangle {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();

  Eigen::Vector2d size_m() const { return max_m - min_m; }
  Eigen::Vector2d middle_m() const { return 0.5 * (min_m + max_m); }
  double area_m2() const { return size_m().prod(); }
  bool contains(const Eigen::Vector2d& point) const {
    return (point.array() >= min_m.array()).all() && (point.array() <= max_m.array()).all();
  }
  /// Nearest point of the rectangle.
  Eigen::Vector2d nearest_m(const Eigen::Vector2d& point) const {
    return point.cwiseMax(min_m).cwiseMin(max_m);
  }
  /// The rectangle with a margin on every side.
  Rectangle grown(double margin_m) const {
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(margin_m);
    return {min_m - margin, max_m + margin};
  }
  /// Smallest rectangle that contains both.
  Rectangle joined(const Rectangle& other) const {
    return {min_m.cwiseMin(other.min_m), max_m.cwiseMax(other.max_m)};
  }
  bool operator==(const Rectangle&) const = default;
};

}  // namespace throng
