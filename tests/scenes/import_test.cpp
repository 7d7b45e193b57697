// Floor plans of other programs become scenes: their kind, unit and layers, and what is left out.
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "base/random.h"
#include "base/text.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/import/imported_plan.h"
#include "tests/nightly.h"
#include "tests/scenes/scene_file.h"

namespace throng::import_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

using Layers = std::map<std::string, std::vector<std::string>>;

class Import : public SceneFile {
 protected:
  ImportedPlan read(const std::string& text, std::optional<double> unit_m = {},
                    const Layers& layers = {}) const {
    return import_plan({.file = write("plan", text), .layers = layers, .unit_m = unit_m});
  }
  /// Error of reading a text, without the folder; "" for none.
  std::string refusal(const std::string& text, std::optional<double> unit_m = {},
                      const Layers& layers = {}) const {
    try {
      read(text, unit_m, layers);
      return "";
    } catch (const InputError& error) {
      std::string message = error.what();
      const size_t at = message.find(folder_.string() + "/");
      if (at != std::string::npos) message.erase(at, folder_.string().size() + 1);
      return message;
    }
  }
};

// ---- WKT

class Wkt : public Import {};

const std::string kRoom = "POLYGON ((0 0, 10 0, 10 6, 0 6, 0 0), (4 2, 4 3, 5 3, 5 2, 4 2))\n";

TEST_F(Wkt, IsWalkableInItsUnit) {
  const ImportedPlan plan = read(kRoom, 1);
  ASSERT_EQ(plan.walkable.size(), 1u);
  EXPECT_EQ(plan.walkable[0].outline.size(), 4u);
  EXPECT_EQ(plan.walkable[0].holes.size(), 1u);
  EXPECT_NEAR(area_m2(plan.walkable[0]), 59, 1e-9);
  EXPECT_NEAR(area_m2(read(kRoom, 0.1).walkable[0]), 0.59, 1e-9);
  EXPECT_EQ(plan.kind, "WKT");
}

TEST_F(Wkt, HasOneGeometryAfterTheOther) {
  const ImportedPlan plan = read(
      "# two rooms and a hall\n"
      "POLYGON ((0 0, 4 0, 4 4, 0 4))\r\n"
      "\n"
      "SRID=25832;MULTIPOLYGON (((6 0, 9 0, 9 4)),\n"
      "  ((6 6, 9 6, 9 9)))\n"
      "GEOMETRYCOLLECTION (\n"
      "POLYGON ((0 6, 4 6, 4 9)))\n",
      1);
  EXPECT_EQ(plan.walkable.size(), 4u);
  EXPECT_THAT(plan.used, ElementsAre("3 geometries as walkable: 4 areas"));
}

TEST_F(Wkt, NeedsAUnit) {
  EXPECT_EQ(refusal(kRoom),
            "plan: expected a unit of length, as in --unit m, found WKT without one");
}

TEST_F(Wkt, NamesTheLineOfAMistake) {
  EXPECT_THAT(refusal(kRoom + "\nPOLYGON ((0 0, 1 0, 1 x))\n", 1), StartsWith("plan:3: expected"));
  EXPECT_THAT(refusal("LINESTRING (0 0, 9 9)\n", 1), HasSubstr("found LINESTRING"));
  EXPECT_THAT(refusal("SRID=4326;POLYGON ((0 0, 1 0, 1 1))\n", 1), HasSubstr("degrees"));
  EXPECT_THAT(refusal("POLYGON ((0 0, 1 0, 1 1)\n", 1), HasSubstr("its end"));
  EXPECT_THAT(refusal(kRoom, 1, {{"walls", {"A"}}}),
              StartsWith("--layer: expected a plan with layers"));
}

// ---- GeoJSON

class GeoJson : public Import {};

std::string feature(const std::string& properties, const std::string& geometry) {
  return R"({"type": "Feature", "properties": )" + properties + R"(, "geometry": )" + geometry +
         "}";
}
std::string collection(const std::string& features) {
  return R"({"type": "FeatureCollection", "features": [)" + features + "]}";
}
std::string square(double x, double y, double edge) {
  return fmt::format(R"({{"type": "Polygon", "coordinates": [[[{0}, {1}], [{2}, {1}], [{2}, {3}], )"
                     R"([{0}, {3}], [{0}, {1}]]]}})",
                     x, y, x + edge, y + edge);
}
const std::string kLine = R"({"type": "LineString", "coordinates": [[0, 0], [5, 0], [5, 5]]})";

TEST_F(GeoJson, HasDegreesUnlessAUnitIsGiven) {
  EXPECT_THAT(refusal(square(0, 0, 10)), HasSubstr("degrees by its standard (RFC 7946)"));
  EXPECT_THAT(refusal(R"({"type": "FeatureCollection", "crs": {"properties": {"name": )"
                      R"("urn:ogc:def:crs:OGC:1.3:CRS84"}}, "features": []})",
                      1),
              HasSubstr("degrees ('urn:ogc:def:crs:OGC:1.3:CRS84')"));
  EXPECT_EQ(read(square(0, 0, 10), 1).walkable.size(), 1u);
}

TEST_F(GeoJson, BuildingInDegreesIsNoPlanInMetres) {
  EXPECT_THAT(refusal(square(7.123, 50.7, 0.0005), 1),
              HasSubstr("expected a plan of 0.5 m to 20 km"));
}

TEST_F(GeoJson, AreasAreWalkableAndLinesAreWalls) {
  const ImportedPlan plan = read(collection(feature("null", square(0, 0, 10)) + "," +
                                            feature("{}", kLine) + "," + feature("{}", "null")),
                                 1);
  EXPECT_EQ(plan.walkable.size(), 1u);
  ASSERT_EQ(plan.walls.size(), 1u);
  EXPECT_EQ(plan.walls[0].line_m.size(), 3u);
  EXPECT_THAT(plan.left_out, ElementsAre("1 feature without geometry"));
}

