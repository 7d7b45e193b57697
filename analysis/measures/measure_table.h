// What measures are made of: values counted in bins, and tables of what they found.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace throng {

/// Numbers without end in bins of one width: how many, their mean, their quantiles.
/// Memory depends on the range, never on how many numbers came.
class Histogram {
 public:
  /// What is below `low` counts in the first bin, what is above the last bin in the last.
  Histogram(double low, double width, size_t bins);

  void add(double value);
  /// All of another's, whose bins are the same.
  void add(const Histogram& other);

  uint64_t count() const { return count_; }
  double sum() const { return sum_; }
  /// NaN without numbers, as the next three.
  double mean() const;
  double max() const;
  /// To within a bin's width, but never beyond the least or the greatest number; `share` in [0, 1].
  double quantile(double share) const;
  /// The share of numbers above a bound, which should be a bin's edge.
  double share_above(double bound) const;

 private:
  double low_;
  double width_;
  std::vector<uint64_t> bins_;
  uint64_t count_ = 0;
  double sum_ = 0;
  double min_ = 0;
  double max_ = 0;
};

/// What a measure of a crowd found, as rows that the same measure of another crowd can stand
/// beside. A row is known by where it applies and what it says, so that rows of two crowds match by
/// these alone.
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
  std::string method;  ///< how it was measured, a sentence or two
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
