// Figures compares the numbers in the documents with the output of the commands that print them.
// Invariant: a number that its command does not print is a failure, and `--update` mends it.
//
// tests/apps/figures.yaml lists the commands:
//
//   - page: docs/culling.md      the document, from the top of the repository
//     at: text                   part of one line, unique on the page and without figures
//     nightly: true              only if the command takes 5 s to a minute [false]
//     command: throng info plaza for sh; $top is the repository
//
// If the line stands in a fenced block, the block is the whole output of the command. Otherwise
// every line of the output stands in the paragraph, list or table from that line on. Spaces and
// line breaks count as one space, 12 345 as 12345. "…" in the output stands for any text, such as a
// time.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace throng {

/// One entry of figures.yaml.
struct Figures {
  int line = 0;  ///< of the entry, counted from 1
  std::string page;
  std::string at;
  bool is_nightly = false;
  std::string command;  ///< for sh
};

/// Part of a document that one command checks.
struct FiguresBlock {
  size_t begin = 0, end = 0;  ///< offsets into the document
  bool is_fenced = false;
};

/// Returns the entries in the order of the file. Throws InputError "name:line: ..." on a missing or
/// unknown key.
std::vector<Figures> read_figures(const std::string& yaml, const std::string& name);

/// Returns the block that `at` marks. Throws std::runtime_error unless exactly one line holds it.
FiguresBlock find_block(const std::string& document, const std::string& at);

/// Returns the printed lines that `text` does not hold, each with its counterpart; "" if it holds
/// all.
std::string difference(const std::string& text, const std::string& printed, bool is_fenced);

/// Returns `text` with the printed numbers; text that "…" stands for is kept where possible.
std::string mended(const std::string& text, const std::string& printed, bool is_fenced);

}  // namespace throng
