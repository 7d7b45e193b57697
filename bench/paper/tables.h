// Tables and JSON of the results of the paper's experiments.
#pragma once

#include <string>
#include <vector>

#include "bench/paper/experiment.h"

namespace throng::paper {

/// A table of the results, one per table of the paper and some more, with the paper's numbers.
/// Text, Markdown and HTML contain the same cells.
struct Table {
  std::string title;
  std::string note;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< as wide as the head
};

std::vector<Table> tables_of(const PaperResult& result);

std::string to_text(const Table& table);
std::string to_markdown(const Table& table);
std::string to_html(const Table& table);

/// Escapes &, <, > and quotes.
std::string html_escaped(const std::string& text);

// JSON keys carry their units; a value that is not a number is absent, never null.

/// Returns indented JSON with a final newline. `cpu` names the machine of the measured times.
std::string to_json(const PaperResult& result, const std::string& cpu);

}  // namespace throng::paper
