// Random polygons: star-shaped or comb-shaped outlines, with holes, slivers of 1 mm, and far from
// the origin.
#pragma once

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "geometry/polygon.h"

namespace throng {

class RandomPolygons {
 public:
  explicit RandomPolygons(uint64_t seed) : seed_(seed) {}

  double uniform(double low, double high) {
    return random_uniform({seed_, 0, next_++, Purpose::kBoxWorld}, low, high);
  }
  int whole(int low, int high) {
    return low + static_cast<int>(uniform(0, 1) * (high - low + 1) * 0.999999);
  }

  /// Star-shaped ring: every point is visible from the middle.
  Polygon::Ring star(const Eigen::Vector2d& middle, double min_m, double max_m, int corners) {
    Polygon::Ring ring;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * (i + uniform(0.1, 0.9)) / corners;
      const double radius_m = uniform(min_m, max_m);
      ring.push_back(
          rounded(middle + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle))));
    }
    return ring;
  }

  /// A wall of 1 mm that ends in a point.
  Polygon::Ring sliver(const Eigen::Vector2d& from, double length_m) {
    const double angle = uniform(0, 2 * std::numbers::pi);
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
    return {rounded(from), rounded(from + 0.7 * length_m * along), rounded(from + length_m * along),
            rounded(from + 0.5 * length_m * along + 1e-3 * across)};
  }

  /// A comb with slots of random widths down to 1 mm.
  Polygon::Ring comb(const Eigen::Vector2d& corner, int teeth) {
    Polygon::Ring ring = {corner};
    double x_m = 0;
    Polygon::Ring top;
    for (int i = 0; i < teeth; ++i) {
      const double tooth_m = uniform(0.5, 3), slot_m = whole(0, 3) == 0 ? 0.001 : uniform(0.1, 1);
      const double depth_m = uniform(0.5, 4);
      top.push_back(corner + Eigen::Vector2d(x_m, 6));
      top.push_back(corner + Eigen::Vector2d(x_m + tooth_m, 6));
      if (i + 1 < teeth) {
        top.push_back(corner + Eigen::Vector2d(x_m + tooth_m, 6 - depth_m));
        top.push_back(corner + Eigen::Vector2d(x_m + tooth_m + slot_m, 6 - depth_m));
      }
      x_m += tooth_m + slot_m;
      if (i + 1 == teeth) ring.push_back(corner + Eigen::Vector2d(x_m - slot_m, 0));
    }
    for (auto point = top.rbegin(); point != top.rend(); ++point) ring.push_back(*point);
    for (Eigen::Vector2d& point : ring) point = rounded(point);
    return ring;
  }

  Polygon polygon() {
    const double far_m = whole(0, 3) == 0 ? 99'000 : 0;
    const Eigen::Vector2d middle(far_m, -far_m);
    if (whole(0, 2) == 0) return {comb(middle, whole(2, 12)), {}};
    Polygon out{star(middle, 4, 12, whole(3, 60)), {}};
    const int holes = whole(0, 3);
    for (int i = 0; i < holes; ++i) {
      // Within a circle that no edge of the outline enters if it has many corners.
      const double angle = 2 * std::numbers::pi * i / 3;
      const Eigen::Vector2d at = middle + 0.5 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      out.holes.push_back(star(at, 0.05, 0.3, whole(3, 12)));
    }
    return out;
  }

 private:
  static Eigen::Vector2d rounded(const Eigen::Vector2d& point) {
    return {std::round(point.x() * 1e4) / 1e4, std::round(point.y() * 1e4) / 1e4};
  }

  uint64_t seed_;
  uint64_t next_ = 0;
};

}  // namespace throng
