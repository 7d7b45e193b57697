// Figures as SVG, drawn by gnuplot.
// One rule: a figure is a gnuplot script with its data in it; the same numbers give the same
// script.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace throng {

struct Figure {
  std::string id;  ///< "figure_07"; its SVG is ID.svg
  std::string title;
  std::string caption;
  std::string script;  ///< everything but the terminal and the output
  int width = 900;
  int height = 460;
};

/// Colours that people who see few colours tell apart, too (Tol 2021, "bright").
inline constexpr const char* kFigureColours[] = {"#4477aa", "#ee6677", "#228833",
                                                 "#ccbb44", "#aa3377", "#66ccee"};

/// A text of any origin (the name of a part, a path) as gnuplot takes it: in quotes that it cannot
/// leave. Whatever else stands in a script is run as a command.
std::string gnuplot_quoted(std::string text);

/// A square of cells, one a pair of names, the darker the larger. `using_expression` says what of a
/// cell's number ($3) is drawn: "3", "(log10(1 + $3))".
struct HeatMap {
  std::vector<std::string> names;
  std::vector<double> values;  ///< names x names, row by row; NaN: an empty cell
  std::string using_expression = "3";
  std::string label;  ///< of the colours
  std::string margins = "set rmargin 14\n";
};
/// Sets up the axes and plots it.
std::string gnuplot_script(const HeatMap& map);

/// Whether figures can be drawn here at all.
bool has_gnuplot();

/// Throws EnvironmentError, with the way out, if gnuplot is not installed.
void require_gnuplot();

/// Draws the figure; returns the SVG's text. Throws EnvironmentError if gnuplot fails.
std::string draw(const Figure& figure, const std::filesystem::path& folder);

}  // namespace throng
