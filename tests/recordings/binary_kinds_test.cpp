// SQLite and HDF5 recordings, parsed in a child process.
#include <gmock/gmock.h>

#include <numbers>

#include "analysis/trajectories/trajectory_sink.h"
#include "geometry/wkt.h"
#include "tests/recordings/binary_files.h"
#include "tests/recordings/recording_folder.h"

namespace throng::binary_kinds_test {
namespace {

using testing::HasSubstr;

class BinaryKinds : public RecordingTest {
 protected:
  std::shared_ptr<const Recording> read_sqlite(const std::string& sql) const {
    make_sqlite(path("a.sqlite"), sql);
    return read_recording({.file = path("a.sqlite")});
  }
  std::shared_ptr<const Recording> read_hdf5(const Hdf5Plan& plan) const {
    make_hdf5(path("a.h5"), plan);
    return read_recording({.file = path("a.h5")});
  }
};

TEST_F(BinaryKinds, ReadJupedsimOrientationsAndArea) {
  const auto recording = read_sqlite(jupedsim_2());
  const RecordingFacts& facts = recording->facts();
  EXPECT_EQ(facts.kind, "JuPedSim SQLite 2");
  EXPECT_EQ(facts.tracked_point, TrackedPoint::kCentre);
  EXPECT_EQ(facts.fps, 25);
  EXPECT_EQ(facts.frames, 3);
  EXPECT_TRUE(facts.has_headings);
  EXPECT_EQ(facts.wkt, "POLYGON ((-2 -2, 8 -2, 8 8, -2 8))");
  EXPECT_TRUE(facts.anomalies.empty());
  const std::vector<Sample> one = track(*recording, 0);
  ASSERT_EQ(one.size(), 3u);
  EXPECT_TRUE(std::isnan(one[0].heading_rad)) << "no direction is none";
  EXPECT_FLOAT_EQ(one[1].heading_rad, std::numbers::pi_v<float> / 2);
}

TEST_F(BinaryKinds, AcceptMissingColumnsOfOtherVersions) {
  const std::string data =
      "CREATE TABLE metadata(key TEXT, value TEXT);"
      "CREATE TABLE trajectory_data(frame INTEGER, id INTEGER, pos_x REAL, pos_y REAL);"
      "INSERT INTO trajectory_data VALUES(0, 1, 0, 0), (1, 1, 0.05, 0);"
      "CREATE TABLE geometry(wkt TEXT);";
  const auto third =
      read_sqlite(data + "INSERT INTO metadata VALUES('fps', '10'), ('version', 3);");
  EXPECT_EQ(third->facts().fps, 10);
  EXPECT_FALSE(third->facts().has_headings);
  const auto first =
      read_sqlite(data +
                  "INSERT INTO metadata VALUES('fps', 10.0), ('version', '1');"
                  "INSERT INTO geometry VALUES('MULTIPOLYGON (((0 0, 9 0, 9 9, 0 9, 0 0)))');");
  EXPECT_THAT(first->facts().wkt, HasSubstr("MULTIPOLYGON"));
}

TEST_F(BinaryKinds, ReadHeadingsOfThrong) {
  const auto writer = open_sqlite_trajectory(path("own.sqlite"));
  TrajectoryHead head;
  head.fps = 20;
  head.wkt = "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0))";
  head.people = {"anna", "bert"};
  writer->begin(head);
  for (int64_t frame = 0; frame < 30; ++frame) {
    std::vector<TrajectoryRow> rows(2);
    for (uint32_t id = 0; id < 2; ++id) {
      rows[id].id = id;
      rows[id].x_m = 1 + 0.05 * static_cast<double>(frame);
      rows[id].y_m = id + 1.0;
      rows[id].heading_rad = 0.25 * (id + 1);
    }
    writer->frame(frame, rows);
  }
  writer->end();
  const auto recording = read_recording({.file = path("own.sqlite"), .strict = true});
  EXPECT_EQ(recording->facts().fps, 20);
  EXPECT_EQ(recording->facts().samples, 60);
  EXPECT_EQ(track(*recording, 1)[29].heading_rad, 0.5f);
}

TEST_F(BinaryKinds, CountPositionsOutsideTheArea) {
  const auto recording = read_sqlite(
      jupedsim_2() + "INSERT INTO trajectory_data VALUES(2, 5, 8.4, 1, 1, 0), (0, 9, 9, 9, 0, 0);");
  std::vector<std::string> anomalies;
  for (const Anomaly& anomaly : recording->facts().anomalies)
    if (anomaly.what.find("outside") != std::string::npos)
      anomalies.push_back(fmt::format("{}: {}", anomaly.count, anomaly.first));
  EXPECT_THAT(anomalies, testing::ElementsAre("2: id 5 at frame 2: (8.400, 1.000) m"));
}

TEST_F(BinaryKinds, RejectOpenDatabases) {
  make_sqlite(path("a.sqlite"), jupedsim_2());
  write("a.sqlite-wal", "something");
  EXPECT_THAT([&] { read_recording({.file = path("a.sqlite")}); },
              testing::ThrowsMessage<InputError>(HasSubstr("found the file a.sqlite-wal")));
}

TEST_F(BinaryKinds, ReadHeadsOfArchiveHdf5) {
  const auto recording = read_hdf5({.wkt = "POLYGON ((-1 -1, 5 -1, 5 5, -1 5))"});
  const RecordingFacts& facts = recording->facts();
  EXPECT_EQ(facts.kind, "archive HDF5");
  EXPECT_EQ(facts.tracked_point, TrackedPoint::kHead);
  EXPECT_EQ(facts.fps, 25);
  EXPECT_EQ(facts.first_frame, 10);
  EXPECT_THAT(facts.wkt, HasSubstr("POLYGON"));
  ASSERT_EQ(recording->people().size(), 2u);
  EXPECT_NEAR(*recording->people()[0].height_m, 1.75, 0.011);
  EXPECT_EQ(track(*recording, 0)[1].position_m.x(), 0.05);
  const auto flat = read_hdf5({.has_z = false});
  EXPECT_FALSE(flat->people()[0].height_m);
}

TEST_F(BinaryKinds, KeepTheOrderOfManyRows) {
  Hdf5Plan plan;
  plan.rows.clear();
  for (int32_t frame = 0; frame < 4000; ++frame)
    for (int32_t id = 0; id < 7; ++id)
      plan.rows.push_back({id, frame, 0.01 * frame, 1.0 * id, 1.6 + 0.01 * id});
  const auto recording = read_hdf5(plan);
  EXPECT_EQ(recording->facts().samples, 28'000);
  EXPECT_EQ(track(*recording, 6)[3999].position_m.x(), 0.01 * 3999);
  EXPECT_TRUE(recording->facts().anomalies.empty());
}

// Even-odd rule over all edges, polygon by polygon.
bool lies_in(const std::vector<Polygon>& polygons, const Eigen::Vector2d& p) {
  for (const Polygon& polygon : polygons) {
    bool is_inside = false;
    const auto cross = [&](const Polygon::Ring& ring) {
      for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
        if ((ring[i].y() > p.y()) != (ring[j].y() > p.y()) &&
            p.x() <
                (ring[j].x() - ring[i].x()) * (p.y() - ring[i].y()) / (ring[j].y() - ring[i].y()) +
                    ring[i].x())
          is_inside = !is_inside;
    };
    cross(polygon.outline);
    for (const auto& hole : polygon.holes) cross(hole);
    if (is_inside) return true;
  }
  return false;
}

TEST(WalkableWkt, ContainsThePointsOfItsPolygons) {
  std::string circle;
  for (int i = 0; i < 200; ++i)
    circle += fmt::format("{}{} {}", i > 0 ? ", " : "", 3 * std::cos(i * 0.0314159),
                          3 * std::sin(i * 0.0314159));
  const std::vector<Polygon> polygons = parse_wkt(
      "GEOMETRYCOLLECTION(polygon (( -5 -5, 5 -5, 5 5, -5 5 ),(" + circle +
          ")), MULTIPOLYGON Z (((1 1 0, 7 1 0, 7 2 0, 1 1 0)), ((2 -8 0, 4 -8 0, 3 8 0))), "
          "POLYGON EMPTY)",
      "a.wkt");
  ASSERT_EQ(polygons.size(), 3u);
  const PolygonLocator area(polygons);
  int inside = 0;
  for (int i = 0; i < 40'000; ++i) {
    const int column = i % 200, row = i / 200;
    const Eigen::Vector2d p(-9 + 0.09013 * column, -9 + 0.09017 * row);
    inside += area.contains(p);
    // Both answers are valid on an edge.
    if (area.contains(p) != lies_in(polygons, p)) {
      EXPECT_TRUE(area.contains(p)) << p.transpose();
      EXPECT_TRUE(lies_in(polygons, p + Eigen::Vector2d(2e-3, 1e-3)) ||
                  lies_in(polygons, p - Eigen::Vector2d(2e-3, 1e-3)) ||
                  lies_in(polygons, p + Eigen::Vector2d(-2e-3, 1e-3)) ||
                  lies_in(polygons, p + Eigen::Vector2d(2e-3, -1e-3)));
    }
  }
  EXPECT_GT(inside, 9'000);
  EXPECT_TRUE(area.contains({-5, 0})) << "on the edge";
}

TEST(WalkableWkt, RejectsInvalidText) {
  for (const char* wkt : {"", "LINESTRING (0 0, 1 1)", "POLYGON ((0 0, 1 1))", "POLYGON ((0 0, 1 0",
                          "POLYGON ((0 0, 1 0, nan 1))", "POLYGON ((0 0, 1 0, 1 1)) x",
                          "POLYGON EMPTY", "POLYGON ((0 0, 1e99 0, 1 1))", "POLYGON ()"})
    EXPECT_THAT([&] { parse_wkt(wkt, "a.wkt"); },
                testing::ThrowsMessage<InputError>(HasSubstr("a.wkt: expected")))
        << wkt;
  std::string deep = "POLYGON ((0 0, 1 0, 1 1))";
  for (int i = 0; i < 100; ++i) deep = fmt::format("GEOMETRYCOLLECTION({})", deep);
  EXPECT_THROW(parse_wkt(deep, "a.wkt"), InputError);
}

TEST(WalkableWkt, NamesUnsupportedGeometries) {
  const std::string expected =
      "a.wkt: expected only POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION in the walkable area "
      "(WKT), found ";
  const auto rejection = [](const std::string& wkt) -> std::string {
    try {
      parse_wkt(wkt, "a.wkt");
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  for (const char* kind : {"LINESTRING", "POINT", "MULTIPOINT", "MULTILINESTRING", "CURVEPOLYGON"})
    for (const char* rest : {" (0 0, 1 1)", " Z (0 0 1)", " EMPTY"}) {
      const std::string geometry = std::string(kind) + rest;
      EXPECT_EQ(rejection(geometry), expected + kind + "; state the area as polygons");
      for (const std::string& members : {geometry, "POLYGON ((0 0, 1 0, 1 1)), " + geometry,
                                         geometry + ", POLYGON ((0 0, 1 0, 1 1))"})
        EXPECT_EQ(rejection("GEOMETRYCOLLECTION (" + members + ")"),
                  expected + kind + "; leave it out of the collection");
    }
  EXPECT_EQ(rejection("linestring(0 0, 1 1)"), expected + "LINESTRING; state the area as polygons");
}

}  // namespace
}  // namespace throng::binary_kinds_test
