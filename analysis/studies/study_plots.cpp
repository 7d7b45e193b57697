#include "analysis/studies/study_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "analysis/studies/study_run.h"
#include "base/append.h"

namespace throng {
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

/// What is drawn along x: parameters that vary, or the scenes where none does.
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

/// Where the values of a column lie along x: numbers where they are, words one after another.
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
      append(ticks, "{}{} {}", i > 0 ? ", " : "", figure_text(words_[i]), i);
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

/// Whether enough runs share a place to tell their mean and spread.
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
      figure_text(figure.title), figure_text(table.columns[along]), figure_text(name),
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
           colour, figure_text(all[i].scene.empty() ? "a run" : all[i].scene));
    if (has_groups(all[i]))
      append(plot, ", $means{} with yerrorlines pt 6 lc rgb '{}' title 'mean and deviation'", i,
             colour);
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