TEST_F(GeoJson, PropertiesStateTheUse) {
  const std::string text =
      collection(feature(R"({"layer": "Floor"})", square(0, 0, 20)) + "," +
                 feature(R"({"type": "column", "name": "pillar north"})", square(3, 3, 1)) + "," +
                 feature(R"({"Layer": "start area"})", square(0, 0, 2)) + "," +
                 feature(R"({"kind": "exit"})", square(17, 17, 2)));
  const ImportedPlan plan = read(text, 1);
  EXPECT_EQ(plan.walkable.size(), 1u);
  ASSERT_EQ(plan.obstacles.size(), 1u);
  EXPECT_EQ(plan.obstacles[0].name, "pillar north");
  EXPECT_EQ(plan.starts.size(), 1u);
  EXPECT_EQ(plan.goals.size(), 1u);
}

TEST_F(GeoJson, LayersAreChosenByLayerTypeOrName) {
  const std::string text = collection(feature(R"({"layer": "L1"})", square(0, 0, 20)) + "," +
                                      feature(R"({"name": "kiosk"})", square(3, 3, 1)) + "," +
                                      feature(R"({"layer": "L2"})", square(5, 5, 1)));
  const ImportedPlan plan = read(text, 1, {{"walkable", {"l1"}}, {"obstacles", {"Kiosk"}}});
  EXPECT_EQ(plan.walkable.size(), 1u);
  EXPECT_EQ(plan.obstacles.size(), 1u);
  EXPECT_THAT(plan.left_out, ElementsAre("1 feature that --layer does not name"));
  EXPECT_EQ(refusal(text, 1, {{"walkable", {"kisok"}}}),
            "--layer: expected a layer, type or name of the features: 'L1', 'L2', 'kiosk', found "
            "'kisok' (did you mean 'kiosk'?)");
}

TEST_F(GeoJson, NumbersNameLayersToo) {
  const std::string text = collection(feature(R"({"layer": 6})", square(0, 0, 20)) + "," +
                                      feature(R"({"layer": 7.0, "name": 12})", square(3, 3, 1)) +
                                      "," + feature(R"({"layer": 7})", square(6, 6, 1)) + "," +
                                      feature(R"({"layer": true})", square(8, 8, 1)));
  const ImportedPlan plan = read(text, 1, {{"walkable", {"6"}}, {"obstacles", {"7"}}});
  EXPECT_EQ(plan.walkable.size(), 1u);
  ASSERT_EQ(plan.obstacles.size(), 2u);
  EXPECT_EQ(plan.obstacles[0].name, "12");
  EXPECT_EQ(plan.obstacles[1].name, "7");
  EXPECT_EQ(refusal(text, 1, {{"walkable", {"5"}}}),
            "--layer: expected a layer, type or name of the features: '12', '6', '7', found '5' "
            "(did you mean '6'?)");
  EXPECT_EQ(load(scene_text_of(plan, "plan")).obstacles.back().name, "7");
}

TEST_F(GeoJson, CountsFeaturesWithoutGeometry) {
  EXPECT_THAT(read(collection(feature("{}", square(0, 0, 10)) + "," + feature("{}", "null") + "," +
                              feature("{}", "null")),
                   1)
                  .left_out,
              ElementsAre("2 features without geometry"));
}

TEST_F(GeoJson, RejectsMalformedFeatures) {
  EXPECT_THAT(refusal("{\"type\": \"FeatureCollection\",\n \"features\": [,]}", 1),
              StartsWith("plan:2: expected JSON"));
  EXPECT_THAT(refusal("{\"type\": \"FeatureCollection\"", 1), HasSubstr("cut short"));
  EXPECT_THAT(refusal(collection("3"), 1), HasSubstr("an object in feature 1, found '3'"));
  EXPECT_THAT(refusal(collection(feature("{}", R"({"type": "Polygon"})")), 1),
              HasSubstr("'coordinates' in feature 1"));
  EXPECT_THAT(
      refusal(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1]]]})", 1),
      HasSubstr("the last equal to the first"));
  EXPECT_THAT(refusal(R"({"type": "Polygon", "coordinates": [[[0, 0], [1, "a"]]]})", 1),
              HasSubstr("positions of two numbers"));
  EXPECT_THAT(refusal(R"({"type": "Polygon", "coordinates": [[[0, 1e999]]]})", 1),
              HasSubstr("too large"));
}

// ---- DXF

class Dxf : public Import {};

/// "0 LINE 8 WALLS": codes and values by turns.
std::string groups(std::string_view words) {
  std::string out;
  for (const std::string& word : split_text(words, ' ')) out += word + "\n";
  return out;
}
std::string dxf(const std::string& entities, const std::string& tables = "",
                const std::string& blocks = "", const std::string& unit = "6") {
  return groups("0 SECTION 2 HEADER 9 $INSUNITS 70 " + unit + " 0 ENDSEC 0 SECTION 2 TABLES 0 " +
                "TABLE 2 LAYER" + tables + " 0 ENDTAB 0 ENDSEC 0 SECTION 2 BLOCKS" + blocks +
                " 0 ENDSEC 0 SECTION 2 ENTITIES" + entities + " 0 ENDSEC 0 EOF");
}
std::string line(const std::string& layer, double x1, double y1, double x2, double y2) {
  return fmt::format(" 0 LINE 8 {} 10 {} 20 {} 11 {} 21 {}", layer, x1, y1, x2, y2);
}
std::string rectangle(const std::string& layer, double x1, double y1, double x2, double y2) {
  return fmt::format(
      " 0 LWPOLYLINE 8 {0} 90 4 70 1 10 {1} 20 {2} 10 {3} 20 {2} 10 {3} 20 {4} 10 "
      "{1} 20 {4}",
      layer, x1, y1, x2, y2);
}

