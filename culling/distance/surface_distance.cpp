#include "culling/distance/surface_distance.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "culling/distance/simplex.h"
#include "culling/distance/triangle_distance.h"
#include "culling/triangles/touching_triangles.h"
#include "culling/triangles/triangle_bvh.h"

namespace throng {

// SurfacePoint is the point of a surface nearest to another point. It lies on a triangle, so its
// distance is never below the true one.

struct SurfacePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double squared = 0;
};

/// `to`: in the part's own frame. Does not allocate.
SurfacePoint nearest_on_surface(const TriangleBvh& surface, const Eigen::Vector3d& to,
                                TriangleCounters& counters);

// FrontTriangles collects the foremost triangles of a surface along a direction: all that can be
// near a part beyond.
// Invariant: omitted triangles are farther behind the foremost point than requested.

struct FrontTriangles {
  struct Triangle {
    uint32_t index;
    double behind;  ///< distance of its foremost corner behind the foremost of all
  };
  static constexpr size_t kMaxTriangles = 256;
  std::array<Triangle, kMaxTriangles> triangles;  ///< foremost first
  size_t count = 0;

  /// Collects triangles at most `behind` behind `ends`, the end of the surface along the direction.
  /// False if there are too many. Does not allocate.
  bool gather(const TriangleBvh& surface, const Eigen::Vector3d& direction, double ends,
              double behind);
};

namespace {

using Eigen::Vector3d;
using Node = TriangleBvh::Node;

/// Poses are rounded to float, so lengths in two frames differ by a few units in the last place. A
/// bound in A's frame is scaled by this factor.
constexpr double kFrameRounding = 1 - 1e-6;

constexpr int kMaxWalks = 8;
/// A walk that gains less than this share of the allowed bound width is the last.
constexpr double kMinGain = 0.25;

/// Lower bound of the distance of two boxes with the same axes; `between`: vector between centres.
double gap(const Vector3d& between, const Vector3d& reach) {
  return (between.cwiseAbs() - reach).cwiseMax(0).norm();
}

struct Ball {
  Vector3d middle;
  double radius;
  explicit Ball(const Triangle& t) : middle((t.corner[0] + t.corner[1] + t.corner[2]) / 3) {
    const auto from_middle = [&](size_t i) { return (t.corner[i] - middle).squaredNorm(); };
    radius = std::sqrt(std::max({from_middle(0), from_middle(1), from_middle(2)}));
  }
};

struct FrontBalls {
  std::array<Triangle, FrontTriangles::kMaxTriangles> triangles;
  std::array<double, FrontTriangles::kMaxTriangles> x, y, z, radius;
  std::array<double, FrontTriangles::kMaxTriangles> overlap;  ///< below 0: apart

  void set(size_t i, const Triangle& triangle) {
    const Ball ball(triangle);
    triangles[i] = triangle;
    x[i] = ball.middle.x();
    y[i] = ball.middle.y();
    z[i] = ball.middle.z();
    radius[i] = ball.radius;
  }
  /// Computes the overlap of each of the first `count` balls with a ball, squared, with sign.
  void find_overlaps(size_t count, const Vector3d& middle, double reach) {
    for (size_t i = 0; i < count; ++i) {
      const double dx = x[i] - middle.x(), dy = y[i] - middle.y(), dz = z[i] - middle.z(),
                   both = reach + radius[i];
      overlap[i] = both * both - (dx * dx + dy * dy + dz * dz);
    }
  }
};

class Search {
 public:
  Search(const PlacedSurface& a, const PlacedSurface& b, const RelativeFrame& a_from_b,
         double within_m, const KnownGap& known, TriangleCounters& counters)
      : a_(*a.surface),
        b_(*b.surface),
        hull_a_(*a.hull),
        hull_b_(*b.hull),
        a_from_b_(a_from_b),
        ratio_(static_cast<double>(b.scale) / static_cast<double>(a.scale)),
        along_((scaled_rotation(*a.pose, 1).transpose() * known.direction).normalized()),
        along_in_b_(a_from_b.linear.transpose() * along_),
        slack_(kDistanceTolerance_m / static_cast<double>(a.scale)),
        enough_(known.lo_m / static_cast<double>(a.scale) + slack_),
        max_(within_m / static_cast<double>(a.scale)),
        counters_(counters) {}

