// MeasureTable holds the results of a measure as rows; Histogram counts values in bins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace throng {

/// Counts values in bins of equal width and returns their count, mean and quantiles.
/// Memory depends on the number of bins only.
class Histogram {
 public:
  /// Values outside of the bins count in the first or last bin.
  Histogram(double low, double width, size_t bins);

  void add(double value);
  /// Adds all values of a histogram with the same bins.
  void add(const Histogram& other);

  uint64_t count() const { return count_; }
  double sum() const { return sum_; }
  /// NaN without values; so do max(), quantile() and share_above().
  double mean() const;
  double max() const;
  /// Accurate to a bin's width and clamped to the range of the values; `share` in [0, 1].
  double quantile(double share) const;
  /// Share of values above `bound`, which should be the edge of a bin.
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

/// One result of a measure. Rows of two crowds match if `at`, `which` and `what` are equal.
struct MeasureRow {
  std::string at{};              ///< "0.25 to 0.5"; "arm and trunk"; "both ways"
  std::optional<double> from{};  ///< lower end if `at` is a range
  std::optional<double> to{};    ///< upper end; none: unbounded
  std::string which{};           ///< distinguishes several results at one place: "ahead"; or ""
  std::string what{};            ///< statistic: "mean", "5 %"
  std::string unit{};            ///< "m/s"; "": a share or a count
  double value = std::numeric_limits<double>::quiet_NaN();

  bool matches(const MeasureRow& other) const {
    return at == other.at && which == other.which && what == other.what;
  }
};

struct MeasureCurve {
  std::string name;  ///< names one of several curves of a measure
  std::vector<std::pair<double, double>> points;
};

struct MeasureTable {
  std::string id;     ///< "speed_density"
  std::string title;  ///< "Speed against density"
  std::string key;    ///< quantity of `at`: "density", "width", "part"
  std::string key_unit;
  std::string method;  ///< method in one or two sentences
  std::vector<MeasureRow> rows;
  std::vector<MeasureCurve> curves;

  /// Value of a row; NaN if there is no such row.
  double value(const std::string& at, const std::string& which, const std::string& what) const;
};

/// Text of a range: "0.25 to 0.5", "above 5".
std::string range_text(double from, std::optional<double> to);
MeasureRow ranged_row(double from, std::optional<double> to, std::string which, std::string what,
                      std::string unit, double value);

}  // namespace throng
