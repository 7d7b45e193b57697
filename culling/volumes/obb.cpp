#include "culling/volumes/obb.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "base/portable_math.h"
#include "culling/volumes/pose_math.h"

namespace throng {
namespace {

using Points = std::vector<Eigen::Vector3d>;

std::array<size_t, 2> extremes(std::span<const Eigen::Vector3f> points, const Eigen::Vector3d& d) {
  std::array<size_t, 2> found = {0, 0};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (size_t p = 0; p < points.size(); ++p) {
    const double h = d.dot(points[p].cast<double>());
    if (h < low) low = h, found[0] = p;
    if (h > high) high = h, found[1] = p;
  }
  return found;
}

/// Points that determine the size of a box. Few, because the search evaluates them often.
class ExtremePoints {
 public:
  explicit ExtremePoints(std::span<const Eigen::Vector3f> points)
      : all_(points), chosen_(points.size()) {
    constexpr int kDirectionCount = 128;
    for (int i = 0; i < kDirectionCount; ++i) {  // Fibonacci spiral over the half sphere
      const double z = (i + 0.5) / kDirectionCount, turn = 2.399963229728653 * i;
      const double r = std::sqrt(1 - z * z);
      const SinCos angle = sin_cos(turn);
      add({r * angle.cos, r * angle.sin, z});
    }
  }
  const Points& points() const { return points_; }
  /// Adds the points that determine the box along these axes; false if all were known.
  bool add_for(const Eigen::Matrix3d& axes) {
    const size_t before = points_.size();
    for (int i = 0; i < 3; ++i) add(axes.col(i));
    return points_.size() > before;
  }

 private:
  void add(const Eigen::Vector3d& direction) {
    for (size_t p : extremes(all_, direction)) {
      if (!chosen_[p]) points_.push_back(all_[p].cast<double>());
      chosen_[p] = true;
    }
  }

  std::span<const Eigen::Vector3f> all_;
  std::vector<bool> chosen_;
  Points points_;
};

Eigen::Vector3d extents(const Points& points, const Eigen::Matrix3d& axes) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d h = axes.transpose() * p;
    low = low.cwiseMin(h);
    high = high.cwiseMax(h);
  }
  return high - low;
}

/// Volume, modified to prefer the smaller area of flat boxes and the shorter of thin ones.
double cost(const Points& points, const Eigen::Matrix3d& axes, double fat) {
  return (extents(points, axes).array() + fat).prod();
}

/// Rotates around the three axes by decreasing angles while the cost decreases.
Eigen::Matrix3d refined(const Points& points, Eigen::Matrix3d axes, double fat) {
  double best = cost(points, axes, fat);
  for (int halvings = 0; halvings <= 10; ++halvings) {
    const double angle = std::ldexp(0.2, -halvings);
    bool improved = true;
    for (int round = 0; improved && round < 16; ++round) {
      improved = false;
      for (int axis = 0; axis < 3; ++axis) {
        for (double side : {angle, -angle}) {
          const Eigen::Matrix3d turned_axes = axes * turn_about(Eigen::Vector3d::Unit(axis), side);
          const double found = cost(points, turned_axes, fat);
          if (found < best * (1 - 1e-9)) {
            best = found;
            axes = turned_axes;
            improved = true;
          }
        }
      }
    }
  }
  return axes;
}

Eigen::Matrix3d principal_axes(const Points& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  return axes;
}

}  // namespace

Eigen::Matrix3d smallest_box_axes(std::span<const Eigen::Vector3f> points) {
  ExtremePoints deciders(points);
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  deciders.add_for(best);
  const double fat = 1e-3 * extents(deciders.points(), best).maxCoeff();
  if (fat == 0) return best;  // one point: all boxes are equal
  double min_cost = cost(deciders.points(), best, fat);
  const Eigen::Matrix3d principal = principal_axes(deciders.points());
  // Initial frames: both frames, each also rotated by 45 degrees around each of its axes.
  for (const Eigen::Matrix3d& frame : {best, principal}) {
    for (int turn = 0; turn < 4; ++turn) {
      Eigen::Matrix3d axes = frame;
      if (turn < 3) axes *= turn_about(Eigen::Vector3d::Unit(turn), 0.785398163397448);
      do {
        axes = refined(deciders.points(), axes, fat);
      } while (deciders.add_for(axes));
      const double found = cost(deciders.points(), axes, fat);
      if (found < min_cost) {
        min_cost = found;
        best = axes;
      }
    }
  }
  return best;
}

Obb::Fitted Obb::fit(std::span<const Eigen::Vector3f> points) {
  assert(!points.empty());
  Fitted box;
  box.axes = smallest_box_axes(points).cast<float>();
  const Eigen::Matrix3d axes = box.axes.cast<double>();
  // The float axes are not quite orthonormal. The centre is computed with their inverse, and the
  // half widths from the centre as stored.
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d h = axes.transpose() * p.cast<double>();
    low = low.cwiseMin(h);
    high = high.cwiseMax(h);
  }
  box.centre_m = (axes.transpose().inverse() * (0.5 * (low + high))).cast<float>();
  const Eigen::Vector3d centre = axes.transpose() * box.centre_m.cast<double>();
  for (int i = 0; i < 3; ++i)
    box.half_m[i] =
        std::nextafter(static_cast<float>(std::max(high[i] - centre[i], centre[i] - low[i])),
                       std::numeric_limits<float>::max());
  return box;
}

Obb::Placed Obb::place(const Fitted& fitted, const PartPose& pose, float scale) {
  Placed box;
  box.centre_m = placed_point(pose, scale, fitted.centre_m);
  box.half_m = scale * fitted.half_m;
  for (int i = 0; i < 3; ++i) box.axes.col(i) = rotated(pose, fitted.axes.col(i));
  return box;
}

bool Obb::overlaps(const Placed& a, const Placed& b, const Eigen::Vector3f& a_to_b_m,
                   float margin_m) {
  // In A's frame: t between the centres, c(i, j) the cosine between A's axis i and B's axis j.
  const Eigen::Vector3f t = a.axes.transpose() * (a_to_b_m + b.centre_m - a.centre_m);
  const Eigen::Matrix3f c = a.axes.transpose() * b.axes;
  const Eigen::Matrix3f s = c.cwiseAbs();
  const Eigen::Vector3f& p = a.half_m;
  const Eigen::Vector3f& q = b.half_m;
  for (int i = 0; i < 3; ++i)
    if (std::fabs(t[i]) > p[i] + s.row(i).dot(q) + margin_m) return false;
  for (int j = 0; j < 3; ++j)
    if (std::fabs(c.col(j).dot(t)) > q[j] + s.col(j).dot(p) + margin_m) return false;
  // Edge axes are at most 1 long and get the full margin, above the rounding of parallel edges.
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const float between = t[i2] * c(i1, j) - t[i1] * c(i2, j);
      const float reach = p[i1] * s(i2, j) + p[i2] * s(i1, j) + q[j1] * s(i, j2) + q[j2] * s(i, j1);
      if (std::fabs(between) > reach + margin_m) return false;
    }
  }
  return true;
}

double Obb::volume_m3(const Fitted& fitted) { return 8 * fitted.half_m.cast<double>().prod(); }

}  // namespace throng
