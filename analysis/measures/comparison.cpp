#include "analysis/measures/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace throng {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Number of columns per line of a block. A column holds A, B and their difference.
constexpr size_t kMaxColumns = 3;

/// True if `a` is the lower range, or is a range and `b` is not.
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

/// Columns of a block, in order of first occurrence.
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
  if (a.method != b.method) text += fmt::format("  A: {}\n  B: {}\n", a.method, b.method);
  if (rows.empty()) return text + "  nothing in either\n";
  const std::vector<Place> places = places_of(rows);
  size_t width = 0;
  for (const Place& place : places) width = std::max(width, place.label.size());
  const auto columns = columns_of(rows);
  for (size_t first = 0; first < columns.size(); first += kMaxColumns)
    text += lines_of(
        places, width,
        {columns.begin() + static_cast<ptrdiff_t>(first),
         columns.begin() + static_cast<ptrdiff_t>(std::min(first + kMaxColumns, columns.size()))});
  return text;
}

std::string facts_of(const std::string& letter, const MeasuredRun& run) {
  std::string text = fmt::format("{}  {}: {} people, {:.1f} s, {:.0f} person-seconds", letter,
                                 run.name, run.facts.people, run.facts.seconds, run.facts.person_s);
  if (run.facts.off_area > 0)
    text += fmt::format("; {} positions of heads are off the ground or in an obstacle",
                        run.facts.off_area);
  return text + "\n";
}

}  // namespace

