// The report: one HTML page that needs nothing else, and a Markdown file with its figures beside.
// One rule: nothing in it is typed by hand; what it says it has from the result.
#pragma once

#include <filesystem>
#include <string>

#include "bench/paper/experiment.h"

namespace throng::paper {

/// Writes report.html, report.md and the figures into a folder that is there. Throws
/// EnvironmentError.
void write_report(const PaperResult& result, const std::vector<Object>& objects,
                  const std::string& cpu, const std::filesystem::path& folder);

}  // namespace throng::paper
