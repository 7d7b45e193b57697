#include "base/figure.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>

#include "base/errors.h"

namespace throng {

std::string gnuplot_quoted(std::string text) {
  // A line end would end the string and begin a command.
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  for (size_t at = text.find('\''); at != std::string::npos; at = text.find('\'', at + 2))
    text.insert(at, 1, '\'');
  return "'" + text + "'";
}

namespace {

/// ": " and the output of a program, in one line; "" if there is none.
std::string words_of(FILE* file) {
  std::string text;
  if (file != nullptr) std::rewind(file);
  for (int c; file != nullptr && text.size() < 300 && (c = std::fgetc(file)) != EOF;)
    if (const bool space = std::isspace(c) != 0; !space || (!text.empty() && text.back() != ' '))
      text += space ? ' ' : static_cast<char>(c);
  while (text.ends_with(' ')) text.pop_back();
  return text.empty() ? "" : ": " + text;
}

}  // namespace

std::string gnuplot_script(const HeatMap& map) {
  const size_t count = map.names.size();
  std::string tics;
  for (size_t i = 0; i < count; ++i)
    tics += fmt::format("{}{} {}", i == 0 ? "" : ", ", gnuplot_quoted(map.names[i]), i);
  std::string script = "$data << EOD\n";
  for (size_t row = 0; row < count; ++row) {
    for (size_t column = 0; column < count; ++column) {
      const double value = map.values[row * count + column];
      script += fmt::format("{} {} {}\n", column, row,
                            std::isnan(value) ? "NaN" : fmt::format("{}", value));
    }
    script += '\n';
  }
  return script +
         fmt::format(
             "EOD\nset xtics rotate by -45 ({0}) scale 0\nset ytics ({0}) scale 0\nset xtics "
             "noenhanced\nset ytics noenhanced\nset xrange "
             "[-0.5:{1}]\nset yrange [{1}:-0.5]\nunset key\nset palette defined (0 'white', 1 "
             "'#ccddee', "
             "2 '{2}', 3 '#223355')\nset cblabel '{3}'\n{5}plot $data "
             "using 1:2:{4} with image pixels\n",
             tics, static_cast<double>(count) - 0.5, kFigureColours[0], map.label,
             map.using_expression, map.margins);
}

bool has_gnuplot() { return std::system("command -v gnuplot >/dev/null 2>&1") == 0; }

void require_gnuplot() {
  if (!has_gnuplot())
    throw EnvironmentError(
        "gnuplot: expected the program that draws the figures, found none; `bash scripts/setup.sh` "
        "installs it, and without --out no figure is drawn");
}

std::string draw(const Figure& figure, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / (figure.id + ".svg");
  // gnuplot's warnings are reported only if it draws nothing.
  const std::unique_ptr<FILE, int (*)(FILE*)> errors(std::tmpfile(), std::fclose);
  const std::string command = errors == nullptr
                                  ? "gnuplot"
                                  : fmt::format("gnuplot 2>/proc/self/fd/{}", fileno(errors.get()));
  FILE* gnuplot = popen(command.c_str(), "w");
  if (gnuplot == nullptr)
    throw EnvironmentError(fmt::format("gnuplot: cannot start: {}", std::strerror(errno)));
  // A separate id per figure: figures in one page must not share their markers.
  fmt::print(gnuplot,
             "set terminal svg size {},{} font 'sans-serif,12' background rgb 'white' name '{}'\n"
             "set output {}\n{}set output\n",
             figure.width, figure.height, figure.id, gnuplot_quoted(file.string()), figure.script);
  const int status = pclose(gnuplot);
  std::ifstream in(file, std::ios::binary);
  std::string svg{std::istreambuf_iterator<char>(in), {}};
  if (status != 0 || !in || svg.find("</svg>") == std::string::npos)
    throw EnvironmentError(
        fmt::format("{}: gnuplot could not draw it{}", file.string(), words_of(errors.get())));
  return svg;
}

}  // namespace throng