std::vector<ComparedRow> compared_rows(const MeasureTable& a, const MeasureTable& b) {
  std::vector<ComparedRow> rows;
  for (const MeasureRow& row : a.rows) rows.push_back({row, row.value, kNone});
  size_t after = 0;  // position in the result for rows that only B has
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

namespace {

using Rows = std::vector<ComparedRow>;

std::string data(double value) { return std::isnan(value) ? "NaN" : fmt::format("{:.6g}", value); }

struct Pair {
  const MeasuredRun& a;
  const MeasuredRun& b;
};

/// "A: plaza, 500 people; B: ..."
std::string names_of(const Pair& pair) {
  return fmt::format("A: {}, {} people; B: {}, {} people", pair.a.name, pair.a.facts.people,
                     pair.b.name, pair.b.facts.people);
}

std::string caption_of(const Pair& pair, const MeasureTable& a, const MeasureTable& b) {
  std::string text = names_of(pair) + ". ";
  return text + (a.method == b.method ? a.method : fmt::format("A: {} B: {}", a.method, b.method));
}

std::string title_of(const Pair& pair, const std::string& title) {
  return fmt::format("set title {} noenhanced\nset grid ytics\nset key top right\n",
                     gnuplot_quoted(fmt::format("{}. {}", title, names_of(pair))));
}

std::string colour(int run) { return kFigureColours[run]; }

/// A pair of bars, for A and B, at each selected row.
struct Bars {
  std::string unit;
  std::function<bool(const MeasureRow&)> is_shown;
  std::function<std::string(const MeasureRow&)> label;
  std::string y_label;
  std::string x_label{};
  bool logarithmic = false;
};

/// Returns an empty script if no row is selected.
std::string bars_script(const Rows& rows, const Bars& bars) {
  std::string text = "$data << EOD\n";
  int count = 0;
  std::array<bool, 2> has_any{};
  for (const ComparedRow& each : rows) {
    if (!bars.is_shown(each.row)) continue;
    ++count;
    has_any[0] |= !std::isnan(each.a);
    has_any[1] |= !std::isnan(each.b);
    std::string label = bars.label(each.row);
    std::replace(label.begin(), label.end(), '"', '\'');
    text += fmt::format("\"{}\" {} {}\n", label, data(each.a), data(each.b));
  }
  if (count == 0) return "";
  text += fmt::format(
      "EOD\nset style data histograms\nset style histogram clustered gap 1\nset style fill solid "
      "0.85\nset xtics rotate by {} noenhanced\nset ylabel '{}'\nset xlabel '{}'\n{}\nplot ",
      count > 8 ? -35 : 0, bars.y_label, bars.x_label,
      bars.logarithmic ? "set logscale y" : "set yrange [0:*]");
  // gnuplot rejects a column without a number.
  std::string separator;
  for (size_t run = 0; run < 2; ++run) {
    const char letter = run == 0 ? 'A' : 'B';
    text += separator + (has_any[run] ? fmt::format("$data using {}:xtic(1) linecolor rgb '{}' "
                                                    "title '{}'",
                                                    run + 2, kFigureColours[run], letter)
                                      : fmt::format("keyentry with boxes linecolor rgb '{}' "
                                                    "title '{}: none'",
                                                    kFigureColours[run], letter));
    separator = ", ";
  }
  return text + "\n";
}

/// Means, and bands from the 10 % to the 90 % quantile.
std::string speed_script(const Rows& rows) {
  std::string text;
  for (const bool is_b : {false, true}) {
    text += fmt::format("${} << EOD\n", is_b ? "b" : "a");
    const auto value = [&](const ComparedRow& each) { return is_b ? each.b : each.a; };
    for (const ComparedRow& each : rows) {
      if (each.row.what != "mean" || std::isnan(value(each))) continue;
      double low = value(each), high = low;
      for (const ComparedRow& other : rows) {
        if (other.row.at != each.row.at) continue;
        if (other.row.what == "10 %") low = value(other);
        if (other.row.what == "90 %") high = value(other);
      }
      const double middle = *each.row.from + 0.125;
      text += fmt::format("{} {} {} {}\n", data(middle), data(value(each)), data(low), data(high));
    }
    text += "EOD\n";
  }
  return text +
         fmt::format(
             "set xlabel 'people per m^2'\nset ylabel 'm/s'\nset xrange [0:*]\nset yrange [0:*]\n"
             "plot $a using 1:3:4 with filledcurves fillcolor rgb '{0}' fillstyle transparent "
             "solid 0.15 notitle, $b using 1:3:4 with filledcurves fillcolor rgb '{1}' fillstyle "
             "transparent solid 0.15 notitle, $a using 1:2 with linespoints linewidth 2 pointtype "
             "7 pointsize 0.6 linecolor rgb '{0}' title 'A: mean, 10 to 90 %', $b using 1:2 with "
             "linespoints linewidth 2 pointtype 5 pointsize 0.6 linecolor rgb '{1}' title 'B: "
             "mean, "
             "10 to 90 %'\n",
             colour(0), colour(1));
}

/// Points at 5 % with bars from 1 to 25 %; four points next to each other at each density.
std::string spacing_script(const Rows& rows) {
  std::vector<std::string> places;
  std::string text;
  for (const ComparedRow& each : rows)
    if (std::find(places.begin(), places.end(), each.row.at) == places.end())
      places.push_back(each.row.at);
  const auto block = [&](const std::string& name, bool is_b, const std::string& which,
                         double shift) {
    text += fmt::format("${} << EOD\n", name);
    for (size_t i = 0; i < places.size(); ++i) {
      double values[3] = {NAN, NAN, NAN};
      for (const ComparedRow& each : rows)
        for (int k = 0; k < 3; ++k)
          if (each.row.at == places[i] && each.row.which == which &&
              each.row.what == std::array{"1 %", "5 %", "25 %"}[static_cast<size_t>(k)])
            values[k] = is_b ? each.b : each.a;
      text += fmt::format("{} {} {} {}\n", data(static_cast<double>(i) + shift), data(values[1]),
                          data(values[0]), data(values[2]));
    }
    text += "EOD\n";
  };
  block("a_ahead", false, "ahead", -0.24);
  block("b_ahead", true, "ahead", -0.08);
  block("a_beside", false, "beside", 0.08);
  block("b_beside", true, "beside", 0.24);
  std::string tics;
  for (size_t i = 0; i < places.size(); ++i)
    tics += fmt::format("{}{} {}", i == 0 ? "" : ", ", gnuplot_quoted(places[i]), i);
  const auto plot = [&](const char* name, int run, int point, const char* title) {
    return fmt::format(
        "${} using 1:2:3:4 with yerrorbars linewidth 2 pointtype {} linecolor rgb '{}' title '{}'",
        name, point, colour(run), title);
  };
  return text + fmt::format(
                    "set xtics ({})\nset xrange [-0.5:{}]\nset yrange [0:1.2]\nset key top right "
                    "maxrows 2\nset xlabel 'people per m^2'\nset ylabel 'distance between heads, "
                    "m: 5 "
                    "%, bars 1 to 25 %'\nplot {}, {}, {}, {}\n",
                    tics, static_cast<double>(places.size()) - 0.5,
                    plot("a_ahead", 0, 7, "A ahead"), plot("b_ahead", 1, 7, "B ahead"),
                    plot("a_beside", 0, 6, "A beside"), plot("b_beside", 1, 6, "B beside"));
}

std::string curve_script(const MeasureTable& a, const MeasureTable& b) {
  std::string text;
  for (const auto& [name, table] : {std::pair("a", &a), std::pair("b", &b)}) {
    text += fmt::format("${} << EOD\n", name);
    for (const MeasureCurve& curve : table->curves)
      for (const auto& [x, y] : curve.points) text += fmt::format("{} {}\n", data(x), data(y));
    text +=
        table->curves.empty() || table->curves.front().points.empty() ? "NaN NaN\nEOD\n" : "EOD\n";
  }
  return text + fmt::format(
                    "set xlabel 'cm'\nset ylabel 'share of touching pairs of parts that are "
                    "deeper, %'\n"
                    "set xrange [0:20]\nset yrange [0:100]\nplot $a with lines linewidth 2 "
                    "linecolor rgb '{}' title 'A', $b with lines linewidth 2 linecolor rgb '{}' "
                    "title 'B'\n",
                    colour(0), colour(1));
}

std::string whole_label(const MeasureRow& row) {
  return row.which.empty() ? row.at : row.at + ", " + row.which;
}

/// Bars of a measure without a special figure type.
std::vector<std::pair<std::string, Bars>> bars_of(const std::string& id) {
  const auto what = [](const std::string& name) {
    return [name](const MeasureRow& row) { return row.what == name; };
  };
  const auto is_ranged = [](const MeasureRow& row) { return row.from.has_value(); };
  if (id == "flow") return {{"", {"1/s", what("flow"), whole_label, "people per s"}}};
  if (id == "width_use")
    return {
        {"",
         {"%", what("share"), [](const MeasureRow& row) { return fmt::format("{:g}", *row.from); },
          "share of the time, %", "lanes of 0.5 m from the right edge, m"}}};
  if (id == "sway")
    return {{"_amplitude",
             {"m", [](const MeasureRow& row) { return row.at == "amplitude"; },
              [](const MeasureRow& row) { return row.what; }, "amplitude, m",
              "statistic over "
              "people"}},
            {"_frequency",
             {"Hz", what("frequency"), whole_label, "strides per second", "walking speed, m/s"}}};
  if (id == "accelerations")
    return {{"",
             {"m/s2", [](const MeasureRow&) { return true; },
              [](const MeasureRow& row) { return row.at + ", " + row.what; }, "m/s^2", "", true}}};
  if (id == "contacts")
    return {
        {"",
         {"1/min", [=](const MeasureRow& row) { return row.what == "contacts" && is_ranged(row); },
          whole_label, "contacts per person and minute", "people per m^2"}},
        {"_parts",
         {"1/min",
          [=](const MeasureRow& row) {
            return row.what == "contacts" && !is_ranged(row) && row.at != "all";
          },
          whole_label, "contacts per person and minute"}}};
  if (id == "depth")
    return {{"_parts",
             {"m", [=](const MeasureRow& row) { return row.what == "90 %" && !is_ranged(row); },
              whole_label, "depth that 90 % stay below, m"}}};
  return {};
}

}  // namespace

std::vector<Figure> comparison_figures(const MeasuredRun& run_a, const MeasuredRun& run_b) {
  const Pair pair{run_a, run_b};
  std::vector<Figure> figures;
  for (size_t i = 0; i < run_a.tables.size(); ++i) {
    const MeasureTable& a = run_a.tables[i];
    const MeasureTable& b = run_b.tables[i];
    const Rows rows = compared_rows(a, b);
    if (rows.empty()) continue;
    const auto add = [&](const std::string& ending, const std::string& script) {
      if (!script.empty())
        figures.push_back(
            {a.id + ending, a.title, caption_of(pair, a, b), title_of(pair, a.title) + script});
    };
    if (a.id == "speed_density") add("", speed_script(rows));
    if (a.id == "spacing") add("", spacing_script(rows));
    if (a.id == "depth") add("", curve_script(a, b));
    for (const auto& [ending, bars] : bars_of(a.id)) add(ending, bars_script(rows, bars));
  }
  return figures;
}

}  // namespace throng