TEST_F(Dxf, LayersAreUsedByTheirNames) {
  const ImportedPlan plan =
      read(dxf(rectangle("A-FLOOR", 0, 0, 20, 10) + rectangle("Columns", 5, 5, 5.5, 5.5) +
               line("INNER_WALLS", 10, 0, 10, 4) + rectangle("Start", 1, 1, 3, 3) +
               rectangle("EXIT", 17, 1, 19, 3) + line("DIMENSIONS", 0, 0, 5, 5) +
               " 0 TEXT 8 INNER_WALLS 1 lobby"));
  EXPECT_EQ(plan.walkable.size(), 1u);
  EXPECT_EQ(plan.obstacles.size(), 1u);
  EXPECT_EQ(plan.walls.size(), 1u);
  EXPECT_EQ(plan.starts.size(), 1u);
  EXPECT_EQ(plan.goals.size(), 1u);
  EXPECT_THAT(plan.used, testing::Contains("layer 'A-FLOOR' as walkable: 1 area"));
  EXPECT_THAT(plan.left_out,
              ElementsAre("layer 'INNER_WALLS': 1 TEXT", "1 layer without a use: 'DIMENSIONS'"));
}

TEST_F(Dxf, GroundFloorWallsAreWalls) {
  const ImportedPlan plan = read(dxf(line("GROUND-FLOOR-WALLS", 0, 0, 9, 0)));
  EXPECT_EQ(plan.walls.size(), 1u);
  EXPECT_TRUE(plan.walkable.empty());
}

TEST_F(Dxf, LayersAreChosenRegardlessOfCase) {
  const std::string text = dxf(rectangle("X1", 0, 0, 9, 9) + line("X2", 0, 0, 9, 0));
  const ImportedPlan plan = read(text, {}, {{"walkable", {"x1"}}, {"walls", {"x2"}}});
  EXPECT_EQ(plan.walkable.size(), 1u);
  EXPECT_EQ(plan.walls.size(), 1u);
  EXPECT_EQ(
      refusal(text, {}, {{"walkable", {"X3"}}}),
      "--layer: expected a layer of the drawing: 'X1', 'X2', found 'X3' (did you mean 'X1'?)");
  EXPECT_THAT(refusal(text, {}, {{"walkable", {"X1"}}, {"walls", {"x1"}}}),
              HasSubstr("expected one use of 'x1'"));
  EXPECT_THAT(refusal(text, {}, {{"floor", {"X1"}}}), HasSubstr("found 'floor'"));
}

TEST_F(Dxf, NeedsALayerWithAUse) {
  EXPECT_EQ(refusal(dxf(line("A", 0, 0, 1, 1) + line("A", 1, 0, 1, 1) + line("B", 0, 0, 1, 1))),
            "plan: expected layers named after their use (walkable, obstacle, wall, start, goal), "
            "or --layer walkable=NAME, found the layers 'A' (2 entities), 'B' (1 entity)");
}

TEST_F(Dxf, HasTheUnitOfItsHeader) {
  const auto width_m = [&](const std::string& unit, std::optional<double> unit_m = {}) {
    return plan_bounds(read(dxf(line("WALL", 0, 0, 500, 0), "", "", unit), unit_m))->size_m().x();
  };
  EXPECT_DOUBLE_EQ(width_m("6"), 500);
  EXPECT_DOUBLE_EQ(width_m("5"), 5);
  EXPECT_DOUBLE_EQ(width_m("2"), 152.4);
  EXPECT_DOUBLE_EQ(width_m("1"), 12.7);
  EXPECT_DOUBLE_EQ(width_m("4", 0.01), 5) << "--unit overrides the file";
  EXPECT_DOUBLE_EQ(width_m("0", 0.01), 5);
  EXPECT_THAT(refusal(dxf(line("WALL", 0, 0, 5, 0), "", "", "0")),
              HasSubstr("expected a unit of length, as in --unit mm"));
  EXPECT_THAT(
      refusal(groups("0 SECTION 2 ENTITIES" + line("WALL", 0, 0, 5, 0) + " 0 ENDSEC 0 EOF")),
      HasSubstr("$INSUNITS is 0 or missing"));
  EXPECT_THAT(refusal(dxf(line("WALL", 0, 0, 5, 0), "", "", "18")),
              HasSubstr("--unit mm overrides"));
}

TEST_F(Dxf, JoinsLinesThatMeet) {
  // Within 1 mm, in any direction; repeated lines count once.
  const ImportedPlan room =
      read(dxf(line("FLOOR", 0, 0, 8, 0) + line("FLOOR", 8.0004, 5, 8, 0.0004) +
               line("FLOOR", 8, 5, 0, 5) + line("FLOOR", 8, 5, 0, 5) + line("FLOOR", 0, 5, 0, 0)));
  ASSERT_EQ(room.walkable.size(), 1u);
  EXPECT_EQ(room.walkable[0].outline.size(), 4u);
  EXPECT_NEAR(area_m2(room.walkable[0]), 40, 0.01);
  const ImportedPlan walls =
      read(dxf(line("WALL", 0, 0, 8, 0) + line("WALL", 8, 0, 8, 5) + line("WALL", 20, 0, 20, 5)));
  ASSERT_EQ(walls.walls.size(), 2u);
  EXPECT_EQ(walls.walls[0].line_m.size(), 3u);
}

TEST_F(Dxf, LinesThatDoNotMeetEncloseNothing) {
  EXPECT_THAT(read(dxf(rectangle("FLOOR", 0, 0, 9, 9) + line("FLOOR", 20, 0, 28, 0) +
                       line("FLOOR", 28.002, 0, 28, 5)))
                  .left_out,
              ElementsAre("layer 'FLOOR': 2 open lines that enclose no area"));
}

