// Missing positions are gaps in tracks, counted and reported, in every kind of file.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/recordings/binary_files.h"
#include "tests/recordings/recording_folder.h"

namespace throng::gaps_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Gaps : public RecordingTest {
 protected:
  void expect_gap(const Recording& recording, int64_t count, const std::string& first) const {
    for (const Anomaly& anomaly : recording.facts().anomalies)
      if (anomaly.what == "missing positions (gaps in tracks)") {
        EXPECT_EQ(anomaly.count, count);
        EXPECT_EQ(anomaly.first, first);
        return;
      }
    FAIL() << "no gaps are reported";
  }
};

constexpr const char* kMissing[] = {
    "nan",  "NaN",  "NAN",     "-nan",      "NA",        "n/a",       "null",
    "?",    "none", "<NA>",    "<na>",      "N/A",       "None",      "NULL",
    ".",    "-",    "1.#QNAN", "-1.#IND",   "1.#qnan",   "-1.#IND00", "1.#QNAN0",
    "#N/A", "#n/a", "#NUM!",   "-nan(ind)", "nan(snan)", "NaT"};

TEST_F(Gaps, AreCounted) {
  for (const std::string missing : kMissing) {
    SCOPED_TRACE(missing);
    const auto archive = read("# framerate: 25\n# id frame x/m y/m z/m\n1 0 " + missing +
                              " 3 1.7\n1 1 2 3 1.7\n1 2 2 " + missing + " 1.7\n1 3 2 3 " + missing +
                              "\n2 3 " + missing + " " + missing + " 1\n");
    EXPECT_EQ(archive->facts().samples, 2);
    EXPECT_EQ(archive->people().size(), 1u);
    EXPECT_EQ(archive->facts().first_frame, 1) << "where the first position is";
    expect_gap(*archive, 3, "id 1 at frame 0");
    const auto table = read("id,t,x,y,z,heading\n1,0.5,2,3,1,0\n1,1," + missing +
                            ",3,1,0\n1,1.5,2,3," + missing + "," + missing + "\n");
    EXPECT_EQ(table->facts().samples, 2);
    EXPECT_EQ(table->facts().fps, 1);
    EXPECT_TRUE(std::isnan(track(*table, 0)[1].heading_rad));
    expect_gap(*table, 1, "id 1 at 1 s");
    const auto trajnet = read("780 1 2 3\n790 1 2.1 3\n800 1 2.2 3\n810 1 " + missing + " " +
                              missing + "\n780 2 0 0\n790 2 0 0.1\n800 2 ? ?\n810 2 ? ?\n");
    EXPECT_EQ(trajnet->facts().kind, "ETH/UCY text");
    EXPECT_EQ(trajnet->facts().fps, 2.5);
    EXPECT_EQ(trajnet->facts().samples, 5);
    expect_gap(*trajnet, 3, "id 1 at frame 810");
    const auto steps = read("pedestrianId simTime endTime startX startY endX endY\n1 0.5 1 0 0 " +
                            missing + " 0\n1 1 1.5 0.5 0 1 0\n");
    EXPECT_EQ(steps->facts().samples, 3);
    expect_gap(*steps, 1, "id 1 at 1 s");
  }
}

TEST_F(Gaps, MayBeEmptyFields) {
  expect_gap(*read("time,pedID,posX,posY\n0,1,2,3\n0.5,1,,3\n1,1,2,\n1.5,1,,\n"), 3,
             "id 1 at 0.5 s");
  expect_gap(*read("time;pedID;posX;posY\n0;1;2;3\n0.5;1;\"\";3\n"), 1, "id 1 at 0.5 s");
  expect_gap(*read("time\tpedID\tposX\tposY\n0\t1\t2\t3\n0.5\t1\t\t3\n1\t1\t2\t\n"), 2,
             "id 1 at 0.5 s");
  expect_gap(*read("# framerate: 25\n# id frame x/m y/m z/m\n1\t0\t2\t3\t1.7\n1\t1\t\t3\t1.7\n"
                   "1\t2\t2\t\t\n1\t3\t2\t3\t\n"),
             2, "id 1 at frame 1");
  expect_gap(*read("780\t1\t2\t3\n790\t1\t2.1\t3\n800\t1\t\t\n"), 1, "id 1 at frame 800");
}

