// Text: what may stand in a name or an option that comes from files and command lines, how to show
// the rest, and text that grows piece by piece, or is a field of CSV (RFC 4180).
// One rule: bytes that are no UTF-8, and what commands a terminal, never pass.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace throng {

/// The bytes of the character that `text` begins with, if it is UTF-8 (RFC 3629: no surrogates, the
/// shortest form) and no control character (C0, DEL, C1); otherwise 0.
size_t printable_character(std::string_view text);

/// The first byte that is no UTF-8 (control characters are), or npos.
size_t find_invalid_utf8(std::string_view text);

/// Why a text is no name, in words that follow "found", or "": names are 1 to kMaxNameBytes bytes
/// of printable UTF-8, not all blank.
std::string defect_of_name(std::string_view name);

/// The same text with "\xNN" for each byte of what is not printable: fit for JSON, a table and a
/// name.
std::string escaped(std::string_view text);

/// The beginning of a text for an error, which is one line whatever a file holds: 'escaped...'.
std::string in_quotes(std::string_view text);

/// What stands before, between and behind the separators; of an empty text one empty piece.
std::vector<std::string> split_text(std::string_view text, char between);

/// Without the blanks at both ends.
std::string_view stripped(std::string_view text);

/// A name as a person says it: "upper right leg" of "upperRightLeg", "left hip link" of
/// "left_hip_link". The name itself where nothing is left of it.
std::string display_name(std::string_view name);

std::vector<std::string> display_name(const std::vector<std::string>& names);

/// A number with its noun: "1 pair", "2 pairs"; the second form is `noun` with an s unless given.
template <std::integral Number>
std::string counted(Number number, std::string_view noun, std::string_view plural = {}) {
  std::string text = std::to_string(number) + ' ';
  text += number == 1 || plural.empty() ? noun : plural;
  if (number != 1 && plural.empty()) text += 's';
  return text;
}

/// A name after a file whose name may be anything: escaped(), and cut where it is too long.
std::string name_after(std::string_view file_stem);

/// Adds to the text. fmt's library formats it: fmt::format_to() compiles half of fmt into each file
/// that calls it, three seconds of a compiler's time.
template <typename... Values>
void append(std::string& text, fmt::format_string<Values...> format, const Values&... values) {
  text += fmt::vformat(format, fmt::make_format_args(values...));
}

/// A field of CSV that may hold commas; its own quotes are doubled.
inline std::string csv_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// A name as a field: quoted where it would not be one otherwise.
inline std::string csv_field(const std::string& name) {
  return name.find_first_of(",\"\r\n") == std::string::npos ? name : csv_quoted(name);
}

/// What is not known (NaN) is empty.
inline std::string csv_number(float value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

/// What an option accepts: "" or one line, "expected ..., found ...".
using OptionCheck = std::function<std::string(const std::string& argument)>;

/// Accepts a number in [low, high] (above low if `open`); `what` completes "expected ...".
OptionCheck number_option(double low, double high, bool open, const std::string& what);
/// Accepts a whole number in [low, high].
OptionCheck whole_option(int64_t low, int64_t high, const std::string& what);
/// Accepts one word of `count` pieces with `between` between them, each of which passes `piece`;
/// `what` completes "expected ...".
OptionCheck list_option(OptionCheck piece, size_t count, char between, const std::string& what);
/// Accepts one of the names, with a did-you-mean.
OptionCheck name_option(std::vector<std::string> names);

}  // namespace throng
