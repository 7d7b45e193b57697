// Two runs side by side, measure by measure: as text and as figures.
// One rule: what only one of them has is shown with nothing beside it, never left out.
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
  MeasureRow row;  ///< its value is of either
  double a = 0;    ///< NaN: none
  double b = 0;
};

/// The rows of the same measure of two runs in one order: ranges ascending, the rest as it comes.
std::vector<ComparedRow> compared_rows(const MeasureTable& a, const MeasureTable& b);

/// A block a measure.
std::string comparison_text(const MeasuredRun& a, const MeasuredRun& b);

/// A figure a measure, of those that found something.
std::vector<Figure> comparison_figures(const MeasuredRun& a, const MeasuredRun& b);

}  // namespace throng
