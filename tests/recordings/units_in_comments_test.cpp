// Units and rates in comments, attributes and metadata are applied or rejected.
#include <gmock/gmock.h>

#include "tests/recordings/binary_files.h"
#include "tests/recordings/recording_folder.h"

namespace throng::units_in_comments_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class UnitsInComments : public RecordingTest {
 protected:
  Eigen::Vector2d first_of(std::string_view text, RecordingOptions options = {}) const {
    return track(*read(text, std::move(options)), 0)[0].position_m;
  }
};

TEST_F(UnitsInComments, AreReadInArchiveText) {
  const std::string rows = "1 0 300 400 170\n1 1 305 400 170\n";
  for (const char* comments :
       {"# id frame x (in cm) y (in cm) z (in cm)\n",
        "# id frame x/cm y/cm z/cm\n",
        "# id frame x [cm] y [cm] z [cm]\n",
        "# id frame x[in cm] y[in cm] z[in cm]\n",
        "#ID\tFR\tX [cm]\tY [cm]\tZ [cm]\n",
        "# id frame x cm y cm z cm\n",
        "# id frame x in cm y in cm z in cm\n",
        "# id, frame, x/cm, y/cm, z/cm\n",
        "# id frame x_cm y_cm z_cm\n",
        "# id frame x / cm y / cm z / cm\n",
        "# unit: cm\n",
        "# units: [cm]\n",
        "# x: cm, y: cm, z: cm\n",
        "# x in cm, y in cm and z in cm\n",
        "# coordinates: cm\n",
        "# lengths in cm, times in s\n",
        "# all values in cm\n",
        "# x, y, z [cm]\n",
        "#XYZ: coordinates (in cm)\n",
        "# X: to the east (in cm); Y: to the north (in cm)\n",
        "# x (cm), y (cm), z (cm)\n",
        "# unit: cm, fps: 25\n",
        "# unit of length: cm\n",
        "# unit (cm)\n",
        "# units [cm]\n",
        "# unit_length: cm\n",
        "# length_unit: cm\n",
        "# {\"fps\": 25, \"unit\": \"cm\"}\n",
        "# {\"unit\": \"cm\", \"fps\": 25}\n",
        "# unit cm\n",
        "# Unit = centimetres\n",
        "# length unit = cm\n",
        "#X,Y,Z: the agents coordinates (in centimetres)\n#ID\tFR\tX\tY\tZ\n",
        "# x, y, z: positions of heads [cm]\n",
        "# all coordinates in cm\n",
        "# x, y in cm\n",
        "# positions are given in centimetres.\n",
        "# columns: id frame x/cm y/cm z/cm\n",
        "#X,Y,v: the agents coordinates (in cm) and instantaneous velocity (m/s)\n",
        "# id frame x (in centimeter) y (in centimeter) z (in centimeter)\n",
        "# z: can be 3d position or height of person (alternating or not)\n# id frame x/cm y/cm "
        "z/cm\n"}) {
    SCOPED_TRACE(comments);
    const auto recording = read(std::string("# framerate: 25 fps\n") + comments + rows);
    EXPECT_EQ(recording->facts().kind, "archive text");
    EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(3, 4));
    EXPECT_FLOAT_EQ(track(*recording, 0)[0].z_m, 1.7f);
  }
  for (const char* comments :
       {"# id frame x (in m) y (in m) z (in m)\n", "# id frame x (in meter) y (in meter)\n",
        "#X,Y,Z: coordinates of the pedestrians (in metres)\n", "# id frame x/m y/m z/m\n"})
    EXPECT_EQ(first_of(std::string("# framerate: 25\n") + comments + rows),
              Eigen::Vector2d(300, 400))
        << comments;
  EXPECT_EQ(first_of("# framerate: 25\n# id frame x/cm y/m z/m\n" + rows), Eigen::Vector2d(3, 400));
  for (const char* comments :
       {"# x in cm, y in m\n", "# X: to the east (in cm), Y: to the north (in m)\n",
        "# x: cm; y: m\n", "# x [cm] and y [m]\n", "# X: east [cm]\n# Y: north [m]\n"})
    EXPECT_EQ(first_of(std::string("# framerate: 25\n") + comments + rows), Eigen::Vector2d(3, 400))
        << comments;
  EXPECT_EQ(first_of("# framerate: 25\n# id frame x [in] y [in]\n" + rows),
            Eigen::Vector2d(300 * 0.0254, 400 * 0.0254));
  for (const char* comments : {"# id frame x/px y/px\n", "# id frame x [furlong] y [furlong]\n",
                               "# unit: px\n", "#X,Y,Z: coordinates (in pixels)\n",
                               "# x, y in furlongs\n", "# id frame x (in px) y (in px)\n"})
    EXPECT_THAT(rejection(std::string("# framerate: 25\n") + comments + rows),
                AllOf(StartsWith("recording:2: expected a unit of length"), HasSubstr("--unit")))
        << comments;
  EXPECT_THAT(rejection("# framerate: 25\n# unit: m\n# id frame x/cm y/cm\n" + rows),
              AllOf(StartsWith("recording:3: "), HasSubstr("m for x"), HasSubstr("'cm'")));
  // Prose states nothing.
  for (const char* comments :
       {"# x y and frame of each id, in the world frame\n",
        "#ANGLE: orientation of the ellipse (in degrees)\n", "# made in a unit test [v2]\n",
        "# unit tests: 5\n", "# positions (of heads)\n"})
    EXPECT_THAT(rejection(std::string("# framerate: 25\n") + comments + rows),
                HasSubstr("--unit cm"))
        << comments;
}