TEST_F(Gaps, MayBeginALine) {
  expect_gap(*read("x,y,id,t\n1,2,1,0\n#N/A,2,1,0.5\n1,2,1,1\n# a comment\n"), 1, "id 1 at 0.5 s");
  expect_gap(*read("# framerate: 25\n# x/m y/m id frame\n1 2 1 0\n#N/A 2 1 1\n1 2 1 2\n"), 1,
             "id 1 at frame 1");
}

TEST_F(Gaps, ExcludeRowsOfSeparators) {
  const auto expect_empty = [&](const std::string& text, int64_t count, const std::string& first) {
    const auto recording = read(text);
    EXPECT_EQ(recording->facts().samples, 2) << text;
    ASSERT_EQ(recording->facts().anomalies.size(), 1u) << text;
    EXPECT_EQ(recording->facts().anomalies[0].what,
              "rows with separators only (treated as empty lines)");
    EXPECT_EQ(recording->facts().anomalies[0].count, count) << text;
    EXPECT_EQ(recording->facts().anomalies[0].first, first) << text;
  };
  expect_empty("id,t,x,y\n1,0,3,4\n,,,\n1,1,3,4\n,,,\n, ,,\n", 3, "line 3");
  expect_empty(",,,\nid,t,x,y\n1,0,3,4\n1,1,3,4\n,,\n\n", 2, "line 1");
  expect_empty("id;t;x;y\n;;;\n1;0;3;4\n1;1;3;4\n", 1, "line 2");
  expect_empty("id\tt\tx\ty\n1\t0\t3\t4\n1\t1\t3\t4\n\t\t\t\n", 1, "line 4");
  expect_empty("id,t,x,y\n1,0,3,4\n\"\",\"\",\"\",\"\"\n1,1,3,4\n", 1, "line 3");
  EXPECT_EQ(read("# framerate: 10,,,\nid,frame,x,y\n1,0,3,4\n1,1,3,4\n")->facts().fps, 10);
  EXPECT_THAT(rejection("id,t,x,y\n1,0,3,4\n1,,,\n"), HasSubstr("expected"));
}

TEST_F(Gaps, MayBeginATableWithoutNames) {
  for (const char* missing : {"?", "", "NaN"}) {
    const auto bare = read(fmt::format("2,0,{0},{0}\n2,1,5,6\n2,2,5,7\n", missing),
                           {.fps = 10, .columns = "id=1,frame=2,x=3,y=4"});
    EXPECT_EQ(track(*bare, 0)[0].position_m, Eigen::Vector2d(5, 6));
    expect_gap(*bare, 1, "id 2 at frame 0");
  }
}

TEST_F(Gaps, AreNanOrNullInBinaryFiles) {
  std::string sql = jupedsim_2();
  for (size_t at = sql.find(" NOT NULL"); at != std::string::npos; at = sql.find(" NOT NULL"))
    sql.erase(at, 9);
  make_sqlite(path("a.sqlite"),
              sql +
                  "UPDATE trajectory_data SET pos_x = NULL WHERE frame = 1 AND id = 5;"
                  "UPDATE trajectory_data SET pos_y = 'NaN' WHERE frame = 2;");
  expect_gap(*read_recording({.file = path("a.sqlite")}), 2, "id 5 at frame 1");
  make_hdf5(path("a.h5"), {.rows = {{1, 0, 0, 0, 0}, {1, 1, std::nan(""), 0, 0}}});
  expect_gap(*read_recording({.file = path("a.h5")}), 1, "id 1 at frame 1");
}

TEST_F(Gaps, DoNotMakeARecording) {
  EXPECT_THAT(rejection("# framerate: 25\n# id frame x/m y/m\n1 0 nan nan\n1 1 nan 3\n"),
              HasSubstr("at least one position of a person, found only 2 missing ones"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,?,?\n"), HasSubstr("only 1 missing ones"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n1,1,1,2\n1,2,?,?\n", {.strict = true}),
              AllOf(HasSubstr("--strict"), HasSubstr("missing positions")));
}

TEST_F(Gaps, ExcludeIdsTimesAndInfinities) {
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n,1,1,2\n"), HasSubstr(":3: expected a whole number"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n1,nan,1,2\n"), HasSubstr(":3: expected a number"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n1,1,1.#INF,2\n"), HasSubstr("'1.#INF'"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n1,1,inf,2\n"), HasSubstr(":3: expected a number"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n1,1,far,2\n"), HasSubstr("'far'"));
  EXPECT_THAT(rejection("id,t,x,y\n1,0,1,2\n-1,1,nan,2\n"), HasSubstr("an id of 0 or more"));
}

}  // namespace
}  // namespace throng::gaps_test
