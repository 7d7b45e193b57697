#include "bench/spread.h"

#include <algorithm>
#include <cmath>

namespace throng::bench {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  const size_t middle = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return {values.front(), median, values[static_cast<size_t>(std::ceil(0.95 * last))]};
}

}  // namespace throng::bench
