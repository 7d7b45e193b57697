// The result as tables, one for each of the paper's and some more.
// One rule: text, Markdown and HTML show the same cells, and the paper's stand beside ours.
#pragma once

#include <string>
#include <vector>

#include "bench/paper/experiment.h"

namespace throng::paper {

struct Table {
  std::string title;
  std::string note;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< as wide as the head
};

/// Those that the result has come to.
std::vector<Table> tables_of(const PaperResult& result);

std::string to_text(const Table& table);
std::string to_markdown(const Table& table);
std::string to_html(const Table& table);

/// &, <, > and quotes made safe.
std::string html_escaped(const std::string& text);

}  // namespace throng::paper
