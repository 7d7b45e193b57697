// Trajectories as comma-separated values (one row per person and frame) or SQLite.
#include "analysis/trajectories/trajectory_sink.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "analysis/trajectories/walkable_area.h"
#include "base/checksum.h"
#include "base/errors.h"
#include "base/text.h"
#include "base/version.h"

namespace throng {
namespace {

class CsvWriter final : public TrajectoryWriter {
 public:
  explicit CsvWriter(const std::filesystem::path& file)
      : file_(file.string()),
        descriptor_(open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail();
  }
  ~CsvWriter() override {
    if (descriptor_ >= 0) close(descriptor_);
  }
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  void begin(const TrajectoryHead& head) override {
    // EINVAL: pipes and devices cannot be truncated.
    if (ftruncate(descriptor_, 0) != 0 && errno != EINVAL) fail();
    frame_s_ = 1 / head.fps;
    text_ = "frame,time_s,id,x_m,y_m,heading_rad,speed_mps\n";
    write_out();
  }

  void frame(int64_t number, std::span<const TrajectoryRow> rows) override {
    const double time_s = static_cast<double>(number) * frame_s_;
    for (const TrajectoryRow& row : rows)
      append(text_, "{},{:.4f},{},{:.4f},{:.4f},{:.4f},{:.4f}\n", number, time_s, row.id, row.x_m,
             row.y_m, row.heading_rad, row.speed_mps);
    write_out();
  }

  void end() override {
    const int closed = close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail();
  }

 private:
  void write_out() {
    size_t done = 0;
    while (done < text_.size()) {
      const ssize_t count = write(descriptor_, text_.data() + done, text_.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        const int error = errno;
        // Cut off incomplete frames: a torn line would read as a wrong number.
        [[maybe_unused]] const int cut = ftruncate(descriptor_, complete_);
        errno = error;
        fail();
      }
      done += static_cast<size_t>(count);
    }
    complete_ += static_cast<off_t>(text_.size());
    text_.clear();
  }

  [[noreturn]] void fail() const {
    throw EnvironmentError(
        fmt::format("{}: cannot write the trajectory: {}; choose another place with --trajectory",
                    file_, std::strerror(errno)));
  }

