// Union of walkable areas: adjoining or overlapping polygons are joined, others stay unchanged, and
// walls surround the whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "base/random.h"
#include "geometry/polygon_union.h"
#include "geometry/wkt.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/run/simulation.h"
#include "tests/recordings/binary_files.h"
#include "tests/recordings/recording_folder.h"

namespace throng::area_union_test {
namespace {

using testing::HasSubstr;
using Ring = Polygon::Ring;

double uniform(uint64_t seed, uint64_t id, uint32_t number, double low, double high) {
  return random_uniform({seed, id, number, Purpose::kBoxWorld}, low, high);
}

JoinedArea joined(const std::string& wkt) { return join(parse_wkt(wkt, "a.wkt"), "a.wkt"); }

std::string text_of(const std::vector<Ring>& rings, int digits = 17) {
  std::string text;
  for (const Ring& ring : rings) {
    text += text.empty() ? "MULTIPOLYGON (((" : ", ((";
    for (size_t i = 0; i < ring.size(); ++i)
      text += fmt::format("{}{:.{}f} {:.{}f}", i == 0 ? "" : ", ", ring[i].x(), digits, ring[i].y(),
                          digits);
    text += "))";
  }
  return text + ")";
}

/// Rings as text in millimetres, each polygon's outline first.
std::string shape_of(const JoinedArea& area) {
  std::string text;
  for (const Polygon& polygon : area.polygons) {
    const auto add = [&](const Ring& ring) {
      for (const Eigen::Vector2d& corner : ring)
        text += fmt::format(" {:.3f},{:.3f}", corner.x() + 0.0, corner.y() + 0.0);
    };
    text += "|";
    add(polygon.outline);
    for (const Ring& hole : polygon.holes) {
      text += " hole";
      add(hole);
    }
  }
  return text;
}

constexpr double kLength_m = 12, kWidth_m = 2;

enum class Cut { kStraight, kOblique, kOverlap, kGap, kObliqueGap };
constexpr Cut kCuts[] = {Cut::kStraight, Cut::kOblique, Cut::kOverlap, Cut::kGap, Cut::kObliqueGap};

/// A corridor along x, cut into `pieces`.
std::vector<Ring> corridor(int pieces, Cut cut, double gap_m = 5e-4) {
  const bool is_oblique = cut == Cut::kOblique || cut == Cut::kObliqueGap;
  const bool has_gap = cut == Cut::kGap || cut == Cut::kObliqueGap;
  std::vector<Ring> rings;
  for (int i = 0; i < pieces; ++i) {
    const double slant = is_oblique ? uniform(3, static_cast<uint64_t>(pieces), 1, -0.25, 0.25) : 0;
    const auto at = [&](int number, double y) -> double {
      const bool is_cut = number > 0 && number < pieces;
      return kLength_m * number / pieces + (is_cut ? slant * (y - 1) : 0);
    };
    const double begin = has_gap && i > 0 ? gap_m : 0;
    const double end = cut == Cut::kOverlap && i + 1 < pieces ? 0.3 : 0;
    rings.push_back({{at(i, 0) + begin, 0},
                     {at(i + 1, 0) + end, 0},
                     {at(i + 1, kWidth_m) + end, kWidth_m},
                     {at(i, kWidth_m) + begin, kWidth_m}});
  }
  return rings;
}

std::vector<Ring> turned(std::vector<Ring> rings, double angle_rad, const Eigen::Vector2d& shift) {
  for (Ring& ring : rings)
    for (Eigen::Vector2d& corner : ring) corner = shift + Eigen::Rotation2Dd(angle_rad) * corner;
  return rings;
}

TEST(AreaUnion, RestoresACutCorridorBitwise) {
  for (int pieces = 1; pieces <= 20; ++pieces)
    for (const Cut cut : kCuts)
      for (uint64_t turn = 0; turn < 4; ++turn) {
        const auto id = static_cast<uint64_t>(pieces);
        const double angle_rad = turn == 0 ? 0 : uniform(turn, id, 0, -3, 3);
        const Eigen::Vector2d shift(uniform(turn, id, 1, -500, 500),
                                    uniform(turn, id, 2, -500, 500));
        const Ring whole = turned(corridor(1, cut), angle_rad, shift).front();
        for (const int digits : {17, 4}) {
          const JoinedArea area =
              joined(text_of(turned(corridor(pieces, cut), angle_rad, shift), digits));
          ASSERT_EQ(area.polygons.size(), 1u) << pieces << " pieces, turn " << turn;
          EXPECT_TRUE(area.polygons[0].holes.empty());
          const Ring expected = parse_wkt(text_of({whole}, digits), "a.wkt")[0].outline;
          EXPECT_EQ(area.polygons[0].outline, expected)
              << pieces << " pieces, cut " << static_cast<int>(cut) << ", turn " << turn;
          const bool has_gap = cut == Cut::kGap || cut == Cut::kObliqueGap;
          EXPECT_EQ(area.gaps, has_gap ? pieces - 1 : 0);
        }
      }
}

TEST(AreaUnion, ClosesGapsOfUpToAMillimetre) {
  for (const double gap_m : {0.0, 1e-4, 5e-4, 1e-3}) {
    const JoinedArea area = joined(text_of(corridor(3, Cut::kGap, gap_m)));
    EXPECT_EQ(area.polygons.size(), 1u) << gap_m;
    EXPECT_EQ(area.gaps, gap_m > 1.5e-4 ? 2 : 0) << gap_m;
    if (area.gaps > 0) {
      EXPECT_NEAR(area.max_gap_m, gap_m, 1e-9);
    }
  }
  for (const double gap_m : {1.2e-3, 2e-3, 0.1}) {
    const JoinedArea area = joined(text_of(corridor(3, Cut::kGap, gap_m)));
    EXPECT_EQ(area.polygons.size(), 3u) << gap_m;
    EXPECT_EQ(area.gaps, 0);
  }
}

Ring rotated_to_first(Ring ring, const Eigen::Vector2d& first) {
  std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), first), ring.end());
  return ring;
}

