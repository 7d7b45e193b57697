// Figures in the documents, each beside the command that prints it.
// One rule: a figure that its command does not print is a failure, and one command mends it.
//
//   <!-- check: COMMAND -->            below 5 s, in every run of the tests
//   <!-- check nightly: COMMAND -->    below a minute, in scripts/nightly.sh
//
// stands on lines of its own, before what it checks: a fenced block is all that the command prints;
// of a paragraph, list or table every line that the command prints has to stand in it. Spaces and
// line breaks count as one space, 12 345 as 12345, and "…" in what is printed stands for anything:
// times are masked so.
#pragma once

#include <string>
#include <vector>

namespace throng {

struct Figures {
  int line = 0;  ///< of the comment
  bool is_nightly = false;
  std::string command;  ///< for sh
  bool is_fenced = false;
  size_t begin = 0, end = 0;  ///< what is checked, as part of the document
};

/// All that a document marks, in order.
std::vector<Figures> figures_in(const std::string& document);

/// What of `printed` does not stand in `text`, line by line; "" if all does.
std::string difference(const std::string& text, const std::string& printed, bool is_fenced);

/// `text` with the numbers that are printed now; what "…" stands for stays where it can.
std::string mended(const std::string& text, const std::string& printed, bool is_fenced);

}  // namespace throng
