#include "analysis/contacts/local_density.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace throng {
namespace {

/// Cells of a table of people; a larger ground gets larger cells.
constexpr double kMaxCells = 1 << 20;
/// Points of the circle that are asked whether they are seen from its middle.
constexpr int kPoints = 64;

/// Offsets from the middle, in metres: a sunflower's seeds, even in every direction (Vogel 1979).
const std::vector<Eigen::Vector2d>& circle_points() {
  static const std::vector<Eigen::Vector2d> points = [] {
    const double golden_rad = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<Eigen::Vector2d> out;
    for (int i = 0; i < kPoints; ++i) {
      const double radius_m = LocalDensity::kRadius_m * std::sqrt((i + 0.5) / kPoints);
      out.emplace_back(radius_m * std::cos(i * golden_rad), radius_m * std::sin(i * golden_rad));
    }
    return out;
  }();
  return points;
}

}  // namespace

LocalDensity::LocalDensity(const Scene& scene)
    : walkable_(scene),
      ground_(scene.ground),
      cell_m_(std::max(kRadius_m, std::sqrt(ground_.area_m2() / kMaxCells))),
      columns_(static_cast<int>(ground_.size_m().x() / cell_m_) + 1),
      rows_(static_cast<int>(ground_.size_m().y() / cell_m_) + 1) {}

int LocalDensity::cell_of(double offset_m, int cells) const {
  return std::clamp(static_cast<int>(std::floor(offset_m / cell_m_)), 0, cells - 1);
}

void LocalDensity::place(std::span<const Eigen::Vector2d> positions_m,
                         std::span<const uint8_t> present) {
  positions_m_ = positions_m;
  const auto is_here = [&](uint32_t id) { return present.empty() || present[id] != 0; };
  const auto cell = [&](uint32_t id) {
    const Eigen::Vector2d offset = positions_m[id] - ground_.min_m;
    return static_cast<size_t>(cell_of(offset.y(), rows_)) * static_cast<size_t>(columns_) +
           static_cast<size_t>(cell_of(offset.x(), columns_));
  };
  const auto people = static_cast<uint32_t>(positions_m.size());
  starts_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
  for (uint32_t id = 0; id < people; ++id)
    if (is_here(id)) ++starts_[cell(id) + 1];
  for (size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  ids_.resize(starts_.back());
  next_.assign(starts_.begin(), starts_.end() - 1);
  for (uint32_t id = 0; id < people; ++id)
    if (is_here(id)) ids_[next_[cell(id)]++] = id;
}

/// Where somebody stands who leans over a wall: beside it.
Eigen::Vector2d LocalDensity::beside_walls(Eigen::Vector2d point) const {
  constexpr double kBeside_m = 1e-3;
  for (const uint32_t footprint : walkable_.near(point)) {
    const Walkable::Nearest wall = walkable_.nearest(footprint, point);
    if (wall.distance_m < 0) point += (kBeside_m - wall.distance_m) * wall.normal;
  }
  return point;
}

int LocalDensity::people_near(const Eigen::Vector2d& point, bool sees_all) const {
  // A wall hides whom it hides up to the near side of the body.
  constexpr double kNearSide_m = 0.15;
  const auto is_seen = [&](const Eigen::Vector2d& to) {
    const Eigen::Vector2d way = to - point;
    const double far_m = way.norm();
    if (sees_all || far_m <= kNearSide_m) return true;
    return !walkable_.crosses(point, point + (1 - kNearSide_m / far_m) * way);
  };
  const Eigen::Vector2d offset = point - ground_.min_m;
  const int first = cell_of(offset.x() - kRadius_m, columns_);
  const int last = cell_of(offset.x() + kRadius_m, columns_);
  int count = 0;
  for (int row = cell_of(offset.y() - kRadius_m, rows_);
       row <= cell_of(offset.y() + kRadius_m, rows_); ++row) {
    const auto line = static_cast<size_t>(row) * static_cast<size_t>(columns_);
    const uint32_t begin = starts_[line + static_cast<size_t>(first)];
    const uint32_t end = starts_[line + static_cast<size_t>(last) + 1];
    for (uint32_t i = begin; i < end; ++i) {
      const Eigen::Vector2d& other = positions_m_[ids_[i]];
      count += (other - point).squaredNorm() <= kRadius_m * kRadius_m && is_seen(other);
    }
  }
  return count;
}

double LocalDensity::around(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d from = beside_walls(point);
  const bool sees_all = walkable_.clearance_m(from) >= kRadius_m;
  double share = 1;
  if (!sees_all) {
    const auto seen = std::count_if(
        circle_points().begin(), circle_points().end(), [&](const Eigen::Vector2d& offset) {
          return ground_.contains(from + offset) && !walkable_.crosses(from, from + offset);
        });
    share = static_cast<double>(std::max<std::ptrdiff_t>(1, seen)) / kPoints;
  }
  return people_near(from, sees_all) / (share * std::numbers::pi * kRadius_m * kRadius_m);
}

size_t DensityLevels::level_of(double density_per_m2) {
  return static_cast<size_t>(std::upper_bound(kBounds.begin(), kBounds.end(), density_per_m2) -
                             kBounds.begin());
}

}  // namespace throng
