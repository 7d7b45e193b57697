#include "crowd/navigation/queue_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace throng {
namespace {

/// Distance of waiting agents to walls: half the shoulders and a hand's breadth.
constexpr double kWall_m = 0.35;
/// Distance of the first position to the goal, unless a line specifies it.
constexpr double kBefore_m = 0.6;
/// Walls farther from the middle of a goal do not determine its front.
constexpr double kFar_m = 20;
/// A direction with less free length is not suitable for a queue.
constexpr double kMinLength_m = 2;
constexpr double kSample_m = 0.05;

const std::array<Eigen::Vector2d, 4> kSides = {Eigen::Vector2d(0, -1), Eigen::Vector2d(-1, 0),
                                               Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 0)};

/// Returns the free length before a wall, an edge of the ground or a door is closer than `gap_m`.
double free_m(const Walkable& walkable, const Eigen::Vector2d& from_m,
              const Eigen::Vector2d& direction, double gap_m, double max_m) {
  double free_m = 0;
  while (free_m < max_m && walkable.clearance_m(from_m + free_m * direction) >= gap_m)
    free_m += kSample_m;
  return std::min(free_m, max_m);
}

/// Returns the unit direction to the side of an area nearest to a wall.
Eigen::Vector2d front_direction(const Walkable& walkable, const Rectangle& area) {
  double nearest_m = kFar_m;
  Eigen::Vector2d front = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& side : kSides) {
    const double away_m = free_m(walkable, area.middle_m(), side, 1e-6, kFar_m) -
                          0.5 * std::abs(side.dot(area.size_m()));
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    front = side;
  }
  return front;
}

Rectangle around(const std::vector<Area>& areas) {
  Rectangle all = areas.front().bounds();
  for (const Area& area : areas) all = all.joined(area.bounds());
  return all;
}

/// The line leads straight back from the front of the goal, or where there is room instead.
std::vector<Eigen::Vector2d> line_from(const Walkable& walkable, const Rectangle& all) {
  const auto first_m = [&](const Eigen::Vector2d& back) {
    return Eigen::Vector2d(all.middle_m() + 0.5 * back.cwiseProduct(all.size_m()) +
                           kBefore_m * back);
  };
  const auto length_m = [&](const Eigen::Vector2d& back) {
    return free_m(walkable, first_m(back), back, kWall_m, kFar_m);
  };
  Eigen::Vector2d back = -front_direction(walkable, all);
  if (back.isZero() || length_m(back) < kMinLength_m)
    back = *std::max_element(kSides.begin(), kSides.end(), [&](const auto& a, const auto& b) {
      return length_m(a) < length_m(b);
    });
  return {first_m(back), first_m(back) + 0.1 * back};
}

}  // namespace

QueueLine::QueueLine(std::vector<Eigen::Vector2d> corners_m) : corners_m_(std::move(corners_m)) {
  ends_m_.push_back(0);
  for (size_t i = 1; i < corners_m_.size(); ++i)
    ends_m_.push_back(ends_m_.back() + (corners_m_[i] - corners_m_[i - 1]).norm());
}

Eigen::Vector2d QueueLine::at(double along_m) const {
  size_t i = 1;
  while (i + 1 < corners_m_.size() && ends_m_[i] < along_m) ++i;
  const double share =
      std::clamp((along_m - ends_m_[i - 1]) / (ends_m_[i] - ends_m_[i - 1]), 0.0, 1.0);
  return corners_m_[i - 1] + share * (corners_m_[i] - corners_m_[i - 1]);
}