  std::string file_;
  int descriptor_;
  double frame_s_ = 0;
  off_t complete_ = 0;
  std::string text_;
};

}  // namespace

std::unique_ptr<TrajectoryWriter> open_csv_trajectory(const std::filesystem::path& file) {
  return std::make_unique<CsvWriter>(file);
}

namespace {

/// One transaction is one fsync: every 10 s at 10 frames per second and 500 people.
constexpr int64_t kRowsPerTransaction = 50'000;
/// Bounds the delay of small crowds.
constexpr int kFramesPerTransaction = 100;

constexpr const char* kSchema = R"(
CREATE TABLE trajectory_data(
  frame INTEGER NOT NULL, id INTEGER NOT NULL, pos_x REAL NOT NULL, pos_y REAL NOT NULL,
  ori_x REAL NOT NULL, ori_y REAL NOT NULL);
CREATE INDEX frame_id_idx ON trajectory_data(frame, id);
CREATE TABLE metadata(key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE geometry(hash INTEGER NOT NULL, wkt TEXT NOT NULL);
CREATE UNIQUE INDEX geometry_hash ON geometry(hash);
CREATE TABLE frame_data(frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);
CREATE TABLE throng_motion(
  frame INTEGER NOT NULL, id INTEGER NOT NULL, heading_rad REAL NOT NULL, speed_mps REAL NOT NULL,
  PRIMARY KEY(frame, id)) WITHOUT ROWID;
CREATE TABLE throng_people(id INTEGER PRIMARY KEY, name TEXT NOT NULL);
)";

class SqliteWriter final : public TrajectoryWriter {
 public:
  explicit SqliteWriter(const std::filesystem::path& file) : file_(file.string()) {
    // Not opened as a database yet: an existing file is only replaced when the run begins.
    const int descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(std::strerror(errno));
    struct flock lock {};
    lock.l_type = F_WRLCK;
    const bool is_in_use = ::fcntl(descriptor, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
    ::close(descriptor);
    if (is_in_use) fail("another program has it open");
  }
  ~SqliteWriter() override {
    // Drops uncommitted rows.
    close();
  }
  SqliteWriter(const SqliteWriter&) = delete;
  SqliteWriter& operator=(const SqliteWriter&) = delete;

  void begin(const TrajectoryHead& head) override {
    create();
    execute("BEGIN");
    const auto say = [&](const std::string& key, const std::string& value) {
      sqlite3_stmt* statement = prepare("INSERT INTO metadata VALUES(?, ?)");
      bind(statement, 1, key);
      bind(statement, 2, value);
      run(statement);
      sqlite3_finalize(statement);
    };
    say("version", "2");
    say("fps", fmt::format("{}", head.fps));
    say("xmin", fmt::format("{}", head.bounds.min_m.x()));
    say("xmax", fmt::format("{}", head.bounds.max_m.x()));
    say("ymin", fmt::format("{}", head.bounds.min_m.y()));
    say("ymax", fmt::format("{}", head.bounds.max_m.y()));
    for (const auto& [key, value] : head.facts) say("throng_" + key, value);
    add_geometry(head.wkt);
    add_people(head.people);
    execute("COMMIT");
    position_ = prepare("INSERT INTO trajectory_data VALUES(?, ?, ?, ?, ?, ?)");
    motion_ = prepare("INSERT INTO throng_motion VALUES(?, ?, ?, ?)");
    shape_ = prepare("INSERT INTO frame_data VALUES(?, ?)");
  }

  void frame(int64_t number, std::span<const TrajectoryRow> rows) override {
    if (pending_frames_ == 0) execute("BEGIN");
    for (const TrajectoryRow& row : rows) {
      insert(position_, number, row.id,
             {row.x_m, row.y_m, std::cos(row.heading_rad), std::sin(row.heading_rad)});
      insert(motion_, number, row.id, {row.heading_rad, row.speed_mps});
    }
    sqlite3_bind_int64(shape_, 1, number);
    sqlite3_bind_int64(shape_, 2, geometry_hash_);
    run(shape_);
    ++pending_frames_;
    pending_rows_ += static_cast<int64_t>(rows.size());
    if (pending_frames_ >= kFramesPerTransaction || pending_rows_ >= kRowsPerTransaction) commit();
  }

  void end() override {
    commit();
    close();
  }

 private:
  void create() {
    // Truncates the file instead of removing it, to keep its owner, hard links and locks.
    std::error_code error;
    if (std::filesystem::is_regular_file(file_, error)) {
      std::filesystem::resize_file(file_, 0, error);
      if (error) fail(error.message());
    }
    for (const char* ending : kSqliteSideFiles) std::filesystem::remove(file_ + ending, error);
    check(sqlite3_open_v2(file_.c_str(), &database_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
                          nullptr));
    execute("PRAGMA synchronous = NORMAL");
    execute(kSchema);
  }

  void add_geometry(const std::string& wkt) {
    geometry_hash_ = static_cast<sqlite3_int64>(Hasher().add(wkt).value());
    sqlite3_stmt* statement = prepare("INSERT INTO geometry VALUES(?, ?)");
    sqlite3_bind_int64(statement, 1, geometry_hash_);
    bind(statement, 2, wkt);
    run(statement);
    sqlite3_finalize(statement);
  }

  void add_people(const std::vector<std::string>& names) {
    sqlite3_stmt* statement = prepare("INSERT INTO throng_people VALUES(?, ?)");
    for (size_t id = 0; id < names.size(); ++id) {
      sqlite3_bind_int64(statement, 1, static_cast<sqlite3_int64>(id));
      bind(statement, 2, names[id]);
      run(statement);
    }
    sqlite3_finalize(statement);
  }

  void insert(sqlite3_stmt* statement, int64_t frame, uint32_t id,
              std::initializer_list<double> values) {
    sqlite3_bind_int64(statement, 1, frame);
    sqlite3_bind_int64(statement, 2, id);
    int column = 3;
    for (const double value : values) sqlite3_bind_double(statement, column++, value);
    run(statement);
  }

  void commit() {
    if (pending_frames_ == 0) return;
    execute("COMMIT");
    pending_frames_ = 0;
    pending_rows_ = 0;
  }

  sqlite3_stmt* prepare(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    check(sqlite3_prepare_v2(database_, sql, -1, &statement, nullptr));
    return statement;
  }
  static void bind(sqlite3_stmt* statement, int column, const std::string& text) {
    sqlite3_bind_text(statement, column, text.c_str(), -1, SQLITE_TRANSIENT);
  }
  void run(sqlite3_stmt* statement) {
    const int result = sqlite3_step(statement);
    if (result != SQLITE_DONE) check(result);
    sqlite3_reset(statement);
  }
  void execute(const char* sql) { check(sqlite3_exec(database_, sql, nullptr, nullptr, nullptr)); }

  void check(int result) {
    if (result == SQLITE_OK) return;
    const std::string reason =
        database_ == nullptr ? sqlite3_errstr(result) : sqlite3_errmsg(database_);
    close();
    roll_back();
    fail(reason);
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw EnvironmentError(
        fmt::format("{}: cannot write the trajectory: {}; choose another place with --trajectory",
                    file_, reason));
  }

  /// A failed write leaves the journal of its transaction next to the file, and readers would need
  /// write permission. Opening the file again rolls the transaction back.
  void roll_back() {
    sqlite3* again = nullptr;
    if (sqlite3_open_v2(file_.c_str(), &again, SQLITE_OPEN_READWRITE, nullptr) == SQLITE_OK)
      sqlite3_exec(again, "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr);
    sqlite3_close_v2(again);
  }

  void close() {
    for (sqlite3_stmt** statement : {&position_, &motion_, &shape_}) {
      sqlite3_finalize(*statement);
      *statement = nullptr;
    }
    sqlite3_close_v2(database_);
    database_ = nullptr;
  }

  std::string file_;
  sqlite3* database_ = nullptr;
  sqlite3_stmt* position_ = nullptr;
  sqlite3_stmt* motion_ = nullptr;
  sqlite3_stmt* shape_ = nullptr;
  sqlite3_int64 geometry_hash_ = 0;
  int pending_frames_ = 0;
  int64_t pending_rows_ = 0;
};

}  // namespace

std::unique_ptr<TrajectoryWriter> open_sqlite_trajectory(const std::filesystem::path& file) {
  return std::make_unique<SqliteWriter>(file);
}

namespace {

std::unique_ptr<TrajectoryWriter> open_trajectory(const std::filesystem::path& file) {
  if (!is_trajectory_name(file))
    throw InputError("--trajectory", "a name that ends in .sqlite or .csv",
                     fmt::format("'{}'", file.string()));
  return file.extension() == ".csv" ? open_csv_trajectory(file) : open_sqlite_trajectory(file);
}

bool has_area(const std::filesystem::path& file) { return file.extension() == ".sqlite"; }

double heading_rad(const Eigen::Quaternionf& turn) {
  return 2 * std::atan2(static_cast<double>(turn.z()), static_cast<double>(turn.w()));
}

double usual_fps(const Scene& scene) {
  const double recorded_fps = scene.recorded ? scene.recorded->recording->facts().fps : 0;
  return recorded_fps > 0 ? recorded_fps : 10;
}

/// "walkers 7"; for recorded people the number is that of the recording.
std::string name_of(const RunInfo& run, size_t id) {
  const std::string& group = run.groups[run.group_of_avatar[id]];
  if (!run.scene->recorded) return fmt::format("{} {}", group, id);
  const std::vector<RecordedPerson>& people = run.scene->recorded->recording->people();
  return fmt::format("{} {}", group, id < people.size() ? people[id].id : static_cast<int64_t>(id));
}

}  // namespace

bool is_trajectory_name(const std::filesystem::path& file) {
  return file.extension() == ".sqlite" || file.extension() == ".csv";
}

void require_trajectory_area(std::span<const std::filesystem::path> files, const Scene& scene,
                             std::optional<int64_t> piece, std::string_view option) {
  if (std::any_of(files.begin(), files.end(), has_area)) trajectory_area(scene, piece, option);
}

TrajectorySink::TrajectorySink(const TrajectoryOptions& options)
    : options_(options), writer_(open_trajectory(options.file)) {}

void TrajectorySink::begin(const RunInfo& run) {
  const Scene& scene = *run.scene;
  every_ = std::max<int64_t>(
      1, std::llround(1 / (options_.fps.value_or(usual_fps(scene)) * run.step_s)));
  TrajectoryHead head;
  head.fps = 1 / (static_cast<double>(every_) * run.step_s);
  head.bounds = scene.ground;
  head.facts = {{"version", std::string(version())},
                {"commit", std::string(commit())},
                {"scene", scene.name},
                {"seed", fmt::format("{}", scene.seed)},
                {"run_id", fmt::format("{:016x}", run.run_id)},
                {"step_s", fmt::format("{}", run.step_s)}};
  if (has_area(options_.file)) {
    TrajectoryArea area = trajectory_area(scene, options_.piece);
    head.wkt = std::move(area.wkt);
    if (area.pieces > 1)
      head.facts.emplace_back("area", fmt::format("{} of {}", area.piece, area.pieces));
  }
  if (scene.recorded) {
    const RecordingFacts& recorded = scene.recorded->recording->facts();
    head.facts.emplace_back("recording", recorded.kind);
    head.facts.emplace_back("shift_x_m", fmt::format("{}", recorded.shift_m.x()));
    head.facts.emplace_back("shift_y_m", fmt::format("{}", recorded.shift_m.y()));
  }
  for (size_t id = 0; id < run.group_of_avatar.size(); ++id)
    head.people.push_back(name_of(run, id));
  writer_->begin(head);
}

void TrajectorySink::frame(const RunInfo&, const Frame& frame) {
  if (frame.number % every_ != 0) return;
  rows_.clear();
  for (uint32_t id = 0; id < frame.roots.size(); ++id) {
    if (!frame.present.empty() && frame.present[id] == 0) continue;
    const RootPose& root = frame.roots[id];
    rows_.push_back({id, root.position_m.x(), root.position_m.y(),
                     heading_rad(root.world_from_root), static_cast<double>(frame.speeds_mps[id])});
  }
  writer_->frame(frames_++, rows_);
  rows_total_ += static_cast<int64_t>(rows_.size());
}

void TrajectorySink::end(const RunInfo&, const RunEnd&) { writer_->end(); }

}  // namespace throng
