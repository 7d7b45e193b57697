#include "culling/distance/growing_polytope.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace throng {
namespace {

__extension__ using Wide = __int128;

/// Bits per coordinate. A difference has one more, a product of two differences 80. Their sums in a
/// cross product have 81, those of its product with a third difference 123. Wide has 127.
constexpr int kBits = 39;

struct Cross {
  Wide x, y, z;
};

/// In units of the grid. Exact, because all are integers and differences fit a double.
std::array<int64_t, 3> whole(const Eigen::Vector3d& difference, double grid_m) {
  return {static_cast<int64_t>(difference.x() / grid_m),
          static_cast<int64_t>(difference.y() / grid_m),
          static_cast<int64_t>(difference.z() / grid_m)};
}

Cross exact_cross(const std::array<int64_t, 3>& u, const std::array<int64_t, 3>& v) {
  const auto at = [&](size_t i, size_t j) { return Wide{u[i]} * v[j] - Wide{u[j]} * v[i]; };
  return {at(1, 2), at(2, 0), at(0, 1)};
}

}  // namespace

double GrowingPolytope::grid_m(double reach_m) {
  assert(reach_m > 0 && std::isfinite(reach_m));
  int exponent = 0;
  std::frexp(reach_m, &exponent);
  return std::ldexp(1.0, exponent - kBits);
}

void GrowingPolytope::start(const std::array<Eigen::Vector3d, 4>& corners, double reach_m) {
  grid_m_ = grid_m(reach_m);
  points_.clear();
  for (const Eigen::Vector3d& corner : corners) points_.push_back(on_grid(corner, grid_m_));
  faces_.clear();
  distances_.clear();
  visible_for_.clear();
  free_.clear();
  begins_at_.assign(4, 0);
  add_face(0, 1, 2);
  if (side(0, points_[3]) > 0) {
    std::swap(points_[1], points_[2]);
    faces_.clear();
    distances_.clear();
    visible_for_.clear();
    add_face(0, 1, 2);
  }
  assert(side(0, points_[3]) < 0 && "the four corners are coplanar");
  add_face(0, 2, 3);
  add_face(0, 3, 1);
  add_face(1, 3, 2);
  faces_[0].neighbours = {2, 3, 1};
  faces_[1].neighbours = {0, 3, 2};
  faces_[2].neighbours = {1, 3, 0};
  faces_[3].neighbours = {2, 1, 0};
}

/// Adds a face in a free slot, without its neighbours.
uint32_t GrowingPolytope::add_face(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t slot;
  if (free_.empty()) {
    slot = static_cast<uint32_t>(faces_.size());
    faces_.emplace_back();
    distances_.emplace_back();
    visible_for_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  Face& face = faces_[slot];
  face.corners = {a, b, c};
  const Eigen::Vector3d &p = points_[a], &q = points_[b], &r = points_[c];
  const Cross cross = exact_cross(whole(q - p, grid_m_), whole(r - p, grid_m_));
  face.cross = {static_cast<double>(cross.x), static_cast<double>(cross.y),
                static_cast<double>(cross.z)};
  face.normal = face.cross.normalized();
  distances_[slot] = std::max({face.normal.dot(p), face.normal.dot(q), face.normal.dot(r)});
  visible_for_[slot] = 0;
  return slot;
}

int GrowingPolytope::exact_side(const Face& face, const Eigen::Vector3d& on_grid) const {
  const Eigen::Vector3d& p = points_[face.corners[0]];
  const Cross cross = exact_cross(whole(points_[face.corners[1]] - p, grid_m_),
                                  whole(points_[face.corners[2]] - p, grid_m_));
  const std::array<int64_t, 3> d = whole(on_grid - p, grid_m_);
  const Wide sum = cross.x * d[0] + cross.y * d[1] + cross.z * d[2];
  return (sum > 0) - (sum < 0);
}

/// Finds the faces with the point in front: they are connected, and a ring of edges encloses them.
void GrowingPolytope::find_horizon(const Eigen::Vector3d& point, uint32_t face) {
  const auto number = static_cast<uint32_t>(points_.size());
  removed_.assign(1, face);
  visible_for_[face] = number;
  horizon_.clear();
  for (size_t next = 0; next < removed_.size(); ++next) {
    const Face& seen = faces_[removed_[next]];
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t beyond = seen.neighbours[i];
      if (visible_for_[beyond] == number) continue;
      if (side(beyond, point) > 0) {
        visible_for_[beyond] = number;
        removed_.push_back(beyond);
      } else {
        horizon_.push_back({seen.corners[i], seen.corners[(i + 1) % 3], beyond});
      }
    }
  }
}

bool GrowingPolytope::add(const Eigen::Vector3d& point, uint32_t face) {
  const Eigen::Vector3d there = on_grid(point, grid_m_);
  added_.clear();
  removed_.clear();
  if (side(face, there) <= 0) return false;
  find_horizon(there, face);
  const auto number = static_cast<uint32_t>(points_.size());
  points_.push_back(there);
  begins_at_.push_back(0);
  for (const uint32_t each : removed_) distances_[each] = kFree;
  free_.insert(free_.end(), removed_.rbegin(), removed_.rend());
  for (const Edge& edge : horizon_) {
    const uint32_t slot = add_face(edge.from, edge.to, number);
    added_.push_back(slot);
    begins_at_[edge.from] = slot;
    faces_[slot].neighbours[0] = edge.beyond;
    Face& beyond = faces_[edge.beyond];
    const size_t i = static_cast<size_t>(
        std::find(beyond.corners.begin(), beyond.corners.end(), edge.to) - beyond.corners.begin());
    assert(i < 3 && beyond.corners[(i + 1) % 3] == edge.from);
    beyond.neighbours[i] = slot;
  }
  for (const uint32_t slot : added_) {
    const uint32_t next = begins_at_[faces_[slot].corners[1]];
    faces_[slot].neighbours[1] = next;
    faces_[next].neighbours[2] = slot;
  }
  return true;
}

bool GrowingPolytope::add(const Eigen::Vector3d& point) {
  const Eigen::Vector3d there = on_grid(point, grid_m_);
  for (uint32_t face = 0; face < faces_.size(); ++face)
    if (is_face(face) && side(face, there) > 0) return add(point, face);
  return false;
}

}  // namespace throng
