#include "culling/exact/triangle_bvh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/checksum.h"
#include "culling/exact/surface.h"

namespace throng {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Corners = std::array<Vector3f, 3>;

struct Bounds {
  Vector3f low = Vector3f::Constant(std::numeric_limits<float>::infinity());
  Vector3f high = Vector3f::Constant(-std::numeric_limits<float>::infinity());

  void add(const Corners& corners) {
    for (const Vector3f& p : corners) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  double half_area() const {
    const Vector3d e = (high.cast<double>() - low.cast<double>());
    return e.x() * e.y() + e.y() * e.z() + e.z() * e.x();
  }
};

TriangleBvh::Node node_around(const Bounds& bounds) {
  TriangleBvh::Node node{};
  for (int i = 0; i < 3; ++i) {
    const double low = static_cast<double>(bounds.low[i]);
    const double high = static_cast<double>(bounds.high[i]);
    const float centre = static_cast<float>(0.5 * (low + high));
    const double half =
        std::max(high - static_cast<double>(centre), static_cast<double>(centre) - low);
    node.centre_m[static_cast<size_t>(i)] = centre;
    node.half_m[static_cast<size_t>(i)] =
        std::nextafter(static_cast<float>(half), std::numeric_limits<float>::max());
  }
  return node;
}

/// Builds the nodes over `order`, which it sorts.
class Builder {
 public:
  Builder(std::span<const Corners> corners, std::vector<TriangleBvh::Node>& nodes)
      : corners_(corners), nodes_(nodes), order_(corners.size()), area_(corners.size()) {
    for (uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    build(0, static_cast<uint32_t>(order_.size()), 0);
  }
  const std::vector<uint32_t>& order() const { return order_; }

 private:
  void build(uint32_t begin, uint32_t end, int depth) {
    Bounds bounds;
    for (uint32_t i = begin; i < end; ++i) bounds.add(corners_[order_[i]]);
    const size_t at = nodes_.size();
    nodes_.push_back(node_around(bounds));
    if (end - begin <= TriangleBvh::kLeafTriangles) {
      nodes_[at].first = begin;
      nodes_[at].count = end - begin;
      return;
    }
    const uint32_t middle =
        depth < TriangleBvh::kFreeDepth ? cheapest_split(begin, end) : (begin + end) / 2;
    build(begin, middle, depth + 1);
    nodes_[at].first = static_cast<uint32_t>(nodes_.size());
    build(middle, end, depth + 1);
  }

  void sort(uint32_t begin, uint32_t end, int axis) {
    std::sort(order_.begin() + begin, order_.begin() + end, [&](uint32_t a, uint32_t b) {
      const double ca = middle_of(a, axis), cb = middle_of(b, axis);
      return ca != cb ? ca < cb : a < b;
    });
  }

  double middle_of(uint32_t triangle, int axis) const {
    const Corners& c = corners_[triangle];
    return static_cast<double>(c[0][axis]) + static_cast<double>(c[1][axis]) +
           static_cast<double>(c[2][axis]);
  }

  /// The full sweep of the surface area heuristic over three axes; leaves `order_` split there.
  uint32_t cheapest_split(uint32_t begin, uint32_t end) {
    double least = std::numeric_limits<double>::infinity();
    int best_axis = 0;
    uint32_t best = (begin + end) / 2;
    for (int axis = 0; axis < 3; ++axis) {
      sort(begin, end, axis);
      Bounds right;
      for (uint32_t i = end; i-- > begin + 1;) {
        right.add(corners_[order_[i]]);
        area_[i] = right.half_area();
      }
      Bounds left;
      for (uint32_t i = begin + 1; i < end; ++i) {
        left.add(corners_[order_[i - 1]]);
        const double cost = left.half_area() * (i - begin) + area_[i] * (end - i);
        if (cost < least) {
          least = cost;
          best_axis = axis;
          best = i;
        }
      }
    }
    sort(begin, end, best_axis);
    return best;
  }

  std::span<const Corners> corners_;
  std::vector<TriangleBvh::Node>& nodes_;
  std::vector<uint32_t> order_;
  std::vector<double> area_;  ///< of everything from a triangle to the end of the sweep
};

/// How often the ray from `p` along +x crosses the triangle from behind, minus from the front.
/// The projection on y, z is wound round the ray edge by edge, each edge taken from its lower end:
/// two triangles that share an edge judge it alike, so nothing slips through between them.
int crossing(const Corners& corners, const Vector3d& p) {
  const Vector3d c[3] = {corners[0].cast<double>(), corners[1].cast<double>(),
                         corners[2].cast<double>()};
  int winding = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d& u = c[i];
    const Vector3d& v = c[(i + 1) % 3];
    const bool up = u.z() <= p.z() && p.z() < v.z();
    const bool down = v.z() <= p.z() && p.z() < u.z();
    if (!up && !down) continue;
    const Vector3d& lower = up ? u : v;
    const Vector3d& upper = up ? v : u;
    const double left = (upper.y() - lower.y()) * (p.z() - lower.z()) -
                        (upper.z() - lower.z()) * (p.y() - lower.y());
    if (left > 0) winding += up ? 1 : -1;
  }
  if (winding == 0) return 0;
  if (std::max({c[0].x(), c[1].x(), c[2].x()}) < p.x()) return 0;
  if (std::min({c[0].x(), c[1].x(), c[2].x()}) > p.x()) return winding;
  const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]);
  return normal.dot(c[0] - p) * winding > 0 ? winding : 0;
}

