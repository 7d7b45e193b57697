#include "culling/distance/growing_polytope.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace throng {
namespace {

/// A face lower than this share of the polytope's size has no plane worth the name.
constexpr double kThin = 1e-10;
/// What lies this share of the size above a plane may as well lie in it.
constexpr double kRounding = 1e-13;

}  // namespace

void GrowingPolytope::start(const std::array<Eigen::Vector3d, 4>& corners) {
  points_.assign(corners.begin(), corners.end());
  faces_.clear();
  size_m_ = 0;
  for (const Eigen::Vector3d& corner : corners)
    size_m_ = std::max(size_m_, corner.cwiseAbs().maxCoeff());
  if ((corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]) > 0)
    std::swap(points_[1], points_[2]);
  faces_ = {face(0, 1, 2), face(0, 2, 3), face(0, 3, 1), face(1, 3, 2)};
}

GrowingPolytope::Face GrowingPolytope::face(uint32_t a, uint32_t b, uint32_t c) const {
  const Eigen::Vector3d& p = points_[a];
  const Eigen::Vector3d& q = points_[b];
  const Eigen::Vector3d& r = points_[c];
  Face out;
  out.corners = {a, b, c};
  const Eigen::Vector3d cross = (q - p).cross(r - p);
  const double twice_area = cross.norm();
  const double longest =
      std::sqrt(std::max({(q - p).squaredNorm(), (r - p).squaredNorm(), (r - q).squaredNorm()}));
  if (twice_area <= longest * kThin * size_m_) return out;
  out.normal = cross / twice_area;
  out.distance = std::max({out.normal.dot(p), out.normal.dot(q), out.normal.dot(r)});
  return out;
}

void GrowingPolytope::remove(size_t index) {
  const std::array<uint32_t, 3> corners = faces_[index].corners;
  for (size_t i = 0; i < 3; ++i) removed_.push_back({corners[i], corners[(i + 1) % 3]});
  faces_[index] = faces_.back();
  faces_.pop_back();
}

/// A thin face goes with any of its neighbours: left alone, it would be a fin.
void GrowingPolytope::remove_thin_beside_removed() {
  const auto is_beside_removed = [&](const Face& each) {
    for (size_t i = 0; i < 3; ++i)
      for (const Edge& edge : removed_)
        if (edge.to == each.corners[i] && edge.from == each.corners[(i + 1) % 3]) return true;
    return false;
  };
  for (size_t i = 0; i < faces_.size();) {
    if (faces_[i].is_thin() && is_beside_removed(faces_[i])) {
      remove(i);
      i = 0;  // which may be another one's neighbour
    } else {
      ++i;
    }
  }
}

bool GrowingPolytope::add(const Eigen::Vector3d& point) {
  size_m_ = std::max(size_m_, point.cwiseAbs().maxCoeff());
  removed_.clear();
  bool some_thin = false;
  for (size_t i = 0; i < faces_.size();) {
    const Face& each = faces_[i];
    some_thin |= each.is_thin();
    if (each.normal.dot(point) > each.distance + kRounding * size_m_)
      remove(i);
    else
      ++i;
  }
  if (removed_.empty()) return false;
  if (some_thin) remove_thin_beside_removed();
  const auto added = static_cast<uint32_t>(points_.size());
  points_.push_back(point);
  for (const Edge& edge : removed_) {
    const bool is_inner = std::any_of(removed_.begin(), removed_.end(), [&](const Edge& other) {
      return other.from == edge.to && other.to == edge.from;
    });
    if (!is_inner) faces_.push_back(face(edge.from, edge.to, added));
  }
  return true;
}

}  // namespace throng
