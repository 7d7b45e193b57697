// Trajectory files hold the tables, columns and geometry that other programs read.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "analysis/trajectories/trajectory_sink.h"
#include "analysis/trajectories/walkable_area.h"
#include "base/errors.h"
#include "geometry/wkt.h"
#include "recordings/recording.h"
#include "tests/crowd/crowd_world.h"

namespace throng::trajectory_test {
namespace {

namespace fs = std::filesystem;

class Trajectory : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / fmt::format("trajectory_{}", getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Three people walk east, 1 m apart, for `frames` steps; the middle one is present for the first
  /// second only.
  void record(TrajectorySink& sink, int64_t frames) {
    scene_.name = "three";
    scene_.seed = 7;
    scene_.ground = {{-5, -4}, {5, 4}};
    scene_.obstacles = {box(0, 2, 1, 1)};
    if (cut_) scene_.obstacles.push_back(*cut_);
    RunInfo run;
    run.scene = &scene_;
    run.run_id = 0xabc;
    run.step_s = 1.0 / 60;
    run.model_of_avatar = {0, 0, 0};
    run.groups = {"walkers", "guards"};
    run.group_of_avatar = {0, 0, 1};
    sink.begin(run);
    std::vector<RootPose> roots(3);
    const std::vector<float> speeds = {1.5f, 1.0f, 0.5f};
    for (int64_t number = 0; number < frames; ++number) {
      for (size_t id = 0; id < roots.size(); ++id) {
        roots[id].position_m = {static_cast<double>(number) / 64, static_cast<double>(id), 0};
        roots[id].world_from_root = Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitZ());
      }
      Frame frame;
      frame.number = number;
      frame.roots = roots;
      frame.speeds_mps = speeds;
      const std::vector<uint8_t> present = {1, number < 60, 1};
      frame.present = present;
      sink.frame(run, frame);
    }
    sink.end(run, {});
  }

  fs::path folder_;
  Scene scene_;
  std::optional<Obstacle> cut_;  ///< additional obstacle
};

/// Rows of a query, with columns joined by '|'.
std::vector<std::string> query(const fs::path& file, const char* sql) {
  sqlite3* database = nullptr;
  EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::vector<std::string> rows;
  sqlite3_stmt* statement = nullptr;
  EXPECT_EQ(sqlite3_prepare_v2(database, sql, -1, &statement, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  while (sqlite3_step(statement) == SQLITE_ROW) {
    std::string& row = rows.emplace_back();
    for (int column = 0; column < sqlite3_column_count(statement); ++column) {
      const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
      row += fmt::format("{}{}", column == 0 ? "" : "|", text == nullptr ? "NULL" : text);
    }
  }
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return rows;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(Trajectory, WritesTheTablesOfJuPedSimVersion2) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 12);
  const auto columns = [&](const char* table) {
    return query(
        folder_ / "t.sqlite",
        fmt::format("SELECT name, type, \"notnull\" FROM pragma_table_info('{}')", table).c_str());
  };
  EXPECT_THAT(columns("trajectory_data"),
              ElementsAre("frame|INTEGER|1", "id|INTEGER|1", "pos_x|REAL|1", "pos_y|REAL|1",
                          "ori_x|REAL|1", "ori_y|REAL|1"));
  EXPECT_THAT(columns("metadata"), ElementsAre("key|TEXT|1", "value|TEXT|1"));
  EXPECT_THAT(columns("geometry"), ElementsAre("hash|INTEGER|1", "wkt|TEXT|1"));
  EXPECT_THAT(columns("frame_data"), ElementsAre("frame|INTEGER|1", "geometry_hash|INTEGER|1"));
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT name FROM pragma_index_info('frame_id_idx')"),
              ElementsAre("frame", "id"));
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT name FROM pragma_index_info('geometry_hash')"),
              ElementsAre("hash"));
}

TEST_F(Trajectory, WritesRateBoundsAndGeometryToSqlite) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 12);
  const fs::path file = folder_ / "t.sqlite";
  EXPECT_THAT(query(file,
                    "SELECT key, value FROM metadata WHERE key NOT LIKE 'throng%' "
                    "ORDER BY key"),
              ElementsAre("fps|10", "version|2", "xmax|5", "xmin|-5", "ymax|4", "ymin|-4"));
  EXPECT_THAT(query(file, "SELECT value FROM metadata WHERE key = 'throng_scene'"),
              ElementsAre("three"));
  EXPECT_THAT(query(file, "SELECT wkt FROM geometry"),
              ElementsAre(trajectory_area(scene_, {}).wkt));
  EXPECT_THAT(query(file, "SELECT count(*) FROM frame_data JOIN geometry ON hash = geometry_hash"),
              ElementsAre("2"));
}

