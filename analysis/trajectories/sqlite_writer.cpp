// Trajectories in the SQLite schema of JuPedSim, version 2, the newest that PedPy reads, too;
// heading, speed and names are tables of our own beside it, prefixed throng_.
#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "analysis/trajectories/trajectory_writer.h"
#include "base/errors.h"
#include "base/hasher.h"

namespace throng {
namespace {

/// A transaction is one fsync: at 10 frames a second and 500 people one in 10 s.
constexpr int64_t kRowsATransaction = 50'000;
/// ... but what was recorded a while ago is in the file, however few there are.
constexpr int kFramesATransaction = 100;

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
    // Not as a database yet: what stands there is only lost when the run begins.
    const int descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(std::strerror(errno));
    struct flock lock {};
    lock.l_type = F_WRLCK;
    const bool is_in_use = ::fcntl(descriptor, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
    ::close(descriptor);
    if (is_in_use) fail("another program has it open");
  }
  ~SqliteWriter() override {
    // What is not committed was not promised.
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
    if (pending_frames_ >= kFramesATransaction || pending_rows_ >= kRowsATransaction) commit();
  }

  void end() override {
    commit();
    close();
  }

 private:
  void create() {
    // Emptied, not removed: its owner, its other names and who has locked it stay.
    std::error_code error;
    if (std::filesystem::is_regular_file(file_, error)) {
      std::filesystem::resize_file(file_, 0, error);
      if (error) fail(error.message());
    }
    for (const char* ending : kBesideSqlite) std::filesystem::remove(file_ + ending, error);
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

  /// A write that failed leaves the journal of its transaction beside the file: readers would need
  /// the right to write. The next one who opens it takes the transaction back; that is us.
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

}  // namespace throng