TEST_F(Dxf, SaysWhichLinesEncloseNothing) {
  const std::string open = line("A", 0, 0, 8, 0) + line("A", 8, 0, 8, 5) + line("A", 0, 2, 4, 2);
  EXPECT_EQ(
      refusal(dxf(open), {}, {{"walkable", {"a"}}}),
      "plan: expected closed lines, or walls, found 2 lines that enclose no area on layer 'A' "
      "(walkable); draw closed polylines, or use the lines as walls (--layer walls=A)");
  EXPECT_EQ(refusal(dxf(line("COLUMN", 0, 0, 8, 0) + line("FLOOR", 0, 2, 4, 2))),
            "plan: expected closed lines, or walls, found 2 lines that enclose no area on layer "
            "'COLUMN' (obstacles) and 1 more layer; draw closed polylines, or use the lines as "
            "walls (--layer walls=COLUMN)");
  EXPECT_EQ(read(dxf(open), {}, {{"walls", {"a"}}}).walls.size(), 2u);
}

TEST_F(GeoJson, SaysWhichLinesEncloseNothing) {
  EXPECT_EQ(refusal(collection(feature(R"({"layer": "ground floor"})", kLine)), 1),
            "plan: expected closed lines, or walls, found 1 line that encloses no area on layer "
            "'ground floor' (walkable); draw closed polylines, or use the lines as walls (--layer "
            "walls=\"ground floor\")");
}

TEST_F(Dxf, WallsEndWhereThreeMeet) {
  const ImportedPlan plan =
      read(dxf(line("WALL", 0, 0, 4, 0) + line("WALL", 4, 0, 8, 0) + line("WALL", 4, 0, 4, 4)));
  EXPECT_EQ(plan.walls.size(), 3u);
}

TEST_F(Dxf, ClosedWallsRepeatTheirFirstCorner) {
  const ImportedPlan plan = read(dxf(rectangle("WALL", 0, 0, 4, 4)));
  ASSERT_EQ(plan.walls.size(), 1u);
  EXPECT_EQ(plan.walls[0].line_m.size(), 5u);
  EXPECT_EQ(plan.walls[0].line_m.front(), plan.walls[0].line_m.back());
}

TEST_F(Dxf, OutlinesInsideOthersAreHoles) {
  const ImportedPlan plan =
      read(dxf(rectangle("FLOOR", 2, 2, 4, 4) + rectangle("FLOOR", 0, 0, 20, 10) +
               rectangle("FLOOR", 2.5, 2.5, 3.5, 3.5) + rectangle("FLOOR", 15, 5, 25, 8) +
               rectangle("FLOOR", 0, 0, 20, 10)));
  ASSERT_EQ(plan.walkable.size(), 3u) << "the hall, the overlapping room, the island in the hole";
  EXPECT_EQ(plan.walkable[0].holes.size(), 1u);
  EXPECT_NEAR(area_m2(plan.walkable[0]), 196, 1e-9);
}

TEST_F(Dxf, ArcsAreChordsWithinACentimetre) {
  const auto expect_circle = [](const std::vector<Eigen::Vector2d>& points,
                                const Eigen::Vector2d& centre, double radius_m) {
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_NEAR((points[i] - centre).norm(), radius_m, 2e-4);
      const Eigen::Vector2d middle = (points[i] + points[(i + 1) % points.size()]) / 2;
      EXPECT_GT((middle - centre).norm(), radius_m - 0.0102);
    }
  };
  // 3 m and 30 m: circle, half circles by bulges, arc and line, ellipse of equal axes.
  for (const double radius : {3.0, 30.0}) {
    const std::string circle = fmt::format(" 0 CIRCLE 8 COLUMN 10 50 20 40 40 {}", radius);
    const std::string bulges = fmt::format(
        " 0 LWPOLYLINE 8 COLUMN 70 1 10 {} 20 40 42 1 10 {} 20 40 42 1", 50 + radius, 50 - radius);
    const std::string ellipse =
        fmt::format(" 0 ELLIPSE 8 COLUMN 10 50 20 40 11 {} 21 0 40 1", radius);
    for (const std::string& text : {circle, bulges, ellipse}) {
      const ImportedPlan plan = read(dxf(text));
      ASSERT_EQ(plan.obstacles.size(), 1u) << text;
      const Polygon::Ring& ring = plan.obstacles[0].polygon.outline;
      expect_circle(ring, {50, 40}, radius);
      EXPECT_LT(ring.size(), 200u);
      EXPECT_NEAR(area_m2(plan.obstacles[0].polygon), std::numbers::pi * radius * radius,
                  0.02 * std::numbers::pi * radius);
    }
  }
  // A quarter from 0 to 90 degrees, in mm: the error is 1 cm there as well.
  const ImportedPlan arc = read(dxf(" 0 ARC 8 WALL 10 0 20 0 40 5000 50 0 51 90", "", "", "4"));
  ASSERT_EQ(arc.walls.size(), 1u);
  EXPECT_LT(arc.walls[0].line_m.size(), 20u);
  EXPECT_NEAR((arc.walls[0].line_m.front() - Eigen::Vector2d(5, 0)).norm(), 0, 1e-9);
  EXPECT_NEAR((arc.walls[0].line_m.back() - Eigen::Vector2d(0, 5)).norm(), 0, 1e-9);
}

TEST_F(Dxf, NegativeBulgesTurnClockwise) {
  const ImportedPlan plan =
      read(dxf(" 0 LWPOLYLINE 8 WALL 70 0 10 0 20 0 42 -0.41421356 10 4 20 0"));
  // An arc of 90 degrees to the left of the chord's direction.
  EXPECT_NEAR(plan_bounds(plan)->max_m.y(), 2 * (std::sqrt(2.0) - 1), 0.01);
  EXPECT_NEAR(plan_bounds(plan)->min_m.y(), 0, 1e-9);
}

