#include "culling/volumes/slabs.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace throng {
namespace {

/// Weighted sum of slabs; a negative weight mirrors the slab.
struct SlabSum {
  Slab total;
  void add(const Slab& slab, float weight, bool rotated) {
    total.centre += rotated ? -(weight * slab.centre) : weight * slab.centre;
    total.half += weight * slab.half;
  }
};

/// Components of d by size: axes by decreasing |d|, and which components are negative.
struct Sorted {
  int axis[3];       // axis[0] has the largest |d|
  float weight[3];   // |d| in that order
  bool negative[3];  // by axis, not by rank
};

Sorted sorted(const Eigen::Vector3f& d) {
  Sorted s{};
  const float x = std::fabs(d.x()), y = std::fabs(d.y()), z = std::fabs(d.z());
  const float largest = std::max(x, std::max(y, z));
  const float smallest = std::min(x, std::min(y, z));
  s.axis[0] = x == largest ? 0 : (y == largest ? 1 : 2);
  s.axis[2] = z == smallest ? 2 : (y == smallest ? 1 : 0);
  s.axis[1] = 3 - s.axis[0] - s.axis[2];
  s.weight[0] = largest;
  s.weight[1] = std::max(std::min(x, y), std::min(std::max(x, y), z));
  s.weight[2] = smallest;
  for (int i = 0; i < 3; ++i) s.negative[i] = std::signbit(d[i]);
  return s;
}

struct Decomposition {
  const Slabs& slabs;
  const Sorted& s;
  SlabSum sum;

  void axis(int rank, float weight) {
    const int a = s.axis[rank];
    sum.add(slabs.slab[static_cast<size_t>(a)], weight, s.negative[a]);
  }
  void edge(int omitted_rank, float weight) {
    const int omitted = s.axis[omitted_rank];
    const int first = omitted == 0 ? 1 : 0;
    const int second = omitted == 2 ? 1 : 2;
    const bool opposite = s.negative[first] != s.negative[second];
    sum.add(slabs.slab[edge_direction(static_cast<size_t>(omitted), opposite)], weight,
            s.negative[first]);
  }
  /// Adds the corner with the signs of d; `flip` changes the sign of one axis.
  void corner(float weight, int flip = -1) {
    bool n[3] = {s.negative[0], s.negative[1], s.negative[2]};
    if (flip >= 0) n[flip] = !n[flip];
    sum.add(slabs.slab[corner_direction(n[1] != n[0], n[2] != n[0])], weight, n[0]);
  }
};

Slab intersection(const Slab& a, const Slab& b) {
  const float low = std::max(a.centre - a.half, b.centre - b.half);
  const float high = std::min(a.centre + a.half, b.centre + b.half);
  return {0.5f * (low + high), 0.5f * (high - low)};
}

}  // namespace

Slabs Slabs::around(std::span<const Eigen::Vector3f> points) {
  assert(!points.empty());
  Slabs out;
  for (size_t i = 0; i < kDirections.size(); ++i) {
    const Eigen::Vector3d direction(kDirections[i][0], kDirections[i][1], kDirections[i][2]);
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Eigen::Vector3f& p : points) {
      const double h = direction.dot(p.cast<double>());
      low = std::min(low, h);
      high = std::max(high, h);
    }
    const float centre = static_cast<float>(0.5 * (low + high));
    // The centre is rounded, so the half width covers both ends from it, rounded up.
    const double half =
        std::max(high - static_cast<double>(centre), static_cast<double>(centre) - low);
    out.slab[i] = {centre,
                   std::nextafter(static_cast<float>(half), std::numeric_limits<float>::max())};
  }
  return out;
}

template <>
Slab Slabs::bound<26>(const Eigen::Vector3f& d) const {
  const Sorted s = sorted(d);
  Decomposition parts{*this, s, {}};
  parts.corner(s.weight[2]);
  parts.edge(2, s.weight[1] - s.weight[2]);
  parts.axis(0, s.weight[0] - s.weight[1]);
  return parts.sum.total;
}

template <>
Slab Slabs::bound<18>(const Eigen::Vector3f& d) const {
  const Sorted s = sorted(d);
  const float largest = s.weight[0], middle = s.weight[1], smallest = s.weight[2];
  Decomposition parts{*this, s, {}};
  if (largest >= middle + smallest) {
    parts.edge(2, middle);
    parts.edge(1, smallest);
    parts.axis(0, std::max(0.0f, largest - middle - smallest));
  } else {
    parts.edge(2, std::max(0.0f, 0.5f * (largest + middle - smallest)));
    parts.edge(1, std::max(0.0f, 0.5f * (largest + smallest - middle)));
    parts.edge(0, std::max(0.0f, 0.5f * (middle + smallest - largest)));
  }
  return parts.sum.total;
}

template <>
Slab Slabs::bound<14>(const Eigen::Vector3f& d) const {
  const Sorted s = sorted(d);
  const float largest = s.weight[0], middle = s.weight[1], smallest = s.weight[2];
  Decomposition one{*this, s, {}};
  one.corner(smallest);
  one.axis(1, middle - smallest);
  one.axis(0, largest - smallest);
  Decomposition two{*this, s, {}};
  two.corner(0.5f * (middle + smallest));
  two.corner(0.5f * (middle - smallest), s.axis[2]);
  two.axis(0, largest - middle);
  return intersection(one.sum.total, two.sum.total);
}

}  // namespace throng
