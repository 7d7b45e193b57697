#include "geometry/floor.h"

#include <algorithm>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <cstdint>
#include <utility>

namespace throng {
namespace {

namespace bg = boost::geometry;
using BoxPoint = bg::model::point<double, 2, bg::cs::cartesian>;
using Box = bg::model::box<BoxPoint>;
using BoxTree = bg::index::rtree<std::pair<Box, uint32_t>, bg::index::quadratic<16>>;

/// A little less than the grid spacing: vertices that differ on the grid count.
constexpr double kMinEdge_m = 0.9e-4;
/// A strip that reaches less far into the floor is accepted.
constexpr double kRounding_m = 1e-4;
constexpr std::array kThicknesses_m = {kStripThickness_m, 0.025, 0.012, 0.006, 0.003, 0.0015, 5e-4};

bool is_before(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
}

/// FloorEdge with the floor on its left, and the corners before and after it.
struct FloorEdge {
  Eigen::Vector2d before, from, to, after;
};

/// Corners that several rings share, sorted: the floor continues behind them.
std::vector<Eigen::Vector2d> shared_corners(const std::vector<Polygon>& floor) {
  std::vector<Eigen::Vector2d> all, shared;
  for_each_edge(floor,
                [&](const Eigen::Vector2d& from, const Eigen::Vector2d&) { all.push_back(from); });
  std::sort(all.begin(), all.end(), is_before);
  for (size_t i = 1; i < all.size(); ++i)
    if (all[i] == all[i - 1]) shared.push_back(all[i]);
  return shared;
}

std::vector<FloorEdge> edges_of(const std::vector<Polygon>& floor) {
  std::vector<FloorEdge> edges;
  const auto add = [&](Polygon::Ring ring, bool walkable_inside) {
    if ((doubled_area(ring) > 0) != walkable_inside) std::reverse(ring.begin(), ring.end());
    Polygon::Ring corners;
    for (const Eigen::Vector2d& corner : ring)
      if (corners.empty() || (corner - corners.back()).norm() >= kMinEdge_m)
        corners.push_back(corner);
    while (corners.size() > 1 && (corners.front() - corners.back()).norm() < kMinEdge_m)
      corners.pop_back();
    const size_t count = corners.size();
    for (size_t i = 0; i < count && count > 1; ++i)
      edges.push_back({corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count],
                       corners[(i + 2) % count]});
  };
  for (const Polygon& polygon : floor) {
    add(polygon.outline, true);
    for (const Polygon::Ring& hole : polygon.holes) add(hole, false);
  }
  return edges;
}

class StripBuilder {
 public:
  explicit StripBuilder(const std::vector<Polygon>& floor)
      : edges_(edges_of(floor)), shared_(shared_corners(floor)) {
    std::vector<std::pair<Box, uint32_t>> boxes;
    for (uint32_t i = 0; i < edges_.size(); ++i)
      boxes.emplace_back(box_of({edges_[i].from, edges_[i].to}), i);
    tree_ = BoxTree(boxes);
  }

  std::vector<FloorStrip> build() const {
    std::vector<FloorStrip> strips;
    for (const FloorEdge& edge : edges_) {
      for (const double thickness_m : kThicknesses_m) {
        const bool is_last = thickness_m == kThicknesses_m.back();
        const FloorStrip strip = strip_of(edge, thickness_m, is_last);
        if (!is_last && (!is_convex(strip) || reaches_floor(edge, strip))) continue;
        strips.push_back(strip);
        break;
      }
    }
    return strips;
  }