TEST_F(Dxf, OldPolylinesHaveVertices) {
  const ImportedPlan plan = read(
      dxf(" 0 POLYLINE 8 FLOOR 66 1 70 1 0 VERTEX 8 FLOOR 10 0 20 0 0 VERTEX 8 FLOOR 10 6 20 0 "
          "0 VERTEX 8 FLOOR 10 6 20 4 0 SEQEND 8 FLOOR"));
  ASSERT_EQ(plan.walkable.size(), 1u);
  EXPECT_NEAR(area_m2(plan.walkable[0]), 12, 1e-9);
  EXPECT_THAT(refusal(dxf(" 0 POLYLINE 8 FLOOR 70 1 0 VERTEX 10 0 20 0" + line("A", 0, 0, 1, 1))),
              HasSubstr("SEQEND"));
}

TEST_F(Dxf, BlocksAreInsertedWhereTheyStand) {
  const std::string column =
      " 0 BLOCK 8 0 2 COLUMN 10 1 20 0" + rectangle("0", 0, 0, 2, 1) +
      " 0 ENDBLK 0 BLOCK 8 0 2 PAIR 10 0 20 0 0 INSERT 8 0 2 column 10 0 20 0 "
      "0 INSERT 8 0 2 COLUMN 10 5 20 0 0 ENDBLK";
  // Entities on layer 0 take the layer of the INSERT; base point, scale, rotation, then position.
  const ImportedPlan plan =
      read(dxf(" 0 INSERT 8 COLUMNS 2 PAIR 10 10 20 20 50 90 41 2 42 2", "", column));
  ASSERT_EQ(plan.obstacles.size(), 2u);
  const Rectangle bounds = *plan_bounds(plan);
  EXPECT_NEAR(bounds.min_m.x(), 8, 1e-4);
  EXPECT_NEAR(bounds.max_m.x(), 10, 1e-4);
  EXPECT_NEAR(bounds.min_m.y(), 18, 1e-4);
  EXPECT_NEAR(bounds.max_m.y(), 32, 1e-4);
}

TEST_F(Dxf, BlocksOfThemselvesAreLeftOut) {
  const std::string blocks = " 0 BLOCK 2 LOOP 10 0 20 0 0 INSERT 8 WALL 2 LOOP 10 1 20 0" +
                             line("WALL", 0, 0, 1, 1) + " 0 ENDBLK";
  EXPECT_THAT(read(dxf(" 0 INSERT 8 WALL 2 LOOP 10 0 20 0", "", blocks)).left_out,
              ElementsAre("1 INSERT deeper than 16 blocks"));
  const std::string doubling =
      " 0 BLOCK 2 LOOP 0 INSERT 2 LOOP 0 INSERT 2 LOOP 0 INSERT 2 LOOP 0 "
      "INSERT 2 LOOP 0 INSERT 2 LOOP 0 ENDBLK";
  EXPECT_THAT(refusal(dxf(" 0 INSERT 8 WALL 2 LOOP 10 0 20 0", "", doubling)),
              HasSubstr("entities, blocks expanded"));
  EXPECT_THAT(read(dxf(" 0 INSERT 8 WALL 2 NONE" + line("WALL", 0, 0, 1, 1))).left_out,
              ElementsAre("1 INSERT of a block that the file lacks"));
}

TEST_F(Dxf, HiddenLayersAndThePaperAreLeftOut) {
  const std::string tables = " 0 LAYER 2 WALL-OLD 70 1 62 7 0 LAYER 2 WALL-OFF 70 0 62 -3";
  const ImportedPlan plan =
      read(dxf(line("WALL", 0, 0, 5, 0) + line("WALL-OLD", 0, 1, 5, 1) +
                   line("wall-off", 0, 2, 5, 2) + line("WALL", 0, 3, 5, 3) + " 67 1",
               tables));
  EXPECT_EQ(plan.walls.size(), 1u);
  EXPECT_THAT(plan.left_out, ElementsAre("layer 'WALL-OFF': 1 hidden entity (layer that is off)",
                                         "layer 'WALL-OLD': 1 hidden entity (frozen layer)",
                                         "1 entity of the paper space"));
  EXPECT_EQ(
      read(dxf(line("WALL-OLD", 0, 1, 5, 1), tables), {}, {{"walls", {"WALL-OLD"}}}).walls.size(),
      1u)
      << "a chosen layer is used";
}

TEST_F(Dxf, CountsWhatIsLeftOutInWords) {
  const std::string paper = line("WALL", 0, 3, 5, 3) + " 67 1";
  const std::string slanted = " 0 CIRCLE 8 WALL 10 0 20 0 40 1 210 1 220 0 230 0";
  const std::string missing = " 0 INSERT 8 WALL 2 NONE";
  EXPECT_THAT(
      read(dxf(line("WALL", 0, 0, 5, 0) + paper + slanted + missing)).left_out,
      ElementsAre("1 CIRCLE that is not horizontal", "1 INSERT of a block that the file lacks",
                  "1 entity of the paper space"));
  EXPECT_THAT(
      read(dxf(line("WALL", 0, 0, 5, 0) + paper + paper + slanted + slanted + missing + missing))
          .left_out,
      ElementsAre("2 CIRCLEs that are not horizontal", "2 INSERTs of blocks that the file lacks",
                  "2 entities of the paper space"));
}

TEST_F(Dxf, EntitiesDrawnFromBelowAreMirrored) {
  const ImportedPlan plan =
      read(dxf(" 0 ARC 8 WALL 10 -3 20 0 40 1 50 0 51 90 210 0 220 0 230 -1"));
  EXPECT_NEAR(plan_bounds(plan)->min_m.x(), 2, 1e-9);
  EXPECT_NEAR(plan_bounds(plan)->max_m.x(), 3, 1e-9);
  EXPECT_THAT(
      read(dxf(" 0 CIRCLE 8 WALL 10 0 20 0 40 1 210 1 220 0 230 0" + line("WALL", 0, 0, 5, 0)))
          .left_out,
      ElementsAre("1 CIRCLE that is not horizontal"));
}

