// The result of the paper's experiments as tables, and for machines.
#pragma once

#include <string>
#include <vector>

#include "bench/paper/experiment.h"

namespace throng::paper {

/// The result as tables, one for each of the paper's and some more.
/// Text, Markdown and HTML show the same cells, and the paper's stand beside ours.
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

// The result for machines.
// Keys carry their units; what is not a number is absent, never null.

/// Indented JSON with a final newline. `cpu` names the machine that the times belong to.
std::string to_json(const PaperResult& result, const std::string& cpu);

}  // namespace throng::paper
