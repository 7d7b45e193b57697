// JupedsimSqlite reads SQLite trajectories of JuPedSim, versions 1 to 3, and of Throng, with
// headings.
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/jupedsim_area.h"
#include "recordings/readers/column_name.h"
#include "recordings/readers/sandboxed_samples.h"

namespace throng {
namespace {

constexpr const char* kExpectedSqlite = "a SQLite database of JuPedSim";

class Statement {
 public:
  Statement(sqlite3* database, const std::string& sql) : database_(database) {
    check(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  bool step() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_DONE && result != SQLITE_ROW) check(result);
    return result == SQLITE_ROW;
  }
  int columns() const { return sqlite3_column_count(statement_); }
  std::string name(int column) const {
    const char* const name = sqlite3_column_name(statement_, column);
    return name != nullptr ? name : "";
  }
  int type(int column) const { return sqlite3_column_type(statement_, column); }
  std::string text(int column) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return text != nullptr ? text : "";
  }
  int64_t whole(int column) const { return sqlite3_column_int64(statement_, column); }
  double number(int column) const { return sqlite3_column_double(statement_, column); }

 private:
  void check(int result) const {
    if (result != SQLITE_OK) throw ParseFailure(kExpectedSqlite, sqlite3_errmsg(database_));
  }

  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
};

/// Runs in the child. The open file is read as it is, without locks, journals or other files.
class Database {
 public:
  explicit Database(const RegularFile& file) {
    const std::string uri = "file:" + path_of(file) + "?immutable=1";
    const int result =
        sqlite3_open_v2(uri.c_str(), &database_,
                        SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    if (result != SQLITE_OK) throw ParseFailure(kExpectedSqlite, sqlite3_errstr(result));
    for (const char* pragma : {"PRAGMA trusted_schema = OFF", "PRAGMA temp_store = MEMORY"})
      sqlite3_exec(database_, pragma, nullptr, nullptr, nullptr);
  }
  ~Database() { sqlite3_close_v2(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  Statement ask(const std::string& sql) const { return {database_, sql}; }
  std::vector<std::string> tables() const {
    std::vector<std::string> out;
    Statement names = ask("SELECT name FROM sqlite_master WHERE type IN ('table', 'view')");
    while (names.step() && out.size() < 100) out.push_back(names.text(0));
    return out;
  }
  std::vector<std::string> columns(const std::string& table) const {
    const Statement all = ask(fmt::format("SELECT * FROM {} LIMIT 0", table));
    std::vector<std::string> out;
    for (int i = 0; i < all.columns(); ++i) out.push_back(all.name(i));
    return out;
  }

 private:
  sqlite3* database_ = nullptr;
};

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string quoted(const std::string& name) {
  std::string out = "\"";
  for (const char c : name) {
    out += c;
    if (c == '"') out += c;
  }
  return out + '"';
}

ParsedFacts facts_of(const Database& database, const std::vector<std::string>& tables,
                     const RecordingOptions& options) {
  ParsedFacts facts;
  std::string unit;
  Statement metadata = database.ask("SELECT key, value FROM metadata");
  while (metadata.step()) {
    const std::string key = lower(trimmed(metadata.text(0))), value = metadata.text(1);
    double number = 0;
    constexpr const char* kFps = "fps in the table metadata";
    if (key == "fps") state_rate(facts.fps, parsed_rate(value, kFps, options), kFps, options);
    if (key == "unit" || key == "units" || key == "length_unit")
      state_unit(unit, bare_unit(value), key + " in the table metadata", options);
    if (key == "version" && !parse_number(trimmed(value), number))
      throw ParseFailure("a number as version in the table metadata", in_quotes(value));
    if (key == "version" && number >= 1 && number < 1000)
      facts.version = static_cast<int64_t>(number);
  }
  facts.units.fill(unit);
  if (!has(tables, "geometry")) return facts;
  Statement count = database.ask("SELECT count(*) FROM geometry");
  if (count.step()) facts.areas = count.whole(0);
  const bool has_frames = has(tables, "frame_data") && has(database.columns("geometry"), "hash");
  Statement area = database.ask(
      has_frames ? "SELECT wkt FROM geometry ORDER BY hash = (SELECT geometry_hash FROM "
                   "frame_data ORDER BY frame LIMIT 1) DESC LIMIT 1"
                 : "SELECT wkt FROM geometry LIMIT 1");
  if (area.step()) facts.wkt = area.text(0);
  return facts;
}

bool is_missing_in(const Statement& row, int column) {
  const int type = row.type(column);
  return type == SQLITE_NULL || (type == SQLITE_TEXT && is_missing(trimmed(row.text(column))));
}

double position_of(const Statement& row, int column) {
  return is_missing_in(row, column) ? std::nan("") : row.number(column);
}

/// Throws unless a column holds a number; positions may be missing.
void expect_number(const Statement& row, int column, bool is_whole, int64_t count) {
  const int type = row.type(column);
  if (!is_whole && is_missing_in(row, column)) return;
  if (type == SQLITE_INTEGER || (type == SQLITE_FLOAT && !is_whole)) return;
  throw ParseFailure(fmt::format("a {}number as {} in row {} of trajectory_data",
                                 is_whole ? "whole " : "", row.name(column), count),
                     type == SQLITE_NULL ? "nothing" : in_quotes(row.text(column)));
}

void parse_database(const RegularFile& file, const RecordingOptions& options,
                    SampleSender& sender) {
  const Database database(file);
  const std::vector<std::string> tables = database.tables();
  if (!has(tables, "trajectory_data") || !has(tables, "metadata"))
    throw ParseFailure(
        "the tables trajectory_data and metadata, as JuPedSim writes them",
        tables.empty() ? "none" : in_quotes(fmt::format("{}", fmt::join(tables, ", "))) + " alone");
  sender.facts(facts_of(database, tables, options));
  const std::vector<std::string> columns = database.columns("trajectory_data");
  for (const char* column : {"frame", "id", "pos_x", "pos_y"})
    if (!has(columns, column))
      throw ParseFailure(fmt::format("a column {} in trajectory_data", column),
                         in_quotes(fmt::format("{}", fmt::join(columns, ", "))));
  // Headings of Throng are as exact as written.
  const bool has_motion = has(tables, "throng_motion");
  const bool has_orientation = !has_motion && has(columns, "ori_x") && has(columns, "ori_y");
  std::string sql = "SELECT t.frame, t.id, t.pos_x, t.pos_y";
  if (has_orientation) sql += ", t.ori_x, t.ori_y";
  if (has_motion) sql += ", m.heading_rad";
  const TableColumns named = columns_by_name(columns, {}, "");
  const std::optional<UnitScale> time = time_scale(named);
  if (time) sql += ", t." + quoted(columns[named[ColumnRole::kTime]]);
  sql += " FROM trajectory_data t";
  if (has_motion) sql += " LEFT JOIN throng_motion m ON m.frame = t.frame AND m.id = t.id";
  Statement rows = database.ask(sql);
  for (int64_t count = 1; rows.step(); ++count) {
    for (const int column : {0, 1}) expect_number(rows, column, true, count);
    for (const int column : {2, 3}) expect_number(rows, column, false, count);
    ParsedSample sample{.id = rows.whole(1),
                        .frame = rows.whole(0),
                        .x = position_of(rows, 2),
                        .y = position_of(rows, 3)};
    if (has_orientation) {
      const double x = rows.number(4), y = rows.number(5);
      // Agents that have not moved have no orientation.
      if (x != 0 || y != 0) sample.heading_rad = static_cast<float>(std::atan2(y, x));
    }
    if (has_motion && rows.type(4) != SQLITE_NULL)
      sample.heading_rad = static_cast<float>(rows.number(4));
    if (const int last = rows.columns() - 1; time && !is_missing_in(rows, last))
      sample.time_s = time->si(rows.number(last));
    sender.sample(sample);
  }
}

class JupedsimSqlite final : public RecordingReader {
 public:
  std::string_view kind() const override { return "JuPedSim SQLite"; }
  bool knows(std::string_view head) const override { return is_sqlite(head); }

  void read(const RecordingSource& source, RecordingBuilder& builder) const override {
    reject_packed(source, *this);
    reject_unfinished_database(source.file().path());
    const SandboxedKind foreign{.parser = {.library = "SQLite",
                                           .expected = kExpectedSqlite,
                                           .remedy = "try `sqlite3 FILE .recover`"},
                                .kind = kind()};
    read_sandboxed(source, foreign, parse_database, builder);
  }
};

}  // namespace

bool is_sqlite(std::string_view head) {
  return head.starts_with(std::string_view("SQLite format 3\0", 16));
}

StatedArea parse_stated_area(const RegularFile& file) {
  const Database database(file);
  const std::vector<std::string> tables = database.tables();
  for (const char* table : {"geometry", "metadata"})
    if (!has(tables, table))
      throw ParseFailure("the tables geometry and metadata, as JuPedSim writes them",
                         tables.empty()
                             ? "none"
                             : in_quotes(fmt::format("{}", fmt::join(tables, ", "))) + " alone");
  // An area has no frame rate: a rate that is not understood does not matter.
  const ParsedFacts facts = facts_of(database, tables, {.fps = 1});
  return {facts.wkt, facts.areas, facts.units[0]};
}

void reject_unfinished_database(const std::filesystem::path& file) {
  for (const char* ending : {"-wal", "-journal"}) {
    std::filesystem::path journal = file;
    journal += ending;
    std::error_code error;
    const auto size = std::filesystem::file_size(journal, error);
    if (!error && size > 0)
      throw InputError(file.string(), "a database that is closed",
                       fmt::format("the file {}; end the program that writes it, or run "
                                   "`sqlite3 {} 'PRAGMA journal_mode = DELETE'`",
                                   journal.filename().string(), file.string()));
  }
}

const RecordingReader& jupedsim_sqlite_reader() {
  static const JupedsimSqlite reader;
  return reader;
}

}  // namespace throng
