// What is reported of repeated times: the least, the middle and the nearly worst.
// One rule: no mean; a machine's noise is one-sided.
#pragma once

#include <vector>

namespace throng::bench {

struct Spread {
  double min = 0, median = 0, p95 = 0;
};

/// All zero for no values.
Spread spread_of(std::vector<double> values);

}  // namespace throng::bench
