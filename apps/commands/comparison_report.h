// What `throng compare` writes besides its table: JSON, and a folder with a report and figures.
#pragma once

#include <filesystem>
#include <string>

#include "analysis/measures/comparison.h"

namespace throng {

/// `{speed_density spacing flow width_use sway accelerations contacts depth}`, a list of rows each,
/// each row with what it says of A and of B; null: nothing.
std::string comparison_json(const MeasuredRun& a, const MeasuredRun& b);

/// report.md and an SVG a figure. The folder exists. Throws EnvironmentError.
void write_comparison_report(const MeasuredRun& a, const MeasuredRun& b,
                             const std::filesystem::path& folder);

}  // namespace throng
