#include "culling/distance/surface_distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "culling/distance/triangle_distance.h"
#include "culling/exact/tree_pair.h"

namespace throng {
namespace {

using Eigen::Vector3d;
using Node = TriangleBvh::Node;

/// Poses are rounded to float, so that lengths differ by a few units in the last place from one
/// frame to another; a bound in A's frame counts for this share of itself.
constexpr double kOfFrames = 1 - 1e-6;

/// How far apart two boxes with the same axes are at least; `between` their centres.
double gap(const Vector3d& between, const Vector3d& reach) {
  return (between.cwiseAbs() - reach).cwiseMax(0).norm();
}

class Search {
 public:
  Search(const PlacedSurface& a, const PlacedSurface& b, const Relative& a_from_b, double within_m,
         const KnownGap& known, ExactCounters& counters)
      : a_(*a.surface),
        b_(*b.surface),
        a_from_b_(a_from_b),
        ratio_(static_cast<double>(b.scale) / static_cast<double>(a.scale)),
        along_((scaled_rotation(*a.pose, 1).transpose() * known.direction).normalized()),
        along_in_b_(a_from_b.linear.transpose() * along_),
        slack_(kEnough_m / static_cast<double>(a.scale)),
        enough_(known.lo_m / static_cast<double>(a.scale) + slack_),
        most_(within_m / static_cast<double>(a.scale)),
        counters_(counters) {}

  /// Depth first, the nearer of two nodes first, so that little is left by the time it is looked
  /// at; until what is found is as near as the surfaces are known to be.
  void run() {
    Pair stack[2 * TriangleBvh::kMaxDepth + 2];
    int top = 0;
    stack[top++] = pair(0, 0);
    while (top > 0 && !found_enough()) {
      const Pair at = stack[--top];
      if (at.bound * kOfFrames > matters()) continue;
      const Node& node_a = a_.nodes()[at.a];
      const Node& node_b = b_.nodes()[at.b];
      if (node_a.count > 0 && node_b.count > 0) {
        compare_leaves(node_a, node_b);
        continue;
      }
      const bool of_a = opens_a(node_a, node_b, ratio_);
      Pair near = of_a ? pair(at.a + 1, at.b) : pair(at.a, at.b + 1);
      Pair far = of_a ? pair(node_a.first, at.b) : pair(at.a, node_b.first);
      if (far.between2 < near.between2) std::swap(near, far);
      stack[top++] = far;
      stack[top++] = near;
    }
  }

  bool found() const { return found_; }
  /// In A's unit of length; nothing where the search ended early.
  double lo() const { return found_enough() ? 0 : std::min(lo_, matters()) * kOfFrames; }
  const NearestPoints& points() const { return points_; }  ///< in A's frame

 private:
  struct Pair {
    uint32_t a, b;
    double bound;     ///< all of it is at least as far apart, in A's unit of length
    double between2;  ///< squared, from middle to middle
  };

  bool found_enough() const { return found_ && most_ <= enough_; }
  /// What is farther apart need not be looked at: the interval may be as wide as slack_.
  double matters() const { return found_ ? most_ - slack_ : most_; }

  Pair pair(uint32_t a, uint32_t b) {
    ++counters_.node_tests;
    const Node& node_a = a_.nodes()[a];
    const Node& node_b = b_.nodes()[b];
    const Vector3d half_a = to_double(node_a.half_m), half_b = to_double(node_b.half_m);
    const Vector3d t = a_from_b_.linear * to_double(node_b.centre_m) + a_from_b_.offset -
                       to_double(node_a.centre_m);
    // The box of each, and the box with its axes around the other's.
    const double by_a = gap(t, half_a + a_from_b_.linear_abs * half_b);
    const double by_b = gap(a_from_b_.inverse * t, half_b + a_from_b_.inverse_abs * half_a);
    const double by_known =
        along_.dot(t) - along_.cwiseAbs().dot(half_a) - along_in_b_.cwiseAbs().dot(half_b);
    return {a, b, std::max({by_a, ratio_ * by_b, by_known}), t.squaredNorm()};
  }

  void compare_leaves(const Node& node_a, const Node& node_b) {
    std::array<Triangle, TriangleBvh::kLeafTriangles> own;
    std::array<double, TriangleBvh::kLeafTriangles> reach;
    for (uint32_t i = 0; i < node_a.count; ++i) {
      for (size_t c = 0; c < 3; ++c)
        own[i].corner[c] = a_.triangles()[node_a.first + i][c].cast<double>();
      reach[i] = most_along(along_, own[i]);
    }
    for (uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
      Triangle tb = in_own_frame(b_.triangles()[j]);
      for (Vector3d& corner : tb.corner) corner = a_from_b_.linear * corner + a_from_b_.offset;
      const double from = least_along(along_, tb);
      for (uint32_t i = 0; i < node_a.count; ++i) {
        // Farther apart than matters, along the known direction or from middle to middle: most are.
        if ((from - reach[i]) * kOfFrames > matters() || is_apart(own[i], tb)) continue;
        ++counters_.triangle_tests;
        take(triangle_gap(own[i], tb));
      }
    }
  }

  /// Farther apart than matters along the line through their middles; costs a tenth of a distance.
  bool is_apart(const Triangle& a, const Triangle& b) const {
    const Vector3d between =
        (b.corner[0] + b.corner[1] + b.corner[2]) - (a.corner[0] + a.corner[1] + a.corner[2]);
    const double length = between.norm();
    return length > 0 && gap_along(between / length, a, b) * kOfFrames > matters();
  }

  void take(const TriangleGap& gap) {
    lo_ = std::min(lo_, gap.lo);
    if (gap.hi > most_) return;
    found_ = true;
    most_ = gap.hi;
    points_ = gap.points;
  }

  const TriangleBvh& a_;
  const TriangleBvh& b_;
  const Relative& a_from_b_;
  double ratio_;                 ///< B's unit of length in A's
  Vector3d along_, along_in_b_;  ///< the known direction, in A's frame and pulled back to B's
  double slack_;                 ///< in A's unit of length, as the next
  double enough_;                ///< what is found may stay
  double most_;                  ///< nothing farther apart than this matters
  double lo_ = std::numeric_limits<double>::infinity();
  bool found_ = false;
  NearestPoints points_;
  ExactCounters& counters_;
};

}  // namespace

std::optional<SurfaceGap> surface_gap(const PlacedSurface& a, const PlacedSurface& b,
                                      const Eigen::Vector3f& a_to_b_m, double within_m,
                                      const KnownGap& known, ExactCounters& counters) {
  assert(a.scale > 0 && b.scale > 0);
  const Relative a_from_b(*a.pose, a.scale, *b.pose, b.scale, a_to_b_m);
  // What is within the margin by a hair is found.
  Search search(a, b, a_from_b, within_m / kOfFrames, known, counters);
  search.run();
  if (!search.found()) return std::nullopt;
  const Eigen::Matrix3d linear = scaled_rotation(*a.pose, a.scale);
  const Vector3d shift = translation(*a.pose);
  SurfaceGap out;
  out.points_m = {linear * search.points().on_a + shift, linear * search.points().on_b + shift};
  out.hi_m = (out.points_m.on_b - out.points_m.on_a).norm();
  out.lo_m = std::min(out.hi_m, std::max(known.lo_m, static_cast<double>(a.scale) * search.lo()));
  return out;
}

}  // namespace throng
