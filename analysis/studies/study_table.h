// The table of a study's runs, its pictures, and its database.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/figure.h"

namespace throng {

// The table of a study: a row a run, as CSV or as SQLite.
// Cells are text until the file is written, rows lie in the order of their runs, and
// equal rows make equal bytes, whoever made them.

struct StudyTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;

  /// npos if there is none.
  size_t column(std::string_view name) const;
};

/// A line of comma-separated values (RFC 4180), without its end.
std::string csv_line(const std::vector<std::string>& cells);
/// All lines; `where` names the text in errors. Throws InputError if a row has other cells than the
/// first.
StudyTable parse_csv(std::string_view text, const std::string& where);
std::string csv_text(const StudyTable& table);

/// ".csv" or ".sqlite", by the name. Throws InputError for another one.
enum class TableKind { kCsv, kSqlite };
TableKind table_kind(const std::filesystem::path& file);

/// Replaces the file. Columns of numbers are numbers in SQLite, table `runs`. Throws
/// EnvironmentError.
void write_table(const std::filesystem::path& file, const StudyTable& table);
/// Throws InputError.
StudyTable read_table(const std::filesystem::path& file);

/// Rows of several tables of one study, each run once, all of them there. Throws InputError.
StudyTable merged(const std::vector<std::pair<std::string, StudyTable>>& tables);

// Tables of studies as SQLite databases.
// A database is made in memory, so that equal rows make equal bytes, and read in a
// process of its own.

std::vector<uint8_t> sqlite_bytes(const StudyTable& table);
/// Table `runs` as CSV. Throws InputError.
std::string csv_of_sqlite(const std::filesystem::path& file);

// Pictures of a study: each measured column against each parameter.
// A column that is the same in all runs has no picture; every run is a point, and their
// mean stands with one standard deviation to either side.

/// "people_by_avatars", ... A curve a scene.
std::vector<Figure> study_figures(const StudyTable& table);

}  // namespace throng
