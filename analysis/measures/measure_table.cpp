#include "analysis/measures/measure_table.h"

#include <fmt/format.h>

namespace throng {

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
