#include "analysis/studies/study_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/studies/study.h"
#include "analysis/studies/study_sqlite.h"
#include "base/errors.h"
#include "base/files/regular_file.h"
#include "base/files/whole_file.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr uint64_t kMostTableBytes = uint64_t{1} << 32;

std::string field(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// The cells of one row; moves `text` behind its end.
std::vector<std::string> take_row(std::string_view& text, const std::string& where) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  size_t at = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c != '"') {
        cells.back() += c;
      } else if (at + 1 < text.size() && text[at + 1] == '"') {
        cells.back() += text[++at];
      } else {
        quoted = false;
      }
    } else if (c == '"' && cells.back().empty()) {
      quoted = true;
    } else if (c == ',') {
      cells.emplace_back();
    } else if (c == '\n') {
      break;
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  if (quoted) throw InputError(where, "a quote that ends", "the end of the text");
  text.remove_prefix(std::min(at + 1, text.size()));
  return cells;
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::optional<size_t> whole_from(const std::string& text) {
  size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

/// What rows of one study share.
struct Whole {
  std::string study;
  size_t runs = 0;
};

/// Where a row belongs.
size_t run_of(const StudyTable& table, const std::vector<std::string>& row, const std::string& name,
              size_t runs) {
  const std::string& cell = row[table.column("run")];
  const std::optional<size_t> run = whole_from(cell);
  if (!run || *run < 1 || *run > runs)
    throw InputError(name, fmt::format("runs from 1 to {}", runs), in_quotes(cell));
  return *run - 1;
}

void require_study(const std::string& name, const StudyTable& table) {
  for (const char* column : {"run", "runs", "study"})
    if (table.column(column) == std::string::npos)
      throw InputError(name, "a table that `throng study` wrote",
                       fmt::format("one without the column '{}'", column));
}

}  // namespace

size_t StudyTable::column(std::string_view name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? std::string::npos : static_cast<size_t>(found - columns.begin());
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) line += ',';
    line += field(cells[i]);
  }
  return line;
}

std::string csv_text(const StudyTable& table) {
  std::string text = csv_line(table.columns) + "\n";
  for (const std::vector<std::string>& row : table.rows) text += csv_line(row) + "\n";
  return text;
}

StudyTable parse_csv(std::string_view text, const std::string& where) {
  if (text.empty()) throw InputError(where, "a table", "an empty file");
  if (find_no_utf8(text) != std::string::npos)
    throw InputError(where, "text in UTF-8", "other bytes");
  StudyTable table;
  table.columns = take_row(text, where);
  while (!text.empty()) {
    std::vector<std::string> row = take_row(text, where);
    if (row.size() != table.columns.size())
      throw InputError(at_line(where, static_cast<int>(table.rows.size()) + 2),
                       fmt::format("{} cells, as in the first line", table.columns.size()),
                       fmt::format("{}", row.size()));
    table.rows.push_back(std::move(row));
  }
  return table;
}

TableKind table_kind(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".csv") return TableKind::kCsv;
  if (extension == ".sqlite") return TableKind::kSqlite;
  throw InputError("--out", "a table that ends in .csv or .sqlite",
                   fmt::format("'{}'", file.string()));
}

void write_table(const std::filesystem::path& file, const StudyTable& table) {
  if (table_kind(file) == TableKind::kCsv)
    write_whole_file(file, csv_text(table), {.what = "the table"});
  else
    write_whole_file(file, sqlite_bytes(table), {.what = "the table"});
}

StudyTable read_table(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".sqlite") return parse_csv(csv_of_sqlite(file), file.string());
  const RegularFile opened(file, "a table of a study", kMostTableBytes);
  const std::vector<uint8_t> bytes = opened.bytes();
  return parse_csv({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

StudyTable merged(const std::vector<std::pair<std::string, StudyTable>>& tables) {
  StudyTable all;
  Whole whole;
  std::vector<const std::string*> from;  // by run: the table it is from
  for (const auto& [name, table] : tables) {
    require_study(name, table);
    if (table.rows.empty()) continue;
    if (all.columns.empty()) {
      all.columns = table.columns;
      whole.study = table.rows.front()[table.column("study")];
      const std::optional<size_t> runs = whole_from(table.rows.front()[table.column("runs")]);
      if (!runs || *runs < 1 || *runs > kMaxStudyRuns)
        throw InputError(name, fmt::format("a number of runs from 1 to {}", kMaxStudyRuns),
                         in_quotes(table.rows.front()[table.column("runs")]));
      whole.runs = *runs;
      all.rows.resize(whole.runs);
      from.resize(whole.runs, nullptr);
    }
    for (const std::vector<std::string>& row : table.rows) {
      if (table.columns != all.columns || row[table.column("study")] != whole.study)
        throw InputError(name, fmt::format("runs of study {}, as in the first table", whole.study),
                         fmt::format("those of {}", row[table.column("study")]));
      const size_t run = run_of(table, row, name, whole.runs);
      if (from[run] != nullptr && all.rows[run] != row)
        throw InputError(name, fmt::format("run {} as in {}", run + 1, *from[run]),
                         "another result");
      from[run] = &name;
      all.rows[run] = row;
    }
  }
  if (all.columns.empty()) throw InputError("--merge", "tables with runs", "none");
  const auto missing = std::find(from.begin(), from.end(), nullptr);
  if (missing != from.end())
    throw InputError(
        "--merge", fmt::format("all {} runs of the study", whole.runs),
        fmt::format("{} missing, run {} the first of them",
                    std::count(from.begin(), from.end(), nullptr), missing - from.begin() + 1));
  return all;
}

}  // namespace throng