TEST(AreaUnion, ClosesSlitsOfUpToAMillimetre) {
  for (const double gap_m : {0.0, 5e-5, 2e-4, 6e-4, 1e-3})
    for (uint64_t turn = 0; turn < 6; ++turn) {
      const double angle_rad = turn == 0 ? 0 : uniform(turn, 7, 0, -3, 3);
      const Eigen::Vector2d shift(uniform(turn, 7, 1, -50, 50), uniform(turn, 7, 2, -50, 50));
      const auto at = [&](Ring ring) { return turned({ring}, angle_rad, shift).front(); };
      const Ring whole = at({{0, 0}, {10, 0}, {10, 2}, {0, 2}});
      for (const Ring& slit :
           {Ring{{5 - gap_m, 0}, {5 - gap_m, 1.5}, {5, 1.5}, {5, 0}},  // with a flat end
            Ring{{5 - gap_m, 0}, {5, 1.5}, {5, 0}},                    // with a point
            Ring{{5 - gap_m, 0}, {6 - gap_m, 1.5}, {6, 1.5}, {5, 0}},  // oblique
            Ring{{5 - gap_m, 0}, {5 - gap_m, 1}, {6, 1}, {6, 1 - gap_m}, {5, 1 - gap_m}, {5, 0}}}) {
        Ring with_slit = {{0, 0}};
        with_slit.insert(with_slit.end(), slit.begin(), slit.end());
        with_slit.insert(with_slit.end(), {{10, 0}, {10, 2}, {0, 2}});
        const JoinedArea area = join({{at(with_slit), {}}}, "a.wkt");
        ASSERT_EQ(area.polygons.size(), 1u) << gap_m;
        EXPECT_TRUE(area.polygons[0].holes.empty()) << gap_m << ", turn " << turn;
        const Ring& found = area.polygons[0].outline;
        // If the ends of a slit of zero width coincide, that corner stays on its line.
        if (gap_m > 0) {
          EXPECT_EQ(rotated_to_first(found, whole[0]), whole)
              << gap_m << ", " << slit.size() << " corners, turn " << turn;
        }
        EXPECT_NEAR(doubled_area(found), 40, 1e-2);
        EXPECT_EQ(area.gaps, gap_m > 1.5e-4 ? 1 : 0) << gap_m;
        if (area.gaps > 0) {
          EXPECT_LE(area.max_gap_m, gap_m + 1e-9);
          EXPECT_GE(area.max_gap_m, 0.8 * gap_m) << "across an oblique one";
        }
      }
      // A ring that nearly touches itself.
      const double half_m = 0.5 * gap_m;
      const Ring open = at({{0, 2 - half_m},
                            {0, 0},
                            {4, 0},
                            {4, 4},
                            {0, 4},
                            {0, 2 + half_m},
                            {1, 2 + half_m},
                            {1, 3},
                            {3, 3},
                            {3, 1},
                            {1, 1},
                            {1, 2 - half_m}});
      const JoinedArea area = join({{open, {}}}, "a.wkt");
      ASSERT_EQ(area.polygons.size(), 1u);
      ASSERT_EQ(area.polygons[0].holes.size(), 1u) << gap_m;
      EXPECT_NEAR(doubled_area(area.polygons[0].outline), 32, 1e-2);
      EXPECT_NEAR(doubled_area(area.polygons[0].holes[0]), -8, 1e-2);
    }
}