TEST_F(UnitsInComments, AreReadInTables) {
  const std::string rows = "id,t,x,y\n1,0,300,400\n1,1,300,400\n";
  EXPECT_EQ(first_of("# unit: cm\n" + rows), Eigen::Vector2d(3, 4));
  EXPECT_EQ(first_of("# x, y: positions (in cm)\n" + rows), Eigen::Vector2d(3, 4));
  EXPECT_THAT(rejection("# unit: px\n" + rows),
              StartsWith("recording:1: expected a unit of length"));
  EXPECT_EQ(read("# units: cm, ms\n" + rows)->facts().duration_s, 0.001);
  EXPECT_EQ(first_of("$VISION\n* COORDCENTX: centre, x [ft]\n* COORDCENTY: centre, y [ft]\n"
                     "* SIMSEC: SimSec, simulation second (Simulation time [s]) [s]\n"
                     "$PEDESTRIAN:NO;SIMSEC;COORDCENTX;COORDCENTY\n3;0.20;10;20\n3;0.40;1.75;2\n"),
            Eigen::Vector2d(3.048, 6.096));
  EXPECT_EQ(read("# framerate: 10 fps\nid,frame,x,y\n1,0,3,4\n1,1,3,4\n")->facts().fps, 10);
  EXPECT_EQ(first_of("# id,frame,x/cm,y/cm\n1,0,300,400\n",
                     {.fps = 25, .columns = "id=1,frame=2,x=3,y=4"}),
            Eigen::Vector2d(3, 4));
}

