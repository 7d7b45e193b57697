#include "scenes/orca.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace throng {
namespace {

/// Rounding of metres a second: below it a plane counts as met.
constexpr double kTiny = 1e-9;
/// Planes a walker meets at most: ten people, and walls on every side.
constexpr size_t kMaxPlanes = 64;

Eigen::Vector2d left_of(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }
double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// What to look for: the point nearest to a target, or the one farthest along a direction.
struct Wish {
  Eigen::Vector2d vector;
  bool is_direction = false;
};

/// The best point on the border of planes[index] that meets the planes before it and the speed
/// limit. False if there is none.
bool solve_on_border(std::span<const HalfPlane> planes, size_t index, const Wish& wish,
                     double max_speed, Eigen::Vector2d& v) {
  const HalfPlane& plane = planes[index];
  const double room = max_speed * max_speed - plane.offset_mps * plane.offset_mps;
  if (room < 0) return false;
  const Eigen::Vector2d foot = plane.offset_mps * plane.normal;
  const Eigen::Vector2d along = left_of(plane.normal);
  double high = std::sqrt(room);
  double low = -high;
  for (size_t i = 0; i < index; ++i) {
    const double slope = planes[i].normal.dot(along);
    const double need = planes[i].violation_mps(foot);  // slope * t >= need
    if (std::abs(slope) <= kTiny) {
      if (need > kTiny) return false;
    } else if (slope > 0) {
      low = std::max(low, need / slope);
    } else {
      high = std::min(high, need / slope);
    }
    if (low > high) return false;
  }
  const double wanted = along.dot(wish.vector);
  const double t = wish.is_direction ? (wanted > 0 ? high : low) : std::clamp(wanted, low, high);
  v = foot + t * along;
  return true;
}

/// Incremental linear program in the plane: returns the index of the first plane that cannot be met
/// together with those before it (v then meets those), or planes.size().
size_t solve(std::span<const HalfPlane> planes, const Wish& wish, double max_speed,
             Eigen::Vector2d& v) {
  if (wish.is_direction) {
    v = max_speed * wish.vector;
  } else {
    const double length = wish.vector.norm();
    v = length > max_speed ? Eigen::Vector2d(wish.vector * (max_speed / length)) : wish.vector;
  }
  for (size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].violation_mps(v) <= kTiny) continue;
    const Eigen::Vector2d before = v;
    if (!solve_on_border(planes, i, wish, max_speed, v)) {
      v = before;
      return i;
    }
  }
  return planes.size();
}

/// From planes[failed] on: lowers the worst violation of the soft planes. A third dimension, the
/// violation, is eliminated plane by plane: where plane i is the worst, the others are no worse,
/// which is again a half-plane of velocities for each.
void relax(std::span<const HalfPlane> planes, size_t hard, size_t failed, double max_speed,
           Eigen::Vector2d& v) {
  std::array<HalfPlane, kMaxPlanes> others;
  double worst = 0;
  for (size_t i = std::max(failed, hard); i < planes.size(); ++i) {
    if (planes[i].violation_mps(v) <= worst + kTiny) continue;
    std::copy(planes.begin(), planes.begin() + static_cast<ptrdiff_t>(hard), others.begin());
    size_t count = hard;
    for (size_t j = hard; j < i; ++j) {
      const Eigen::Vector2d difference = planes[j].normal - planes[i].normal;
      const double length = difference.norm();
      // Same direction: one of the two is the tighter everywhere, and i is worse than j could be.
      if (length <= kTiny) continue;
      others[count++] = {difference / length,
                         (planes[j].offset_mps - planes[i].offset_mps) / length};
    }
    Eigen::Vector2d candidate = v;
    const std::span<const HalfPlane> bounds(others.data(), count);
    if (solve(bounds, {planes[i].normal, true}, max_speed, candidate) == count) v = candidate;
    worst = std::max(worst, planes[i].violation_mps(v));
  }
}

}  // namespace

HalfPlane avoid(const Encounter& e) {
  const Eigen::Vector2d velocity = e.own_velocity_mps - e.other_velocity_mps;
  const double gap_square = e.offset_m.squaredNorm();
  const bool overlaps = gap_square <= e.radius_m * e.radius_m;
  const double horizon_s = overlaps ? e.step_s : e.horizon_s;
  const Eigen::Vector2d w = velocity - e.offset_m / horizon_s;
  const double w_length = w.norm();
  const double w_along = w.dot(e.offset_m);
  HalfPlane plane;
  double change_mps = 0;  // signed length of u along the normal
  if (overlaps ||
      (w_along < 0 && w_along * w_along > e.radius_m * e.radius_m * w_length * w_length)) {
    // The cut-off circle of radius R / horizon is nearest.
    if (w_length > kTiny)
      plane.normal = w / w_length;
    else
      plane.normal = gap_square > 0 ? Eigen::Vector2d(-e.offset_m.normalized())
                                    : Eigen::Vector2d(Eigen::Vector2d::UnitX());
    change_mps = e.radius_m / horizon_s - w_length;
  } else {
    // One of the cone's legs is.
    const double leg = std::sqrt(gap_square - e.radius_m * e.radius_m);
    const Eigen::Vector2d& p = e.offset_m;
    const double side = cross(p, w) > 0 ? 1 : -1;
    const Eigen::Vector2d direction =
        side / gap_square * (leg * p + side * e.radius_m * left_of(p));
    plane.normal = left_of(direction);
    change_mps = -plane.normal.dot(velocity);
  }
  plane.offset_mps = plane.normal.dot(e.own_velocity_mps) + 0.5 * change_mps;
  return plane;
}

HalfPlane keep_off(const Eigen::Vector2d& normal, double clearance_m, double horizon_s) {
  return {normal, -std::max(0.0, clearance_m) / horizon_s};
}

Eigen::Vector2d choose_velocity(std::span<const HalfPlane> planes, int hard,
                                const Eigen::Vector2d& wanted_mps, double max_speed_mps) {
  assert(planes.size() <= kMaxPlanes);
  Eigen::Vector2d v = Eigen::Vector2d::Zero();
  const size_t failed = solve(planes, {wanted_mps, false}, max_speed_mps, v);
  // Hard planes all allow standing still; only rounding can make them fail.
  if (failed < static_cast<size_t>(hard)) return Eigen::Vector2d::Zero();
  if (failed < planes.size()) relax(planes, static_cast<size_t>(hard), failed, max_speed_mps, v);
  return v;
}

}  // namespace throng