TEST_F(Trajectory, HasOneRowPerPersonAndFrame) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 13);  // records steps 0, 6 and 12
  const fs::path file = folder_ / "t.sqlite";
  EXPECT_EQ(sink.frames(), 3);
  EXPECT_EQ(sink.rows(), 9);
  EXPECT_THAT(query(file,
                    "SELECT frame, count(*), min(id), max(id) FROM trajectory_data "
                    "GROUP BY frame"),
              ElementsAre("0|3|0|2", "1|3|0|2", "2|3|0|2"));
  EXPECT_THAT(query(file, "SELECT pos_x, pos_y FROM trajectory_data WHERE frame = 2 AND id = 1"),
              ElementsAre("0.1875|1.0"));
  EXPECT_THAT(query(file,
                    "SELECT round(heading_rad, 4), speed_mps FROM throng_motion "
                    "WHERE frame = 1 AND id = 0"),
              ElementsAre("0.5|1.5"));
}

TEST_F(Trajectory, AnswersTheQueriesOfPedPyAndJuPedSim) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 13);
  const fs::path file = folder_ / "t.sqlite";
  EXPECT_THAT(query(file, "select value from metadata where key = 'version'"), ElementsAre("2"));
  EXPECT_THAT(query(file, "select value from metadata where key = 'fps'"), ElementsAre("10"));
  EXPECT_THAT(query(file, "select frame, id, pos_x as x, pos_y as y from trajectory_data limit 2"),
              ElementsAre("0|0|0.0|0.0", "0|1|0.0|1.0"));
  EXPECT_THAT(query(file,
                    "SELECT id, pos_x, pos_y, round(ori_x, 6), round(ori_y, 6) "
                    "FROM trajectory_data WHERE frame == (2) ORDER BY id ASC"),
              ElementsAre("0|0.1875|0.0|0.877583|0.479426", "1|0.1875|1.0|0.877583|0.479426",
                          "2|0.1875|2.0|0.877583|0.479426"));
  EXPECT_THAT(query(file, "SELECT count(*) FROM frame_data"), ElementsAre("3"));
  EXPECT_THAT(query(file,
                    "SELECT count(*) FROM geometry WHERE hash IN (SELECT geometry_hash FROM "
                    "frame_data WHERE frame == 1)"),
              ElementsAre("1"));
  // Both require a single polygon.
  const std::vector<std::string> wkt = query(file, "SELECT wkt FROM geometry");
  ASSERT_EQ(wkt.size(), 1u);
  EXPECT_EQ(parse_wkt(wkt[0], "wkt").size(), 1u) << wkt[0];
  EXPECT_THAT(wkt[0], testing::StartsWith("POLYGON (("));
}

TEST_F(Trajectory, IsReadBackWithAreaAndHeadings) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 120);
  RecordingOptions options;
  options.file = folder_ / "t.sqlite";
  const auto recording = read_recording(options);
  EXPECT_EQ(recording->facts().kind, "JuPedSim SQLite 2");
  EXPECT_EQ(recording->facts().fps, 10);
  EXPECT_TRUE(recording->facts().has_headings);
  EXPECT_EQ(recording->facts().wkt, trajectory_area(scene_, {}).wkt);
  std::vector<Sample> samples;
  recording->read(1, samples);
  ASSERT_EQ(samples.size(), 10u);
  EXPECT_EQ(samples[2].heading_rad, 0.5f);
  EXPECT_EQ(samples[2].position_m, Eigen::Vector2d(0.1875, 1));
}

TEST_F(Trajectory, StoresTheChosenPieceOfTheArea) {
  const auto write = [&](const char* name, std::optional<int64_t> piece) {
    TrajectorySink sink({folder_ / name, 10, piece});
    record(sink, 6);
  };
  cut_ = box(0, -3, 10, 0.2);
  EXPECT_THROW(write("t.sqlite", {}), InputError);
  EXPECT_NO_THROW(write("t.csv", {})) << "CSV holds no area";
  write("t.sqlite", 2);
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT wkt FROM geometry"),
              ElementsAre("POLYGON ((-5.0000 -4.0000, 5.0000 -4.0000, 5.0000 -3.1001, -5.0000 "
                          "-3.1001, -5.0000 -4.0000))"));
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT value FROM metadata WHERE key = 'throng_area'"),
              ElementsAre("2 of 2"));
}

TEST_F(Trajectory, HasNoRowsOfAbsentPeople) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 120);
  EXPECT_THAT(query(folder_ / "t.sqlite",
                    "SELECT id, count(*), max(frame) FROM trajectory_data "
                    "GROUP BY id"),
              ElementsAre("0|20|19", "1|10|9", "2|20|19"));
}

TEST_F(Trajectory, NamesPeopleByTheirGroup) {
  TrajectorySink sink({folder_ / "t.sqlite", 10});
  record(sink, 6);
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT name FROM throng_people ORDER BY id"),
              ElementsAre("walkers 0", "walkers 1", "guards 2"));
}

