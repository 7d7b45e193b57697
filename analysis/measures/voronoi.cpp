#include "analysis/measures/voronoi.h"

#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <numbers>

namespace throng {
namespace {

namespace bp = boost::polygon;

/// Number of corners of the polygon that represents the cap's circle; it has the circle's area.
constexpr int kCapCorners = 64;
/// People closer than this share a point.
constexpr double kSamePoint_m = 1e-6;

const std::vector<Eigen::Vector2d>& cap() {
  static const std::vector<Eigen::Vector2d> corners = [] {
    constexpr double kStep_rad = 2 * std::numbers::pi / kCapCorners;
    const double radius_m = VoronoiCells::kCap_m * std::sqrt(kStep_rad / std::sin(kStep_rad));
    std::vector<Eigen::Vector2d> out;
    for (int i = 0; i < kCapCorners; ++i)
      out.emplace_back(radius_m * std::cos(i * kStep_rad), radius_m * std::sin(i * kStep_rad));
    return out;
  }();
  return corners;
}

double area_of(const std::vector<Eigen::Vector2d>& corners) {
  double doubled = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& next = corners[(i + 1) % corners.size()];
    doubled += corners[i].x() * next.y() - next.x() * corners[i].y();
  }
  return 0.5 * doubled;
}

bool reaches_cap(const std::vector<Eigen::Vector2d>& corners) {
  constexpr double kCapReached_m = VoronoiCells::kCap_m - 1e-3;
  return std::any_of(corners.begin(), corners.end(), [](const Eigen::Vector2d& corner) {
    return corner.squaredNorm() >= kCapReached_m * kCapReached_m;
  });
}

// Integer coordinates in units of 0.01 mm make differences of polygons exact.
constexpr double kUnit_m = 1e-5;
/// Obstacles grow by this to all sides, which joins those that touch at a corner.
constexpr double kJoin_m = 1e-4;
using Point = bp::point_data<int>;

int whole(double metres) {
  constexpr double kFar = 2e9;
  return static_cast<int>(std::lround(std::clamp(metres / kUnit_m, -kFar, kFar)));
}

bp::polygon_data<int> polygon_of(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Point> points;
  for (const Eigen::Vector2d& corner : corners)
    points.emplace_back(whole(corner.x()), whole(corner.y()));
  bp::polygon_data<int> polygon;
  polygon.set(points.begin(), points.end());
  return polygon;
}

}  // namespace

VoronoiCells::VoronoiCells(const Scene& scene)
    : walkable_(scene), footprints_(walkable_.footprints()) {}

/// Keeps the part of the cell with normal . x <= offset (Sutherland and Hodgman 1974).
void VoronoiCells::cut(const Eigen::Vector2d& normal, double offset) {
  cut_.clear();
  for (size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d& p = corners_[i];
    const Eigen::Vector2d& q = corners_[(i + 1) % corners_.size()];
    const double at_p = normal.dot(p) - offset;
    const double at_q = normal.dot(q) - offset;
    if (at_p <= 0) cut_.push_back(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0))
      cut_.push_back(p + (q - p) * (at_p / (at_p - at_q)));
  }
  corners_.swap(cut_);
}

std::optional<VoronoiCell> VoronoiCells::cell(const Eigen::Vector2d& point,
                                              std::span<const Eigen::Vector2d> others) {
  if (!walkable_.ground().contains(point)) return {};
  corners_ = cap();
  sorted_neighbours_.clear();
  for (const Eigen::Vector2d& other : others) {
    const Eigen::Vector2d offset_m = other - point;
    if (const double distance_m = offset_m.norm(); distance_m > kSamePoint_m)
      sorted_neighbours_.emplace_back(distance_m, offset_m / distance_m);
  }
  std::sort(sorted_neighbours_.begin(), sorted_neighbours_.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [distance_m, normal] : sorted_neighbours_) {
    double reach = 0;
    for (const Eigen::Vector2d& corner : corners_) reach = std::max(reach, corner.squaredNorm());
    if (distance_m * distance_m > 4 * reach) break;  // nor do farther ones
    cut(normal, 0.5 * distance_m);
  }
  const Rectangle& ground = walkable_.ground();
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d along = axis == 0 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
    cut(along, ground.max_m[axis] - point[axis]);
    cut(-along, point[axis] - ground.min_m[axis]);
  }
  return without_obstacles(point);
}

std::optional<VoronoiCell> VoronoiCells::without_obstacles(const Eigen::Vector2d& point) {
  double reach = 0;
  for (const Eigen::Vector2d& corner : corners_) reach = std::max(reach, corner.norm());
  bp::polygon_set_data<int> solid;
  for (const uint32_t footprint : walkable_.nearby_footprints(point)) {
    const double distance_m = walkable_.nearest(footprint, point).distance_m;
    if (distance_m < 0) return {};
    if (distance_m >= reach) continue;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> corners = footprints_[footprint];
    for (const Eigen::Vector2d& corner : corners)
      middle += corner / static_cast<double>(corners.size());
    for (Eigen::Vector2d& corner : corners) {
      for (int axis = 0; axis < 2; ++axis)
        corner[axis] += std::copysign(kJoin_m, corner[axis] - middle[axis]);
      corner -= point;
    }
    solid.insert(polygon_of(corners));
  }
  if (solid.empty()) return VoronoiCell{area_of(corners_), reaches_cap(corners_)};

  bp::polygon_set_data<int> whole_cell;
  whole_cell.insert(polygon_of(corners_));
  using namespace bp::operators;
  const bp::polygon_set_data<int> left(whole_cell - solid);
  std::vector<bp::polygon_with_holes_data<int>> pieces;
  left.get(pieces);
  for (const auto& piece : pieces) {
    if (!bp::contains(piece, Point(0, 0))) continue;
    std::vector<Eigen::Vector2d> outline;
    for (const Point& corner : piece)
      outline.emplace_back(kUnit_m * corner.x(), kUnit_m * corner.y());
    return VoronoiCell{static_cast<double>(bp::area(piece)) * kUnit_m * kUnit_m,
                       reaches_cap(outline)};
  }
  return {};
}

}  // namespace throng
