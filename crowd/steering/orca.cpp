#include "crowd/steering/orca.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace throng {
namespace {

using Eigen::Vector2f;

Vector2f left_of(const Vector2f& v) { return {-v.y(), v.x()}; }
float dot(const Vector2f& a, const Vector2f& b) { return a.x() * b.x() + a.y() * b.y(); }
float cross(const Vector2f& a, const Vector2f& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Objective: the point nearest to a target, or the farthest along a direction.
struct Objective {
  Vector2f vector;
  bool is_direction = false;
};

/// Optimises on the border of planes[index] within the planes before it and the speed limit.
/// Returns false if there is no such point.
bool solve_on_border(std::span<const HalfPlane> planes, size_t index, const Objective& objective,
                     float max_speed, Vector2f& v) {
  const HalfPlane& plane = planes[index];
  const float discriminant = max_speed * max_speed - plane.offset_mps * plane.offset_mps;
  if (discriminant < 0) return false;
  const Vector2f foot = plane.offset_mps * plane.normal;
  const Vector2f along = left_of(plane.normal);
  float high = std::sqrt(discriminant);
  float low = -high;
  for (size_t i = 0; i < index; ++i) {
    const float slope = dot(planes[i].normal, along);
    const float need = planes[i].violation_mps(foot);  // slope * t >= need
    if (std::abs(slope) <= kTiny_mps) {
      if (need > kTiny_mps) return false;
    } else if (slope > 0) {
      low = std::max(low, need / slope);
    } else {
      high = std::min(high, need / slope);
    }
  }
  if (low > high) return false;
  const float target = dot(along, objective.vector);
  const float t =
      objective.is_direction ? (target > 0 ? high : low) : std::clamp(target, low, high);
  v = {foot.x() + t * along.x(), foot.y() + t * along.y()};
  return true;
}

/// Incremental linear program in the plane. Returns the index of the first plane that contradicts
/// those before it (v then satisfies those), or planes.size().
size_t solve(std::span<const HalfPlane> planes, const Objective& objective, float max_speed,
             Vector2f& v) {
  if (objective.is_direction) {
    v = max_speed * objective.vector;
  } else {
    const float length = std::sqrt(dot(objective.vector, objective.vector));
    v = objective.vector;
    if (length > max_speed) v *= max_speed / length;
  }
  for (size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].violation_mps(v) <= kTiny_mps) continue;
    if (!solve_on_border(planes, i, objective, max_speed, v)) return i;
  }
  return planes.size();
}

/// From planes[failed] on: minimises the worst violation of the soft planes, plane by plane. Where
/// plane i is the worst, the others are no worse: a half-plane of velocities for each.
void minimise_violation(std::span<const HalfPlane> planes, size_t hard, size_t failed,
                        float max_speed, Vector2f& v) {
  std::array<HalfPlane, kMaxPlanes> others;
  float worst = 0;
  for (size_t i = std::max(failed, hard); i < planes.size(); ++i) {
    if (planes[i].violation_mps(v) <= worst + kTiny_mps) continue;
    std::copy(planes.begin(), planes.begin() + static_cast<ptrdiff_t>(hard), others.begin());
    size_t count = hard;
    for (size_t j = hard; j < i; ++j) {
      const Vector2f difference = planes[j].normal - planes[i].normal;
      const float length = std::sqrt(dot(difference, difference));
      // Same direction: one of the two is always tighter, and i is worse than j could be.
      if (length <= kTiny_mps) continue;
      others[count++] = {difference / length,
                         (planes[j].offset_mps - planes[i].offset_mps) / length};
    }
    Vector2f candidate = v;
    const std::span<const HalfPlane> bounds(others.data(), count);
    if (solve(bounds, {planes[i].normal, true}, max_speed, candidate) == count) v = candidate;
    worst = std::max(worst, planes[i].violation_mps(v));
  }
}

}  // namespace