  /// Walks from a point near A to the nearest on B, to the nearest on A, and so on. Where the parts
  /// bulge towards each other this covers most of the path without testing pairs of boxes.
  void walk_from(const Vector3d& near_a) {
    Vector3d on_a = near_a;
    for (int walk = 0; walk < kMaxWalks && !has_converged(); ++walk) {
      const Vector3d in_b = a_from_b_.inverse * (on_a - a_from_b_.offset);
      const Vector3d on_b =
          a_from_b_.linear * nearest_on_surface(b_, in_b, counters_).point + a_from_b_.offset;
      on_a = nearest_on_surface(a_, on_b, counters_).point;
      const double apart = (on_b - on_a).norm();
      const bool is_far = apart > max_ - kMinGain * slack_;
      if (apart <= max_) take({on_a, on_b}, apart);
      if (is_far) break;
    }
  }

  /// Tests the foremost triangles of A and B along the known direction. B lies beyond A, so only
  /// these can be closer than the best pair. False if there are too many.
  bool sweep() {
    if (has_converged()) return true;
    const double a_ends = hull_a_.support_bound(along_),
                 b_ends = hull_b_.support_bound(-along_in_b_);
    const double between = (along_.dot(a_from_b_.offset) - b_ends - a_ends) * kFrameRounding;
    const double behind = search_limit() - between;
    FrontTriangles front_a, front_b;
    if (!front_a.gather(a_, along_, a_ends, behind) ||
        !front_b.gather(b_, -along_in_b_, b_ends, behind))
      return false;
    FrontBalls balls_b;
    for (size_t j = 0; j < front_b.count; ++j) balls_b.set(j, placed_b(front_b.triangles[j].index));
    size_t count_b = front_b.count;
    for (size_t i = 0; i < front_a.count && !has_converged(); ++i) {
      const Triangle of_a = in_own_frame(a_.triangles()[front_a.triangles[i].index]);
      const Ball ball(of_a);
      // Later triangles of A are farther behind, so fewer of B's are close enough.
      const double left = search_limit() - between - front_a.triangles[i].behind;
      while (count_b > 0 && front_b.triangles[count_b - 1].behind > left) --count_b;
      balls_b.find_overlaps(count_b, ball.middle, search_limit() / kFrameRounding + ball.radius);
      for (size_t j = 0; j < count_b; ++j)
        if (balls_b.overlap[j] >= 0) compare(of_a, balls_b.triangles[j]);
    }
    return true;
  }

