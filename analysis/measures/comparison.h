// comparison shows the measures of two runs next to each other, as text and as figures.
// Invariant: rows that only one run has are shown with an empty cell for the other.
#pragma once

#include <string>
#include <vector>

#include "analysis/measures/crowd_measures.h"
#include "analysis/measures/measure_table.h"
#include "base/figure.h"

namespace throng {

struct MeasuredRun {
  std::string name;
  CrowdMeasures::Facts facts;
  std::vector<MeasureTable> tables;
};

struct ComparedRow {
  MeasureRow row;  ///< `value` is of either run
  double a = 0;    ///< value of run A; NaN: none
  double b = 0;    ///< value of run B; NaN: none
};

/// Matches the rows of one measure of two runs. Ranges are in ascending order, other rows in the
/// order of their tables.
std::vector<ComparedRow> compared_rows(const MeasureTable& a, const MeasureTable& b);

/// One block of text per measure.
std::string comparison_text(const MeasuredRun& a, const MeasuredRun& b);

/// One figure per measure with data.
std::vector<Figure> comparison_figures(const MeasuredRun& a, const MeasuredRun& b);

}  // namespace throng