TEST_F(Trajectory, CommitsLongRecordingsPeriodically) {
  const fs::path file = folder_ / "t.sqlite";
  const auto writer = open_sqlite_trajectory(file);
  writer->begin({60, {{-1, -1}, {1, 1}}, "POLYGON EMPTY", {}, {"person"}});
  const std::vector<TrajectoryRow> rows = {{0, 0.5, 0.5, 0, 1}};
  for (int64_t number = 0; number < 250; ++number) writer->frame(number, rows);
  EXPECT_THAT(query(file, "SELECT count(*) FROM trajectory_data"), ElementsAre("200"))
      << "readable while it is being written";
  writer->end();
  EXPECT_THAT(query(file, "SELECT count(*) FROM trajectory_data"), ElementsAre("250"));
}

TEST_F(Trajectory, UsesTheNearestRateThatTheStepAllows) {
  TrajectorySink sink({folder_ / "t.sqlite", 25});  // 60 / 25 = 2.4 steps, rounded to 2
  record(sink, 10);
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT value FROM metadata WHERE key = 'fps'"),
              ElementsAre("30"));
  EXPECT_EQ(sink.frames(), 5);
}

TEST_F(Trajectory, WritesTheSameRowsToCsv) {
  TrajectorySink sink({folder_ / "t.csv", 10});
  record(sink, 12);
  const std::vector<std::string> lines = lines_of(folder_ / "t.csv");
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_EQ(lines[0], "frame,time_s,id,x_m,y_m,heading_rad,speed_mps");
  EXPECT_EQ(lines[1], "0,0.0000,0,0.0000,0.0000,0.5000,1.5000");
  EXPECT_EQ(lines[6], "1,0.1000,2,0.0938,2.0000,0.5000,0.5000");
}

TEST_F(Trajectory, ReplacesAnEarlierRecording) {
  for (int run = 0; run < 2; ++run) {
    TrajectorySink sink({folder_ / "t.sqlite", 10});
    record(sink, 6);
  }
  EXPECT_THAT(query(folder_ / "t.sqlite", "SELECT count(*) FROM trajectory_data"),
              ElementsAre("3"));
}

TEST_F(Trajectory, KeepsAFileThatIsBeingRead) {
  const fs::path file = folder_ / "t.sqlite";
  {
    TrajectorySink sink({file, 10});
    record(sink, 60);
  }
  const uintmax_t size = fs::file_size(file);
  int ready[2], over[2];
  ASSERT_EQ(pipe(ready), 0);
  ASSERT_EQ(pipe(over), 0);
  const pid_t reader = fork();  // another process, because locks are per process
  if (reader == 0) {
    sqlite3* database = nullptr;
    sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
    sqlite3_exec(database, "BEGIN; SELECT count(*) FROM trajectory_data", nullptr, nullptr,
                 nullptr);
    char byte = 0;
    const bool handshake = write(ready[1], &byte, 1) == 1 && read(over[0], &byte, 1) == 1;
    std::_Exit(handshake ? 0 : 1);
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THROW(TrajectorySink({file, 10}), EnvironmentError);
  EXPECT_EQ(fs::file_size(file), size);
  ASSERT_EQ(write(over[1], &byte, 1), 1);
  int status = -1;
  waitpid(reader, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_NO_THROW(TrajectorySink({file, 10}));
  EXPECT_EQ(fs::file_size(file), size) << "truncated before begin()";
  for (const int end : {ready[0], ready[1], over[0], over[1]}) close(end);
}

TEST_F(Trajectory, RejectsOtherExtensions) {
  EXPECT_THROW(TrajectorySink({folder_ / "t.txt", 10}), InputError);
}

/// Limits the size of files while it exists, like a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

TEST_F(Trajectory, KeepsCommittedFramesOnAFullDisk) {
  const fs::path file = folder_ / "t.sqlite";
  std::vector<TrajectoryRow> people(500, {0, 0.5, 0.5, 0, 1});
  for (uint32_t id = 0; id < people.size(); ++id) people[id].id = id;
  {
    const FullDisk disk(10'000'000);
    const auto writer = open_sqlite_trajectory(file);
    writer->begin({60, {{-1, -1}, {1, 1}}, "POLYGON EMPTY", {}, {}});
    EXPECT_THROW(for (int64_t number = 0; number < 2000; ++number) writer->frame(number, people),
                 EnvironmentError);
  }
  const std::vector<std::string> frames = query(file, "SELECT count(*) FROM frame_data");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_GE(std::stoi(frames[0]), 100);
  EXPECT_EQ(std::stoi(frames[0]) % 100, 0);
  EXPECT_THAT(query(file, "SELECT count(*) FROM trajectory_data"),
              ElementsAre(fmt::format("{}", 500 * std::stoi(frames[0]))));
  EXPECT_THAT(query(file, "PRAGMA integrity_check"), ElementsAre("ok"));
}

TEST_F(Trajectory, ReportsAMissingFolder) {
  for (const char* name : {"no/t.sqlite", "no/t.csv"}) {
    try {
      TrajectorySink sink({folder_ / name, 10});
      FAIL() << name << " was created";
    } catch (const EnvironmentError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  }
}

}  // namespace
}  // namespace throng::trajectory_test
