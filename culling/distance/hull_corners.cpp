#include "culling/distance/hull_corners.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "culling/distance/growing_polytope.h"
#include "culling/distance/simplex.h"

namespace throng {
namespace {

using Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Shares of the gap. A point this close to the hull, or to a plane or line of all points, need not
/// be a corner. The rest of the gap is for rounding.
constexpr double kInside = 0.9, kFlat = 0.2;
constexpr uint32_t kNone = 0xffffffff;

/// Up to four points, each the farthest from the span of those before, and the directions that they
/// span. Fewer if all points are within `tolerance_m` of the span.
struct Spread {
  std::vector<Eigen::Index> corners = {0};
  std::array<Vector3d, 3> axes{};
};

Spread spread_of(const Points& points, double tolerance_m) {
  Spread out;
  const Vector3d origin = points.row(0);
  Points left = points.rowwise() - origin.transpose();  // without the parts along the axes found
  for (Vector3d& axis : out.axes) {
    Eigen::Index next = 0;
    const double far = std::sqrt(left.rowwise().squaredNorm().maxCoeff(&next));
    if (far <= tolerance_m) break;
    out.corners.push_back(next);
    axis = left.row(next).transpose() / far;
    left -= (left * axis) * axis.transpose();
  }
  return out;
}

std::vector<Eigen::Index> ends_of_line(const Points& points, const Vector3d& axis) {
  const Eigen::VectorXd along = points * axis;
  std::vector<Eigen::Index> out(2);
  along.minCoeff(&out[0]);
  along.maxCoeff(&out[1]);
  return out;
}

/// Corners of points in a plane: monotone chain (Andrew 1979), exact on a grid of 1e-9 of the size.
std::vector<Eigen::Index> corners_in_plane(const Points& points, const Vector3d& u,
                                           const Vector3d& v) {
  struct Place {
    int64_t x, y;
    Eigen::Index index;
  };
  const Eigen::VectorXd x = points * u, y = points * v;
  const double low_x = x.minCoeff(), low_y = y.minCoeff();
  const double per_m = 0x1p30 / std::max(x.maxCoeff() - low_x, y.maxCoeff() - low_y);
  std::vector<Place> places;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    places.push_back(
        {std::llround((x[i] - low_x) * per_m), std::llround((y[i] - low_y) * per_m), i});
  const auto order = [](const Place& p) { return std::pair(p.x, p.y); };
  std::sort(places.begin(), places.end(), [&](const Place& p, const Place& q) {
    return std::pair(order(p), p.index) < std::pair(order(q), q.index);
  });
  std::vector<Eigen::Index> out;
  std::vector<Place> chain;
  const auto turns_left = [](const Place& p, const Place& q, const Place& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0;
  };
  const auto add = [&](const Place& place) {
    while (chain.size() > 1 && !turns_left(chain[chain.size() - 2], chain.back(), place))
      chain.pop_back();
    chain.push_back(place);
  };
  const auto take = [&] {
    for (const Place& place : chain) out.push_back(place.index);
    chain.clear();
  };
  std::for_each(places.begin(), places.end(), add);
  take();
  std::for_each(places.rbegin(), places.rend(), add);
  take();
  return out;
}

/// Quickhull: each point that is not yet inside is listed with one face that it is in front of.
class CornerSearch {
 public:
  CornerSearch(const Points& points, double gap_m)
      : size_(static_cast<size_t>(points.rows())), inside_m_(kInside * gap_m), next_(size_, kNone) {
    const Vector3d low = points.colwise().minCoeff(), high = points.colwise().maxCoeff();
    const Vector3d middle = 0.5 * (low + high);
    reach_m_ = (high - low).maxCoeff();  // beyond the middle half, with rounding
    const double grid = GrowingPolytope::grid_m(reach_m_);
    places_.reserve(size_);
    for (Eigen::Index i = 0; i < points.rows(); ++i)
      places_.push_back(GrowingPolytope::on_grid(Vector3d(points.row(i)) - middle, grid));
  }

  HullCorners find(std::span<const Eigen::Index> start, size_t max_tests) {
    std::array<Vector3d, 4> corners;
    for (size_t i = 0; i < 4; ++i) corners[i] = places_[static_cast<size_t>(start[i])];
    hull_.start(corners, reach_m_);
    for (size_t i = 0; i < 4; ++i)
      for (const Eigen::Index corner : start)  // the order may have changed
        if (places_[static_cast<size_t>(corner)] == hull_.points()[i])
          corner_of_.push_back(static_cast<uint32_t>(corner));
    lists_.resize(4);
    constexpr std::array<uint32_t, 4> kFirst = {0, 1, 2, 3};
    for (uint32_t point = 0; point < size_; ++point)
      if (std::find(corner_of_.begin(), corner_of_.end(), point) == corner_of_.end())
        list(point, kFirst);
    HullCorners out;
    for (size_t at = 0; at < pending_.size() && out.is_complete; ++at) {
      if (lists_[pending_[at]].first == kNone) continue;
      push_out(pending_[at]);
      out.max_faces = std::max(out.max_faces, hull_.faces().size());
      out.is_complete = tests_ <= max_tests;
    }
    out.tests = tests_;
    for (const uint32_t corner : corners_left()) out.indices.push_back(corner);
    if (!out.is_complete)
      for (const List& each : lists_)
        for (uint32_t point = each.first; point != kNone; point = next_[point])
          out.indices.push_back(point);
    return out;
  }

