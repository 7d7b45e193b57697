#include "analysis/by_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "base/errors.h"
#include "base/files/atomic_file.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr const char* kTable = "part_pairs.csv";
constexpr const char* kFigures[] = {"by_part_boxes", "by_part_volumes"};
constexpr const char* kObstacle = "obstacle";
constexpr const char* kWhole = "whole body";

/// Part names of all body types; an obstacle counts as one part.
class Names {
 public:
  explicit Names(const RunInfo& run) : run_(run) {}

  size_t of(size_t type, size_t part) {
    const std::string name =
        type < run_.models.size() ? run_.models[type]->parts[part].name : kObstacle;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<size_t>(found - names.begin());
    names.push_back(name);
    return names.size() - 1;
  }
  VolumeKind volume(size_t type, size_t part) const {
    const PartVolumes& volumes = run_.scene->part_volume;
    return type < run_.models.size() ? volumes.of(run_.models[type]->parts[part].name)
                                     : volumes.fallback;
  }
  std::vector<std::string> names;

 private:
  const RunInfo& run_;
};

void add_sum(StageCounters& sum, const StageCounters& frame) {
  sum.volume = frame.volume;
  sum.tests += frame.tests;
  sum.passed += frame.passed;
}

/// Heat maps side by side, each showing both triangles of a matrix.
class Panels {
 public:
  explicit Panels(const PartNameTally& tally) : tally_(tally) {}

  template <typename Value>
  void add(const std::string& title, const char* expression, const char* label,
           const Value& value) {
    const size_t count = tally_.names.size();
    HeatMap map{.names = display_name(tally_.names),
                .values = {},
                .using_expression = expression,
                .label = label,
                .margins = margins()};
    for (size_t row = 0; row < count; ++row)
      for (size_t column = 0; column < count; ++column)
        map.values.push_back(value(tally_.at(std::min(row, column), std::max(row, column))));
    script_ += fmt::format("set title '{}'\n", title) + gnuplot_script(map);
    ++panels_;
  }
  Figure figure(const char* id, const char* title) const {
    const char* const font = tally_.names.size() > kMany ? "',6'" : "',9'";
    return {id,
            title,
            "",
            fmt::format("set multiplot\nset xtics font {0}\nset ytics font {0}\n{1}unset "
                        "multiplot\n",
                        font, script_),
            kWidth,
            kHeight};
  }

 private:
  static constexpr int kWidth = 1750, kHeight = 520;
  static constexpr size_t kMany = 24;  // above this number of names the font shrinks

  std::string margins() const {
    const double left = 0.078 + 0.325 * panels_;
    return fmt::format(
        "set lmargin at screen {:.3f}\nset rmargin at screen {:.3f}\nset tmargin at screen "
        "0.93\nset bmargin at screen 0.2\n",
        left, left + 0.212);
  }

  const PartNameTally& tally_;
  std::string script_;
  int panels_ = 0;
};

Figure figure_of(const PartNameTally& tally, const char* id, const char* title, const char* test,
                 uint64_t PartPairCounts::*tests, uint64_t PartPairCounts::*passed) {
  const auto count = [](uint64_t n) { return static_cast<double>(n); };
  constexpr const char* kLog = "(log10(1 + $3))";
  constexpr const char* kLogLabel = "log_1_0(1 + n)";
  Panels panels(tally);
  panels.add(std::string(test) + " tested", kLog, kLogLabel,
             [&](const PartPairCounts& cell) { return count(cell.*tests); });
  panels.add("passed", kLog, kLogLabel,
             [&](const PartPairCounts& cell) { return count(cell.*passed); });
  if (tally.counts_touching)
    panels.add("false positives, % of passed", "3", "%", [&](const PartPairCounts& cell) {
      return cell.*passed == 0 ? std::numeric_limits<double>::quiet_NaN()
                               : 100 * (1 - count(cell.touching) / count(cell.*passed));
    });
  return panels.figure(id, title);
}

