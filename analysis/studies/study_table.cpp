#include "analysis/studies/study_table.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "analysis/studies/study.h"
#include "analysis/studies/study_run.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "base/files/regular_file.h"
#include "base/files/sandboxed_parser.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr uint64_t kMaxTableBytes = uint64_t{1} << 32;

std::string field(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// Parses the cells of one row and moves `text` past it.
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

std::optional<size_t> integer_from(const std::string& text) {
  size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

struct TableCheck {
  std::string study;
  size_t runs = 0;
};

size_t run_of(const StudyTable& table, const std::vector<std::string>& row, const std::string& name,
              size_t runs) {
  const std::string& cell = row[table.column("run")];
  const std::optional<size_t> run = integer_from(cell);
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
  if (find_invalid_utf8(text) != std::string::npos)
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
    write_file_atomically(file, csv_text(table), {.what = "the table"});
  else
    write_file_atomically(file, sqlite_bytes(table), {.what = "the table"});
}

StudyTable read_table(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".sqlite") return parse_csv(csv_of_sqlite(file), file.string());
  const RegularFile opened(file, "a table of a study", kMaxTableBytes);
  const std::vector<uint8_t> bytes = opened.bytes();
  return parse_csv({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
}

StudyTable merged(const std::vector<std::pair<std::string, StudyTable>>& tables) {
  StudyTable all;
  TableCheck check;
  std::vector<const std::string*> from;  // by run: name of its table; null: missing
  for (const auto& [name, table] : tables) {
    require_study(name, table);
    if (table.rows.empty()) continue;
    if (all.columns.empty()) {
      all.columns = table.columns;
      check.study = table.rows.front()[table.column("study")];
      const std::optional<size_t> runs = integer_from(table.rows.front()[table.column("runs")]);
      if (!runs || *runs < 1 || *runs > kMaxStudyRuns)
        throw InputError(name, fmt::format("a number of runs from 1 to {}", kMaxStudyRuns),
                         in_quotes(table.rows.front()[table.column("runs")]));
      check.runs = *runs;
      all.rows.resize(check.runs);
      from.resize(check.runs, nullptr);
    }
    for (const std::vector<std::string>& row : table.rows) {
      if (table.columns != all.columns || row[table.column("study")] != check.study)
        throw InputError(name, fmt::format("runs of study {} as in the first table", check.study),
                         fmt::format("those of {}", row[table.column("study")]));
      const size_t run = run_of(table, row, name, check.runs);
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
        "--merge", fmt::format("all {} runs of the study", check.runs),
        fmt::format("{} missing, the first is run {}",
                    std::count(from.begin(), from.end(), nullptr), missing - from.begin() + 1));
  return all;
}

namespace {

using Kind = StudyMeasure::Kind;

template <typename Number>
bool is_number(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Kind of a measured column; for other columns the kind that all cells have.
Kind kind_of(const StudyTable& table, size_t column) {
  const std::string& name = table.columns[column];
  if (name == "study" || name == "scene") return Kind::kText;
  for (const StudyMeasure& measure : study_measures())
    if (measure.name == name) return measure.kind;
  const auto all = [&](const auto& is_one) {
    return std::all_of(table.rows.begin(), table.rows.end(),
                       [&](const auto& row) { return row[column].empty() || is_one(row[column]); });
  };
  if (all(is_number<int64_t>)) return Kind::kInteger;
  return all(is_number<double>) ? Kind::kNumber : Kind::kText;
}

/// Throws if a step failed. In-memory databases fail only for lack of memory.
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
  } else if (kind == Kind::kInteger) {
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
    const char* const type = kinds[i] == Kind::kInteger  ? "INTEGER"
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

/// Runs in the child. Numbers with a decimal point keep it, to keep the kind of their column.
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
  if (select == nullptr) throw ParseFailure(kExpected, sqlite3_errmsg(opened));
  StudyTable table;
  for (int i = 0; i < sqlite3_column_count(select.get()); ++i)
    table.columns.emplace_back(sqlite3_column_name(select.get(), i));
  int result = SQLITE_ROW;
  while ((result = sqlite3_step(select.get())) == SQLITE_ROW) {
    std::vector<std::string>& row = table.rows.emplace_back();
    for (int i = 0; i < static_cast<int>(table.columns.size()); ++i)
      row.push_back(text_at(select.get(), i));
  }
  if (result != SQLITE_DONE) throw ParseFailure(kExpected, sqlite3_errmsg(opened));
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
  const std::vector<uint8_t> text = parse_sandboxed(
      file, {"SQLite", "a table of a study", "make it again, or as .csv"}, {}, csv_in_child);
  return {text.begin(), text.end()};
}

namespace {

constexpr size_t kFirstParameter = 5;  // after run, runs, study, scene, seed

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

bool varies(const StudyTable& table, size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [&](const auto& row) { return row[column] != table.rows.front()[column]; });
}

/// Columns for the x axis: parameters that vary, or the scene if none varies.
std::vector<size_t> abscissas(const StudyTable& table) {
  std::vector<size_t> out;
  const size_t end = std::min(table.column(study_measures().front().name), table.columns.size());
  for (size_t i = kFirstParameter; i < end; ++i)
    if (varies(table, i)) out.push_back(i);
  const size_t scene = table.column("scene");
  if (out.empty() && varies(table, scene)) out.push_back(scene);
  return out;
}

struct Group {
  std::vector<double> values;
  double mean() const {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  double deviation() const {
    if (values.size() < 2) return 0;
    double sum = 0;
    for (const double value : values) sum += (value - mean()) * (value - mean());
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
  }
};

/// Positions of a column's values along x: numbers as they are, words at 0, 1, 2, ...
class Axis {
 public:
  Axis(const StudyTable& table, size_t column) : column_(column) {
    for (const auto& row : table.rows) {
      if (!number_of(row[column])) is_numeric_ = false;
      if (std::find(words_.begin(), words_.end(), row[column]) == words_.end())
        words_.push_back(row[column]);
    }
  }
  double at(const std::vector<std::string>& row) const {
    if (is_numeric_) return *number_of(row[column_]);
    return static_cast<double>(std::find(words_.begin(), words_.end(), row[column_]) -
                               words_.begin());
  }
  std::string script() const {
    if (is_numeric_) return "";
    std::string ticks;
    for (size_t i = 0; i < words_.size(); ++i)
      append(ticks, "{}{} {}", i > 0 ? ", " : "", gnuplot_quoted(words_[i]), i);
    return fmt::format("set xtics ({}) noenhanced\nset xrange [-0.5:{}]\n", ticks,
                       static_cast<double>(words_.size()) - 0.5);
  }

 private:
  size_t column_;
  bool is_numeric_ = true;
  std::vector<std::string> words_;
};

struct Series {
  std::string scene;
  std::vector<std::pair<double, double>> points;
  std::map<double, Group> groups;
};

std::vector<Series> series_of(const StudyTable& table, const Axis& axis, size_t measure,
                              bool by_scene) {
  std::vector<Series> all;
  for (const auto& row : table.rows) {
    const std::optional<double> value = number_of(row[measure]);
    if (!value) continue;
    const std::string& scene = row[table.column("scene")];
    auto found = std::find_if(all.begin(), all.end(), [&](const Series& series) {
      return !by_scene || series.scene == scene;
    });
    if (found == all.end()) found = all.insert(all.end(), Series{by_scene ? scene : "", {}, {}});
    found->points.emplace_back(axis.at(row), *value);
    found->groups[axis.at(row)].values.push_back(*value);
  }
  return all;
}

/// True if runs share x values, which makes mean and spread meaningful.
bool has_groups(const Series& series) {
  return series.points.size() >= 2 * series.groups.size() || series.groups.size() <= 12;
}

Figure figure_of(const StudyTable& table, size_t along, size_t measure) {
  const Axis axis(table, along);
  const bool by_scene = along != table.column("scene") && varies(table, table.column("scene"));
  const std::vector<Series> all = series_of(table, axis, measure, by_scene);
  const std::string& name = table.columns[measure];
  Figure figure;
  figure.id = fmt::format("{}_by_{}", name, table.columns[along]);
  std::replace_if(
      figure.id.begin(), figure.id.end(),
      [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-';
      },
      '_');
  figure.title = fmt::format("{} against {}", name, table.columns[along]);
  std::string& script = figure.script;
  append(
      script,
      "set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\n"
      "set grid ytics lc rgb '#dddddd'\nset key outside right noenhanced\nset offsets graph 0.05, "
      "graph 0.05, graph 0.05, graph 0.05\n{}",
      gnuplot_quoted(figure.title), gnuplot_quoted(table.columns[along]), gnuplot_quoted(name),
      axis.script());
  std::string plot;
  for (size_t i = 0; i < all.size(); ++i) {
    append(script, "$runs{} << EOD\n", i);
    for (const auto& [x, y] : all[i].points) append(script, "{:.9g} {:.9g}\n", x, y);
    append(script, "EOD\n$means{} << EOD\n", i);
    for (const auto& [x, group] : all[i].groups)
      append(script, "{:.9g} {:.9g} {:.9g}\n", x, group.mean(), group.deviation());
    script += "EOD\n";
    const char* const colour = kFigureColours[i % std::size(kFigureColours)];
    append(plot, "{}$runs{} with points pt 7 ps 0.35 lc rgb '{}' title {}", i > 0 ? ", " : "", i,
           colour, gnuplot_quoted(all[i].scene.empty() ? "a run" : all[i].scene));
    if (has_groups(all[i]))
      append(plot,
             ", $means{} with yerrorlines pt 6 lc rgb '{}' title 'mean and standard "
             "deviation'",
             i, colour);
  }
  append(script, "plot {}\n", plot);
  return figure;
}

}  // namespace

std::vector<Figure> study_figures(const StudyTable& table) {
  std::vector<Figure> figures;
  if (table.rows.empty()) return figures;
  for (const size_t along : abscissas(table))
    for (const StudyMeasure& measure : study_measures()) {
      const size_t column = table.column(measure.name);
      if (measure.kind == StudyMeasure::Kind::kText || column == std::string::npos ||
          !varies(table, column))
        continue;
      figures.push_back(figure_of(table, along, column));
      figures.back().caption = measure.meaning;
    }
  return figures;
}

}  // namespace throng
