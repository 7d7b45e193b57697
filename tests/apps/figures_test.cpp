// Counts, hashes and sizes in the documents equal what the commands in figures.yaml print.
// THRONG_NIGHTLY=1 also runs the commands that take up to a minute. THRONG_DOCS_UPDATE=1 writes the
// printed figures into the documents instead. scripts/docs.sh sets both.
#include "tests/apps/figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string_view>

#include "base/errors.h"
#include "tests/apps/cli.h"
#include "tests/nightly.h"

namespace throng::figures_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kFile = "tests/apps/figures.yaml";

std::vector<Figures> all_figures() {
  return read_figures(read_file(fs::path(THRONG_SOURCE_DIR) / kFile), kFile);
}

/// Pages that figures.yaml names. An unreadable file has none; Figures.HaveAPlaceOnTheirPage
/// reports it.
std::vector<std::string> pages() {
  std::vector<std::string> names;
  try {
    for (const Figures& figures : all_figures()) names.push_back(figures.page);
  } catch (const std::exception&) {
    return {};
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

bool is_updating() {
  const char* const value = std::getenv("THRONG_DOCS_UPDATE");
  return value != nullptr && std::string_view(value) == "1";
}

/// Runs the command of one entry and compares its output with the page, or updates the page.
void check_figures(const Figures& figures) {
  const fs::path file = fs::path(THRONG_SOURCE_DIR) / figures.page;
  const std::string where = std::string(kFile) + ":" + std::to_string(figures.line);
  std::string text = read_file(file);
  const FiguresBlock block = find_block(text, figures.at);
  const ScratchFolder folder;
  const Outcome outcome = shell("top='" THRONG_SOURCE_DIR "'\n" + figures.command, folder);
  EXPECT_EQ(outcome.exit_code, 0) << where << ": " << figures.command << "\n" << outcome.err;
  const size_t size = block.end - block.begin;
  const std::string current = text.substr(block.begin, size);
  const std::string wrong = difference(current, outcome.out, block.is_fenced);
  if (wrong.empty()) return;
  if (outcome.exit_code == 0 && is_updating()) {
    text.replace(block.begin, size, mended(current, outcome.out, block.is_fenced));
    write_file(file, text);
    std::printf("%s: mended %s:\n%s", where.c_str(), figures.page.c_str(), wrong.c_str());
    return;
  }
  ADD_FAILURE() << where << ": " << figures.page << ": " << figures.command << "\n"
                << wrong << outcome.err
                << "  scripts/docs.sh --update writes the printed figures into the page";
}

class Document : public testing::TestWithParam<std::string> {};

TEST_P(Document, ContainsTheFiguresOfItsCommands) {
  for (const Figures& figures : all_figures())
    if (figures.page == GetParam() && (test::is_nightly() || !figures.is_nightly))
      check_figures(figures);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Document);
INSTANTIATE_TEST_SUITE_P(All, Document, testing::ValuesIn(pages()), [](const auto& test) {
  std::string name = fs::path(test.param).stem().string();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Figures, HaveAPlaceOnTheirPage) {
  for (const Figures& figures : all_figures()) {
    SCOPED_TRACE(std::string(kFile) + ":" + std::to_string(figures.line) + ": " + figures.page);
    EXPECT_NO_THROW(find_block(read_file(fs::path(THRONG_SOURCE_DIR) / figures.page), figures.at));
  }
}

TEST(Figures, AreReadFromAList) {
  const auto all = read_figures(
      "- page: docs/a.md\n  at: first line\n  command: one | two\n"
      "- page: b.md\n  at: '| x'\n  nightly: true\n  command: |\n    a \\\n      b\n    c\n",
      "f.yaml");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].page, "docs/a.md");
  EXPECT_EQ(all[0].at, "first line");
  EXPECT_EQ(all[0].command, "one | two");
  EXPECT_FALSE(all[0].is_nightly);
  EXPECT_EQ(all[1].line, 4);
  EXPECT_EQ(all[1].command, "a \\\n  b\nc\n");
  EXPECT_TRUE(all[1].is_nightly);
}

TEST(Figures, AreRejectedWithMissingOrUnknownKeys) {
  for (const char* text : {"page: a.md\n", "- a\n", "- page: a.md\n  at: x\n",
                           "- page: a.md\n  at: x\n  command: b\n  nightly: 1\n",
                           "- page: a.md\n  at: x\n  command: b\n  daily: true\n",
                           "- page: a.md\n  at: ''\n  command: b\n"})
    EXPECT_THROW(read_figures(text, "f.yaml"), InputError) << text;
}

TEST(Figures, AreCheckedInTheBlockOfTheirLine) {
  const std::string document =
      "# A\nFive\nsix.\n\nnot this\n\n```text\nx 1\ny 2\n```\nrest\n| head |\n| 7 |\n";
  const auto block_at = [&](const char* at) {
    const FiguresBlock block = find_block(document, at);
    return (block.is_fenced ? "fenced: " : "") +
           document.substr(block.begin, block.end - block.begin);
  };
  EXPECT_EQ(block_at("Five"), "Five\nsix.");
  EXPECT_EQ(block_at("six"), "six.");
  EXPECT_EQ(block_at("y 2"), "fenced: x 1\ny 2\n");
  EXPECT_EQ(block_at("| head"), "| head |\n| 7 |\n");
}

TEST(Figures, AreRejectedWithoutAUniqueLine) {
  EXPECT_THROW(find_block("a\nb\n", "c"), std::runtime_error);
  EXPECT_THROW(find_block("a 1\n\na 2\n", "a"), std::runtime_error);
  EXPECT_THROW(find_block("", "a"), std::runtime_error);
}

TEST(Figures, AreFoundWithAnySpacingAndGrouping) {
  const std::string text = "| plaza | 12 345\n  pairs | 0.4 ms |";
  EXPECT_EQ(difference(text, "12345 pairs\n", false), "");
  EXPECT_EQ(difference(text, "plaza | 12345 pairs | … ms\n", false), "");
  for (const char* wrong : {"2345 pairs", "12346 pairs", "1 plaza", "345 pairs | 0.5 ms", ""})
    EXPECT_NE(difference(text, wrong, false), "") << wrong;
}

TEST(Figures, AreNotFoundInLongerNumbers) {
  EXPECT_NE(difference("of 45 pairs", "5 pairs", false), "");
  EXPECT_NE(difference("pairs: 45", "pairs: 4", false), "");
  EXPECT_NE(difference("pairs: 4.5", "pairs: 4", false), "");
}

TEST(Figures, OfABlockAreTheWholeOutput) {
  EXPECT_EQ(difference("a  1\nb 2\n", "a 1\nb 2\n", true), "");
  EXPECT_EQ(difference("a 1 in 3.2 s\n", "a 1 in … s\n", true), "");
  EXPECT_NE(difference("a 1\n", "a 1\nb 2\n", true), "");
  EXPECT_NE(difference("a 1\nb 2\n", "a 1\n", true), "");
  EXPECT_THAT(difference("a 1\n", "a 2\n", true), HasSubstr("the command:  a 2"));
}

TEST(Figures, AreUpdatedInPlace) {
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
