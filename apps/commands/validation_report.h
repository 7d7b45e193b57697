// What `throng validate` tells: a table of verdicts, JSON, and a page of Markdown with its figures.
// One rule: every number in it was measured in this run; what failed says so.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/validation/validation.h"

namespace throng {

struct ValidationRun {
  const validation::Test* test = nullptr;
  std::vector<validation::SeedOutcome> seeds;
  validation::Outcome outcome{};  ///< of all seeds
};

/// How many of the standards' tests (one experiment may be several) passed, failed, and were only
/// measured.
struct ValidationCount {
  int passed = 0;
  int failed = 0;
  int differ = 0;
  int skipped = 0;
};
ValidationCount count_of(const std::vector<ValidationRun>& runs);

/// A line a test, and one for the walls.
std::string verdict_table(const std::vector<ValidationRun>& runs);
/// {throng, stopped_early, tests: [{id title verdict measured criterion ... seeds readings}],
/// passed, failed, differ, skipped}
std::string validation_json(const std::vector<ValidationRun>& runs, bool stopped_early);

/// Writes report.md and an SVG a figure into a folder that is there. Throws EnvironmentError.
void write_validation_report(const std::vector<ValidationRun>& runs,
                             const std::filesystem::path& folder);

}  // namespace throng