TEST(AreaUnion, LeavesPolygonsWithoutSlitsUnchanged) {
  std::vector<Polygon> polygons;
  const auto notched = [&](const Ring& notch) {
    Ring ring = {{0, 0}};
    ring.insert(ring.end(), notch.begin(), notch.end());
    ring.insert(ring.end(), {{10, 0}, {10, 2}, {0, 2}});
    polygons.push_back({ring, {}});
  };
  notched({{5, 0}, {5, 1.5}, {5.0012, 1.5}, {5.0012, 0}});  // wider than a slit
  notched({{5, 0}, {5.005, 1.5}, {5.01, 0}});               // that ends in a point
  // A line on the ground, and an area as narrow.
  polygons.push_back(
      {{{0, 0}, {10, 0}, {10, 2}, {0, 2}}, {{{5, 0.5}, {5, 1.5}, {5.0006, 1.5}, {5.0006, 0.5}}}});
  polygons.push_back({{{0, 0}, {10, 0}, {10, 0.0006}, {0, 0.0006}}, {}});
  // Circles with an edge per half millimetre, and a hole.
  const auto circle = [](double radius_m, int corners, double sign) {
    Ring ring;
    for (int i = 0; i < corners; ++i)
      ring.emplace_back(radius_m * std::cos(sign * 2 * std::numbers::pi * i / corners),
                        radius_m * std::sin(sign * 2 * std::numbers::pi * i / corners));
    return ring;
  };
  polygons.push_back({circle(0.5, 6000, 1), {circle(0.1, 1200, -1)}});
  for (const Polygon& polygon : polygons) {
    const JoinedArea area = join({polygon}, "a.wkt");
    ASSERT_EQ(area.polygons.size(), 1u);
    EXPECT_EQ(area.polygons[0].outline, polygon.outline);
    EXPECT_EQ(area.polygons[0].holes, polygon.holes);
    EXPECT_EQ(area.gaps, 0);
  }
}