std::string csv_of(const PartNameTally& tally, bool exact) {
  std::string text;
  const auto put = [&](const char* stage, const std::string& volume, size_t a, size_t b,
                       uint64_t tests, uint64_t passed, bool truth, uint64_t touching) {
    append(text, "{},{},{},{},{},{},{},{}\n", stage, volume, csv_field(tally.names[a]),
           csv_field(tally.names[b]), tests, passed, truth ? fmt::format("{}", touching) : "",
           truth ? fmt::format("{}", passed - touching) : "");
  };
  const auto for_each = [&](const auto& visit) {
    for (size_t a = 0; a < tally.names.size(); ++a)
      for (size_t b = a; b < tally.names.size(); ++b)
        if (tally.at(a, b).box_tests > 0) visit(a, b, tally.at(a, b));
  };
  for_each([&](size_t a, size_t b, const PartPairCounts& cell) {
    put("part_box", "aabb", a, b, cell.box_tests, cell.box_passed, tally.counts_touching,
        cell.touching);
  });
  for_each([&](size_t a, size_t b, const PartPairCounts& cell) {
    put("part_volume", tally.volumes[a * tally.names.size() + b], a, b, cell.box_passed,
        cell.part_passed, tally.counts_touching, cell.touching);
  });
  if (!exact) return text;
  for_each([&](size_t a, size_t b, const PartPairCounts& cell) {
    put("triangles", "triangles", a, b, cell.part_passed, cell.touching, true, cell.touching);
  });
  return text;
}

}  // namespace

PartNameTally by_name(const PartTally& tally, const RunInfo& run) {
  Names names(run);
  const PartTally::Blocks blocks = tally.blocks();
  for (const auto& [types, block] : blocks) {
    for (size_t a = 0; a < block.parts_a; ++a) names.of(types.first, a);
    for (size_t b = 0; b < block.parts_b; ++b) names.of(types.second, b);
  }
  PartNameTally out{names.names, {}, {}, tally.counts_touching};
  const size_t count = out.names.size();
  out.cells.resize(count * count);
  std::vector<std::set<std::string>> volumes(count * count);
  for (const auto& [types, block] : blocks)
    for (size_t a = 0; a < block.parts_a; ++a)
      for (size_t b = 0; b < block.parts_b; ++b) {
        const PartPairCounts& cell = block.cells[a * block.parts_b + b];
        if (cell.box_tests == 0) continue;
        const auto [row, column] =
            std::minmax({names.of(types.first, a), names.of(types.second, b)});
        out.cells[row * count + column].add(cell);
        const auto [first, second] =
            std::minmax({names.volume(types.first, a), names.volume(types.second, b)});
        volumes[row * count + column].insert(
            first == second ? std::string(name_of(first))
                            : fmt::format("{}+{}", name_of(first), name_of(second)));
      }
  for (const std::set<std::string>& each : volumes)
    out.volumes.push_back(each.empty() ? "" : *each.begin());
  return out;
}

std::vector<Figure> figures_of(const PartNameTally& tally) {
  if (tally.names.empty()) return {};
  return {figure_of(tally, kFigures[0], "Boxes, part by part", "boxes", &PartPairCounts::box_tests,
                    &PartPairCounts::box_passed),
          figure_of(tally, kFigures[1], "Part volumes, part by part", "part volumes",
                    &PartPairCounts::box_passed, &PartPairCounts::part_passed)};
}

ByPartSink::ByPartSink(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error)
    throw EnvironmentError(
        fmt::format("{}: cannot create: {}; choose another folder with --part-pairs",
                    folder_.string(), error.message()));
}

void ByPartSink::frame(const RunInfo&, const Frame& frame) {
  add_sum(bodies_, frame.counters->body_sphere);
  add_sum(body_boxes_, frame.counters->body_box);
}

void ByPartSink::end(const RunInfo& run, const RunEnd& end) {
  const PartNameTally tally = end.by_part == nullptr ? PartNameTally{} : by_name(*end.by_part, run);
  std::string text = "stage,volume,part_a,part_b,tests,passed,touching,false_positives\n";
  for (const auto& [stage, sum] :
       {std::pair("body_sphere", &bodies_), std::pair("body_box", &body_boxes_)})
    append(text, "{},{},{},{},{},{},,\n", stage, sum->volume, kWhole, kWhole, sum->tests,
           sum->passed);
  write_file_atomically(folder_ / kTable, text + csv_of(tally, run.culler.exact),
                        {.what = "the counts by part"});
  // Figures of an earlier run do not belong to these numbers.
  std::error_code error;
  for (const char* name : kFigures)
    std::filesystem::remove(folder_ / fmt::format("{}.svg", name), error);
  if (!has_gnuplot()) return;
  for (const Figure& figure : figures_of(tally)) draw(figure, folder_);
}

std::vector<std::string> by_part_files() {
  std::vector<std::string> names{kTable};
  for (const char* figure : kFigures) names.push_back(fmt::format("{}.svg", figure));
  return names;
}

}  // namespace throng
