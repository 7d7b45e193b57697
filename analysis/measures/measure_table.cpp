#include "analysis/measures/measure_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace throng {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Histogram::Histogram(double low, double width, size_t bins)
    : low_(low), width_(width), bins_(bins, 0) {}

void Histogram::add(double value) {
  const double bin = std::floor((value - low_) / width_);
  ++bins_[static_cast<size_t>(std::clamp(bin, 0.0, static_cast<double>(bins_.size() - 1)))];
  min_ = count_ == 0 ? value : std::min(min_, value);
  max_ = count_ == 0 ? value : std::max(max_, value);
  ++count_;
  sum_ += value;
}

void Histogram::add(const Histogram& other) {
  assert(low_ == other.low_ && width_ == other.width_ && bins_.size() == other.bins_.size());
  if (other.count_ == 0) return;
  for (size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
  min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
  max_ = count_ == 0 ? other.max_ : std::max(max_, other.max_);
  count_ += other.count_;
  sum_ += other.sum_;
}

double Histogram::mean() const { return count_ == 0 ? kNone : sum_ / static_cast<double>(count_); }

double Histogram::max() const { return count_ == 0 ? kNone : max_; }

double Histogram::quantile(double share) const {
  if (count_ == 0) return kNone;
  const double rank = share * static_cast<double>(count_);
  double before = 0;
  for (size_t i = 0; i < bins_.size(); ++i) {
    const auto here = static_cast<double>(bins_[i]);
    if (here > 0 && before + here >= rank) {
      const double within = (rank - before) / here;
      const double value = low_ + width_ * (static_cast<double>(i) + within);
      return std::clamp(value, min_, max_);
    }
    before += here;
  }
  return max_;
}

double Histogram::share_above(double bound) const {
  if (count_ == 0) return kNone;
  const auto first = static_cast<size_t>(
      std::clamp(std::round((bound - low_) / width_), 0.0, static_cast<double>(bins_.size())));
  uint64_t above = 0;
  for (size_t i = first; i < bins_.size(); ++i) above += bins_[i];
  return static_cast<double>(above) / static_cast<double>(count_);
}

double MeasureTable::value(const std::string& at, const std::string& which,
                           const std::string& what) const {
  for (const MeasureRow& row : rows)
    if (row.at == at && row.which == which && row.what == what) return row.value;
  return std::numeric_limits<double>::quiet_NaN();
}

std::string range_text(double from, std::optional<double> to) {
  return to ? fmt::format("{:g} to {:g}", from, *to) : fmt::format("above {:g}", from);
}

MeasureRow ranged_row(double from, std::optional<double> to, std::string which, std::string what,
                      std::string unit, double value) {
  return {range_text(from, to), from, to, std::move(which), std::move(what),
          std::move(unit),      value};
}

}  // namespace throng
