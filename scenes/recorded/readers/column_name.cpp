#include "scenes/recorded/readers/column_name.h"

#include <algorithm>
#include <cctype>

#include "scenes/recorded/readers/text_lines.h"

namespace throng {
namespace {

std::string_view without_quotes(std::string_view text) {
  for (const char quote : {'"', '\''})
    if (text.size() >= 2 && text.front() == quote && text.back() == quote)
      return trimmed(text.substr(1, text.size() - 2));
  return text;
}

std::string plain(std::string_view text) {
  std::string out;
  for (const char c : lower(text))
    if (!is_blank(c) && c != '_') out += c;
  while (!out.empty() && std::string_view(",:-.").find(out.back()) != std::string_view::npos)
    out.pop_back();
  return out;
}

bool is_parting(char c) {
  return is_blank(c) || std::string_view("_,:-.").find(c) != std::string_view::npos;
}
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
bool is_lower(char c) { return c >= 'a' && c <= 'z'; }

/// "x in" of "x in cm" is x.
std::string_view without_in(std::string_view text) {
  while (!text.empty() && is_parting(text.back())) text.remove_suffix(1);
  if (text.size() > 3 && is_parting(text[text.size() - 3]) && lower(text).ends_with("in"))
    text.remove_suffix(3);
  return text;
}

/// Where the last word begins: behind a blank or an underscore, or at a capital inside a name.
size_t last_word(std::string_view text) {
  for (size_t i = text.size(); i-- > 1;) {
    if (is_parting(text[i])) return i + 1;
    const bool begins_word = is_upper(text[i]) && (is_lower(text[i - 1]) ||
                                                   (i + 1 < text.size() && is_lower(text[i + 1])));
    if (begins_word) return i;
  }
  return std::string_view::npos;
}

void find_suffix(std::string_view text, ColumnName& out) {
  for (const std::string_view degrees : {"\xC2\xB0", "\xC2\xBA", "\xB0"})
    if (text.size() > degrees.size() && text.ends_with(degrees)) {
      text.remove_suffix(degrees.size());
      out.suffix = degrees;
      out.plain_before_suffix = plain(without_in(text));
      return;
    }
  if (text.ends_with('.')) text.remove_suffix(1);  // "in."
  const size_t word = last_word(text);
  if (word == std::string_view::npos || word >= text.size()) return;
  out.suffix = lower(text.substr(word));
  out.plain_before_suffix = plain(without_in(text.substr(0, word)));
}

/// The first of all brackets that holds a unit, else what the first one holds: "(seen) [cm]".
std::string unit_in_brackets(std::string_view text) {
  std::string first;
  for (size_t at = text.find_first_of(kOpeningBrackets); at != std::string_view::npos;
       at = text.find_first_of(kOpeningBrackets, at + 1)) {
    const std::string_view inner = text.substr(at + 1);
    // "[meter(s)]" has brackets within.
    const size_t plural = inner.find("(s)");
    std::string unit = bare_unit(inner.substr(0, inner.find_first_of(kClosingBrackets)));
    if (plural != std::string_view::npos && unit_named(bare_unit(inner.substr(0, plural))))
      return bare_unit(inner.substr(0, plural));
    if (unit_named(unit)) return unit;
    // "[s since start]", but "in" begins prose.
    const std::string word = unit.substr(0, unit.find(' '));
    if (word != "in" && unit_named(word)) return word;
    if (first.empty()) first = std::move(unit);
  }
  return first;
}

}  // namespace

bool ColumnName::has_suffix_of(std::optional<Quantity> quantity) const {
  if (!quantity || suffix.empty() || !unit.empty()) return false;
  const std::optional<Unit> found = unit_named(suffix);
  return found && found->quantity == *quantity;
}

std::string bare_unit(std::string_view text) {
  std::string out = lower(without_quotes(trimmed(text)));
  const auto take = [&](std::string_view word) {
    if (!out.starts_with(word)) return;
    const std::string_view rest = trimmed(std::string_view(out).substr(word.size()));
    if (!rest.empty()) out = std::string(rest);
  };
  if (out.size() >= 2 && kOpeningBrackets.find(out.front()) != std::string_view::npos &&
      kClosingBrackets.find(out.back()) != std::string_view::npos)
    out = std::string(trimmed(std::string_view(out).substr(1, out.size() - 2)));
  for (const std::string_view word : {"unit:", "units:", "unit=", "unit ", "in "}) take(word);
  return out;
}

ColumnName column_name(std::string_view text) {
  ColumnName out;
  out.text = text;
  text = without_quotes(trimmed(text));
  size_t cut = text.find_first_of("[({/", 1);
  if (text.empty()) cut = std::string_view::npos;
  if (cut == std::string_view::npos) {
    out.plain = plain(text);
    find_suffix(text, out);
    return out;
  }
  const std::string_view name = text.substr(0, cut);
  std::string_view rest = text.substr(cut);
  if (rest.front() == '/') {
    rest = trimmed(rest.substr(1));
    // "v/(m/s)" has its unit in brackets, "x/cm (seen)" before them.
    const size_t bracket = rest.find_first_of(kOpeningBrackets, 1);
    out.unit = bare_unit(rest.substr(0, bracket));
  } else {
    out.unit = unit_in_brackets(rest);
  }
  out.plain = plain(without_in(name));
  return out;
}

}  // namespace throng
