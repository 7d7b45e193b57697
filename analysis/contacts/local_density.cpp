#include "analysis/contacts/local_density.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/counting_sort.h"

namespace throng {
namespace {

constexpr double kMaxCells = 1 << 20;

int cell(double offset_m, double cell_m, int cells) {
  return static_cast<int>(std::clamp(std::floor(offset_m / cell_m), 0.0, cells - 1.0));
}

}  // namespace

PointGrid::PointGrid(const Rectangle& ground, double cell_m)
    : ground_(ground),
      cell_m_(std::max(cell_m, std::sqrt(ground.area_m2() / kMaxCells))),
      columns_(static_cast<int>(ground.size_m().x() / cell_m_) + 1),
      rows_(static_cast<int>(ground.size_m().y() / cell_m_) + 1) {}

int PointGrid::column_of(double x) const { return cell(x - ground_.min_m.x(), cell_m_, columns_); }

int PointGrid::row_of(double y) const { return cell(y - ground_.min_m.y(), cell_m_, rows_); }

void PointGrid::place(std::span<const Eigen::Vector2d> points, std::span<const uint8_t> there) {
  points_ = points;
  const auto cell_of = [&](size_t i) {
    return static_cast<size_t>(row_of(points[i].y())) * static_cast<size_t>(columns_) +
           static_cast<size_t>(column_of(points[i].x()));
  };
  indices_.resize(points.size());
  const size_t cells = static_cast<size_t>(columns_) * static_cast<size_t>(rows_);
  starts_.resize(cells + 2);
  counting_sort(
      cells, starts_.data(),
      [&](const auto& visit) {
        for (uint32_t i = 0; i < points.size(); ++i)
          if (there.empty() || there[i] != 0) visit(i);
      },
      cell_of, [&](uint32_t i, uint32_t position) { indices_[position] = i; });
}

namespace {

/// Number of points of the circle that are tested for visibility from its centre.
constexpr int kPoints = 64;

/// Offsets from the centre in metres: a sunflower pattern, uniform in area (Vogel 1979).
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
    : walkable_(scene), ground_(scene.ground), grid_(scene.ground, kRadius_m) {}

/// Moves the position of a person who leans over a wall to just outside of it.
Eigen::Vector2d LocalDensity::push_off_walls(Eigen::Vector2d point) const {
  constexpr double kOffset_m = 1e-3;
  for (const uint32_t footprint : walkable_.nearby_footprints(point)) {
    const Walkable::Nearest wall = walkable_.nearest(footprint, point);
    if (wall.distance_m < 0) point += (kOffset_m - wall.distance_m) * wall.normal;
  }
  return point;
}

int LocalDensity::people_within(const Eigen::Vector2d& point, bool is_unobstructed) const {
  // A wall hides a person only beyond the near side of the body.
  constexpr double kSightMargin_m = 0.15;
  const auto is_visible = [&](const Eigen::Vector2d& to) {
    const Eigen::Vector2d offset_m = to - point;
    const double far_m = offset_m.norm();
    if (is_unobstructed || far_m <= kSightMargin_m) return true;
    return !walkable_.crosses(point, point + (1 - kSightMargin_m / far_m) * offset_m);
  };
  int count = 0;
  grid_.for_each_within(point, kRadius_m,
                        [&](uint32_t i, double) { count += is_visible(grid_.point(i)); });
  return count;
}

double LocalDensity::around(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d from = push_off_walls(point);
  const bool is_unobstructed = walkable_.clearance_m(from) >= kRadius_m;
  double share = 1;
  if (!is_unobstructed) {
    const auto visible_count = std::count_if(
        circle_points().begin(), circle_points().end(), [&](const Eigen::Vector2d& offset) {
          return ground_.contains(from + offset) && !walkable_.crosses(from, from + offset);
        });
    share = static_cast<double>(std::max<std::ptrdiff_t>(1, visible_count)) / kPoints;
  }
  return people_within(from, is_unobstructed) / (share * std::numbers::pi * kRadius_m * kRadius_m);
}

size_t DensityLevels::level_of(double density_per_m2) {
  return static_cast<size_t>(std::upper_bound(kBounds.begin(), kBounds.end(), density_per_m2) -
                             kBounds.begin());
}

}  // namespace throng
