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

TEST(Polygons, AreMendedWhereHolesAdjoin) {
  const Polygon::Ring square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  const auto box = [](double x, double y, double length_m, double width_m) -> Polygon::Ring {
    return {{x, y}, {x + length_m, y}, {x + length_m, y + width_m}, {x, y + width_m}};
  };
  const auto area_of = [](const MendedPolygon& mend) {
    double sum_m2 = 0;
    for (const Polygon& polygon : mend.polygons) {
      EXPECT_FALSE(fault_of(polygon));
      sum_m2 += area_m2(polygon);
    }
    return sum_m2;
  };
  const MendedPolygon sound = mended({square, {box(1, 1, 1, 1)}});
  EXPECT_EQ(sound.polygons, (std::vector<Polygon>{{square, {box(1, 1, 1, 1)}}}));

  const MendedPolygon adjoining = mended({square, {box(1, 1, 1, 1), box(2, 1, 1, 2)}});
  ASSERT_EQ(adjoining.polygons.size(), 1u);
  EXPECT_EQ(adjoining.polygons[0].holes.size(), 1u);
  EXPECT_NEAR(area_of(adjoining), 16 - 3, 1e-3);
  EXPECT_NEAR(area_of(mended({square, {box(1, 1, 2, 1), box(2, 1, 1, 2)}})), 16 - 3, 1e-3);

  const MendedPolygon at_the_wall = mended({square, {box(1, 0, 1, 1)}});
  ASSERT_EQ(at_the_wall.polygons.size(), 1u);
  EXPECT_TRUE(at_the_wall.polygons[0].holes.empty());
  EXPECT_NEAR(area_of(at_the_wall), 15, 1e-3);
  const MendedPolygon divided = mended({square, {box(1, 0, 1, 4)}});
  EXPECT_EQ(divided.polygons.size(), 2u);
  EXPECT_NEAR(area_of(divided), 12, 1e-3);

  // A spike of 4 um, and holes that are a line and a point on the grid.
  const MendedPolygon thin = mended(
      {square,
       {{{1, 1}, {2, 1}, {2, 2}, {1, 2}, {0.999996, 1.5}, {0.5, 1.500002}, {0.999996, 1.500004}},
        {{3, 1}, {3, 2}, {3.000004, 1.5}},
        {{3, 3}, {3.000004, 3}, {3, 3.000004}}}});
  EXPECT_EQ(thin.slivers, 3);
  ASSERT_EQ(thin.polygons.size(), 1u);
  EXPECT_EQ(thin.polygons[0].holes.size(), 1u);
  EXPECT_NEAR(area_of(thin), 15, 1e-3);

  for (const Polygon& broken :
       {Polygon{{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {}}, Polygon{square, {box(3, 1, 2, 1)}},
        Polygon{square, {box(5, 5, 1, 1), box(5.5, 5, 1, 1)}}, Polygon{square, {square}},
        Polygon{square, {{{1, 1}, {2, 2}, {2, 1}, {1, 2}}}},
        Polygon{square, {{{NAN, 1}, {2, 2}, {2, 1}}}}, Polygon{{{0, 0}, {1e9, 0}, {0, 1}}, {}},
        Polygon{square, {{{1, 1}, {2, 2}}}}})
    EXPECT_TRUE(mended(broken).fault && mended(broken).polygons.empty());
}

TEST(Polygons, CoverAfterMendingWhatRandomHolesLeave) {
  int mended_ones = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    RandomPolygons random(seed);
    Polygon polygon{random.star({0, 0}, 3, 4, random.whole(3, 40)), {}};
    for (int i = random.whole(1, 6); i > 0; --i)
      polygon.holes.push_back(random.star({random.uniform(-1, 1), random.uniform(-1, 1)}, 0.05, 0.6,
                                          random.whole(3, 9)));
    const MendedPolygon mend = mended(polygon);
    if (mend.fault) continue;  // a hole crosses an outline of few corners
    mended_ones += fault_of(polygon).has_value();
    for (const Polygon& piece : mend.polygons) EXPECT_FALSE(fault_of(piece));
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector2d p(random.uniform(-4, 4), random.uniform(-4, 4));
      if (edge_distance_m(polygon, p) < 1e-3) continue;
      bool is_free = is_inside({polygon.outline, {}}, p);
      for (const Polygon::Ring& hole : polygon.holes)
        is_free = is_free && !is_inside({hole, {}}, p);
      int covering = 0;
      for (const Polygon& piece : mend.polygons) covering += is_inside(piece, p) ? 1 : 0;
      EXPECT_EQ(covering, is_free ? 1 : 0) << p.transpose();
    }
  }
  EXPECT_GT(mended_ones, 100);
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
