#include "culling/distance/simplex.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace throng {
namespace {

using Eigen::Vector3d;

/// Position on a segment nearest to the origin: 0 at a, 1 at b.
double share_of_nearest(const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  return length2 > 0 ? std::clamp(-a.dot(along) / length2, 0.0, 1.0) : 0.0;
}

struct Nearest {
  std::array<double, 4> weights{};
  double squared = std::numeric_limits<double>::infinity();
};

class Finder {
 public:
  explicit Finder(const Simplex& simplex) : simplex_(simplex) {}

  void point(int a) { take({{a, 1}}); }

  void segment(int a, int b) {
    const double share = share_of_nearest(at(a), at(b));
    take({{a, 1 - share}, {b, share}});
  }

  void triangle(int a, int b, int c) {
    const std::array<double, 3> weights = weights_of_nearest(at(a), at(b), at(c));
    take({{a, weights[0]}, {b, weights[1]}, {c, weights[2]}});
  }

  /// True if the origin is inside, up to rounding.
  bool holds_origin() const {
    const auto side = [&](int a, int b, int c, int beyond) {
      const Vector3d normal = (at(b) - at(a)).cross(at(c) - at(a));
      return -normal.dot(at(a)) * normal.dot(at(beyond) - at(a));
    };
    return side(0, 1, 2, 3) > 0 && side(0, 1, 3, 2) > 0 && side(0, 2, 3, 1) > 0 &&
           side(1, 2, 3, 0) > 0;
  }

  const Nearest& nearest() const { return nearest_; }

 private:
  struct Weight {
    int corner;
    double weight;
  };

  const Vector3d& at(int corner) const {
    return simplex_.corners[static_cast<size_t>(corner)].between;
  }
  void take(std::initializer_list<Weight> weights) {
    Vector3d point = Vector3d::Zero();
    for (const Weight& w : weights) point += w.weight * at(w.corner);
    const double squared = point.squaredNorm();
    if (!(squared < nearest_.squared)) return;
    nearest_ = {{}, squared};
    for (const Weight& w : weights) nearest_.weights[static_cast<size_t>(w.corner)] = w.weight;
  }

  const Simplex& simplex_;
  Nearest nearest_;
};

}  // namespace

/// Decides by the signs that give the edge or corner next to the origin.
std::array<double, 3> weights_of_nearest(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (va > 0 && vb > 0 && vc > 0) {
    const double sum = va + vb + vc;
    return {va / sum, vb / sum, vc / sum};
  }
  // Beyond an edge, or degenerate.
  std::array<double, 3> best{};
  double min_squared = std::numeric_limits<double>::infinity();
  const auto try_edge = [&](const Vector3d& p, const Vector3d& q, size_t i, size_t j) {
    const double share = share_of_nearest(p, q);
    const double squared = ((1 - share) * p + share * q).squaredNorm();
    if (!(squared < min_squared)) return;
    min_squared = squared;
    best = {};
    best[i] = 1 - share;
    best[j] = share;
  };
  if (vc <= 0) try_edge(a, b, 0, 1);
  if (vb <= 0) try_edge(a, c, 0, 2);
  if (va <= 0) try_edge(b, c, 1, 2);
  return best;
}

Vector3d Simplex::reduce() {
  Finder finder(*this);
  switch (count) {
    case 1:
      finder.point(0);
      break;
    case 2:
      finder.segment(0, 1);
      break;
    case 3:
      finder.triangle(0, 1, 2);
      break;
    default:
      if (finder.holds_origin()) return Vector3d::Zero();
      finder.triangle(0, 1, 2);
      finder.triangle(0, 1, 3);
      finder.triangle(0, 2, 3);
      finder.triangle(1, 2, 3);
  }
  Vector3d out = Vector3d::Zero();
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    const double weight = finder.nearest().weights[static_cast<size_t>(i)];
    if (weight <= 0) continue;
    corners[static_cast<size_t>(kept)] = corners[static_cast<size_t>(i)];
    weights[static_cast<size_t>(kept)] = weight;
    out += weight * corners[static_cast<size_t>(kept++)].between;
  }
  count = kept;
  return out;
}

}  // namespace throng
