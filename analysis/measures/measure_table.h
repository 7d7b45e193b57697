// What a measure of a crowd found, as rows that the same measure of another crowd can stand beside.
// One rule: a row is known by where it applies and what it says, so that rows of two crowds match
// by these alone.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace throng {

struct MeasureRow {
  std::string at{};              ///< "0.25 to 0.5"; "arm and trunk"; "both ways"
  std::optional<double> from{};  ///< where `at` is a range of numbers
  std::optional<double> to{};    ///< none: without end
  std::string which{};           ///< which of several at one place: "ahead"; or ""
  std::string what{};            ///< "mean", "5 %"
  std::string unit{};            ///< "m/s"; "": a share or a count
  double value = std::numeric_limits<double>::quiet_NaN();

  bool matches(const MeasureRow& other) const {
    return at == other.at && which == other.which && what == other.what;
  }
};

struct MeasureCurve {
  std::string name;  ///< of what several curves of a measure show
  std::vector<std::pair<double, double>> points;
};

struct MeasureTable {
  std::string id;     ///< "speed_density"
  std::string title;  ///< "Speed against density"
  std::string key;    ///< what `at` is: "density", "width", "part", "way"
  std::string key_unit;
  std::string how;  ///< how it was measured, a sentence or two
  std::vector<MeasureRow> rows;
  std::vector<MeasureCurve> curves;

  /// NaN where there is no such row.
  double value(const std::string& at, const std::string& which, const std::string& what) const;
};

/// "0.25 to 0.5", "above 5".
std::string range_text(double from, std::optional<double> to);
/// A row at a range of numbers.
MeasureRow ranged_row(double from, std::optional<double> to, std::string which, std::string what,
                      std::string unit, double value);

}  // namespace throng
