// The paper's figures as SVG, drawn by gnuplot: ours beside theirs.
// One rule: a figure is a gnuplot script with its data in it; the same numbers give the same
// script.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/paper/experiment.h"

namespace throng::paper {

struct Figure {
  std::string id;  ///< "figure_07"; its SVG is ID.svg
  std::string title;
  std::string caption;
  std::string script;  ///< everything but the terminal and the output
};

std::vector<Figure> figures_of(const PaperResult& result);

/// Throws EnvironmentError, with the way out, if gnuplot is not installed.
void require_gnuplot();

/// Draws the figure; returns the SVG's text. Throws EnvironmentError if gnuplot fails.
std::string draw(const Figure& figure, const std::filesystem::path& folder);

}  // namespace throng::paper