/// What a turn round a solid counts; 0 round what is open. One sum then tells whether any solid is
/// wound round: turns are few and weights are 64 well mixed bits, so that they cancel with a chance
/// of about 1 in 2^60 only.
uint64_t weight_of(uint32_t solid) {
  if (solid == Surface::kOpen) return 0;
  return mixed(uint64_t{solid} + 1);
}

}  // namespace

TriangleBvh::TriangleBvh(std::span<const Eigen::Vector3f> points,
                         std::span<const Eigen::Vector3i> triangles) {
  assert(!triangles.empty());
  std::vector<Corners> corners(triangles.size());
  for (size_t i = 0; i < triangles.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const int index = triangles[i][c];
      assert(index >= 0 && static_cast<size_t>(index) < points.size());
      corners[i][static_cast<size_t>(c)] = points[static_cast<size_t>(index)];
    }
  const Surface surface(corners);
  solid_count_ = surface.solid_count();
  pieces_ = surface.pieces();
  nodes_.reserve(2 * corners.size());
  const Builder builder(corners, nodes_);
  triangles_.reserve(corners.size());
  for (uint32_t i : builder.order()) triangles_.push_back(corners[i]);
  const std::vector<uint32_t>& solids = surface.solids();
  const bool is_one = std::all_of(solids.begin(), solids.end(), [](uint32_t s) { return s == 0; });
  if (is_one || solid_count_ == 0) return;
  solids_.reserve(corners.size());
  for (uint32_t i : builder.order()) solids_.push_back(solids[i]);
}

bool TriangleBvh::contains(const Eigen::Vector3d& point_m) const {
  if (solid_count_ == 0) return false;
  uint32_t stack[kMaxDepth + 1];
  int top = 0;
  stack[top++] = 0;
  uint64_t winding = 0;
  while (top > 0) {
    const uint32_t at = stack[--top];
    const Node& node = nodes_[at];
    const auto offset = [&](size_t i) {
      return point_m[static_cast<Eigen::Index>(i)] - static_cast<double>(node.centre_m[i]);
    };
    if (offset(0) > static_cast<double>(node.half_m[0]) ||
        std::fabs(offset(1)) > static_cast<double>(node.half_m[1]) ||
        std::fabs(offset(2)) > static_cast<double>(node.half_m[2]))
      continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = at + 1;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto times = static_cast<uint64_t>(int64_t{crossing(triangles_[i], point_m)});
      if (times == 0) continue;
      winding += solids_.empty() ? times : times * weight_of(solids_[i]);
    }
  }
  return winding != 0;
}

}  // namespace throng
