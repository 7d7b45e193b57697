#include "recordings/readers/column_name.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "recordings/readers/text_lines.h"

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

std::string_view without_in(std::string_view text) {
  while (!text.empty() && is_parting(text.back())) text.remove_suffix(1);
  if (text.size() > 3 && is_parting(text[text.size() - 3]) && lower(text).ends_with("in"))
    text.remove_suffix(3);
  return text;
}

/// Start of the last word: after a blank or underscore, or at an inner capital.
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
  if (text.ends_with('.')) text.remove_suffix(1);
  const size_t word = last_word(text);
  if (word == std::string_view::npos || word >= text.size()) return;
  // An inner capital begins a word: "timeMs".
  const bool is_parted = is_parting(text[word - 1]);
  out.suffix = is_parted ? folded(text.substr(word)) : lower(text.substr(word));
  out.plain_before_suffix = plain(without_in(text.substr(0, word)));
}

/// Units of counting and other scales: such words are no remarks.
bool names_a_scale(std::string_view word) {
  constexpr std::string_view kScales[] = {
      "image",      "screen",   "grid",      "index",         "percent",    "normalised",
      "normalized", "scaled",   "relative",  "dimensionless", "lat",        "lon",
      "points",     "latitude", "longitude", "pts",           "rev",        "unitless",
      "rods",       "chains",   "frames",    "hundredths",    "thousandths"};
  constexpr std::string_view kCounted[] = {"day",  "week",  "month", "year", "step",  "sample",
                                           "beat", "count", "unit",  "cell", "cycle", "revolution",
                                           "tile", "block", "dot",   "turn", "texel", "league"};
  constexpr std::string_view kOthers[] = {
      "cubit", "verst",   "parsec",  "angstrom", "ell",     "meile",  "zoll",
      "fuss",  "elle",    "sekunde", "stunde",   "schritt", "pouce",  "pied",
      "heure", "seconde", "pulgada", "milla",    "segundo", "minuto", "hora",
      "grado", "micro",   "centi",   "kilo",     "nano",    "mega",   "deci"};
  const bool is_plural = word.ends_with('s') || word.ends_with('n');
  const std::string_view single = is_plural ? word.substr(0, word.size() - 1) : word;
  if (std::find(std::begin(kOthers), std::end(kOthers), word) != std::end(kOthers) ||
      std::find(std::begin(kOthers), std::end(kOthers), single) != std::end(kOthers))
    return true;
  return std::find(std::begin(kScales), std::end(kScales), word) != std::end(kScales) ||
         std::find(std::begin(kCounted), std::end(kCounted), single) != std::end(kCounted);
}

/// Returns whether words differ by one inserted, missing or changed letter, or by swapped
/// neighbours.
bool differs_by_a_slip(std::string_view a, std::string_view b) {
  const auto same =
      static_cast<size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
  a.remove_prefix(same);
  b.remove_prefix(same);
  while (!a.empty() && !b.empty() && a.back() == b.back()) {
    a.remove_suffix(1);
    b.remove_suffix(1);
  }
  const bool is_swapped = a.size() == 2 && b.size() == 2 && a[0] == b[1] && a[1] == b[0];
  return is_swapped || (a.size() <= 1 && b.size() <= 1);
}

/// Words without vowels, such as "mtr" and "pxl".
bool is_abbreviation(std::string_view word) {
  constexpr std::string_view kClocks[] = {"gmt", "gps", "bst", "cst", "mst", "pst"};
  return word.find_first_of("aeiou") == std::string_view::npos &&
         std::find(std::begin(kClocks), std::end(kClocks), word) == std::end(kClocks);
}

/// Returns whether a word is a unit, a misspelt unit or one of another language: "kilometros",
/// "secnds".
bool is_like_unit(std::string_view word) {
  if (unit_named(word) || names_a_scale(word) || is_abbreviation(word) ||
      word.find("metr") != std::string_view::npos || word.ends_with("meter") ||
      word.ends_with("meters") || word.find("pixel") != std::string_view::npos)
    return true;
  // Shorter words are too similar: "head" and "feet", "main" and "min".
  constexpr size_t kLongEnough = 5;
  const std::vector<std::string_view> spellings = spelt_units();
  return std::any_of(spellings.begin(), spellings.end(), [&](std::string_view spelling) {
    return spelling.size() >= kLongEnough && differs_by_a_slip(word, spelling);
  });
}

/// Returns whether words are a remark: plain words, one with at least three letters, none similar
/// to a unit. Examples: "head", "UTC", "centre of mass".
bool is_remark(std::string_view text) {
  std::string words = lower(text);
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == '-' || c == '_'; }, ' ');
  size_t longest = 0;
  for (const std::string_view word : words_of(words)) {
    if (!std::all_of(word.begin(), word.end(), is_lower) || is_like_unit(word)) return false;
    longest = std::max(longest, word.size());
  }
  // "world frame" is a remark; "frame" alone may be a unit of counting.
  return longest >= 3 && words != "frame" && !words.starts_with("in ");
}

/// Unit in the first bracket that holds one, else the first bracket's content unless it is a
/// remark: "(seen) [cm]".
std::string unit_in_brackets(std::string_view text, std::string& remark) {
  std::string first;
  for (size_t at = text.find_first_of(kOpeningBrackets); at != std::string_view::npos;
       at = text.find_first_of(kOpeningBrackets, at + 1)) {
    const std::string_view inner = text.substr(at + 1);
    // "[meter(s)]" has nested brackets.
    const size_t plural = inner.find("(s)");
    std::string unit = bare_unit(inner.substr(0, inner.find_first_of(kClosingBrackets)));
    if (plural != std::string_view::npos && unit_named(bare_unit(inner.substr(0, plural))))
      return bare_unit(inner.substr(0, plural));
    if (unit_named(unit)) return unit;
    // "[s since start]" has a unit; "in" begins prose.
    const std::string word = unit.substr(0, unit.find(' '));
    if (word != "in" && unit_named(word)) return word;
    const std::string_view whole = trimmed(inner.substr(0, inner.find_first_of(kClosingBrackets)));
    if (text[at] == '(' && is_remark(whole)) {
      if (remark.empty()) remark = whole;
    } else if (first.empty()) {
      first = std::move(unit);
    }
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
  std::string out = folded(without_quotes(trimmed(text)));
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

ColumnName column_name(std::string_view whole) {
  ColumnName out;
  out.text = whole;
  const std::string spelt = without_capitals_throughout(whole);
  std::string_view text = without_quotes(trimmed(spelt));
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
    out.unit = unit_in_brackets(rest, out.remark);
  }
  if (out.unit.empty() && !out.remark.empty()) find_suffix(trimmed(name), out);
  out.plain = plain(without_in(name));
  return out;
}

}  // namespace throng
