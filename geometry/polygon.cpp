#include "geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace throng {
namespace {

constexpr double kOnEdge_m = 1e-3;

double squared_distance_to_segment_m2(const Eigen::Vector2d& p, const Eigen::Vector2d& from,
                                      const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - from - t * along).squaredNorm();
}

}  // namespace

double doubled_area(const Polygon::Ring& ring) {
  double sum = 0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& next = ring[(i + 1) % ring.size()];
    sum += ring[i].x() * next.y() - ring[i].y() * next.x();
  }
  return sum;
}

double area_m2(const Polygon& polygon) {
  double doubled_m2 = std::abs(doubled_area(polygon.outline));
  for (const Polygon::Ring& hole : polygon.holes) doubled_m2 -= std::abs(doubled_area(hole));
  return 0.5 * doubled_m2;
}

bool is_inside(std::span<const Polygon> polygons, const Eigen::Vector2d& point) {
  bool inside = false;
  for_each_edge(polygons, [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const std::optional<double> x_m = crossing_m(from, to, point.y());
    if (x_m && point.x() < *x_m) inside = !inside;
  });
  return inside;
}

Polygon::Ring clipped_to(Polygon::Ring ring, const Rectangle& rectangle) {
  const auto cut = [&](int axis, double sign, double bound) {
    Polygon::Ring kept;
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d &p = ring[i], &q = ring[(i + 1) % ring.size()];
      const double at_p = sign * p[axis] - bound, at_q = sign * q[axis] - bound;
      if (at_p <= 0) kept.push_back(p);
      if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) {
        kept.push_back(p + (q - p) * (at_p / (at_p - at_q)));
        kept.back()[axis] = sign * bound;
      }
    }
    ring = std::move(kept);
  };
  for (int axis = 0; axis < 2; ++axis) {
    cut(axis, 1, rectangle.max_m[axis]);
    cut(axis, -1, -rectangle.min_m[axis]);
  }
  return ring;
}

void scale(std::vector<Polygon>& polygons, const Eigen::Vector2d& fixed_m, double factor) {
  const auto scale_ring = [&](Polygon::Ring& ring) {
    for (Eigen::Vector2d& point : ring) point = fixed_m + factor * (point - fixed_m);
  };
  for (Polygon& polygon : polygons) {
    scale_ring(polygon.outline);
    for (Polygon::Ring& hole : polygon.holes) scale_ring(hole);
  }
}

size_t vertex_count(const std::vector<Polygon>& polygons) {
  size_t count = 0;
  for (const Polygon& polygon : polygons)
    for_each_ring(polygon, [&](const Polygon::Ring& ring) { count += ring.size(); });
  return count;
}

Rectangle bounds_of(const std::vector<Eigen::Vector2d>& points) {
  Rectangle bounds{points.front(), points.front()};
  for (const Eigen::Vector2d& point : points) {
    bounds.min_m = bounds.min_m.cwiseMin(point);
    bounds.max_m = bounds.max_m.cwiseMax(point);
  }
  return bounds;
}

Rectangle bounds_of(const std::vector<Polygon>& polygons) {
  Rectangle bounds = bounds_of(polygons.front().outline);
  for (const Polygon& polygon : polygons) bounds = bounds.joined(bounds_of(polygon.outline));
  return bounds;
}

Polygon polygon_of(const Rectangle& r) {
  return {{r.min_m, {r.max_m.x(), r.min_m.y()}, r.max_m, {r.min_m.x(), r.max_m.y()}}, {}};
}

std::optional<Rectangle> rectangle_of(const Polygon& polygon) {
  const Polygon::Ring& ring = polygon.outline;
  if (ring.size() != 4 || !polygon.holes.empty()) return std::nullopt;
  const Rectangle bounds = bounds_of(ring);
  for (size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &from = ring[i], &to = ring[(i + 1) % 4];
    if ((from.x() == to.x()) == (from.y() == to.y())) return std::nullopt;
  }
  // Edges along x and y that turn back would leave a side of the bounds out.
  return std::abs(doubled_area(ring)) > 0 && bounds.size_m().minCoeff() > 0 ? std::optional(bounds)
                                                                            : std::nullopt;
}

double distance_to_segment_m(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                             const Eigen::Vector2d& to) {
  return std::sqrt(squared_distance_to_segment_m2(point, from, to));
}

PolygonLocator::PolygonLocator(const std::vector<Polygon>& polygons) {
  std::vector<Edge> all;
  for (uint32_t i = 0; i < polygons.size(); ++i) {
    for_each_ring(polygons[i], [&](const Polygon::Ring& ring) {
      for (size_t k = 0; k < ring.size(); ++k)
        all.push_back({ring[k], ring[(k + 1) % ring.size()], i});
    });
  }
  bottom_ = std::numeric_limits<double>::infinity();
  top_ = -bottom_;
  for (const Edge& edge : all) {
    bottom_ = std::min(bottom_, edge.from.y() - kOnEdge_m);
    top_ = std::max(top_, edge.from.y() + kOnEdge_m);
  }
  const auto first_slab = [&](const Edge& edge) {
    return slab_of(std::min(edge.from.y(), edge.to.y()) - kOnEdge_m);
  };
  const auto last_slab = [&](const Edge& edge) {
    return slab_of(std::max(edge.from.y(), edge.to.y()) + kOnEdge_m);
  };
  // Number of slabs with a few edges each, fewer if most edges cross many slabs.
  size_t slabs = std::clamp<size_t>(all.size() / 2, 1, 1024);
  for (;; slabs /= 2) {
    slabs_per_m_ = top_ > bottom_ ? static_cast<double>(slabs) / (top_ - bottom_) : 0;
    slab_begin_.assign(slabs + 1, 0);
    size_t copies = 0;
    for (const Edge& edge : all) copies += last_slab(edge) - first_slab(edge) + 1;
    if (slabs == 1 || copies <= 16 * all.size()) break;
  }
  for (const Edge& edge : all)
    for (size_t slab = first_slab(edge); slab <= last_slab(edge); ++slab) ++slab_begin_[slab + 1];
  for (size_t slab = 0; slab < slabs; ++slab) slab_begin_[slab + 1] += slab_begin_[slab];
  edges_.resize(slab_begin_.back());
  std::vector<uint32_t> next(slab_begin_.begin(), slab_begin_.end() - 1);
  for (const Edge& edge : all)
    for (size_t slab = first_slab(edge); slab <= last_slab(edge); ++slab)
      edges_[next[slab]++] = edge;
}

size_t PolygonLocator::slab_of(double y) const {
  const double slab = std::floor((y - bottom_) * slabs_per_m_);
  return static_cast<size_t>(std::clamp(slab, 0.0, static_cast<double>(slab_begin_.size() - 2)));
}

bool PolygonLocator::contains(const Eigen::Vector2d& point) const {
  if (point.y() < bottom_ || point.y() > top_) return false;
  const size_t slab = slab_of(point.y());
  bool is_inside = false;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (uint32_t i = slab_begin_[slab]; i < slab_begin_[slab + 1]; ++i) {
    const Edge& edge = edges_[i];
    if (i > slab_begin_[slab] && edge.polygon != edges_[i - 1].polygon && is_inside) return true;
    nearest2 = std::min(nearest2, squared_distance_to_segment_m2(point, edge.from, edge.to));
    const std::optional<double> x_m = crossing_m(edge.from, edge.to, point.y());
    if (x_m && point.x() < *x_m) is_inside = !is_inside;
  }
  return is_inside || nearest2 <= kOnEdge_m * kOnEdge_m;
}

}  // namespace throng