HalfPlane avoidance_plane(const Encounter& e) {
  const Vector2f velocity = e.own_velocity_mps - e.other_velocity_mps;
  const float gap_square = dot(e.offset_m, e.offset_m);
  const float radius_square = e.radius_m * e.radius_m;
  const bool overlaps = gap_square <= radius_square;
  const float rate = overlaps ? 1 / e.step_s : 1 / e.horizon_s;
  const Vector2f w(velocity.x() - e.offset_m.x() * rate, velocity.y() - e.offset_m.y() * rate);
  const float w_square = dot(w, w);
  const float w_along = dot(w, e.offset_m);
  HalfPlane plane;
  float change_mps = 0;  // signed length of u along the normal
  if (overlaps || (w_along < 0 && w_along * w_along > radius_square * w_square)) {
    // The cut-off circle of radius R / horizon is nearest.
    const float w_length = std::sqrt(w_square);
    if (w_length > kTiny_mps) {
      plane.normal = {w.x() / w_length, w.y() / w_length};
    } else if (gap_square > 0) {
      const float gap = std::sqrt(gap_square);
      plane.normal = {-e.offset_m.x() / gap, -e.offset_m.y() / gap};
    }
    change_mps = e.radius_m * rate - w_length;
  } else {
    // One of the cone's legs is nearest.
    const float leg = std::sqrt(gap_square - radius_square);
    const float side_leg = cross(e.offset_m, w) > 0 ? leg : -leg;
    // Direction of the leg, turned left.
    plane.normal = {-(side_leg * e.offset_m.y() + e.radius_m * e.offset_m.x()) / gap_square,
                    (side_leg * e.offset_m.x() - e.radius_m * e.offset_m.y()) / gap_square};
    change_mps = -dot(plane.normal, velocity);
  }
  // Clearance to approach is always halved: all of it for one would freeze the other.
  const float share = change_mps > 0 ? e.share : 0.5f;
  plane.offset_mps = dot(plane.normal, e.own_velocity_mps) + share * change_mps;
  return plane;
}

HalfPlane wall_plane(const Vector2f& normal, float clearance_m, float horizon_s) {
  return {normal, -std::max(0.0f, clearance_m) / horizon_s};
}

Vector2f choose_velocity(std::span<const HalfPlane> planes, int hard, const Vector2f& preferred_mps,
                         float max_speed_mps) {
  assert(planes.size() <= kMaxPlanes);
  Vector2f v = Vector2f::Zero();
  const size_t failed = solve(planes, {preferred_mps, false}, max_speed_mps, v);
  // Hard planes all allow standing still; only rounding can make them fail.
  if (failed < static_cast<size_t>(hard)) return Vector2f::Zero();
  if (failed < planes.size())
    minimise_violation(planes, static_cast<size_t>(hard), failed, max_speed_mps, v);
  return v;
}

size_t add_walls(const SteeringView& people, size_t i, float slack_m, HalfPlane* planes) {
  const uint32_t first = people.wall_starts[i], end = people.wall_starts[i + 1];
  for (uint32_t w = first; w < end; ++w)
    *planes++ = wall_plane({people.wall_x[w], people.wall_y[w]},
                           people.wall_clearance_m[w] + slack_m, people.wall_horizon_s);
  return end - first;
}

void decide_orca_scalar(const SteeringView& p, std::span<const uint32_t> slots, float* next_x_mps,
                        float* next_y_mps) {
  std::array<HalfPlane, kMaxPlanes> planes;
  for (size_t i = 0; i < slots.size(); ++i) {
    const uint32_t slot = slots[i];
    const NeighbourState& own = p.published[slot];
    const size_t walls = add_walls(p, i, 0, planes.data());
    size_t count = walls;
    Encounter e;
    e.own_velocity_mps = {own.vx_mps, own.vy_mps};
    e.horizon_s = own.horizon_s;
    e.step_s = p.period_s;
    for (size_t k = 0; k < p.neighbour_counts[slot]; ++k) {
      const uint32_t other = p.neighbours[NeighbourGrid::kMaxNeighbours * slot + k];
      const NeighbourState& published = p.published[other];
      e.offset_m = {published.x_m - own.x_m, published.y_m - own.y_m};
      // Agents at one place separate along x, in the order of slots.
      if (e.offset_m.x() == 0 && e.offset_m.y() == 0)
        e.offset_m.x() = slot < other ? 1e-6f : -1e-6f;
      e.other_velocity_mps = {published.vx_mps, published.vy_mps};
      e.radius_m = own.radius_m + published.radius_m;
      e.share = avoidance_share(own.impatience, published.impatience);
      planes[count++] = avoidance_plane(e);
    }
    const Vector2f v =
        choose_velocity({planes.data(), count}, static_cast<int>(walls),
                        {own.preferred_x_mps, own.preferred_y_mps}, own.max_speed_mps);
    next_x_mps[slot] = v.x();
    next_y_mps[slot] = v.y();
  }
}

}  // namespace throng