  /// Depth first, the nearer of two nodes first, which leaves few nodes to open. Stops when the
  /// points found are as close as the lower bound allows.
  void run() {
    Pair stack[2 * TriangleBvh::kMaxDepth + 2];
    int top = 0;
    stack[top++] = pair(0, 0);
    while (top > 0 && !has_converged()) {
      const Pair at = stack[--top];
      if (at.bound * kFrameRounding > search_limit()) continue;
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
  /// Lower bound in A's unit of length; 0 if the search ended early.
  double lo() const { return has_converged() ? 0 : std::min(lo_, search_limit()) * kFrameRounding; }
  const NearestPoints& points() const { return points_; }  ///< in A's frame

 private:
  struct Pair {
    uint32_t a, b;
    double bound;     ///< lower bound of its distance in A's unit of length
    double between2;  ///< squared distance of the middles
  };

  bool has_converged() const { return found_ && max_ <= enough_; }
  /// Pairs farther apart need not be tested: the bounds may be slack_ apart.
  double search_limit() const { return found_ ? max_ - slack_ : max_; }

  Pair pair(uint32_t a, uint32_t b) {
    ++counters_.node_tests;
    const Node& node_a = a_.nodes()[a];
    const Node& node_b = b_.nodes()[b];
    const Vector3d half_a = to_double(node_a.half_m), half_b = to_double(node_b.half_m);
    const Vector3d t = a_from_b_.linear * to_double(node_b.centre_m) + a_from_b_.offset -
                       to_double(node_a.centre_m);
    // Each box against the other's enclosing box with the same axes.
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

  void compare_leaves(const Node& node_a, const Node& node_b) {
    std::array<Triangle, TriangleBvh::kLeafTriangles> own;
    std::array<double, TriangleBvh::kLeafTriangles> reach;
    for (uint32_t i = 0; i < node_a.count; ++i) {
      for (size_t c = 0; c < 3; ++c)
        own[i].corner[c] = a_.triangles()[node_a.first + i][c].cast<double>();
      reach[i] = max_along(along_, own[i]);
    }
    for (uint32_t j = node_b.first; j < node_b.first + node_b.count; ++j) {
      const Triangle tb = placed_b(j);
      const double from = min_along(along_, tb);
      for (uint32_t i = 0; i < node_a.count; ++i) {
        // Most are farther apart, along the known direction or between the middles.
        if ((from - reach[i]) * kFrameRounding <= search_limit()) compare(own[i], tb);
      }
    }
  }

  /// True if farther apart than search_limit() along the line through the nearest points so far, or
  /// through the middles. Costs a tenth of a distance.
  bool is_apart(const Triangle& a, const Triangle& b) const {
    if (found_ && gap_along(found_along_, a, b) * kFrameRounding > search_limit()) return true;
    const Vector3d between =
        (b.corner[0] + b.corner[1] + b.corner[2]) - (a.corner[0] + a.corner[1] + a.corner[2]);
    const double length = between.norm();
    return length > 0 && gap_along(between / length, a, b) * kFrameRounding > search_limit();
  }

  void compare(const Triangle& a, const Triangle& b) {
    if (is_apart(a, b)) return;
    ++counters_.triangle_tests;
    take(triangle_gap(a, b));
  }

  void take(const TriangleGap& gap) {
    lo_ = std::min(lo_, gap.lo);
    if (gap.hi > max_) return;
    take(gap.points, gap.hi);
  }
  void take(const NearestPoints& points, double apart) {
    found_ = true;
    max_ = apart;
    points_ = points;
    if (apart > 0) found_along_ = (points.on_b - points.on_a) / apart;
  }

  const TriangleBvh& a_;
  const TriangleBvh& b_;
  const ConvexHull &hull_a_, &hull_b_;
  const RelativeFrame& a_from_b_;
  double ratio_;                 ///< B's unit of length in A's
  Vector3d along_, along_in_b_;  ///< known direction, in A's frame and pulled back to B's
  double slack_;                 ///< in A's unit of length, as enough_ and max_
  double enough_;                ///< upper bound at which the search stops
  double max_;                   ///< pairs farther apart do not matter
  double lo_ = std::numeric_limits<double>::infinity();
  bool found_ = false;
  NearestPoints points_;
  Vector3d found_along_ = Vector3d::UnitX();  ///< unit vector from one point to the other
  TriangleCounters& counters_;
};

}  // namespace

std::optional<SurfaceGap> surface_gap(const PlacedSurface& a, const PlacedSurface& b,
                                      const Eigen::Vector3f& a_to_b_m, double within_m,
                                      const KnownGap& known, TriangleCounters& counters) {
  assert(a.scale > 0 && b.scale > 0);
  const RelativeFrame a_from_b(*a.pose, a.scale, *b.pose, b.scale, a_to_b_m);
  // Includes points barely within the margin.
  Search search(a, b, a_from_b, within_m / kFrameRounding, known, counters);
  const Eigen::Matrix3d linear = scaled_rotation(*a.pose, a.scale);
  const Vector3d shift = translation(*a.pose);
  search.walk_from(linear.inverse() * (known.guess_m - shift));
  if (!search.sweep()) search.run();
  if (!search.found()) return std::nullopt;
  SurfaceGap out;
  out.points_m = {linear * search.points().on_a + shift, linear * search.points().on_b + shift};
  out.hi_m = (out.points_m.on_b - out.points_m.on_a).norm();
  out.lo_m = std::min(out.hi_m, std::max(known.lo_m, static_cast<double>(a.scale) * search.lo()));
  return out;
}

namespace {

using Eigen::Vector3d;

/// Adds the points where the edges of one triangle cross the other.
struct Crossings {
  Vector3d sum = Vector3d::Zero();
  int count = 0;

  void add(const Triangle& edges, const Triangle& face) {
    const Vector3d u = face.corner[1] - face.corner[0], v = face.corner[2] - face.corner[0];
    const Vector3d normal = u.cross(v);
    const double squared = normal.squaredNorm();
    if (!(squared > 0)) return;
    for (int i = 0; i < 3; ++i) {
      const Vector3d &p = edges.corner[i], &q = edges.corner[(i + 1) % 3];
      const double before = normal.dot(p - face.corner[0]), after = normal.dot(q - face.corner[0]);
      if (before == after || (before > 0) == (after > 0)) continue;
      const Vector3d at = p + before / (before - after) * (q - p), r = at - face.corner[0];
      const double s = normal.dot(r.cross(v)) / squared, t = normal.dot(u.cross(r)) / squared;
      if (s < 0 || t < 0 || s + t > 1) continue;
      sum += at;
      ++count;
    }
  }
};

/// Point shared by two touching triangles: the middle of their common segment. If they are coplanar
/// or touch in a corner, the middle of their nearest points.
Vector3d shared_point(const Triangle& a, const Triangle& b) {
  Crossings crossings;
  crossings.add(a, b);
  crossings.add(b, a);
  if (crossings.count > 0) return crossings.sum / crossings.count;
  const NearestPoints nearest = triangle_gap(a, b).points;
  return 0.5 * (nearest.on_a + nearest.on_b);
}

/// Orders pairs by distance to a target.
struct NearestFirst {
  struct Rank {
    double a2 = 0, b2 = 0;  ///< squared distances to the two boxes, in A's unit of length
    double both() const { return std::max(a2, b2); }
  };
  Vector3d in_a, in_b;    ///< target in the frame of each
  double a_from_b2;       ///< squared: B's unit of length in A's
  const double& nearer2;  ///< squared: farther pairs are skipped

  Rank with_a(Rank rank, const TriangleBvh::Node& node) const {
    return {squared_to_box(node, in_a), rank.b2};
  }
  Rank with_b(Rank rank, const TriangleBvh::Node& node) const {
    return {rank.a2, a_from_b2 * squared_to_box(node, in_b)};
  }
  bool is_open(Rank rank) const { return rank.both() < nearer2; }
  static bool is_before(Rank one, Rank other) { return one.both() < other.both(); }
};

}  // namespace

std::optional<Vector3d> contact_point(const PlacedSurface& a, const PlacedSurface& b,
                                      const Eigen::Vector3f& a_to_b_m, const Vector3d& guess_m,
                                      TriangleCounters& counters) {
  const RelativeFrame a_from_b(*a.pose, a.scale, *b.pose, b.scale, a_to_b_m);
  const double ratio = static_cast<double>(b.scale) / static_cast<double>(a.scale);
  const Eigen::Matrix3d linear = scaled_rotation(*a.pose, a.scale);
  const Vector3d target = linear.inverse() * (guess_m - translation(*a.pose));
  const double worth = kContactPointTolerance_m / static_cast<double>(a.scale);
  std::optional<Vector3d> best;
  double best_far = std::numeric_limits<double>::infinity(), nearer2 = best_far;
  const TouchingTriangles triangles(*a.surface, *b.surface, a_from_b, ratio, counters);
  triangles.visit(
      [&](const Triangle& ta, const Triangle& tb) {
        const Vector3d point = shared_point(ta, tb);
        const double far = (point - target).norm();
        if (far < best_far) {
          best = point;
          best_far = far;
          nearer2 = std::pow(std::max(0.0, far - worth), 2);
        }
        return false;
      },
      NearestFirst{target, a_from_b.inverse * (target - a_from_b.offset), ratio * ratio, nearer2});
  if (!best) best = piece_inside(*a.surface, *b.surface, a_from_b);
  if (!best) return std::nullopt;
  return linear * *best + translation(*a.pose);
}

namespace {

using Eigen::Vector3d;

/// Directions are doubles, boxes and corners are floats: the rounding of their sums is below this.
constexpr double kSumRounding = 1e-12;

double reach_along(const TriangleBvh::Node& node, const Vector3d& direction,
                   const Vector3d& direction_abs) {
  return direction.dot(to_double(node.centre_m)) + direction_abs.dot(to_double(node.half_m)) +
         kSumRounding;
}

double foremost_corner(const std::array<Eigen::Vector3f, 3>& corners, const Vector3d& direction) {
  const auto along = [&](size_t i) { return direction.dot(corners[i].cast<double>()); };
  return std::max({along(0), along(1), along(2)});
}

/// Calls visit(index, extent of its foremost corner) for the triangles of all leaves that may reach
/// min_extent(), which may grow meanwhile. The foremost of two nodes comes first.
template <typename MinExtent, typename Visit>
void for_foremost(const TriangleBvh& surface, const Vector3d& direction,
                  const MinExtent& min_extent, const Visit& visit) {
  const Vector3d direction_abs = direction.cwiseAbs();
  struct Waiting {
    uint32_t node;
    double reach;
  };
  const auto waiting = [&](uint32_t node) {
    return Waiting{node, reach_along(surface.nodes()[node], direction, direction_abs)};
  };
  Waiting stack[TriangleBvh::kMaxDepth + 2];
  int top = 0;
  stack[top++] = waiting(0);
  while (top > 0) {
    const Waiting at = stack[--top];
    if (at.reach < min_extent()) continue;
    const TriangleBvh::Node& node = surface.nodes()[at.node];
    for (uint32_t i = node.first; i < node.first + node.count; ++i)
      visit(i, foremost_corner(surface.triangles()[i], direction));
    if (node.count > 0) continue;
    Waiting near = waiting(at.node + 1), far = waiting(node.first);
    if (far.reach > near.reach) std::swap(near, far);
    stack[top++] = far;
    stack[top++] = near;
  }
}

}  // namespace

bool FrontTriangles::gather(const TriangleBvh& surface, const Vector3d& direction, double ends,
                            double behind) {
  count = 0;
  bool fits = true;
  for_foremost(
      surface, direction,
      [&] { return fits ? ends - behind : std::numeric_limits<double>::infinity(); },
      [&](uint32_t index, double reach) {
        if (ends - reach > behind) return;
        fits &= count < kMaxTriangles;
        if (fits) triangles[count++] = {index, ends - reach};
      });
  std::sort(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Triangle& p, const Triangle& q) {
              return p.behind < q.behind || (p.behind == q.behind && p.index < q.index);
            });
  return fits;
}

namespace {

using Eigen::Vector3d;

/// Point of a triangle nearest to `to`, minus `to`.
Vector3d nearest_on_triangle(const std::array<Eigen::Vector3f, 3>& corners, const Vector3d& to) {
  const Vector3d a = corners[0].cast<double>() - to, b = corners[1].cast<double>() - to,
                 c = corners[2].cast<double>() - to;
  const std::array<double, 3> weights = weights_of_nearest(a, b, c);
  return weights[0] * a + weights[1] * b + weights[2] * c;
}

}  // namespace

SurfacePoint nearest_on_surface(const TriangleBvh& surface, const Vector3d& to,
                                TriangleCounters& counters) {
  struct Waiting {
    uint32_t node;
    double squared;
  };
  const auto waiting = [&](uint32_t node) {
    ++counters.node_tests;
    return Waiting{node, squared_to_box(surface.nodes()[node], to)};
  };
  SurfacePoint out{to, std::numeric_limits<double>::infinity()};
  Waiting stack[TriangleBvh::kMaxDepth + 2];
  int top = 0;
  stack[top++] = waiting(0);
  while (top > 0) {
    const Waiting at = stack[--top];
    if (at.squared >= out.squared) continue;
    const TriangleBvh::Node& node = surface.nodes()[at.node];
    if (node.count == 0) {
      Waiting near = waiting(at.node + 1), far = waiting(node.first);
      if (far.squared < near.squared) std::swap(near, far);
      stack[top++] = far;
      stack[top++] = near;
      continue;
    }
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Vector3d between = nearest_on_triangle(surface.triangles()[i], to);
      if (const double squared = between.squaredNorm(); squared < out.squared)
        out = {to + between, squared};
    }
  }
  return out;
}

}  // namespace throng
