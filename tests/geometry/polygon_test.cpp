// Polygons: faults have a place, pieces are convex and cover the polygon exactly once.
#include "geometry/polygon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/geometry/random_polygons.h"

namespace throng::polygon_test {
namespace {

using testing::HasSubstr;

bool is_inside(const Polygon& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  const auto add = [&](const Polygon::Ring& ring) {
    for (size_t i = 0, k = ring.size() - 1; i < ring.size(); k = i++)
      if ((ring[i].y() > p.y()) != (ring[k].y() > p.y()) &&
          p.x() < ring[i].x() + (p.y() - ring[i].y()) / (ring[k].y() - ring[i].y()) *
                                    (ring[k].x() - ring[i].x()))
        inside = !inside;
  };
  add(polygon.outline);
  for (const Polygon::Ring& hole : polygon.holes) add(hole);
  return inside;
}

double edge_distance_m(const Polygon& polygon, const Eigen::Vector2d& p) {
  double nearest_m = 1e300;
  const auto add = [&](const Polygon::Ring& ring) {
    for (size_t i = 0; i < ring.size(); ++i)
      nearest_m =
          std::min(nearest_m, distance_to_segment_m(p, ring[i], ring[(i + 1) % ring.size()]));
  };
  add(polygon.outline);
  for (const Polygon::Ring& hole : polygon.holes) add(hole);
  return nearest_m;
}

TEST(Polygons, HaveTheirFaultsNamedWithAPlace) {
  const auto found = [](const Polygon& polygon) {
    const auto fault = fault_of(polygon);
    return fault ? fault->expected + " | " + fault->found : "none";
  };
  EXPECT_THAT(found({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {}}),
              HasSubstr("a crossing at [1.0000, 1.0000]"));
  EXPECT_THAT(found({{{0, 0}, {4, 0}, {2, 0}, {2, 2}}, {}}), HasSubstr("turns back at"));
  EXPECT_THAT(found({{{0, 0}, {1, 0}}, {}}), HasSubstr("three vertices"));
  EXPECT_THAT(found({{{0, 0}, {1e-6, 0}, {0, 1e-6}}, {}}), HasSubstr("three different vertices"));
  EXPECT_THAT(found({{{0, 0}, {1e9, 0}, {0, 1}}, {}}), HasSubstr("100 km"));
  EXPECT_THAT(found({{{0, 0}, {NAN, 0}, {0, 1}}, {}}), HasSubstr("100 km"));
  const Polygon::Ring square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  EXPECT_THAT(found({square, {{{5, 5}, {6, 5}, {6, 6}}}}),
              HasSubstr("a hole outside of it near ["));
  EXPECT_THAT(found({square, {{{3, 3}, {5, 3}, {5, 5}}}}), HasSubstr("a crossing at [4.0000"));
  EXPECT_THAT(found({square, {square}}), HasSubstr("on top of each other"));
  EXPECT_EQ(found({square, {{{1, 1}, {2, 1}, {2, 2}}}}), "none");
  EXPECT_EQ(found({square, {{{0, 2}, {2, 1}, {2, 3}}}}), "none") << "rings may touch in a point";
}

TEST(Polygons, AreCoveredByTrianglesAndConvexPieces) {
  int with_holes = 0;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    RandomPolygons random(seed);
    const Polygon polygon = random.polygon();
    if (fault_of(polygon)) continue;
    with_holes += polygon.holes.empty() ? 0 : 1;
    double triangles_m2 = 0;
    for (const auto& [a, b, c] : triangles_of(polygon)) triangles_m2 += 0.5 * cross(b - a, c - a);
    EXPECT_NEAR(triangles_m2, area_m2(polygon), 1e-6 * area_m2(polygon));
    double pieces_m2 = 0;
    const std::vector<Polygon::Ring> pieces = convex_pieces_of(polygon);
    for (const Polygon::Ring& piece : pieces) {
      pieces_m2 += 0.5 * doubled_area(piece);
      for (size_t i = 0; i < piece.size(); ++i) {
        const Eigen::Vector2d &p = piece[i], &q = piece[(i + 1) % piece.size()],
                              &r = piece[(i + 2) % piece.size()];
        EXPECT_GE(cross(q - p, r - q), -1e-7) << "a concave corner";
      }
    }
    EXPECT_NEAR(pieces_m2, area_m2(polygon), 1e-6 * area_m2(polygon));
    const Rectangle bounds = bounds_of(polygon.outline);
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector2d p(random.uniform(bounds.min_m.x(), bounds.max_m.x()),
                              random.uniform(bounds.min_m.y(), bounds.max_m.y()));
      if (edge_distance_m(polygon, p) < 1e-6) continue;
      int covering = 0;
      for (const Polygon::Ring& piece : pieces) covering += is_inside({piece, {}}, p) ? 1 : 0;
      EXPECT_EQ(covering, is_inside(polygon, p) ? 1 : 0) << p.transpose();
    }
  }
  EXPECT_GT(with_holes, 50);
}

TEST(Polygons, MayHaveAThousandHoles) {
  Polygon hall{{{0, 0}, {100, 0}, {100, 100}, {0, 100}}, {}};
  for (int i = 0; i < 32; ++i)
    for (int k = 0; k < 32; ++k) {
      const Eigen::Vector2d at(3 * i + 1, 3 * k + 1);
      hall.holes.push_back({at, at + Eigen::Vector2d(1, 0), at + Eigen::Vector2d(0, 1)});
    }
  EXPECT_FALSE(fault_of(hall));
  double triangles_m2 = 0;
  for (const auto& [a, b, c] : triangles_of(hall)) triangles_m2 += 0.5 * cross(b - a, c - a);
  EXPECT_NEAR(triangles_m2, 10'000 - 512, 1e-3);
  hall.holes.push_back({{99, 99}, {101, 99}, {99, 101}});
  EXPECT_TRUE(fault_of(hall));
}

TEST(Polygons, OfConvexShapeAreOnePiece) {
  EXPECT_EQ(convex_pieces_of({{{0, 0}, {0, 3}, {4, 3}, {4, 0}}, {}}).size(), 1u) << "clockwise";
  Polygon::Ring round;
  for (int i = 0; i < 100; ++i)
    round.emplace_back(5 * std::cos(0.0628 * i), 5 * std::sin(0.0628 * i));
  EXPECT_EQ(convex_pieces_of({round, {}}).size(), 1u);
  const Polygon l = {{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}, {}};
  EXPECT_EQ(convex_pieces_of(l).size(), 2u);
}

TEST(Polygons, AreRectanglesIfTheirEdgesRunAlongXAndY) {
  EXPECT_TRUE(rectangle_of({{{0, 0}, {0, 3}, {4, 3}, {4, 0}}, {}}));
  EXPECT_FALSE(rectangle_of({{{0, 0}, {0, 3}, {4, 3}, {4, 0.1}}, {}}));
  EXPECT_FALSE(rectangle_of({{{0, 0}, {4, 0}, {4, 3}}, {}}));
  EXPECT_FALSE(rectangle_of({{{0, 0}, {0, 9}, {9, 9}, {9, 0}}, {{{1, 1}, {2, 1}, {2, 2}}}}));
}

}  // namespace
}  // namespace throng::polygon_test
