// Numbers without end in bins of one width: how many, their mean, their quantiles.
// One rule: memory depends on the range, never on how many numbers came.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace throng {

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
  double least_ = 0;
  double greatest_ = 0;
};

}  // namespace throng