TEST_F(UnitsInComments, AreReadFromLists) {
  const std::string rows = "1,0,300,4000\n1,500,300,4000\n";
  const RecordingOptions numbered = {.columns = "id=1,t=2,x=3,y=4"};
  const auto expect_read = [&](const std::string& text, const RecordingOptions& options = {}) {
    SCOPED_TRACE(text);
    const auto recording = read(text, options);
    EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(3, 4));
    EXPECT_EQ(recording->facts().duration_s, 0.5);
  };
  for (const char* list :
       {"#,ms,cm,mm", "# ,ms,cm,mm", "#-,ms,cm,mm", "# -, [ms], [cm], [mm]",
        "#\"\",\"ms\",\"cm\",\"mm\"", "#none,ms,cm,mm", "#id,ms,cm,mm", "#,MS,CM,MM", "# ms cm mm",
        "# - ms cm mm", "#;ms;cm;mm", "#\t-\tms\tcm\tmm", "# (ms) (cm) (mm)", "# id [ms] [cm] [mm]",
        "#,ms,cm,mm,"}) {
    expect_read(fmt::format("id,t,x,y\n{}\n{}", list, rows));
    expect_read(fmt::format("{}\nid,t,x,y\n{}", list, rows));
    expect_read(fmt::format("# id,t,x,y\n{}\n{}", list, rows), numbered);
  }
  expect_read("id t x y\n# - ms cm mm\n1 0 300 4000\n1 500 300 4000\n");
  expect_read("t,x,y,id\n# ms, cm, mm\n0,300,4000,1\n500,300,4000,1\n");
  for (const char* list :
       {"# - - cm mm cm", "#\t\t\tcm\tmm\tcm", "# cm mm cm", "# id frame cm mm cm"})
    EXPECT_EQ(
        first_of(fmt::format("# framerate: 25\n# id frame x y z\n{}\n1 0 300 4000 170\n", list)),
        Eigen::Vector2d(3, 4))
        << list;
  EXPECT_EQ(first_of("# framerate: 25\n# cm\n1 0 300 400 170\n1 1 300 400 170\n"),
            Eigen::Vector2d(3, 4));
  for (const char* list : {"#,ms,px,mm", "#,ms,cm", "#,ms,cm,mm,mm,mm", "#,ms,cm,blobs", "# ms cm",
                           "#,cm,ms,mm", "#,ms,miles,mm", "# - ms cm furlongs", "#,ms,Mm,mm"})
    EXPECT_THAT(rejection(fmt::format("id,t,x,y\n{}\n{}", list, rows)),
                AllOf(StartsWith("recording:2: expected a unit of"), HasSubstr("the comment '")))
        << list;
  for (const char* list : {"#,ms,cm,cm", "#,s,,", "# - s m m"})
    EXPECT_THAT(rejection(fmt::format("id,frame,x,y\n{}\n1,0,3,4\n", list), {.fps = 25}),
                StartsWith("recording:2: expected a unit of length"))
        << list << ": frames have none";
  EXPECT_THAT(rejection("id,t,x [m],y [m]\n#,s,cm,cm\n" + rows), HasSubstr("expected m for x"));
  for (const char* prose :
       {"# all in m here", "# recorded in Aachen, m, 2013", "# s", "# h", "# door in the middle",
        "# camera in, door out", "# in", "# run 3 h", "# 1 2 3 4", "# m, s"}) {
    const auto recording = read(fmt::format("id,t,x,y\n{}\n1,0,3,4\n1,1,3,4\n", prose));
    EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(3, 4)) << prose;
    EXPECT_EQ(recording->facts().duration_s, 1) << prose;
  }
}