 private:
  template <typename Points>
  static Box box_of(const Points& points) {
    Eigen::Vector2d low = *std::begin(points), high = low;
    for (const Eigen::Vector2d& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    return {BoxPoint(low.x(), low.y()), BoxPoint(high.x(), high.y())};
  }
  static Box box_of(std::initializer_list<Eigen::Vector2d> points) {
    return box_of<std::initializer_list<Eigen::Vector2d>>(points);
  }

  /// At a corner where the floor bends around the wall, strips end at the bisector. At other
  /// corners they extend by their thickness, to close the corner.
  FloorStrip strip_of(const FloorEdge& edge, double thickness_m, bool is_last) const {
    const Eigen::Vector2d along = (edge.to - edge.from).normalized(), out(along.y(), -along.x());
    const auto reach_m = [&](const Eigen::Vector2d& corner, const Eigen::Vector2d& in,
                             const Eigen::Vector2d& on) {
      const double turn = cross(in, on);
      if (std::binary_search(shared_.begin(), shared_.end(), corner, is_before)) return 0.0;
      if (turn > 0) return thickness_m;
      // Half the angle of the wall between both edges; its tangent from the cosine of the turn.
      const double cosine = std::clamp(in.dot(on) / (in.norm() * on.norm()), -1.0, 1.0);
      const double tangent = std::sqrt((1 + cosine) / std::max(1e-12, 1 - cosine));
      return -thickness_m / std::max(tangent, 1e-3);
    };
    double early_m = reach_m(edge.from, edge.from - edge.before, edge.to - edge.from);
    double late_m = reach_m(edge.to, edge.to - edge.from, edge.after - edge.to);
    const double shorter_m = -std::min(0.0, early_m) - std::min(0.0, late_m);
    const double max_shorter_m = 0.9 * (edge.to - edge.from).norm();
    if (is_last && shorter_m > max_shorter_m)
      for (double* end_m : {&early_m, &late_m})
        if (*end_m < 0) *end_m *= max_shorter_m / shorter_m;
    const Eigen::Vector2d begin = edge.from - std::max(0.0, early_m) * along;
    const Eigen::Vector2d end = edge.to + std::max(0.0, late_m) * along;
    const Eigen::Vector2d outer_begin = edge.from - early_m * along + thickness_m * out;
    const Eigen::Vector2d outer_end = edge.to + late_m * along + thickness_m * out;
    return {begin, outer_begin, outer_end, end};
  }

  static bool is_convex(const FloorStrip& strip) {
    for (size_t i = 0; i < 4; ++i)
      if (!(cross(strip[(i + 1) % 4] - strip[i], strip[(i + 2) % 4] - strip[(i + 1) % 4]) > 0))
        return false;
    return true;
  }

  /// Returns whether another edge runs through a strip.
  bool reaches_floor(const FloorEdge& edge, const FloorStrip& strip) const {
    for (auto it = tree_.qbegin(bg::index::intersects(box_of(strip))); it != tree_.qend(); ++it) {
      const FloorEdge& other = edges_[it->second];
      if (&other != &edge && runs_through(strip, other.from, other.to)) return true;
    }
    return false;
  }

  /// Clips a segment by the strip's sides, moved inwards (Cyrus and Beck 1978).
  static bool runs_through(const FloorStrip& strip, const Eigen::Vector2d& from,
                           const Eigen::Vector2d& to) {
    double enter = 0, leave = 1;
    for (size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d side = (strip[(i + 1) % 4] - strip[i]).normalized();
      const double at_from = cross(side, from - strip[i]) - kRounding_m;
      const double climb = cross(side, to - from);
      if (climb == 0) {
        if (at_from <= 0) return false;
      } else if (climb > 0) {
        enter = std::max(enter, -at_from / climb);
      } else {
        leave = std::min(leave, -at_from / climb);
      }
      if (enter >= leave) return false;
    }
    return true;
  }

  std::vector<FloorEdge> edges_;
  std::vector<Eigen::Vector2d> shared_;
  BoxTree tree_;
};

}  // namespace

std::vector<FloorStrip> strips_around(const std::vector<Polygon>& floor) {
  return StripBuilder(floor).build();
}

std::vector<double> crossings_m(const std::vector<Polygon>& floor, double y_m) {
  std::vector<double> crossings;
  for_each_edge(floor, [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    if (const std::optional<double> x_m = crossing_m(from, to, y_m)) crossings.push_back(*x_m);
  });
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace throng
