// Area is a part of the ground where agents start, enter or go: a rectangle or polygons.
// Invariant: polygons are joined and without faults; one that is a rectangle is stored as such.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/rectangle.h"
#include "geometry/polygon.h"

namespace throng {

class Area {
 public:
  Area() = default;
  Area(const Rectangle& rectangle) : bounds_(rectangle) {}
  Area(const Eigen::Vector2d& min_m, const Eigen::Vector2d& max_m) : bounds_{min_m, max_m} {}
  /// @pre At least one polygon, none with a fault; they do not overlap.
  explicit Area(std::vector<Polygon> polygons);

  bool is_rectangle() const { return polygons_.empty(); }
  const Rectangle& bounds() const { return bounds_; }
  /// The polygons, or the rectangle as a polygon.
  std::vector<Polygon> polygons() const;

  Eigen::Vector2d size_m() const { return bounds_.size_m(); }
  double area_m2() const { return is_rectangle() ? bounds_.area_m2() : area_m2_; }
  /// A point inside, as far from the edges as possible within 5 %; the middle of a rectangle.
  Eigen::Vector2d middle_m() const { return is_rectangle() ? bounds_.middle_m() : middle_m_; }

  bool contains(const Eigen::Vector2d& point) const {
    return bounds_.contains(point) && (is_rectangle() || is_inside(polygons_, point));
  }
  /// Returns whether a point lies in the area grown by a margin; a rectangle stays a rectangle.
  bool contains(const Eigen::Vector2d& point, double margin_m) const {
    return bounds_.grown(margin_m).contains(point) &&
           (is_rectangle() || (nearest_in_polygons_m(point) - point).norm() <= margin_m);
  }
  /// Nearest point of the area.
  Eigen::Vector2d nearest_m(const Eigen::Vector2d& point) const {
    return is_rectangle() ? bounds_.nearest_m(point) : nearest_in_polygons_m(point);
  }
  /// Nearest point on the edges of an area that is no rectangle.
  Eigen::Vector2d nearest_edge_m(const Eigen::Vector2d& point) const;
  /// Nearest point that is `rim_m` inside the edges, less in an area narrower than four times that.
  Eigen::Vector2d nearest_inside_m(const Eigen::Vector2d& point, double rim_m) const;

  /// Maps the unit square onto the area, equal parts onto equal areas.
  Eigen::Vector2d at(const Eigen::Vector2d& share) const {
    return is_rectangle() ? Eigen::Vector2d(bounds_.min_m + size_m().cwiseProduct(share))
                          : in_polygons_at(share);
  }
  /// The same, `rim_m` inside the edges.
  Eigen::Vector2d at(const Eigen::Vector2d& share, double rim_m) const;

  /// The area after x -> fixed_m + factor * (x - fixed_m).
  Area scaled(const Eigen::Vector2d& fixed_m, double factor) const;

  bool operator==(const Area& other) const {
    return bounds_ == other.bounds_ && polygons_ == other.polygons_;
  }

 private:
  Eigen::Vector2d nearest_in_polygons_m(const Eigen::Vector2d& point) const;
  Eigen::Vector2d in_polygons_at(const Eigen::Vector2d& share) const;
  Rectangle inner_bounds(double rim_m) const;
  void find_middle();

  Rectangle bounds_;
  std::vector<Polygon> polygons_;  ///< empty: the bounds
  std::vector<FlatTriangle> triangles_;
  std::vector<double> shares_;  ///< per triangle: share of the area up to its end
  double area_m2_ = 0;
  Eigen::Vector2d middle_m_ = Eigen::Vector2d::Zero();
};

}  // namespace throng
