// write_report() writes the paper's experiments as HTML and Markdown with figures and pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/figure.h"
#include "bench/paper/experiment.h"
#include "bench/paper/parts.h"
#include "viewer/picture/raster.h"

namespace throng::paper {

// The paper's figures, with measured and published numbers.

std::vector<Figure> figures_of(const PaperResult& result);

/// A picture like one of the paper's, drawn with the tested volumes: Figures 1, 2, 4, 5, 11 and 12.
/// Colliding objects are red.
struct Picture {
  std::string id;  ///< "figure_04", "figure_05a"
  std::string title;
  std::string caption;  ///< description, with the contents of the paper's figure
  Image image;
};

/// Draws the pictures after one second of motion; or-DOP 26 decides which objects collide.
std::vector<Picture> pictures_of(const std::vector<Object>& objects, uint64_t seed);

// The HTML page is self-contained; the Markdown file refers to its figures.

/// Writes report.html, report.md and the figures into an existing folder. Throws EnvironmentError.
void write_report(const PaperResult& result, const std::vector<Object>& objects,
                  const std::string& cpu, const std::filesystem::path& folder);

}  // namespace throng::paper