TEST_F(UnitsInComments, ExcludeUnrelatedComments) {
  const std::string rows = "id,t,x,y\n1,0,300,400\n1,1,300,400\n";
  for (const char* comment : {"# time resolution (ms): 100",
                              "# time step [ms]: 100",
                              "# time [min]: 5",
                              "# time (h): 14",
                              "# position error (cm): 2",
                              "# position accuracy [cm]: 2",
                              "# coordinates of the door (cm): 100 200",
                              "# length of corridor [cm]: 500",
                              "# length (cm): 500",
                              "# distance between marks [cm]: 50",
                              "# coordinate grid [cm]: 50",
                              "# height unit: cm",
                              "# unit of height: cm",
                              "# unit for body radius: cm",
                              "# x = in, y = out",
                              "# x (in) is where they come in",
                              "# x in [0, 10], y in [0, 5]",
                              "# heights in cm",
                              "# positions were in cm, are now in m",
                              "# coordinates (px) were calibrated",
                              "# units: 12 people",
                              "# unit: none",
                              "# Units: SI",
                              "# unit: meters (m)",
                              "# unit: m (was cm)",
                              "# unit: 1 m",
                              "# units: id s m m"}) {
    const auto recording = read(fmt::format("{}\n{}", comment, rows));
    EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(300, 400)) << comment;
    EXPECT_EQ(recording->facts().duration_s, 1) << comment;
  }
  EXPECT_EQ(first_of("# all lengths in cm; time in s; heights in mm\n" + rows),
            Eigen::Vector2d(3, 4));
  // Ordinary names next to their opposites.
  EXPECT_THAT(rejection("id,t,x_in,y_in,x_out,y_out\n1,0,300,400,1,1\n1,1,300,400,1,1\n"),
              HasSubstr("expected"));
  // Two different lines of names.
  EXPECT_THAT(rejection("# framerate: 10\n# id frame x/m y/m\n# id frame x/cm y/cm\n1 0 300 400\n"),
              HasSubstr("expected"));
}

TEST_F(UnitsInComments, IncludeRatesOrRejectThem) {
  const std::string rows = "# id frame x/m y/m\n1 0 3 4\n1 1 3 4\n";
  const std::pair<const char*, double> known[] = {
      {"# framerate: 29,97 fps", 29.97},
      {"# framerate: 1/25 s", 25},
      {"#framerate: 25.00", 25},
      {"# framerate:25 frames per second", 25},
      {"# Frame rate = 25 Hz", 25},
      {"# fps: 25", 25},
      {"# framerate 25", 25},
      {"# framerate [fps]: 25", 25},
      {"# frame rate (Hz): 25", 25},
      {"# frame rate in fps: 25", 25},
      {"# frames per second: 25", 25},
      {"# camera 3; framerate: 25 fps; unit: m", 25},
      {"# framerate: 30000/1001", 30000 / 1001.0},
      {"# made with a tool for fps 3\n# framerate: 25", 25},
      {"# playback fps: 50\n# framerate: 25", 25},
      {"# framerate: 25\n# framerate: 25.00 fps", 25}};
  for (const auto& [comment, fps] : known)
    EXPECT_DOUBLE_EQ(read(fmt::format("{}\n{}", comment, rows))->facts().fps, fps) << comment;
  for (const char* comment :
       {"# framerate: 25 fps or so", "# framerate: fast", "# fps: 1,000", "# framerate: 1/25",
        "# framerate: 25 16", "# framerate: 25 fps (every tenth)", "# framerate: 10 Hz, 25 Hz",
        "# framerate: 10;25"}) {
    EXPECT_THAT(rejection(fmt::format("{}\n{}", comment, rows)),
                AllOf(StartsWith("recording:1: expected a frame rate as in 25"),
                      HasSubstr("--fps overrides")))
        << comment;
    EXPECT_EQ(read(fmt::format("{}\n{}", comment, rows), {.fps = 25})->facts().fps, 25);
  }
  EXPECT_THAT(rejection("# framerate: 25\n# framerate: 16\n" + rows),
              AllOf(StartsWith("recording:2: expected one frame rate, 25"), HasSubstr("'16'")));
}

