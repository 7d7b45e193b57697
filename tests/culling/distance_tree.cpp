#include "tests/culling/distance_tree.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "culling/distance/triangle_distance.h"

namespace throng::test {
namespace {

using Eigen::Vector3d;

constexpr size_t kLeaf = 1;

Vector3d middle_of(const Triangle& t) { return (t.corner[0] + t.corner[1] + t.corner[2]) / 3; }

/// x -> linear x + shift.
struct Affine {
  Eigen::Matrix3d linear;
  Vector3d shift;
  Vector3d operator*(const Vector3d& x) const { return linear * x + shift; }
  Triangle operator*(const Triangle& t) const {
    return {{*this * t.corner[0], *this * t.corner[1], *this * t.corner[2]}};
  }
};

Affine world_from(const DistanceTree::Placed& part, const Vector3d& root_m) {
  Affine out{Eigen::Matrix3d(), root_m};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      out.linear(r, c) =
          static_cast<double>(part.scale) * static_cast<double>(part.pose->rows[r][c]);
    out.shift[r] += static_cast<double>(part.pose->rows[r][3]);
  }
  return out;
}

/// True if farther apart than `max_m` along the line through their middles.
bool is_apart(const Triangle& a, const Triangle& b, double max_m) {
  const Vector3d between = middle_of(b) - middle_of(a);
  const double length = between.norm();
  return length > 0 && gap_along(between / length, a, b) > max_m + 1e-9;
}

}  // namespace

DistanceTree::DistanceTree(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3i> triangles) {
  for (const Eigen::Vector3i& t : triangles) {
    const auto corner = [&](int c) -> Vector3d {
      return points[static_cast<size_t>(t[c])].cast<double>();
    };
    triangles_.push_back({{corner(0), corner(1), corner(2)}});
  }
  add(0, triangles_.size());
}

size_t DistanceTree::add(size_t first, size_t end) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;
  for (size_t i = first; i < end; ++i)
    for (const Vector3d& corner : triangles_[i].corner) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  const Vector3d middle = (low + high) / 2;
  double radius = 0;
  for (size_t i = first; i < end; ++i)
    for (const Vector3d& corner : triangles_[i].corner)
      radius = std::max(radius, (corner - middle).norm());
  const size_t index = balls_.size();
  balls_.push_back({middle, radius, first, end});
  if (end - first <= kLeaf) return index;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const size_t half = (first + end) / 2;
  const auto at = [&](size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(half), at(end), [axis](const Triangle& p, const Triangle& q) {
    return middle_of(p)[axis] < middle_of(q)[axis];
  });
  const size_t left = add(first, half), right = add(half, end);
  balls_[index].left = left;
  balls_[index].right = right;
  return index;
}

double DistanceTree::distance(const Placed& a, const Placed& b, const Vector3d& a_to_b_m,
                              double within_m) {
  const Affine from_a = world_from(a, Vector3d::Zero()), from_b = world_from(b, a_to_b_m);
  // Rotations are rounded to float: no point of a part is farther out by more than this share.
  const double max_scale_a = static_cast<double>(a.scale) * (1 + 1e-5),
               max_scale_b = static_cast<double>(b.scale) * (1 + 1e-5);
  double min_distance = within_m;
  bool found = false;
  struct Two {
    size_t a, b;
    double apart;
  };
  const auto two = [&](size_t i, size_t j) {
    const Ball &p = a.tree->balls_[i], &q = b.tree->balls_[j];
    return Two{i, j,
               (from_b * q.middle - from_a * p.middle).norm() - max_scale_a * p.radius -
                   max_scale_b * q.radius};
  };
  std::vector<Two> open = {two(0, 0)};
  while (!open.empty()) {
    const Two at = open.back();
    open.pop_back();
    if (at.apart > min_distance) continue;
    const Ball &p = a.tree->balls_[at.a], &q = b.tree->balls_[at.b];
    if (p.left == 0 && q.left == 0) {
      for (size_t i = p.first; i < p.end; ++i)
        for (size_t j = q.first; j < q.end; ++j) {
          const Triangle of_a = from_a * a.tree->triangles_[i],
                         of_b = from_b * b.tree->triangles_[j];
          if (is_apart(of_a, of_b, min_distance)) continue;
          const double apart = triangle_gap(of_a, of_b).hi;
          if (apart > min_distance) continue;
          min_distance = apart;
          found = true;
        }
      continue;
    }
    const bool opens_a =
        q.left == 0 || (p.left != 0 && max_scale_a * p.radius > max_scale_b * q.radius);
    Two near = opens_a ? two(p.left, at.b) : two(at.a, q.left);
    Two far = opens_a ? two(p.right, at.b) : two(at.a, q.right);
    if (far.apart < near.apart) std::swap(near, far);
    open.push_back(far);
    open.push_back(near);
  }
  return found ? min_distance : std::numeric_limits<double>::infinity();
}

double DistanceTree::distance_by_all(const Placed& a, const Placed& b, const Vector3d& a_to_b_m) {
  struct Rounded {
    Triangle triangle;
    Vector3d middle;
    double radius;
  };
  const auto rounded = [](const Triangle& t) -> Rounded {
    const Vector3d middle = middle_of(t);
    double radius = 0;
    for (const Vector3d& corner : t.corner) radius = std::max(radius, (corner - middle).norm());
    return {t, middle, radius};
  };
  const Affine from_a = world_from(a, Vector3d::Zero()), from_b = world_from(b, a_to_b_m);
  std::vector<Rounded> of_b;
  for (const Triangle& q : b.tree->triangles_) of_b.push_back(rounded(from_b * q));
  double min_distance = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : a.tree->triangles_) {
    const Rounded p = rounded(from_a * triangle);
    for (const Rounded& q : of_b) {
      const double reach = min_distance + p.radius + q.radius;  // farther apart by their middles
      if ((q.middle - p.middle).squaredNorm() > reach * reach) continue;
      min_distance = std::min(min_distance, triangle_gap(p.triangle, q.triangle).hi);
    }
  }
  return min_distance;
}

}  // namespace throng::test
