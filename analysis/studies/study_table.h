// The table of a study: a row a run, as CSV or as SQLite.
// One rule: cells are text until the file is written, rows lie in the order of their runs, and
// equal rows make equal bytes, whoever made them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

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

}  // namespace throng