TEST(AreaUnion, JoinsAllKindsOfNeighbours) {
  const std::string square = "((0 0, 9 0, 9 9, 0 9))";
  const std::string whole = "| 0.000,0.000 9.000,0.000 9.000,9.000 0.000,9.000";
  const std::string with_hole = "((0 0, 9 0, 9 9, 0 9), (3 3, 3 6, 6 6, 6 3))";
  const struct {
    const char* what;
    std::string polygons, expected;
  } cases[] = {
      {"twice", square + ", " + square, whole},
      {"one in the other", square + ", ((3 3, 6 3, 6 6, 3 6))", whole},
      {"one around the other", "((3 3, 6 3, 6 6, 3 6)), " + square, whole},
      {"one fills the other's hole", with_hole + ", ((3 3, 6 3, 6 6, 3 6))", whole},
      {"but for half a millimetre",
       with_hole + ", ((3.0005 3.0005, 5.9995 3.0005, 5.9995 5.9995, 3.0005 5.9995))", whole},
      {"one in the other's hole", with_hole + ", ((4 4, 5 4, 5 5, 4 5))",
       whole + " hole 3.000,3.000 3.000,6.000 6.000,6.000 6.000,3.000"
               "| 4.000,4.000 5.000,4.000 5.000,5.000 4.000,5.000"},
      {"corner to corner", "((0 0, 1 0, 1 1, 0 1)), ((1 1, 2 1, 2 2, 1 2))",
       "| 0.000,0.000 1.000,0.000 1.000,1.000 0.000,1.000"
       "| 1.000,1.000 2.000,1.000 2.000,2.000 1.000,2.000"},
      {"far apart", "((0 0, 1 0, 1 1, 0 1)), ((5 5, 6 5, 6 6, 5 6))",
       "| 0.000,0.000 1.000,0.000 1.000,1.000 0.000,1.000"
       "| 5.000,5.000 6.000,5.000 6.000,6.000 5.000,6.000"},
      {"a narrow one at a wide one's side", square + ", ((9.0005 3, 12 3, 12 5, 9.0005 5))",
       "| 0.000,0.000 9.000,0.000 9.000,3.000 12.000,3.000 12.000,5.000 9.000,5.000 9.000,9.000 "
       "0.000,9.000"},
      {"four around a hole",
       "((0 0, 3 0, 3 9, 0 9)), ((3 0, 6 0, 6 3, 3 3)), ((3 6, 6 6, 6 9, 3 9)), ((6 0, 9 0, 9 9, "
       "6 9))",
       whole + " hole 6.000,3.000 3.000,3.000 3.000,6.000 6.000,6.000"},
      {"four whose gaps cross",
       "((0 0, 4 0, 4 4, 0 4)), ((4.0005 0, 9 0, 9 4, 4.0005 4)), ((0 4.0005, 4 4.0005, 4 9, 0 "
       "9)), ((4.0005 4.0005, 9 4.0005, 9 9, 4.0005 9))",
       whole},
      {"the other way round", "((0 9, 9 9, 9 4, 0 4)), ((0 0, 0 4, 9 4, 9 0))",
       "| 0.000,9.000 0.000,0.000 9.000,0.000 9.000,9.000"},
  };
  for (const auto& each : cases) {
    EXPECT_EQ(shape_of(joined("MULTIPOLYGON (" + each.polygons + ")")), each.expected) << each.what;
    std::string collection = "GEOMETRYCOLLECTION (POLYGON ";
    for (size_t i = 0; i < each.polygons.size(); ++i)
      collection += each.polygons.compare(i, 4, ")), ") == 0 ? (i += 3, ")), POLYGON ")
                                                             : std::string(1, each.polygons[i]);
    EXPECT_EQ(shape_of(joined(collection + ")")), each.expected) << each.what;
  }
}

TEST(AreaUnion, JoinsBricksToAWall) {
  for (uint64_t wall = 0; wall < 60; ++wall) {
    const double gap_m = wall % 3 == 0 ? 0 : wall % 3 == 1 ? 5e-4 : -0.02;
    const double half_m = 0.5 * gap_m;
    const int rows = 1 + static_cast<int>(wall % 6);
    std::vector<Ring> bricks;
    for (int row = 0; row < rows; ++row) {
      std::vector<double> x = {0, 10};
      for (uint32_t i = 0; i < (wall + static_cast<uint64_t>(row)) % 5; ++i)
        x.insert(x.end() - 1,
                 x[x.size() - 2] + uniform(wall, static_cast<uint64_t>(row), i, 0.5, 2));
      for (size_t i = 0; i + 1 < x.size(); ++i) {
        const double left = x[i] + (i > 0 ? half_m : 0);
        const double right = x[i + 1] - (i + 2 < x.size() ? half_m : 0);
        const double low = 8.0 * row / rows + (row > 0 ? half_m : 0);
        const double high = 8.0 * (row + 1) / rows - (row + 1 < rows ? half_m : 0);
        bricks.push_back({{left, low}, {right, low}, {right, high}, {left, high}});
      }
    }
    const double angle_rad = uniform(wall, 99, 0, -3, 3);
    const Ring whole = turned({{{0, 0}, {10, 0}, {10, 8}, {0, 8}}}, angle_rad, {30, 20}).front();
    const JoinedArea area = joined(text_of(turned(bricks, angle_rad, {30, 20})));
    ASSERT_EQ(area.polygons.size(), 1u) << "wall " << wall;
    EXPECT_TRUE(area.polygons[0].holes.empty()) << "wall " << wall;
    ASSERT_EQ(area.polygons[0].outline.size(), 4u) << "wall " << wall;
    for (size_t i = 0; i < 4; ++i)
      EXPECT_LT((area.polygons[0].outline[i] - whole[i]).norm(), 1e-9) << "wall " << wall;
  }
}