TEST_F(Dxf, RejectsOtherForms) {
  EXPECT_THAT(refusal("AutoCAD Binary DXF\r\n\x1a"), HasSubstr("save it as ASCII DXF"));
  EXPECT_THAT(refusal("AC1032" + std::string(20, '\0')), HasSubstr("a DWG drawing; save it"));
  const std::string whole = dxf(line("WALL", 0, 0, 5, 0));
  EXPECT_THAT(refusal(whole.substr(0, whole.size() - 20)), HasSubstr("cut short"));
  EXPECT_THAT(refusal(dxf(" 0 LINE 8 WALL 10 0 20 0 11 far 21 0")), HasSubstr("found 'far'"));
  EXPECT_THAT(refusal(dxf(" 0 LINE 8 WALL 10 0 20 0 11 5")),
              HasSubstr("the group code 21 in 'LINE'"));
  EXPECT_THAT(refusal(dxf(" 0 LINE 8 WALL ten 0")), HasSubstr("a group code of DXF"));
  EXPECT_THAT(refusal(dxf(" 0 LINE 8 WALL 10 0 20 0 11 1e13 21 0")), HasSubstr("within 1e12"));
}

TEST_F(Dxf, NamesMayHaveCodePages) {
  const ImportedPlan plan = read(dxf(rectangle("COLUMN-S\xdc"
                                               "D",
                                               0, 0, 1, 1) +
                                     line("WALL-S\\U+00DCD", 0, 0, 5, 0)));
  EXPECT_EQ(plan.obstacles.at(0).name,
            "COLUMN-S\xc3\x9c"
            "D");
  EXPECT_EQ(plan.walls.at(0).name,
            "WALL-S\xc3\x9c"
            "D");
}

// ---- all kinds

TEST_F(Import, FarPlansMoveToTheOrigin) {
  const ImportedPlan plan =
      read("POLYGON ((500000 5600000, 500010 5600000, 500010 5600006, 500000 5600006))", 1);
  EXPECT_EQ(plan.shift_m, Eigen::Vector2d(500000, 5600000));
  EXPECT_EQ(plan.walkable[0].outline[2], Eigen::Vector2d(10, 6));
  EXPECT_THAT(scene_text_of(plan, "plan"),
              HasSubstr("# Coordinates are those of the plan minus [500000, 5600000] m."));
  EXPECT_EQ(read("POLYGON ((80000 0, 80010 0, 80010 6))", 1).shift_m, Eigen::Vector2d(0, 0));
}

TEST_F(Import, RepeatedCornersAreRemoved) {
  const ImportedPlan plan = read(
      "POLYGON ((0 0, 5 0, 5.00001 0, 5 0, 5 5, 0 5, 0.00002 0), (1 1, 1 1.00001, 1.00001 1))\n"
      "POLYGON ((9 9, 9 9.00001, 9.00001 9))",
      1);
  ASSERT_EQ(plan.walkable.size(), 1u);
  EXPECT_EQ(plan.walkable[0].outline.size(), 4u);
  EXPECT_TRUE(plan.walkable[0].holes.empty());
  EXPECT_THAT(plan.left_out, ElementsAre("1 area without extent"));
}

TEST_F(Import, AreasDoNotCrossThemselves) {
  EXPECT_THAT(refusal("POLYGON ((0 0, 400 0, 0 400, 400 400))", 0.01),
              testing::MatchesRegex("plan: expected .* in walkable areas, found .*2.*2.* "
                                    "\\(metres\\); correct the plan there"));
  EXPECT_THAT(refusal(dxf(" 0 LWPOLYLINE 8 COLUMN 70 1 10 0 20 0 10 4 20 0 10 0 20 4 10 4 20 4")),
              HasSubstr("in the area 'COLUMN'"));
}