double QueueLine::nearest_m(const Eigen::Vector2d& point, double from_m, double to_m) const {
  double nearest_m = std::clamp(from_m, 0.0, length_m());
  double min_m2 = (at(nearest_m) - point).squaredNorm();
  for (size_t i = 1; i < corners_m_.size(); ++i) {
    const double low_m = std::max(ends_m_[i - 1], from_m), high_m = std::min(ends_m_[i], to_m);
    if (low_m > high_m) continue;
    const Eigen::Vector2d direction =
        (corners_m_[i] - corners_m_[i - 1]) / (ends_m_[i] - ends_m_[i - 1]);
    const double along_m =
        std::clamp(ends_m_[i - 1] + direction.dot(point - corners_m_[i - 1]), low_m, high_m);
    const double square_m2 =
        (corners_m_[i - 1] + (along_m - ends_m_[i - 1]) * direction - point).squaredNorm();
    if (square_m2 >= min_m2) continue;
    min_m2 = square_m2;
    nearest_m = along_m;
  }
  return nearest_m;
}

size_t QueueLine::nearest_corner(double along_m) const {
  size_t i = 1;
  while (i + 1 < corners_m_.size() && ends_m_[i] < along_m) ++i;
  return along_m - ends_m_[i - 1] < ends_m_[i] - along_m ? i - 1 : i;
}

QueuePlan::QueuePlan(const Goal& goal, const Walkable& walkable, int64_t max_people)
    : areas(goal.areas), max_inside(static_cast<uint32_t>(goal.max_inside())), people(max_people) {
  spacing_m = goal.queue.spacing_m;
  std::vector<Eigen::Vector2d> corners_m = goal.queue.line_m;
  if (corners_m.empty()) corners_m = line_from(walkable, around(areas));
  const Eigen::Vector2d end = corners_m.back();
  const Eigen::Vector2d direction = (end - corners_m[corners_m.size() - 2]).normalized();
  const double beyond_m =
      free_m(walkable, end, direction, kWall_m, spacing_m * static_cast<double>(people));
  if (beyond_m > kSample_m) corners_m.push_back(end + (beyond_m - kSample_m) * direction);
  line = QueueLine(std::move(corners_m));
  places = static_cast<size_t>(std::floor(line.length_m() / spacing_m + 1e-9)) + 1;
  for (const Area& area : areas)
    fronts.push_back(goal.has_queue ? front_direction(walkable, area.bounds())
                                    : Eigen::Vector2d(Eigen::Vector2d::Zero()));
}

/// Searches a grid around the end of the line, up to the distance that all agents need.
void QueuePlan::find_overflow_positions(const Walkable& walkable, const FlowField& to_end) {
  const int64_t needed = std::max<int64_t>(0, people - static_cast<int64_t>(places));
  const Eigen::Vector2d end = line.corners_m().back();
  const int max_rings = static_cast<int>(std::ceil(walkable.ground().size_m().norm() / spacing_m));
  std::vector<std::pair<double, Eigen::Vector2d>> found;
  // A ring's corners are farther off than the next ring's sides: both are searched.
  for (int ring = 1, enough = 0; ring <= max_rings && enough < 2; ++ring) {
    for (int i = -ring; i <= ring; ++i)
      for (int k = -ring; k <= ring; ++k) {
        if (std::max(std::abs(i), std::abs(k)) != ring) continue;
        const Eigen::Vector2d point = end + spacing_m * Eigen::Vector2d(i, k);
        if (!is_clear(walkable, point) || !to_end.reaches(point)) continue;
        found.emplace_back(to_end.distance_m(point), point);
      }
    if (static_cast<int64_t>(found.size()) >= needed) ++enough;
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (static_cast<int64_t>(found.size()) > needed) found.resize(static_cast<size_t>(needed));
  for (const auto& [path_m, point] : found) overflow_positions_m.push_back(point);
}

/// Returns whether a point is clear of walls, the line and the goal.
bool QueuePlan::is_clear(const Walkable& walkable, const Eigen::Vector2d& point) const {
  if (walkable.clearance_m(point) < kWall_m) return false;
  for (const Area& area : areas)
    if ((point - area.nearest_m(point)).norm() < kBefore_m) return false;
  const double along_m = line.nearest_m(point, 0, line.length_m());
  return (line.at(along_m) - point).norm() >= spacing_m - 1e-9;
}

}  // namespace throng
