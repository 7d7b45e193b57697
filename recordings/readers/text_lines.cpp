#include "recordings/readers/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr double kMaxWhole = 9e15;
/// In lower case, without "<" and ">". Words with '#' are errors of spreadsheets.
constexpr std::string_view kMissingWords[] = {
    "",        "na",     "n/a",   "n.a.",    "nat",   "null",   "nil",    "none",
    "missing", "undef",  "\\n",   "?",       "-",     "--",     "---",    ".",
    "#n/a",    "#null!", "#num!", "#value!", "#ref!", "#name?", "#div/0!"};

}  // namespace

void LineSplitter::reject_long_line() const {
  throw InputError(fmt::format("{}:{}", file_.string(), number_ + 1),
                   fmt::format("lines of at most {} KiB", kMaxLineBytes >> 10), "a longer one");
}

void LineSplitter::give(std::string_view line) {
  if (line.size() > kMaxLineBytes) reject_long_line();
  ++number_;
  if (number_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  handler_.take(line, number_);
}

void LineSplitter::push(std::string_view bytes) {
  while (!bytes.empty()) {
    const void* const end = std::memchr(bytes.data(), '\n', bytes.size());
    if (end == nullptr) {
      if (partial_line_.size() + bytes.size() > kMaxLineBytes) reject_long_line();
      partial_line_ += bytes;
      return;
    }
    const auto length = static_cast<size_t>(static_cast<const char*>(end) - bytes.data());
    if (partial_line_.empty()) {
      give(bytes.substr(0, length));
    } else {
      partial_line_ += bytes.substr(0, length);
      give(partial_line_);
      partial_line_.clear();
    }
    bytes.remove_prefix(length + 1);
  }
}

void LineSplitter::end() {
  if (!partial_line_.empty()) give(partial_line_);
  partial_line_.clear();
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && (is_blank(text.back()) || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

bool parse_number(std::string_view text, double& out) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && stop == end && !text.empty();
}

bool parse_whole(std::string_view text, int64_t& out) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, out);
  if (error == std::errc() && stop == end && !text.empty()) return true;
  double value = 0;
  if (!parse_number(text, value) || !(std::abs(value) <= kMaxWhole)) return false;
  out = static_cast<int64_t>(value);
  return static_cast<double>(out) == value;
}

std::string defect_of_whole(std::string_view text) {
  double value = 0;
  if (!text.empty() && parse_number(text, value) && std::abs(value) > kMaxWhole)
    return in_quotes(text) + ", which is too large";
  return text.empty() ? "nothing" : in_quotes(text);
}

int decimals_of(std::string_view number) {
  const size_t e = number.find_first_of("eE");
  const size_t point = number.find('.');
  const size_t digits = std::min(e, number.size());
  const int decimals = point < digits ? static_cast<int>(digits - point - 1) : 0;
  int64_t exponent = 0;
  if (e != std::string_view::npos) {
    std::string_view text = number.substr(e + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    parse_whole(text, exponent);
  }
  return std::clamp(decimals - static_cast<int>(std::clamp<int64_t>(exponent, -99, 99)), 0, 99);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  for (size_t at = 0; at < line.size();) {
    if (is_blank(line[at])) {
      ++at;
      continue;
    }
    const size_t begin = at;
    while (at < line.size() && !is_blank(line[at])) ++at;
    out.push_back(line.substr(begin, at - begin));
  }
  return out;
}

void fields_of(std::string_view line, size_t columns, std::vector<std::string_view>& out) {
  out = words_of(line);
  const auto tabs = static_cast<size_t>(std::count(line.begin(), line.end(), '\t'));
  const bool has_empty_ones = line.find("\t\t") != std::string_view::npos || line.ends_with('\t');
  if (out.empty() || !has_empty_ones || (columns > 0 && tabs + 1 != columns)) return;
  out.clear();
  for (size_t at = 0; at <= line.size();) {
    const size_t end = std::min(line.find('\t', at), line.size());
    out.push_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
}

bool is_missing(std::string_view text) {
  constexpr size_t kMaxLineBytes = 16;
  if (text.size() > kMaxLineBytes) return false;
  std::string word = lower(text);
  // Output of C on various systems: "-nan(ind)", "1.#QNAN0", "-1.#IND00".
  std::string_view number = word;
  if (number.starts_with('-') || number.starts_with('+')) number.remove_prefix(1);
  if (number == "nan" || (number.starts_with("nan(") && number.ends_with(')'))) return true;
  for (const std::string_view kind : {"1.#qnan", "1.#snan", "1.#ind", "1.#nan"})
    if (number.starts_with(kind))
      return number.find_first_not_of('0', kind.size()) == std::string_view::npos;
  if (word.size() > 2 &&
      ((word.front() == '<' && word.back() == '>') || (word.front() == '(' && word.back() == ')')))
    word = word.substr(1, word.size() - 2);
  return std::find(std::begin(kMissingWords), std::end(kMissingWords), word) !=
         std::end(kMissingWords);
}

bool is_comment(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with('%') || line.starts_with("//")) return true;
  if (!line.starts_with('#')) return false;
  const size_t end = line.find_first_of(" \t,;|");
  return end == 1 || !is_missing(line.substr(0, end));
}

bool is_empty_row(std::string_view line, char separator) {
  bool has_separator = false;
  for (const char c : line) {
    has_separator |= c == separator;
    if (c != separator && !is_blank(c) && c != '"') return false;
  }
  return has_separator && separator != ' ';
}

bool parse_number_or_missing(std::string_view text, double& out) {
  if (parse_number(text, out)) return true;
  if (!is_missing(text)) return false;
  out = kMissing;
  return true;
}

}  // namespace throng