TEST(AreaUnion, ContainsThePointsOfItsPolygons) {
  for (uint64_t seed = 0; seed < 40; ++seed) {
    std::vector<Polygon> polygons;
    for (uint64_t i = 0; i < 2 + seed % 7; ++i) {
      const Eigen::Vector2d middle(uniform(seed, i, 0, -3, 3), uniform(seed, i, 1, -3, 3));
      const auto ring = [&](double size_m, double turn_rad) {
        Ring corners;
        const int count = 3 + static_cast<int>((seed + i) % 6);
        for (int k = 0; k < count; ++k)
          corners.push_back(
              middle +
              size_m * Eigen::Vector2d(std::cos(turn_rad + 2 * k * std::numbers::pi / count),
                                       std::sin(turn_rad + 2 * k * std::numbers::pi / count)));
        return corners;
      };
      Polygon& polygon = polygons.emplace_back();
      polygon.outline = ring(uniform(seed, i, 2, 0.5, 2.5), uniform(seed, i, 3, 0, 3));
      if (i % 3 == 1) polygon.holes.push_back(ring(0.1, 0));
    }
    const PolygonLocator before(polygons);
    const PolygonLocator after(join(polygons, "").polygons);
    for (uint64_t i = 0; i < 3000; ++i) {
      const Eigen::Vector2d p(uniform(seed, i, 10, -6, 6), uniform(seed, i, 11, -6, 6));
      // Avoids points within 1 mm of an edge.
      const auto near_edge = [&](const Eigen::Vector2d& step) {
        return before.contains(p + step) != before.contains(p - step);
      };
      if (near_edge({2e-3, 0}) || near_edge({0, 2e-3})) continue;
      ASSERT_EQ(after.contains(p), before.contains(p))
          << "seed " << seed << " at " << p.transpose();
    }
  }
}

TEST(AreaUnion, RejectsTooManyCrossings) {
  // Strips along x crossed by strips along y.
  std::vector<Polygon> strips;
  for (int i = 0; i < 2000; ++i) {
    strips.push_back(
        {{{0, 0.05 * i}, {200, 0.05 * i}, {200, 0.05 * i + 0.01}, {0, 0.05 * i + 0.01}}, {}});
    strips.push_back(
        {{{0.05 * i, 0}, {0.05 * i + 0.01, 0}, {0.05 * i + 0.01, 200}, {0.05 * i, 200}}, {}});
  }
  EXPECT_THAT([&] { join(strips, "a.h5"); },
              testing::ThrowsMessage<InputError>(HasSubstr("a.h5: expected polygons of which at")));
  std::vector<Polygon> far = {{{{1e6, 0}, {1e6 + 1, 0}, {1e6 + 1, 1}}, {}}};
  EXPECT_EQ(join({far[0], {{{0, 0}, {1, 0}, {1, 1}}, {}}}, "a.h5").polygons.size(), 2u);
  EXPECT_THAT(
      [&] {
        join({far[0], far[0]}, "a.h5");
      },
      testing::ThrowsMessage<InputError>(HasSubstr("within 100 km")));
}

class CutCorridor : public RecordingTest {
 protected:
  /// People who walk along both walls, close enough to touch them.
  Scene scene(const std::string& wkt) const {
    std::string rows;
    for (int person = 0; person < 4; ++person)
      for (int frame = 0; frame < 60; ++frame)
        rows += fmt::format("{}({}, {}, {}, {}, 1, 0)", rows.empty() ? "" : ", ", frame, person,
                            0.5 + 2.4 * person + 0.07 * frame,
                            person % 2 == 0 ? 0.2 + 0.02 * person : kWidth_m - 0.2);
    make_sqlite(path("walk.sqlite"),
                "CREATE TABLE trajectory_data(frame INTEGER, id INTEGER, pos_x REAL, pos_y REAL, "
                "ori_x REAL, ori_y REAL);"
                "CREATE TABLE metadata(key TEXT, value TEXT);"
                "INSERT INTO metadata VALUES('version', '2'), ('fps', '15');"
                "CREATE TABLE geometry(hash INTEGER, wkt TEXT);"
                "INSERT INTO geometry VALUES(1, '" +
                    wkt + "'); INSERT INTO trajectory_data VALUES " + rows + ";");
    RecordingOptions options;
    options.file = path("walk.sqlite");
    Scene scene = recorded_scene(options, true);
    scene.groups.back().gait_styles = StyleShares{1};
    scene.exact = true;
    return scene;
  }

