#include "tests/apps/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "base/errors.h"
#include "scenes/file/yaml_tree.h"

namespace throng {
namespace {

constexpr std::string_view kAnything = "…";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// End of the number at `at`: digits, and a fraction if there is one.
size_t number_end(const std::string& line, size_t at) {
  while (at < line.size() && is_digit(line[at])) ++at;
  if (at + 1 < line.size() && line[at] == '.' && is_digit(line[at + 1]))
    for (++at; at < line.size() && is_digit(line[at]);) ++at;
  return at;
}

/// Pattern for a number with or without grouping: 12345 or 12 345.
std::string grouped_pattern(const std::string& number) {
  const size_t whole = std::min(number.find('.'), number.size());
  std::string out = R"(\b)";
  for (size_t i = 0; i < number.size(); ++i) {
    if (i > 0 && i < whole && (whole - i) % 3 == 0) out += " ?";
    out += number[i] == '.' ? std::string(R"(\.)") : std::string(1, number[i]);
  }
  return out + R"((?!\.?[0-9]))";
}

std::string grouped(const std::string& number) {
  const size_t whole = std::min(number.find('.'), number.size());
  std::string out;
  for (size_t i = 0; i < number.size(); ++i) {
    if (i > 0 && i < whole && (whole - i) % 3 == 0) out += ' ';
    out += number[i];
  }
  return out;
}

/// Pattern of a printed line in a document. With `any_numbers` it matches any numbers; each number
/// and each "…" is a group. Digits of a name (ordop26) belong to the name.
struct Pattern {
  std::regex regex;
  std::vector<std::string> groups;  ///< the number, or "…"
};

Pattern pattern_of(const std::string& line, bool any_numbers) {
  Pattern pattern;
  std::string text;
  for (size_t i = 0; i < line.size();) {
    if (line.compare(i, kAnything.size(), kAnything) == 0) {
      text += "(.*?)";
      pattern.groups.emplace_back(kAnything);
      i += kAnything.size();
    } else if (line[i] == ' ') {
      text += R"(\s+)";
      while (i < line.size() && line[i] == ' ') ++i;
    } else if (is_digit(line[i])) {
      const bool is_name = i > 0 && std::isalpha(static_cast<unsigned char>(line[i - 1])) != 0;
      const size_t end = number_end(line, i);
      const std::string number = line.substr(i, end - i);
      if (is_name) {
        text += number;
      } else if (any_numbers) {
        text += R"((\b[0-9]{1,3}(?: [0-9]{3})+|\b[0-9]+(?:\.[0-9]+)?))";
        pattern.groups.push_back(number);
      } else {
        text += grouped_pattern(number);
      }
      i = end;
    } else {
      if (std::string_view(R"(^$\.*+?()[]{}|/)").find(line[i]) != std::string_view::npos)
        text += '\\';
      text += line[i++];
    }
  }
  pattern.regex = std::regex(text);
  return pattern;
}

std::string trimmed(const std::string& line) {
  const size_t first = line.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : line.substr(first, line.find_last_not_of(' ') + 1 - first);
}

std::string difference_of_blocks(const std::string& text, const std::string& printed) {
  const std::vector<std::string> found = lines_of(printed), said = lines_of(text);
  std::string out;
  for (size_t i = 0; i < std::max(found.size(), said.size()); ++i) {
    const std::string now = i < found.size() ? trimmed(found[i]) : "";
    const std::string then = i < said.size() ? trimmed(said[i]) : "";
    if (!std::regex_match(then, pattern_of(now, false).regex))
      out += fmt::format("  the document: {}\n  the command:  {}\n", then, now);
  }
  return out;
}

/// Place of `line` in `text` apart from its numbers: as many equal numbers as possible, not before
/// `from` if there is a choice.
std::optional<std::smatch> place_of(const Pattern& line, const std::string& text, size_t from) {
  std::optional<std::smatch> best;
  int most = -1;
  for (std::sregex_iterator at(text.begin(), text.end(), line.regex), end; at != end; ++at) {
    int equal = static_cast<size_t>(at->position()) >= from ? 1 : 0;
    for (size_t g = 0; g < line.groups.size(); ++g)
      equal += 2 * ((*at)[g + 1].str() == line.groups[g]);
    if (equal > most) {
      most = equal;
      best = *at;
    }
  }
  return best;
}

/// A printed line in which "…" is replaced by the old text.
std::string unmasked(const std::string& line, const std::string& old) {
  std::smatch match;
  const Pattern pattern = pattern_of(trimmed(line), true);
  const std::string text = trimmed(old);
  if (!std::regex_match(text, match, pattern.regex)) return line;
  std::string out = line;
  for (size_t g = 0, at = 0; g < pattern.groups.size(); ++g) {
    if (pattern.groups[g] != kAnything) continue;
    at = out.find(kAnything, at);
    out.replace(at, kAnything.size(), match[g + 1].str());
    at += match[g + 1].str().size();
  }
  return out;
}

std::string scalar_of(const YamlEntry& entry, const std::string& name) {
  if (entry.value.kind == YamlNode::Kind::kScalar && !trimmed(entry.value.scalar).empty())
    return entry.value.scalar;
  throw InputError(fmt::format("{}:{}", name, entry.line), fmt::format("text for '{}'", entry.key),
                   "none");
}

Figures figures_of(const YamlNode& node, const std::string& name) {
  const std::string where = fmt::format("{}:{}", name, node.line);
  if (node.kind != YamlNode::Kind::kMap)
    throw InputError(where, "a map with page, at and command", "something else");
  Figures figures;
  figures.line = node.line;
  for (const YamlEntry& entry : node.entries) {
    const std::string value = scalar_of(entry, name);
    const std::string entry_where = fmt::format("{}:{}", name, entry.line);
    if (entry.key == "page") {
      figures.page = value;
    } else if (entry.key == "at") {
      figures.at = trimmed(value);
    } else if (entry.key == "command") {
      figures.command = value;
    } else if (entry.key == "nightly") {
      if (value != "true" && value != "false")
        throw InputError(entry_where, "true or false for 'nightly'", "'" + value + "'");
      figures.is_nightly = value == "true";
    } else {
      throw InputError(entry_where, "page, at, nightly or command", "'" + entry.key + "'");
    }
  }
  if (figures.page.empty() || figures.at.empty() || figures.command.empty())
    throw InputError(where, "page, at and command", "an entry without one of them");
  return figures;
}

}  // namespace

std::vector<Figures> read_figures(const std::string& yaml, const std::string& name) {
  const YamlNode list = parse_yaml(yaml, name);
  if (list.kind != YamlNode::Kind::kList)
    throw InputError(name, "a list of figures", "something else");
  std::vector<Figures> all;
  for (const YamlNode& item : list.items) all.push_back(figures_of(item, name));
  return all;
}

FiguresBlock find_block(const std::string& document, const std::string& at) {
  constexpr std::string_view kFence = "```";
  FiguresBlock block;
  bool is_in_fence = false, is_marked = false;
  size_t count = 0, fence_begin = 0, next = 0;
  for (size_t line = 0; line < document.size(); line = next) {
    next = std::min(document.find('\n', line), document.size() - 1) + 1;
    const std::string text = trimmed(document.substr(line, next - line));
    if (text.starts_with(kFence)) {
      if (is_in_fence && is_marked) block.end = line;
      is_in_fence = !is_in_fence;
      is_marked = false;
      fence_begin = next;
      continue;
    }
    if (text.find(at) == std::string::npos) continue;
    ++count;
    is_marked = is_in_fence;
    block.is_fenced = is_in_fence;
    block.begin = is_in_fence ? fence_begin : line;
    block.end =
        std::min(is_in_fence ? document.size() : document.find("\n\n", line), document.size());
  }
  if (count != 1)
    throw std::runtime_error(
        fmt::format("expected one line that contains '{}', found {}", at, count));
  return block;
}

std::string difference(const std::string& text, const std::string& printed, bool is_fenced) {
  if (trimmed(printed).empty()) return "  the command prints nothing\n";
  if (is_fenced) return difference_of_blocks(text, printed);
  std::string out;
  for (const std::string& line : lines_of(printed)) {
    if (trimmed(line).empty()) continue;
    if (std::regex_search(text, pattern_of(trimmed(line), false).regex)) continue;
    const auto place = place_of(pattern_of(trimmed(line), true), text, 0);
    out += "  the document: " + (place ? place->str() : "no such line") +
           "\n  the command:  " + trimmed(line) + "\n";
  }
  return out;
}

std::string mended(const std::string& text, const std::string& printed, bool is_fenced) {
  std::string out = is_fenced ? "" : text;
  if (is_fenced) {
    const std::vector<std::string> old = lines_of(text);
    const std::vector<std::string> lines = lines_of(printed);
    for (size_t i = 0; i < lines.size(); ++i)
      out += unmasked(lines[i], i < old.size() ? old[i] : "") + "\n";
    return out;
  }
  size_t from = 0;
  for (const std::string& line : lines_of(printed)) {
    const Pattern pattern = pattern_of(trimmed(line), true);
    // The iterator's text must outlive the match.
    const std::string before = out;
    const auto place = trimmed(line).empty() ? std::nullopt : place_of(pattern, before, from);
    if (!place) continue;
    from = static_cast<size_t>(place->position() + place->length());
    for (size_t g = pattern.groups.size(); g-- > 0;) {
      const std::string was = (*place)[g + 1].str();
      if (pattern.groups[g] == kAnything) continue;
      const bool has_spaces = was.find(' ') != std::string::npos;
      out.replace(static_cast<size_t>(place->position(g + 1)), was.size(),
                  has_spaces ? grouped(pattern.groups[g]) : pattern.groups[g]);
    }
  }
  return out;
}

}  // namespace throng
