#include "analysis/measures/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace throng {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Columns of one line of a block: what is said of each place, of A, of B and their difference.
constexpr size_t kMostColumns = 3;

/// A range below another; or any range, where what follows is of all.
bool is_before(const MeasureRow& a, const MeasureRow& b) {
  return a.from && (!b.from || *a.from < *b.from);
}

std::string number(const std::string& unit, double value, bool with_sign) {
  if (std::isnan(value)) return "-";
  int digits = 2;
  if (unit.empty() || unit == "person s") digits = 0;
  if (unit == "m") digits = 3;
  if (unit == "%") digits = 1;
  return with_sign ? fmt::format("{:+.{}f}", value, digits) : fmt::format("{:.{}f}", value, digits);
}

/// Rows at one place, in their order.
struct Place {
  std::string label;
  std::vector<const ComparedRow*> rows;
};

std::vector<Place> places_of(const std::vector<ComparedRow>& rows) {
  std::vector<Place> places;
  for (const ComparedRow& each : rows) {
    std::string label = each.row.at;
    if (!each.row.which.empty()) label += fmt::format(", {}", each.row.which);
    if (places.empty() || places.back().label != label) places.push_back({label, {}});
    places.back().rows.push_back(&each);
  }
  return places;
}

/// What is said of places, in the order in which it first comes.
std::vector<std::pair<std::string, std::string>> columns_of(const std::vector<ComparedRow>& rows) {
  std::vector<std::pair<std::string, std::string>> columns;
  for (const ComparedRow& each : rows) {
    const std::pair column(each.row.what, each.row.unit);
    if (std::find(columns.begin(), columns.end(), column) == columns.end())
      columns.push_back(column);
  }
  return columns;
}

std::string lines_of(const std::vector<Place>& places, size_t width,
                     const std::vector<std::pair<std::string, std::string>>& columns) {
  std::string head(width + 2, ' '), names(width + 2, ' ');
  for (const auto& [what, unit] : columns) {
    head += fmt::format("  {:^29}", unit.empty() ? what : fmt::format("{}, {}", what, unit));
    names += fmt::format("  {:>9} {:>9} {:>9}", "A", "B", "B - A");
  }
  std::string text;
  for (const Place& place : places) {
    std::string line = fmt::format("  {:<{}}", place.label, width);
    bool has_any = false;
    for (const auto& [what, unit] : columns) {
      double a = kNone, b = kNone;
      for (const ComparedRow* each : place.rows)
        if (each->row.what == what) {
          a = each->a;
          b = each->b;
        }
      has_any |= !std::isnan(a) || !std::isnan(b);
      line += fmt::format("  {:>9} {:>9} {:>9}", number(unit, a, false), number(unit, b, false),
                          number(unit, b - a, true));
    }
    if (has_any) text += fmt::format("{}\n", line);
  }
  return fmt::format("{}\n{}\n{}", head, names, text);
}

std::string block_of(const MeasureTable& a, const MeasureTable& b) {
  const std::vector<ComparedRow> rows = compared_rows(a, b);
  std::string text = fmt::format("{}", a.title);
  if (!a.key_unit.empty() && std::any_of(rows.begin(), rows.end(), [](const ComparedRow& r) {
        return r.row.from && r.row.to;
      }))
    text += fmt::format(" ({})", a.key_unit);
  text += "\n";
  if (a.how != b.how) text += fmt::format("  A: {}\n  B: {}\n", a.how, b.how);
  if (rows.empty()) return text + "  nothing in either\n";
  const std::vector<Place> places = places_of(rows);
  size_t width = 0;
  for (const Place& place : places) width = std::max(width, place.label.size());
  const auto columns = columns_of(rows);
  for (size_t first = 0; first < columns.size(); first += kMostColumns)
    text += lines_of(
        places, width,
        {columns.begin() + static_cast<ptrdiff_t>(first),
         columns.begin() + static_cast<ptrdiff_t>(std::min(first + kMostColumns, columns.size()))});
  return text;
}

std::string facts_of(const std::string& letter, const MeasuredRun& run) {
  std::string text = fmt::format("{}  {}: {} people, {:.1f} s, {:.0f} person-seconds", letter,
                                 run.name, run.facts.people, run.facts.seconds, run.facts.person_s);
  if (run.facts.off_area > 0)
    text += fmt::format("; {} times a head was off the area or in an obstacle", run.facts.off_area);
  return text + "\n";
}

}  // namespace

std::vector<ComparedRow> compared_rows(const MeasureTable& a, const MeasureTable& b) {
  std::vector<ComparedRow> rows;
  for (const MeasureRow& row : a.rows) rows.push_back({row, row.value, kNone});
  size_t after = 0;  // where what stands next in B goes, if A has none
  for (const MeasureRow& row : b.rows) {
    const auto same = std::find_if(rows.begin(), rows.end(),
                                   [&](const ComparedRow& each) { return each.row.matches(row); });
    if (same != rows.end()) {
      same->b = row.value;
      after = static_cast<size_t>(same - rows.begin()) + 1;
      continue;
    }
    while (after < rows.size() && is_before(rows[after].row, row)) ++after;
    rows.insert(rows.begin() + static_cast<ptrdiff_t>(after), {row, kNone, row.value});
    ++after;
  }
  return rows;
}

std::string comparison_text(const MeasuredRun& a, const MeasuredRun& b) {
  std::string text = facts_of("A", a) + facts_of("B", b);
  for (size_t i = 0; i < a.tables.size(); ++i)
    text += fmt::format("\n{}", block_of(a.tables[i], b.tables[i]));
  return text;
}

}  // namespace throng
