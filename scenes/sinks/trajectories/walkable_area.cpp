#include "scenes/sinks/trajectories/walkable_area.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/polygon/polygon.hpp>
#include <cmath>

#include "base/append.h"
#include "scenes/file/shapes.h"

namespace throng {
namespace {

namespace bp = boost::polygon;

/// Whole numbers make the difference of polygons exact; 0.1 mm, 32 bits hold 200 km.
constexpr double kUnit_m = 1e-4;
using Point = bp::point_data<int>;
using Shape = bp::polygon_with_holes_data<int>;

Point point_at(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::lround(p.x() / kUnit_m)),
          static_cast<int>(std::lround(p.y() / kUnit_m))};
}

bp::polygon_data<int> polygon_of(const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Point> points;
  for (const Eigen::Vector2d& corner : corners) points.push_back(point_at(corner));
  bp::polygon_data<int> polygon;
  polygon.set(points.begin(), points.end());
  return polygon;
}

/// A little larger to all sides.
std::vector<Eigen::Vector2d> inflated(std::vector<Eigen::Vector2d> corners) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : corners)
    middle += corner / static_cast<double>(corners.size());
  for (Eigen::Vector2d& corner : corners)
    for (int axis = 0; axis < 2; ++axis)
      corner[axis] += std::copysign(kUnit_m, corner[axis] - middle[axis]);
  return corners;
}

/// All of it, or what a recording says of it.
bp::polygon_set_data<int> ground_of(const Scene& scene) {
  bp::polygon_set_data<int> ground, holes;
  const Eigen::Vector2d &low = scene.ground.min_m, &high = scene.ground.max_m;
  if (scene.area.empty())
    ground.insert(polygon_of({low, {high.x(), low.y()}, high, {low.x(), high.y()}}));
  for (const AreaPolygon& polygon : scene.area) {
    ground.insert(polygon_of(polygon.outline));
    for (const AreaPolygon::Ring& hole : polygon.holes) holes.insert(polygon_of(hole));
  }
  using namespace bp::operators;
  return scene.area.empty() ? ground : bp::polygon_set_data<int>(ground - holes);
}

template <typename Ring>
std::vector<Eigen::Vector2d> ring_of(const Ring& ring, bool counter_clockwise) {
  std::vector<Eigen::Vector2d> corners;
  for (const Point& point : ring) corners.emplace_back(kUnit_m * point.x(), kUnit_m * point.y());
  if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  double doubled_area = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& next = corners[(i + 1) % corners.size()];
    doubled_area += corners[i].x() * next.y() - next.x() * corners[i].y();
  }
  if ((doubled_area > 0) != counter_clockwise) std::reverse(corners.begin(), corners.end());
  // The corner that a ring starts in says nothing: always the leftmost.
  const auto first = std::min_element(corners.begin(), corners.end(),
                                      [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                                        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
                                      });
  std::rotate(corners.begin(), first, corners.end());
  return corners;
}

std::string text_of(const std::vector<Eigen::Vector2d>& ring) {
  std::string text = "(";
  for (size_t i = 0; i <= ring.size(); ++i) {
    const Eigen::Vector2d& corner = ring[i % ring.size()];
    // Four digits are the whole unit; adding zero turns -0 into 0.
    append(text, "{}{:.4f} {:.4f}", i == 0 ? "" : ", ", corner.x() + 0.0, corner.y() + 0.0);
  }
  return text + ")";
}

std::string text_of(const WalkablePolygon& polygon) {
  std::string text = fmt::format("({}", text_of(polygon.outline));
  for (const auto& hole : polygon.holes) text += fmt::format(", {}", text_of(hole));
  return text + ")";
}

}  // namespace

std::vector<WalkablePolygon> walkable_area(const Scene& scene) {
  bp::polygon_set_data<int> ground = ground_of(scene);
  bp::polygon_set_data<int> solid;
  for (const Footprint& footprint : footprints_of(scene))
    solid.insert(polygon_of(inflated(footprint.corners)));
  using namespace bp::operators;
  std::vector<Shape> shapes;
  const bp::polygon_set_data<int> left(ground - solid);
  left.get(shapes);
  std::sort(shapes.begin(), shapes.end(),
            [](const Shape& a, const Shape& b) { return bp::area(a) > bp::area(b); });
  std::vector<WalkablePolygon> area;
  for (const Shape& shape : shapes) {
    WalkablePolygon& polygon = area.emplace_back();
    polygon.outline = ring_of(shape, true);
    for (auto hole = shape.begin_holes(); hole != shape.end_holes(); ++hole)
      polygon.holes.push_back(ring_of(*hole, false));
  }
  return area;
}

std::string walkable_wkt(const Scene& scene) {
  const std::vector<WalkablePolygon> area = walkable_area(scene);
  if (area.empty()) return "POLYGON EMPTY";
  if (area.size() == 1) return fmt::format("POLYGON {}", text_of(area.front()));
  std::string text = "MULTIPOLYGON (";
  for (size_t i = 0; i < area.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", text_of(area[i]));
  return text + ")";
}

}  // namespace throng
