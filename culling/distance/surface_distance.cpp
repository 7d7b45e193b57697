#include "culling/distance/surface_distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "culling/distance/surface_front.h"
#include "culling/distance/surface_point.h"
#include "culling/distance/triangle_distance.h"
#include "culling/exact/tree_pair.h"

namespace throng {
namespace {

using Eigen::Vector3d;
using Node = TriangleBvh::Node;

/// Poses are rounded to float, so that lengths differ by a few units in the last place from one
/// frame to another; a bound in A's frame counts for this share of itself.
constexpr double kOfFrames = 1 - 1e-6;

constexpr int kMostWalks = 8;
/// A walk that comes no nearer than by this share of what an interval may be wide is the last.
constexpr double kWorthwhile = 0.25;

/// How far apart two boxes with the same axes are at least; `between` their centres.
double gap(const Vector3d& between, const Vector3d& reach) {
  return (between.cwiseAbs() - reach).cwiseMax(0).norm();
}

/// A triangle and a ball around it.
struct Rounded {
  Triangle triangle;
  double behind, radius;
  Vector3d middle;

  Rounded() = default;
  Rounded(const Triangle& placed, double is_behind) : triangle(placed), behind(is_behind) {
    middle = (placed.corner[0] + placed.corner[1] + placed.corner[2]) / 3;
    const auto from_middle = [&](const Vector3d& corner) {
      return (corner - middle).squaredNorm();
    };
    radius = std::sqrt(std::max({from_middle(placed.corner[0]), from_middle(placed.corner[1]),
                                 from_middle(placed.corner[2])}));
  }
};

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

  /// From a point near A, to the nearest on B, from there to the nearest on A, and so on: where the
  /// parts bulge towards each other, that is most of the way, and no pair of boxes is looked at.
  void walk_from(const Vector3d& near_a) {
    Vector3d on_a = near_a;
    for (int walk = 0; walk < kMostWalks && !found_enough(); ++walk) {
      const Vector3d in_b = a_from_b_.inverse * (on_a - a_from_b_.offset);
      const Vector3d on_b =
          a_from_b_.linear * nearest_on_surface(b_, in_b, counters_).point + a_from_b_.offset;
      on_a = nearest_on_surface(a_, on_b, counters_).point;
      const double apart = (on_b - on_a).norm();
      const bool is_far = apart > most_ - kWorthwhile * slack_;
      if (apart <= most_) {
        found_ = true;
        most_ = apart;
        points_ = {on_a, on_b};
      }
      if (is_far) break;
    }
  }

  /// Along the known direction B lies beyond A, so what can be nearer than the best lies at A's
  /// front and at B's: a few triangles each, each of A's against each of B's. False where they are
  /// too many.
  bool sweep() {
    const double a_ends = farthest_along(a_, along_), b_ends = farthest_along(b_, -along_in_b_);
    const double between = (along_.dot(a_from_b_.offset) - b_ends - a_ends) * kOfFrames;
    const double behind = matters() - between;
    SurfaceFront front_a, front_b;
    if (!front_a.gather(a_, along_, a_ends, behind) ||
        !front_b.gather(b_, -along_in_b_, b_ends, behind))
      return false;
    std::array<Rounded, SurfaceFront::kMost> of_b;
    for (size_t j = 0; j < front_b.count; ++j)
      of_b[j] = {placed_b(front_b.triangles[j].index), front_b.triangles[j].behind};
    for (size_t i = 0; i < front_a.count && !found_enough(); ++i) {
      const Rounded of_a(in_own_frame(a_.triangles()[front_a.triangles[i].index]),
                         front_a.triangles[i].behind);
      for (size_t j = 0; j < front_b.count; ++j) {
        if (between + of_a.behind + of_b[j].behind > matters()) break;  // so are the next
        compare_if_near(of_a, of_b[j]);
      }
    }
    return true;
  }

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

  Triangle placed_b(uint32_t index) const {
    Triangle out = in_own_frame(b_.triangles()[index]);
    for (Vector3d& corner : out.corner) corner = a_from_b_.linear * corner + a_from_b_.offset;
    return out;
  }

  void compare_if_near(const Rounded& of_a, const Rounded& of_b) {
    const double reach = matters() / kOfFrames + of_a.radius + of_b.radius;
    if ((of_a.middle - of_b.middle).squaredNorm() <= reach * reach)
      compare(of_a.triangle, of_b.triangle);
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
      const Triangle tb = placed_b(j);
      const double from = least_along(along_, tb);
      for (uint32_t i = 0; i < node_a.count; ++i) {
        // Farther apart than matters, along the known direction or from middle to middle: most are.
        if ((from - reach[i]) * kOfFrames <= matters()) compare(own[i], tb);
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

  void compare(const Triangle& a, const Triangle& b) {
    if (is_apart(a, b)) return;
    ++counters_.triangle_tests;
    take(triangle_gap(a, b));
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
  const Eigen::Matrix3d linear = scaled_rotation(*a.pose, a.scale);
  const Vector3d shift = translation(*a.pose);
  search.walk_from(linear.inverse() * (known.near_m - shift));
  if (!search.sweep()) search.run();
  if (!search.found()) return std::nullopt;
  SurfaceGap out;
  out.points_m = {linear * search.points().on_a + shift, linear * search.points().on_b + shift};
  out.hi_m = (out.points_m.on_b - out.points_m.on_a).norm();
  out.lo_m = std::min(out.hi_m, std::max(known.lo_m, static_cast<double>(a.scale) * search.lo()));
  return out;
}

}  // namespace throng
