// StudyTable holds a study's results; this file also reads, writes, merges and plots tables.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/figure.h"

namespace throng {

/// Table with one row per run, written as CSV or SQLite.
/// Invariant: rows are in the order of their runs, and equal rows give equal bytes.
struct StudyTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;

  /// Index of a column; npos if there is none.
  size_t column(std::string_view name) const;
};

/// A line of comma-separated values (RFC 4180), without a line end.
std::string csv_line(const std::vector<std::string>& cells);
/// Parses CSV text; `where` names it in errors. Throws InputError if rows differ in their number of
/// cells.
StudyTable parse_csv(std::string_view text, const std::string& where);
std::string csv_text(const StudyTable& table);

/// Kind of a table by its extension, .csv or .sqlite. Throws InputError for other extensions.
enum class TableKind { kCsv, kSqlite };
TableKind table_kind(const std::filesystem::path& file);

/// Writes the table, replacing the file. SQLite has one table `runs`, with numeric columns where
/// all cells are numbers. Throws EnvironmentError.
void write_table(const std::filesystem::path& file, const StudyTable& table);
/// Reads a table from either format. Throws InputError.
StudyTable read_table(const std::filesystem::path& file);

/// Merges tables of one study. Throws InputError unless each of its runs occurs.
StudyTable merged(const std::vector<std::pair<std::string, StudyTable>>& tables);

/// The table as a SQLite database, built in memory: equal rows give equal bytes.
std::vector<uint8_t> sqlite_bytes(const StudyTable& table);

/// Table `runs` of a SQLite file as CSV, read in a separate process. Throws InputError.
std::string csv_of_sqlite(const std::filesystem::path& file);

/// Figures "people_by_avatars", ...: each measured column that varies against each parameter. They
/// show one point per run, means with one standard deviation, and one curve per scene.
std::vector<Figure> study_figures(const StudyTable& table);

}  // namespace throng
