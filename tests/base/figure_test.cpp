// Text in a gnuplot script stays inside its quotes.
#include "base/figure.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

namespace throng::figure_test {
namespace {

TEST(FigureText, StaysQuotedOnOneLine) {
  EXPECT_EQ(gnuplot_quoted("left hand"), "'left hand'");
  EXPECT_EQ(gnuplot_quoted("it's"), "'it''s'");
  EXPECT_EQ(gnuplot_quoted("''"), "''''''");
  EXPECT_EQ(gnuplot_quoted("a\nb\tc\x7f"), "'a b c '");
}

TEST(FigureText, RunsNoCommandFromAName) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::temp_directory_path() / ("throng_figure_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string touch = "touch " + (folder / "touched").string();
  for (const std::string& name :
       std::vector<std::string>{"x' 0); system('" + touch + "'); set xtics ('y", "`" + touch + "`",
                                "$(" + touch + ")", "x'\n!" + touch + "\n"}) {
    Figure figure;
    figure.id = "figure";
    figure.script = "set xtics (" + gnuplot_quoted(name) + " 0)\nplot [0:1] x title " +
                    gnuplot_quoted(name) + "\n";
    EXPECT_NE(draw(figure, folder).find("</svg>"), std::string::npos) << name;
    EXPECT_FALSE(fs::exists(folder / "touched")) << name;
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace throng::figure_test
