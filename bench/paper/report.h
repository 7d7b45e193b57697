// The report of the paper's experiments: figures, pictures, an HTML page and a Markdown file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/figure.h"
#include "bench/paper/experiment.h"
#include "bench/paper/parts.h"
#include "viewer/picture/raster.h"

namespace throng::paper {

// The paper's figures: ours beside theirs.
// Every number in them is measured or printed in the paper.

std::vector<Figure> figures_of(const PaperResult& result);

/// The paper's pictures, drawn with the volumes that are tested: Figures 1, 2, 4, 5, 11 and 12.
/// What collides is red, whatever else it is; a picture shows what the paper's shows.
struct Picture {
  std::string id;  ///< "figure_04", "figure_05a"
  std::string title;
  std::string caption;  ///< what the paper's figure shows
  Image image;
};

/// A second into the runs; or-DOP 26 tells which collide.
std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed);

// The report: one HTML page that needs nothing else, and a Markdown file with its figures beside.
// Nothing in it is typed by hand; what it says it has from the result.

/// Writes report.html, report.md and the figures into a folder that is there. Throws
/// EnvironmentError.
void write_report(const PaperResult& result, const std::vector<Object>& objects,
                  const std::string& cpu, const std::filesystem::path& folder);

}  // namespace throng::paper
