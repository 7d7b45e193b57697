#include "scenes/file/density.h"

#include <algorithm>
#include <cmath>

#include "crowd/navigation/walkable.h"

namespace throng {
namespace {

/// Radius of the steering disc of a person of 1.70 m, which keeps clear of walls.
constexpr double kWallGap_m = 0.22;
constexpr double kSample_m = 0.05;
constexpr double kMaxSamples = 4e6;

}  // namespace

double standing_area_m2(const Scene& scene, const Area& area) {
  const Walkable walkable(scene);
  const Eigen::Vector2d size = area.size_m();
  const double sample_m = std::max(kSample_m, std::sqrt(size.prod() / kMaxSamples));
  const int columns = std::max(1, static_cast<int>(std::ceil(size.x() / sample_m)));
  const int rows = std::max(1, static_cast<int>(std::ceil(size.y() / sample_m)));
  int64_t free = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      // Jittered within its cell: a regular grid would miss or hit whole rows along an edge.
      const auto part = [&](double step) {
        const double sum = step * (static_cast<double>(row) * columns + column);
        return sum - std::floor(sum);
      };
      const Eigen::Vector2d share((column + part(0.7548776662466927)) / columns,
                                  (row + part(0.5698402909980532)) / rows);
      const Eigen::Vector2d point = area.at(share);
      if (walkable.clearance_m(point) >= kWallGap_m) ++free;
    }
  return area.area_m2() * static_cast<double>(free) /
         (static_cast<double>(columns) * static_cast<double>(rows));
}

int64_t count_by_density(const Scene& scene, const Group& group) {
  return std::llround(group.density_per_m2 * standing_area_m2(scene, group.spawn));
}

}  // namespace throng
