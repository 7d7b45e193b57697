// Strips around a floor: none reaches into it, and no straight step leaves the floor without
// entering one.
#include "geometry/floor.h"

#include <gtest/gtest.h>

#include "tests/geometry/random_polygons.h"

namespace throng::floor_test {
namespace {

bool is_in_strip(const FloorStrip& strip, const Eigen::Vector2d& p, double inset_m) {
  for (size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d side = (strip[(i + 1) % 4] - strip[i]).normalized();
    if (cross(side, p - strip[i]) < inset_m) return false;
  }
  return true;
}

TEST(FloorStrips, LineEveryEdgeOnTheOutside) {
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    RandomPolygons random(seed);
    const Polygon polygon = random.polygon();
    if (fault_of(polygon)) continue;
    const std::vector<FloorStrip> strips = strips_around({polygon});
    const PolygonLocator floor({polygon});
    const auto is_in_any = [&](const Eigen::Vector2d& p, double inset_m) {
      return std::any_of(strips.begin(), strips.end(),
                         [&](const FloorStrip& strip) { return is_in_strip(strip, p, inset_m); });
    };
    const auto check = [&](const Polygon::Ring& ring) {
      for (size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d &from = ring[i], &to = ring[(i + 1) % ring.size()];
        if ((to - from).norm() < 2e-3) continue;  // the strip next to it may be thinner
        const Eigen::Vector2d along = (to - from).normalized(), left(-along.y(), along.x());
        for (int k = 0; k < 8; ++k) {
          const Eigen::Vector2d p = from + random.uniform(0.01, 0.99) * (to - from);
          // Just outside of the edge, by less than the thinnest strip.
          for (const double off_m : {-1e-4, 1e-4}) {
            const Eigen::Vector2d near_edge = p + off_m * left;
            bool is_floor = false;
            for (const double x : crossings_m({polygon}, near_edge.y()))
              is_floor ^= x <= near_edge.x();
            EXPECT_TRUE(is_floor || is_in_any(near_edge, 0)) << near_edge.transpose();
          }
        }
      }
    };
    check(polygon.outline);
    for (const Polygon::Ring& hole : polygon.holes) check(hole);
    const Rectangle bounds = bounds_of(polygon.outline);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d p(random.uniform(bounds.min_m.x(), bounds.max_m.x()),
                              random.uniform(bounds.min_m.y(), bounds.max_m.y()));
      if (floor.contains(p) && is_in_any(p, 1e-3))
        ADD_FAILURE() << "on the floor: " << p.transpose();
    }
  }
}

}  // namespace
}  // namespace throng::floor_test