TEST_F(Import, LimitsVerticesAndSize) {
  std::string text = "POLYGON ((";
  for (int i = 0; i <= 100'000; ++i) text += fmt::format("{}{} {}", i > 0 ? ", " : "", i, i % 2);
  EXPECT_THAT(refusal(text + "))", 1), HasSubstr("at most 100000 vertices"));
  EXPECT_THAT(refusal("POLYGON ((0 0, 30000 0, 30000 1))", 1), HasSubstr("0.5 m to 20 km"));
}

TEST_F(Import, RejectsOtherFiles) {
  EXPECT_THAT(refusal(""), HasSubstr("found an empty file"));
  EXPECT_THAT(refusal("ISO-10303-21;\n"), HasSubstr("IFC"));
  EXPECT_THAT(refusal("People walk.\n"), HasSubstr("found 'People walk.'"));
  EXPECT_THAT([&] { import_plan({.file = folder_ / "none", .layers = {}, .unit_m = {}}); },
              testing::ThrowsMessage<InputError>(HasSubstr("expected a floor plan")));
}

TEST_F(Import, StartsAndGoalsEndAtTheWalkableAreas) {
  const ImportedPlan plan =
      read(dxf(rectangle("FLOOR", 0, 0, 20, 10) + rectangle("START", -5, 1, 3, 3) +
               rectangle("EXIT_A", 19, 4, 22, 12) + rectangle("EXIT_B", 30, 0, 32, 2) +
               rectangle("COLUMN_A", 25, 0, 26, 1) + rectangle("COLUMN_B", 19, 0, 26, 1) +
               line("WALL", 0, 0, 20, 0) + line("WALL_B", 0, -1, 20, -1)));
  ASSERT_EQ(plan.starts.size(), 1u);
  EXPECT_NEAR(area_m2(plan.starts[0].polygon), 6, 1e-9);
  ASSERT_EQ(plan.goals.size(), 1u);
  EXPECT_NEAR(area_m2(plan.goals[0].polygon), 6, 1e-9);
  EXPECT_EQ(plan.obstacles.size(), 1u);
  EXPECT_EQ(plan.walls.size(), 1u);
  EXPECT_THAT(plan.left_out, ElementsAre("2 obstacles and walls outside the walkable areas",
                                         "the goal 'EXIT_B' outside the walkable areas",
                                         "parts outside the walkable areas of 2 starts and goals"));
}

// ---- scenes

using SceneText = Import;

ImportedPlan station() {
  ImportedPlan plan;
  plan.kind = "DXF drawing";
  plan.walkable = {{{{0, 0}, {20, 0}, {20, 10}, {0, 12}}, {}}};
  plan.obstacles = {{"column", {{{5, 5}, {6, 5}, {6, 6.25}}, {}}},
                    {"column", {{{8, 5}, {9, 5}, {9, 6}}, {}}},
                    {"on \"the\" left", {{{3, 5}, {4, 5}, {4, 6}}, {}}}};
  plan.walls = {{"wall 1", {{10, 0}, {10, 4.123456}}, 0}};
  plan.starts = {{"west", {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {}}}};
  plan.goals = {{"a", {{{18, 0}, {20, 0}, {20, 2}, {18, 2}}, {}}},
                {"b", {{{18, 7}, {20, 7}, {20, 9}}, {}}}};
  return plan;
}

TEST_F(SceneText, HasTheFormOfSceneFiles) {
  EXPECT_EQ(scene_text_of(station(), "station.dxf"),
            R"(# Floor plan of station.dxf (DXF drawing), imported by Throng.
duration_s: 60

ground: {polygon: [[0, 0], [20, 0], [20, 10], [0, 12]], wall_height_m: 2.5}

groups:
  - name: west
    count: 4
    spawn: {min_m: [0, 0], max_m: [4, 4]}
    goals:
      - any_of:
          - {min_m: [18, 0], max_m: [20, 2]}
          - {polygon: [[18, 7], [20, 7], [20, 9]]}
    on_arrival: leave

obstacles:
  - {name: column, kind: polygon, polygon: [[5, 5], [6, 5], [6, 6.25]], top_m: 2.5}
  - {name: column-2, kind: polygon, polygon: [[8, 5], [9, 5], [9, 6]], top_m: 2.5}
  - {name: "on \"the\" left", kind: polygon, polygon: [[3, 5], [4, 5], [4, 6]], top_m: 2.5}
  - {name: wall-1, kind: wall, line: [[10, 0], [10, 4.1235]], thickness_m: 0.1, top_m: 2.5}
)");
}

TEST_F(SceneText, WrapsLinesThatYamlReadsBack) {
  ImportedPlan plan = station();
  for (int i = 0; i < 200; ++i) plan.walkable[0].outline.emplace_back(-i * 0.1234 - 1, 12);
  plan.walkable.push_back({{{50, 0}, {60, 0}, {60, 9}}, {{{55, 1}, {56, 1}, {56, 2}}}});
  for (const size_t areas : {2u, 1u}) {
    plan.walkable.resize(areas);
    const std::string text = scene_text_of(plan, "station.dxf");
    size_t longest = 0;
    for (const std::string& line : split_text(text, '\n')) longest = std::max(longest, line.size());
    EXPECT_LE(longest, 100u);
    const YamlNode root = parse_yaml(text, "scene");
    for (const YamlEntry& entry : root.entries)
      if (entry.key == "ground") {
        const YamlNode& ground = entry.value.entries.at(0).value;
        if (areas == 1)
          EXPECT_EQ(ground.items.size(), plan.walkable[0].outline.size());
        else
          EXPECT_EQ(ground.scalar, ground_wkt_of(plan));
      }
  }
}

TEST_F(SceneText, GroundWithoutAreasSurroundsThePlan) {
  ImportedPlan plan = station();
  plan.walkable.clear();
  plan.starts.clear();
  const std::string text = scene_text_of(plan, "station.dxf");
  EXPECT_THAT(text, HasSubstr("ground: {min_m: [2, -1], max_m: [21, 10]}\n"));
  EXPECT_THAT(text, HasSubstr("# The plan has no starts; the area of the plan stands for them.\n"));
  EXPECT_THAT(text, HasSubstr("spawn: {min_m: [3, 0], max_m: [20, 9]}"));
}

TEST_F(SceneText, LargePlansKeepTheirGroundInAFile) {
  EXPECT_THAT(scene_text_of(station(), "station.dxf", "station.wkt"),
              HasSubstr("ground: {file: station.wkt, wall_height_m: 2.5}"));
  EXPECT_EQ(ground_wkt_of(station()), "MULTIPOLYGON (((0 0, 20 0, 20 10, 0 12, 0 0)))");
}

TEST_F(SceneText, LoadsAsAScene) {
  const ImportedPlan plan = read(
      dxf(rectangle("FLOOR", 0, 0, 20, 10) + rectangle("FLOOR", 15, 5, 30, 12) +
          rectangle("COLUMNS", 5, 5, 5.5, 5.5) + " 0 CIRCLE 8 COLUMNS 10 9 20 5 40 0.4" +
          line("WALLS", 12, 0, 12, 4) + line("WALLS", 12, 4, 15, 4) + line("WALLS", 0, 0, 0, 9) +
          rectangle("START", -1, 1, 5, 3) + rectangle("EXIT", 28, 9, 31, 13)));
  const Scene scene = load(scene_text_of(plan, "plan.dxf"));
  ASSERT_EQ(scene.groups.size(), 1u);
  EXPECT_EQ(scene.groups[0].name, "START");
  EXPECT_EQ(scene.groups[0].count, 3);
  EXPECT_FALSE(scene.floor.empty());
  const ImportedPlan walls = read(dxf(line("WALLS", 0, 0, 9, 0) + rectangle("WALLS", 0, 3, 9, 9)));
  EXPECT_EQ(load(scene_text_of(walls, "plan.dxf")).groups.size(), 1u);
  EXPECT_EQ(load(scene_text_of(read(kRoom, 1), "room.wkt")).groups.size(), 1u);
  write("s.wkt", ground_wkt_of(plan));
  EXPECT_EQ(load(scene_text_of(plan, "plan.dxf", "s.wkt")).groups.size(), 1u);
}

TEST_F(SceneText, JoinsTouchingRoomsBeforeItChoosesTheLargest) {
  // A hall of 150 m2 apart, and ten rooms of 16 m2 that share edges.
  std::string text = "GEOMETRYCOLLECTION (POLYGON ((50 0, 65 0, 65 10, 50 10))";
  for (int i = 0; i < 10; ++i)
    text += fmt::format(", POLYGON (({0} {1}, {2} {1}, {2} {3}, {0} {3}))", 4 * (i % 5),
                        4 * (i / 5), 4 * (i % 5) + 4, 4 * (i / 5) + 4);
  const Scene scene = load(scene_text_of(read(text + ")", 1), "rooms.wkt"));
  ASSERT_EQ(scene.groups.size(), 1u);
  EXPECT_EQ(scene.groups[0].count, 40);
  EXPECT_NEAR(scene.groups[0].spawn.area_m2(), 160, 1e-6);
  EXPECT_EQ(scene.groups[0].spawn.bounds(), (Rectangle{{0, 0}, {20, 8}}));
  EXPECT_EQ(scene.groups[0].goals.at(0).areas.at(0), scene.groups[0].spawn);
}

TEST_F(SceneText, StartsInTheRectangleAroundALongOutline) {
  std::string text = "POLYGON ((0 0, 300 0";
  for (int i = 0; i <= 12'000; ++i) text += fmt::format(", {} {}", 300 - i * 0.025, 50 + i % 2);
  const Scene scene = load(scene_text_of(read(text + "))", 1), "long.wkt"));
  EXPECT_TRUE(scene.groups.at(0).spawn.is_rectangle());
  EXPECT_EQ(scene.groups[0].spawn.bounds(), (Rectangle{{0, 0}, {300, 51}}));
}

// ---- damaged files

struct DamagedKind {
  std::string name;
  std::string text;
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
void PrintTo(const DamagedKind& kind, std::ostream* out) { *out << kind.name; }

class DamagedPlan : public Import, public testing::WithParamInterface<DamagedKind> {};

/// A few edits: numbers become extreme, bytes change, pieces are cut or repeated.
std::string damaged(std::string text, uint64_t seed, uint64_t number) {
  const RandomKey key{seed, number, 0, Purpose::kStyle};
  uint32_t draw = 0;
  const auto below = [&](size_t limit) {
    return static_cast<size_t>(random_bits(key, draw++) % std::max<size_t>(limit, 1));
  };
  constexpr std::string_view kWords[] = {"0",   "-1",    "1e39", "-1e308",     "nan",    "inf",
                                         "1e9", "65536", "",     "4294967296", "1e-320", "EMPTY"};
  for (size_t edits = 1 + below(3); edits > 0 && !text.empty(); --edits) {
    const size_t at = below(text.size());
    const size_t length = below(std::min<size_t>(text.size() - at, 200));
    switch (below(12)) {
      default: {
        const size_t from = std::min(text.find_first_of("0123456789", at), text.size());
        const size_t to = std::min(text.find_first_not_of("0123456789.-e", from), text.size());
        text.replace(from, to - from, kWords[below(std::size(kWords))]);
        break;
      }
      case 1:
        text[at] = static_cast<char>(below(256));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(below(text.size()), text.substr(at, length));
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.insert(at, std::string(1 + below(2000), "([{0 \n"[below(6)]));
        break;
      case 6:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
    }
  }
  return text;
}

TEST_P(DamagedPlan, IsReadOrRejectedInOneLine) {
  using Clock = std::chrono::steady_clock;
  constexpr int kNightlyFiles = 2000, kFiles = 100;
  constexpr double kMaxSeconds = 10;
  constexpr uint64_t kSeed = 1;
  const int files = test::is_nightly() ? kNightlyFiles : kFiles;
  int accepted = 0;
  for (int i = 0; i < files; ++i) {
    SCOPED_TRACE(testing::Message() << GetParam().name << ", seed " << kSeed << ", file " << i);
    const std::string text = damaged(GetParam().text, kSeed, static_cast<uint64_t>(i));
    const Clock::time_point begin = Clock::now();
    try {
      const ImportedPlan plan = read(text, i % 8 == 0 ? std::nullopt : std::optional(1.0));
      EXPECT_NO_THROW(parse_yaml(scene_text_of(plan, "plan"), "scene"));
      ++accepted;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, HasSubstr("expected "));
      EXPECT_THAT(message, HasSubstr(", found "));
      EXPECT_THAT(message, Not(HasSubstr("\n")));
    }
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), kMaxSeconds);
  }
  std::printf("[ damaged ] %s: seed %d, %d files, %d accepted\n", GetParam().name.c_str(),
              static_cast<int>(kSeed), files, accepted);
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, files);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, DamagedPlan,
    testing::Values(
        DamagedKind{"Wkt",
                    kRoom + "MULTIPOLYGON (((20 0, 30 0, 30 9)), ((20 10, 30 10, 30 19)))\n"},
        DamagedKind{"GeoJson", collection(feature(R"({"layer": "floor"})", square(0, 0, 20)) + "," +
                                          feature(R"({"name": "kiosk"})", kLine) + "," +
                                          feature(R"({"type": "exit"})", square(3, 3, 1)))},
        DamagedKind{"Dxf",
                    dxf(rectangle("FLOOR", 0, 0, 20, 10) + line("WALL", 3, 0, 3, 5) +
                            line("WALL", 3, 5, 6, 5) + " 0 CIRCLE 8 COLUMN 10 9 20 4 40 1" +
                            " 0 INSERT 8 COLUMN 2 PILLAR 10 14 20 4 50 30" +
                            " 0 ARC 8 WALL 10 9 20 4 40 2 50 10 51 80",
                        " 0 LAYER 2 WALL 70 0 62 7",
                        " 0 BLOCK 2 PILLAR 10 0 20 0" + rectangle("0", 0, 0, 1, 1) + " 0 ENDBLK")}),
    [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace throng::import_test