TEST_F(UnitsInComments, AreReadInBinaryFiles) {
  const auto sqlite = [&](const std::string& more, RecordingOptions options = {}) {
    make_sqlite(path("a.sqlite"), jupedsim_2() + more);
    options.file = path("a.sqlite");
    return read_recording(options);
  };
  const auto sqlite_rejection = [&](const std::string& more) {
    try {
      sqlite(more);
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(sqlite("UPDATE metadata SET value = '29,97 fps' WHERE key = 'fps'")->facts().fps,
            29.97);
  EXPECT_EQ(sqlite("UPDATE metadata SET value = '1/25 s' WHERE key = 'fps'")->facts().fps, 25);
  const std::string open =
      "DROP TABLE metadata; CREATE TABLE metadata(key, value); "
      "INSERT INTO metadata VALUES('fps', 25), ('version', 2), ";
  EXPECT_THAT(sqlite_rejection(open + "('fps', 30)"),
              AllOf(HasSubstr("expected one frame rate, 25, found 30 as fps"),
                    HasSubstr("--fps overrides")));
  EXPECT_EQ(sqlite(open + "('fps', '25.0 Hz')")->facts().fps, 25) << "the same twice";
  EXPECT_EQ(sqlite(open + "('FPS', 30)", {.fps = 10})->facts().fps, 10);
  EXPECT_THAT(sqlite_rejection(open + "('unit', 'm'), ('units', 'cm')"),
              AllOf(HasSubstr("expected one unit, 'm', found 'cm' as units"), HasSubstr("--unit")));
  const std::string unclear = "UPDATE metadata SET value = '25 or so' WHERE key = 'fps'";
  EXPECT_THAT(sqlite_rejection(unclear), AllOf(HasSubstr("a frame rate as in 25"),
                                               HasSubstr("'25 or so'"), HasSubstr("--fps")));
  EXPECT_EQ(sqlite(unclear, {.fps = 25})->facts().fps, 25);
  const auto in_cm = sqlite("INSERT INTO metadata VALUES('unit', 'cm')");
  EXPECT_EQ(track(*in_cm, 1)[0].position_m, Eigen::Vector2d(0.01, 0.01));
  EXPECT_EQ(in_cm->facts().wkt_unit_m, 0.01);
  EXPECT_THAT(sqlite_rejection("INSERT INTO metadata VALUES('unit', 'px')"),
              HasSubstr("a unit of length (m, cm, mm, km, ft, in)"));

  const auto hdf5 = [&](const Hdf5Plan& plan) {
    make_hdf5(path("a.h5"), plan);
    return read_recording({.file = path("a.h5")});
  };
  Hdf5Plan plan;
  plan.texts = {{"fps", "29,97 fps"},
                {"x", "pedestrian x-coordinate (centimeter [cm])"},
                {"y", "pedestrian y-coordinate (meter [m])"}};
  plan.fps = 0;
  plan.rows = {{1, 0, 300, 4, 1.7}, {1, 1, 300, 4, 1.7}};
  const auto described = hdf5(plan);
  EXPECT_EQ(described->facts().fps, 29.97);
  EXPECT_EQ(track(*described, 0)[0].position_m, Eigen::Vector2d(3, 4));
  plan.texts = {{"fps", "25"}};
  plan.x_name = "x [cm]";
  EXPECT_EQ(track(*hdf5(plan), 0)[0].position_m.x(), 3);
  plan.texts = {{"fps", "25"}, {"unit", "m"}};
  EXPECT_THAT([&] { hdf5(plan); },
              testing::ThrowsMessage<InputError>(HasSubstr("expected one unit, 'cm', found 'm'")));
  plan.texts = {{"fps", "25"}};
  plan.x_name = "x/px";
  EXPECT_THAT([&] { hdf5(plan); },
              testing::ThrowsMessage<InputError>(HasSubstr("a unit of length")));
}

TEST_F(UnitsInComments, AreReadInFootsteps) {
  const auto recording = read(
      "pedestrianId simTime[ms] endTime[ms]-PID1 startX[cm]-PID1 startY-PID1 endX-PID1 endY-PID1\n"
      "1 400 900 250 710 300 710\n1 900 1400 300 710 350 710\n");
  EXPECT_DOUBLE_EQ(recording->facts().duration_s, 1);
  EXPECT_EQ(track(*recording, 0)[0].position_m, Eigen::Vector2d(2.5, 7.1));
  EXPECT_THAT(rejection("pedestrianId simTime endTime startX/px startY/px endX/px endY/px\n"
                        "1 0.4 0.9 2 7 3 7\n"),
              HasSubstr("a unit of length"));
}

}  // namespace
}  // namespace throng::units_in_comments_test