  /// Position, heading and size, sorted: rings may begin at any corner.
  static std::vector<std::array<double, 6>> walls_of(const Scene& scene) {
    std::vector<std::array<double, 6>> walls;
    for (const Obstacle& wall : scene.obstacles)
      walls.push_back({wall.centre_m.x(), wall.centre_m.y(), wall.heading_rad, wall.size_m.x(),
                       wall.size_m.y(), wall.size_m.z()});
    std::sort(walls.begin(), walls.end());
    return walls;
  }

  /// Frame, person, part, and whether contact with a wall began or ended.
  using Touch = std::tuple<int64_t, uint32_t, uint32_t, EventKind>;
  static std::vector<Touch> touches(const Scene& scene) {
    Simulation simulation(scene, {});
    const auto avatars = static_cast<uint32_t>(simulation.info().avatar_count());
    std::vector<Touch> out;
    for (int64_t i = 0; i < 60; ++i) {
      const Frame& frame = simulation.step();
      for (const PairEvent& event : frame.events) {
        const PairKey& pair = event.pair;
        if (pair.a() < avatars && pair.b() >= avatars)
          out.emplace_back(frame.number, pair.a(), pair.part_a(), event.kind);
      }
    }
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST_F(CutCorridor, EndsWallsAtSharedCorners) {
  const Scene touching = scene("MULTIPOLYGON (((0 0, 6 0, 6 2, 0 2)), ((6 2, 9 2, 9 5, 6 5)))");
  ASSERT_EQ(touching.obstacles.size(), 8u);
  const PolygonLocator area(touching.floor);
  for (const Obstacle& wall : touching.obstacles)
    for (const Eigen::Vector3f& vertex : wall.mesh.vertices) {
      const Eigen::Vector2d along(std::cos(wall.heading_rad), std::sin(wall.heading_rad));
      const Eigen::Vector2d at =
          wall.centre_m.head<2>() + static_cast<double>(vertex.x()) * along +
          static_cast<double>(vertex.y()) * Eigen::Vector2d(-along.y(), along.x());
      // Away from edges, where the area begins.
      const bool is_in = at.x() > 0.01 && at.y() > 0.01 && at.x() < 8.99 && at.y() < 4.99 &&
                         area.contains(at) && (at - Eigen::Vector2d(6, 2)).norm() > 0.01;
      EXPECT_FALSE(is_in && area.contains(at + Eigen::Vector2d(0.01, 0.01)) &&
                   area.contains(at - Eigen::Vector2d(0.01, 0.01)))
          << wall.name << " reaches to " << at.transpose();
    }
}

TEST_F(CutCorridor, HasTheContactsOfTheWholeCorridor) {
  const Scene whole = scene(text_of(corridor(1, Cut::kStraight)));
  ASSERT_EQ(whole.obstacles.size(), 4u);
  const std::vector<Touch> expected = touches(whole);
  ASSERT_GT(expected.size(), 20u) << "people touch the walls";
  for (int pieces = 2; pieces <= 20; ++pieces)
    for (const Cut cut : kCuts) {
      std::vector<Ring> rings = corridor(pieces, cut);
      if (pieces % 3 == 0) std::rotate(rings.begin(), rings.begin() + pieces / 2, rings.end());
      const Scene cut_scene = scene(text_of(rings));
      ASSERT_EQ(walls_of(cut_scene), walls_of(whole)) << pieces << " pieces";
      // Runs two kinds of cuts per number of pieces.
      if ((static_cast<int>(cut) + pieces) % 5 < 2) {
        EXPECT_EQ(touches(cut_scene), expected)
            << pieces << " pieces, cut " << static_cast<int>(cut);
      }
      const std::vector<Anomaly>& anomalies = cut_scene.recorded->recording->facts().anomalies;
      const bool has_gap = cut == Cut::kGap || cut == Cut::kObliqueGap;
      ASSERT_EQ(anomalies.size(), has_gap ? 1u : 0u);
      if (!has_gap) continue;
      EXPECT_EQ(anomalies[0].what, "gaps of up to 1 mm in the walkable area (closed)");
      EXPECT_EQ(anomalies[0].count, pieces - 1);
      EXPECT_THAT(anomalies[0].first, HasSubstr(" mm wide at ("));
    }
}

}  // namespace
}  // namespace throng::area_union_test
