#include "geometry/area.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace throng {
Area::Area(std::vector<Polygon> polygons) : bounds_(bounds_of(polygons)) {
  if (polygons.size() == 1 && rectangle_of(polygons[0])) return;
  polygons_ = std::move(polygons);
  for (const Polygon& polygon : polygons_) {
    area_m2_ += throng::area_m2(polygon);
    for (const FlatTriangle& triangle : triangles_of(polygon)) triangles_.push_back(triangle);
  }
  double sum_m2 = 0;
  for (const auto& [a, b, c] : triangles_) {
    sum_m2 += 0.5 * ((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
    shares_.push_back(sum_m2);
  }
  for (double& share : shares_) share /= sum_m2;
  find_middle();
}

std::vector<Polygon> Area::polygons() const {
  return is_rectangle() ? std::vector<Polygon>{polygon_of(bounds_)} : polygons_;
}

Eigen::Vector2d Area::nearest_edge_m(const Eigen::Vector2d& point) const {
  Eigen::Vector2d nearest_m = middle_m_;
  double min_m2 = std::numeric_limits<double>::infinity();
  for_each_edge(polygons_, [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d along = to - from;
    const double t = std::clamp(along.dot(point - from) / along.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector2d candidate_m = from + t * along;
    const double square_m2 = (candidate_m - point).squaredNorm();
    if (square_m2 >= min_m2) return;
    min_m2 = square_m2;
    nearest_m = candidate_m;
  });
  return nearest_m;
}

Eigen::Vector2d Area::nearest_in_polygons_m(const Eigen::Vector2d& point) const {
  return contains(point) ? point : nearest_edge_m(point);
}

Rectangle Area::inner_bounds(double rim_m) const {
  const Eigen::Vector2d rim = (0.25 * size_m()).cwiseMin(rim_m);
  return {bounds_.min_m + rim, bounds_.max_m - rim};
}

Eigen::Vector2d Area::nearest_inside_m(const Eigen::Vector2d& point, double rim_m) const {
  if (is_rectangle()) return inner_bounds(rim_m).nearest_m(point);
  const bool is_inside = contains(point);
  const Eigen::Vector2d edge_m = nearest_edge_m(point);
  const double away_m = (point - edge_m).norm();
  if (is_inside && away_m >= rim_m) return point;
  // Inwards from the edge: away from a point outside, or on beyond one inside.
  const Eigen::Vector2d inwards = is_inside ? point - edge_m : edge_m - point;
  for (double in_m = rim_m; away_m > 0 && in_m > 0.1 * rim_m; in_m *= 0.5) {
    Eigen::Vector2d candidate_m = edge_m + in_m / away_m * inwards;
    if (contains(candidate_m)) return candidate_m;
  }
  return edge_m + rim_m * (middle_m_ - edge_m).normalized();
}

Eigen::Vector2d Area::in_polygons_at(const Eigen::Vector2d& share) const {
  const auto found = std::lower_bound(shares_.begin(), shares_.end(), share.x());
  const auto index = std::min(static_cast<size_t>(found - shares_.begin()), triangles_.size() - 1);
  const double begin = index == 0 ? 0 : shares_[index - 1], width = shares_[index] - begin;
  const double u = width > 0 ? std::clamp((share.x() - begin) / width, 0.0, 1.0) : 0.0;
  const auto& [a, b, c] = triangles_[index];
  const double off_a = std::sqrt(u);
  return (1 - off_a) * a + off_a * ((1 - share.y()) * b + share.y() * c);
}

Eigen::Vector2d Area::at(const Eigen::Vector2d& share, double rim_m) const {
  if (!is_rectangle()) return nearest_inside_m(at(share), rim_m);
  const Rectangle inner = inner_bounds(rim_m);
  return inner.min_m + inner.size_m().cwiseProduct(share);
}

Area Area::scaled(const Eigen::Vector2d& fixed_m, double factor) const {
  if (is_rectangle())
    return {fixed_m + factor * (bounds_.min_m - fixed_m),
            fixed_m + factor * (bounds_.max_m - fixed_m)};
  std::vector<Polygon> out = polygons_;
  scale(out, fixed_m, factor);
  return Area(std::move(out));
}

/// The best of a grid of points, then of ever finer grids around the best so far.
void Area::find_middle() {
  constexpr int kSide = 16;
  constexpr int kRounds = 4;
  const auto& [a, b, c] = triangles_.front();
  middle_m_ = (a + b + c) / 3;
  double best_m = (nearest_edge_m(middle_m_) - middle_m_).norm();
  Rectangle search = bounds_;
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < kSide; ++i)
      for (int k = 0; k < kSide; ++k) {
        const Eigen::Vector2d share((i + 0.5) / kSide, (k + 0.5) / kSide);
        const Eigen::Vector2d point = search.min_m + search.size_m().cwiseProduct(share);
        if (!contains(point)) continue;
        const double away_m = (nearest_edge_m(point) - point).norm();
        if (away_m <= best_m) continue;
        best_m = away_m;
        middle_m_ = point;
      }
    const Eigen::Vector2d half = search.size_m() / kSide;
    search = {middle_m_ - half, middle_m_ + half};
  }
}

}  // namespace throng
