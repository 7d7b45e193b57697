// Figure is a gnuplot script with its data; draw() makes an SVG of it.
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

/// Colours that colour-blind readers can distinguish (Tol 2021, "bright").
inline constexpr const char* kFigureColours[] = {"#4477aa", "#ee6677", "#228833",
                                                 "#ccbb44", "#aa3377", "#66ccee"};

/// Quotes any text (name of a part, path) for gnuplot. Unquoted text in a script would run as a
/// command.
std::string gnuplot_quoted(std::string text);

/// Square heat map with a row and a column per name; larger values are darker. `using_expression`
/// maps a cell's number ($3) to the drawn value: "3", "(log10(1 + $3))".
struct HeatMap {
  std::vector<std::string> names;
  std::vector<double> values;  ///< names x names, row by row; NaN: an empty cell
  std::string using_expression = "3";
  std::string label;  ///< label of the colour bar
  std::string margins = "set rmargin 14\n";
};
std::string gnuplot_script(const HeatMap& map);

bool has_gnuplot();

/// Throws EnvironmentError with a remedy if gnuplot is not installed.
void require_gnuplot();

/// Draws the figure; returns the SVG's text. Throws EnvironmentError if gnuplot fails.
std::string draw(const Figure& figure, const std::filesystem::path& folder);

}  // namespace throng
