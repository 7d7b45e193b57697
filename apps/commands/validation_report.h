// The report of `throng validate`: a table of verdicts, JSON, and a Markdown page with figures.
// Invariant: every number was measured in this run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/validation/validation.h"

namespace throng {

struct ValidationRun {
  const validation::Test* test = nullptr;
  std::vector<validation::SeedOutcome> seeds;
  validation::Outcome outcome{};  ///< combined outcome of all seeds
};

/// Number of standard tests that passed, failed, or were only measured. One experiment may serve
/// several tests.
struct ValidationCount {
  int passed = 0;
  int failed = 0;
  int differ = 0;
  int skipped = 0;
};
ValidationCount count_of(const std::vector<ValidationRun>& runs);

/// A line per test, and one for wall crossings.
std::string verdict_table(const std::vector<ValidationRun>& runs);
/// {throng, stopped_early, tests: [{id title verdict measured criterion ... seeds readings}],
/// passed, failed, differ, skipped}
std::string validation_json(const std::vector<ValidationRun>& runs, bool stopped_early);

/// Writes report.md and its SVG figures into an existing folder. Throws EnvironmentError.
void write_validation_report(const std::vector<ValidationRun>& runs,
                             const std::filesystem::path& folder);

}  // namespace throng