 private:
  /// Points in front of a face.
  struct List {
    uint32_t first = kNone, farthest = kNone;
    double height_m = 0;
  };

  /// Lists a point with the first face that it is in front of, if any.
  void list(uint32_t point, std::span<const uint32_t> faces) {
    const Vector3d& place = places_[point];
    for (const uint32_t face : faces) {
      ++tests_;
      if (hull_.side(face, place) <= 0) continue;
      const double height_m = hull_.faces()[face].normal.dot(place) - hull_.distances()[face];
      if (height_m <= inside_m_ && distance_m(face, place) <= inside_m_) return;
      List& list = lists_[face];
      if (list.first == kNone) pending_.push_back(face);
      next_[point] = list.first;
      list.first = point;
      if (list.farthest != kNone && height_m <= list.height_m) return;
      list.farthest = point;
      list.height_m = height_m;
      return;
    }
  }

  double distance_m(uint32_t face, const Vector3d& place) const {
    std::array<Vector3d, 3> from;
    for (size_t i = 0; i < 3; ++i) from[i] = hull_.points()[hull_.faces()[face].corners[i]] - place;
    const std::array<double, 3> weights = weights_of_nearest(from[0], from[1], from[2]);
    return (weights[0] * from[0] + weights[1] * from[1] + weights[2] * from[2]).norm();
  }

  /// Makes the farthest point in front of a face a corner and relists the points of the removed
  /// faces. Points that are still outside are in front of an added face.
  void push_out(uint32_t face) {
    const uint32_t corner = lists_[face].farthest;
    hull_.add(places_[corner], face);
    corner_of_.push_back(corner);
    tests_ += 3 * hull_.removed().size();
    orphans_.clear();
    for (const uint32_t each : hull_.removed()) {
      for (uint32_t point = lists_[each].first; point != kNone; point = next_[point])
        if (point != corner) orphans_.push_back(point);
      lists_[each] = {};
    }
    lists_.resize(hull_.faces().size());
    for (const uint32_t point : orphans_) list(point, hull_.added());
  }

  /// Corners that are neither within a face nor within an edge.
  std::vector<uint32_t> corners_left() {
    creases_.assign(corner_of_.size(), 0);
    for (uint32_t face = 0; face < hull_.faces().size(); ++face) {
      if (!hull_.is_face(face)) continue;
      const GrowingPolytope::Face& f = hull_.faces()[face];
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t from = f.corners[i], to = f.corners[(i + 1) % 3];
        for (const uint32_t other : hull_.faces()[f.neighbours[i]].corners)
          if (other != from && other != to && hull_.side(face, hull_.points()[other]) != 0)
            ++creases_[from];
      }
    }
    std::vector<uint32_t> out;
    for (size_t i = 0; i < creases_.size(); ++i)
      if (creases_[i] >= 3) out.push_back(corner_of_[i]);
    return out;
  }

  size_t size_;
  double inside_m_, reach_m_ = 0;
  std::vector<Vector3d> places_;  // points on the grid around their middle
  std::vector<uint32_t> next_;    // by point: next point of its list
  GrowingPolytope hull_;
  std::vector<uint32_t> corner_of_;  // by point of the hull: index of the input point
  std::vector<List> lists_;
  std::vector<uint32_t> pending_;  // faces with a list, oldest first
  std::vector<uint32_t> orphans_;
  std::vector<uint32_t> creases_;  // by point of the hull: number of edges where the surface bends
  size_t tests_ = 0;
};

}  // namespace

HullCorners hull_corners(const Points& points, double gap_m, size_t max_tests_per_point) {
  assert(points.rows() > 0);
  const Spread spread = spread_of(points, kFlat * gap_m);
  HullCorners out;
  switch (spread.corners.size()) {
    case 1:
      out.indices = spread.corners;
      break;
    case 2:
      out.indices = ends_of_line(points, spread.axes[0]);
      break;
    case 3:
      out.indices = corners_in_plane(points, spread.axes[0], spread.axes[1]);
      break;
    default:
      out = CornerSearch(points, gap_m)
                .find(spread.corners, max_tests_per_point * static_cast<size_t>(points.rows()));
  }
  std::sort(out.indices.begin(), out.indices.end());
  out.indices.erase(std::unique(out.indices.begin(), out.indices.end()), out.indices.end());
  return out;
}

}  // namespace throng
