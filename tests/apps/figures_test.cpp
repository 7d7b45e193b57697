// Counts, hashes and sizes in the documents are what their commands print.
// THRONG_NIGHTLY=1 also runs what takes up to a minute; THRONG_DOCS_UPDATE=1 writes what is
// printed into the documents instead (scripts/docs.sh does both).
#include "tests/apps/figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "tests/apps/cli.h"
#include "tests/nightly.h"

namespace throng::figures_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::vector<std::string> documents() {
  std::vector<std::string> names = {"README.md"};
  for (const fs::directory_entry& entry : fs::directory_iterator(THRONG_SOURCE_DIR "/docs"))
    if (entry.path().extension() == ".md")
      names.push_back("docs/" + entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

bool is_updating() {
  const char* const value = std::getenv("THRONG_DOCS_UPDATE");
  return value != nullptr && std::string_view(value) == "1";
}

class Document : public testing::TestWithParam<std::string> {};

TEST_P(Document, SaysWhatItsCommandsPrint) {
  const fs::path file = fs::path(THRONG_SOURCE_DIR) / GetParam();
  std::string text = read_file(file);
  const std::vector<Figures> all = figures_in(text);
  // From the last to the first: what is mended moves what comes after.
  for (auto figures = all.rbegin(); figures != all.rend(); ++figures) {
    if (figures->is_nightly && !test::is_nightly()) continue;
    const ScratchFolder folder;
    const Outcome outcome = shell("top='" THRONG_SOURCE_DIR "'\n" + figures->command, folder);
    const size_t size = figures->end - figures->begin;
    const std::string said = text.substr(figures->begin, size);
    const std::string wrong = difference(said, outcome.out, figures->is_fenced);
    const std::string where = GetParam() + ":" + std::to_string(figures->line);
    EXPECT_EQ(outcome.exit_code, 0) << where << ": " << figures->command << "\n" << outcome.err;
    if (wrong.empty()) continue;
    if (outcome.exit_code == 0 && is_updating()) {
      text.replace(figures->begin, size, mended(said, outcome.out, figures->is_fenced));
      write_file(file, text);
      std::printf("%s: mended:\n%s", where.c_str(), wrong.c_str());
      continue;
    }
    ADD_FAILURE() << where << ": " << figures->command << "\n"
                  << wrong << outcome.err << "  scripts/docs.sh --update writes what is printed";
  }
}

INSTANTIATE_TEST_SUITE_P(All, Document, testing::ValuesIn(documents()), [](const auto& test) {
  std::string name = fs::path(test.param).stem().string();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Figures, AreFoundWithWhatTheyCheck) {
  const auto all = figures_in(
      "# A\n  <!-- check: one | two -->\n<!-- check: three -->\nFive\nsix.\n\nnot this\n\n"
      "<!-- check nightly: a \\\n  b -->\n\n```text\nx 1\n```\nrest\n"
      "```text\n<!-- check: shown, not meant -->\n```\n");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].command, "one | two ");
  EXPECT_EQ(all[0].line, 2);
  EXPECT_FALSE(all[0].is_nightly || all[0].is_fenced);
  EXPECT_EQ(all[0].end - all[0].begin, std::string("Five\nsix.").size());
  EXPECT_EQ(all[1].command, "three ");
  EXPECT_EQ(all[1].begin, all[0].begin);
  EXPECT_EQ(all[2].command, "a \\\n  b ");
  EXPECT_TRUE(all[2].is_nightly && all[2].is_fenced);
  EXPECT_EQ(all[2].end - all[2].begin, std::string("x 1\n").size());
}

TEST(Figures, OfATextAreFoundHoweverTheyAreSpacedAndGrouped) {
  const std::string text = "| plaza | 12 345\n  pairs | 0.4 ms |";
  EXPECT_EQ(difference(text, "12345 pairs\n", false), "");
  EXPECT_EQ(difference(text, "plaza | 12345 pairs | … ms\n", false), "");
  for (const char* wrong : {"2345 pairs", "12346 pairs", "1 plaza", "345 pairs | 0.5 ms", ""})
    EXPECT_NE(difference(text, wrong, false), "") << wrong;
}

TEST(Figures, OfATextAreNotFoundInLongerNumbers) {
  EXPECT_NE(difference("of 45 pairs", "5 pairs", false), "");
  EXPECT_NE(difference("pairs: 45", "pairs: 4", false), "");
  EXPECT_NE(difference("pairs: 4.5", "pairs: 4", false), "");
}

TEST(Figures, OfABlockAreAllThatIsPrinted) {
  EXPECT_EQ(difference("a  1\nb 2\n", "a 1\nb 2\n", true), "");
  EXPECT_EQ(difference("a 1 in 3.2 s\n", "a 1 in … s\n", true), "");
  EXPECT_NE(difference("a 1\n", "a 1\nb 2\n", true), "");
  EXPECT_NE(difference("a 1\nb 2\n", "a 1\n", true), "");
  EXPECT_THAT(difference("a 1\n", "a 2\n", true), HasSubstr("the command:  a 2"));
}

TEST(Figures, AreMendedWhereTheyStand) {
  EXPECT_EQ(mended("| to 5 | 6 035 |\n| to 10 | 20 152 |", "to 5 | 7135\nto 10 | 999", false),
            "| to 5 | 7 135 |\n| to 10 | 999 |");
  EXPECT_EQ(mended("| 1: to 5 | 10 |\n| 4: to 5 | 20 |", "to 5 | 11\nto 5 | 21", false),
            "| 1: to 5 | 11 |\n| 4: to 5 | 21 |");
  EXPECT_EQ(mended("ordop26 found 12 in 3.4 ms", "ordop26 found 13 in … ms", false),
            "ordop26 found 13 in 3.4 ms");
  EXPECT_EQ(mended("a 1 in 3.2 s\nold\n", "a 2 in … s\nb 4\nc 5\n", true),
            "a 2 in 3.2 s\nb 4\nc 5\n");
}

}  // namespace
}  // namespace throng::figures_test
