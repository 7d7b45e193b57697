#include "analysis/studies/study_sqlite.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>

#include "analysis/studies/study_run.h"
#include "analysis/studies/study_table.h"
#include "base/errors.h"
#include "base/files/foreign.h"

namespace throng {
namespace {

using Kind = StudyMeasure::Kind;

template <typename Number>
bool is_number(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Of a measure as it says, of all else by what stands there.
Kind kind_of(const StudyTable& table, size_t column) {
  const std::string& name = table.columns[column];
  if (name == "study" || name == "scene") return Kind::kText;
  for (const StudyMeasure& measure : study_measures())
    if (measure.name == name) return measure.kind;
  const auto all = [&](const auto& is_one) {
    return std::all_of(table.rows.begin(), table.rows.end(),
                       [&](const auto& row) { return row[column].empty() || is_one(row[column]); });
  };
  if (all(is_number<int64_t>)) return Kind::kWhole;
  return all(is_number<double>) ? Kind::kNumber : Kind::kText;
}

/// What goes wrong in memory is its lack.
void require(bool done, sqlite3* database) {
  if (!done)
    throw EnvironmentError(
        fmt::format("SQLite: cannot make the table: {}",
                    database != nullptr ? sqlite3_errmsg(database) : "no memory"));
}

std::string in_sql(const std::string& name) {
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

void bind(sqlite3_stmt* statement, int at, Kind kind, const std::string& cell) {
  if (cell.empty() && kind != Kind::kText) {
    sqlite3_bind_null(statement, at);
  } else if (kind == Kind::kWhole) {
    int64_t value = 0;
    std::from_chars(cell.data(), cell.data() + cell.size(), value);
    sqlite3_bind_int64(statement, at, value);
  } else if (kind == Kind::kNumber) {
    double value = 0;
    std::from_chars(cell.data(), cell.data() + cell.size(), value);
    sqlite3_bind_double(statement, at, value);
  } else {
    sqlite3_bind_text(statement, at, cell.data(), static_cast<int>(cell.size()), SQLITE_TRANSIENT);
  }
}

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

Statement prepare(sqlite3* database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr);
  return {statement, sqlite3_finalize};
}

void fill(sqlite3* database, const StudyTable& table) {
  std::string columns, places;
  std::vector<Kind> kinds;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    kinds.push_back(kind_of(table, i));
    const char* const type = kinds[i] == Kind::kWhole    ? "INTEGER"
                             : kinds[i] == Kind::kNumber ? "REAL"
                                                         : "TEXT";
    columns += fmt::format("{}{} {}", i > 0 ? ", " : "", in_sql(table.columns[i]), type);
    places += i > 0 ? ", ?" : "?";
  }
  const std::string create = fmt::format("CREATE TABLE runs({})", columns);
  require(sqlite3_exec(database, create.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK, database);
  sqlite3_exec(database, "BEGIN", nullptr, nullptr, nullptr);
  const Statement insert = prepare(database, fmt::format("INSERT INTO runs VALUES({})", places));
  require(insert != nullptr, database);
  for (const std::vector<std::string>& row : table.rows) {
    for (size_t i = 0; i < row.size(); ++i)
      bind(insert.get(), static_cast<int>(i) + 1, kinds[i], row[i]);
    require(sqlite3_step(insert.get()) == SQLITE_DONE, database);
    sqlite3_reset(insert.get());
  }
  require(sqlite3_exec(database, "COMMIT", nullptr, nullptr, nullptr) == SQLITE_OK, database);
}

/// In the child. A number with a point keeps it, so that its column stays one of such numbers.
std::string text_at(sqlite3_stmt* statement, int column) {
  if (sqlite3_column_type(statement, column) == SQLITE_FLOAT) {
    const std::string text = fmt::format("{}", sqlite3_column_double(statement, column));
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  }
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? "" : text;
}

std::vector<uint8_t> csv_in_child(const RegularFile& file) {
  constexpr const char* kExpected = "a SQLite table that `throng study` wrote";
  sqlite3* opened = nullptr;
  const std::string name = fmt::format("file:/proc/self/fd/{}?immutable=1", file.descriptor());
  sqlite3_open_v2(name.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  const Database database(opened, sqlite3_close_v2);
  const Statement select = prepare(opened, "SELECT * FROM runs ORDER BY rowid");
  if (select == nullptr) throw Refusal(kExpected, sqlite3_errmsg(opened));
  StudyTable table;
  for (int i = 0; i < sqlite3_column_count(select.get()); ++i)
    table.columns.emplace_back(sqlite3_column_name(select.get(), i));
  int result = SQLITE_ROW;
  while ((result = sqlite3_step(select.get())) == SQLITE_ROW) {
    std::vector<std::string>& row = table.rows.emplace_back();
    for (int i = 0; i < static_cast<int>(table.columns.size()); ++i)
      row.push_back(text_at(select.get(), i));
  }
  if (result != SQLITE_DONE) throw Refusal(kExpected, sqlite3_errmsg(opened));
  const std::string text = csv_text(table);
  return {text.begin(), text.end()};
}

}  // namespace

std::vector<uint8_t> sqlite_bytes(const StudyTable& table) {
  sqlite3* opened = nullptr;
  const bool is_open = sqlite3_open(":memory:", &opened) == SQLITE_OK;
  const Database database(opened, sqlite3_close_v2);
  require(is_open, opened);
  fill(opened, table);
  sqlite3_int64 size = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> bytes(
      sqlite3_serialize(opened, "main", &size, 0), sqlite3_free);
  require(bytes != nullptr, opened);
  return {bytes.get(), bytes.get() + size};
}

std::string csv_of_sqlite(const std::filesystem::path& file) {
  const std::vector<uint8_t> text = parse_apart(
      file, {"SQLite", "a table of a study", "make it again, or as .csv"}, {}, csv_in_child);
  return {text.begin(), text.end()};
}

}  // namespace throng
