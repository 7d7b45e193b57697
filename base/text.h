// Text functions validate, quote and split names and options, and write CSV fields (RFC 4180).
// Invariant: invalid UTF-8 and terminal control sequences never pass.
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

/// Bytes of the first character of `text` if it is valid UTF-8 (RFC 3629: no surrogates, shortest
/// form) and no control character (C0, DEL, C1); otherwise 0.
size_t printable_character(std::string_view text);

/// Position of the first byte that is not UTF-8 (control characters are), or npos.
size_t find_invalid_utf8(std::string_view text);

/// Why a text is not a name, as words after "found", or "". Names are 1 to kMaxNameBytes bytes of
/// printable UTF-8, not all blank.
std::string defect_of_name(std::string_view name);

/// The text with "\xNN" for each unprintable byte: fit for JSON, a table and a name.
std::string escaped(std::string_view text);

/// The beginning of a text for a one-line error: 'escaped...'.
std::string in_quotes(std::string_view text);

/// The pieces between the separators; one empty piece for an empty text.
std::vector<std::string> split_text(std::string_view text, char between);

/// The text without the blanks at both ends.
std::string_view stripped(std::string_view text);

/// A readable name: "upper right leg" for "upperRightLeg", "left hip link" for "left_hip_link". The
/// name itself if nothing else remains.
std::string display_name(std::string_view name);

std::vector<std::string> display_name(const std::vector<std::string>& names);

/// A number with its noun: "1 pair", "2 pairs"; the plural is `noun` with an s by default.
template <std::integral Number>
std::string counted(Number number, std::string_view noun, std::string_view plural = {}) {
  std::string text = std::to_string(number) + ' ';
  text += number == 1 || plural.empty() ? noun : plural;
  if (number != 1 && plural.empty()) text += 's';
  return text;
}

/// A name made from a file's stem: escaped() and cut to the limit.
std::string name_after(std::string_view file_stem);

/// Appends formatted text. Compiled once in fmt's library: fmt::format_to() would add three seconds
/// to the compilation of each file that calls it.
template <typename... Values>
void append(std::string& text, fmt::format_string<Values...> format, const Values&... values) {
  text += fmt::vformat(format, fmt::make_format_args(values...));
}

/// A quoted CSV field; quotes inside are doubled.
inline std::string csv_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

/// A name as a CSV field, quoted if needed.
inline std::string csv_field(const std::string& name) {
  return name.find_first_of(",\"\r\n") == std::string::npos ? name : csv_quoted(name);
}

/// A number as a CSV field; NaN (unknown) is empty.
inline std::string csv_number(float value) {
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

/// Checks an argument; returns "" or one line, "expected ..., found ...".
using OptionCheck = std::function<std::string(const std::string& argument)>;

/// Accepts a number in [low, high] (above low if `open`); `what` completes "expected ...".
OptionCheck number_option(double low, double high, bool open, const std::string& what);
/// Accepts a whole number in [low, high].
OptionCheck whole_option(int64_t low, int64_t high, const std::string& what);
/// Accepts one word of `count` pieces separated by `between`, each of which passes `piece`; `what`
/// completes "expected ...".
OptionCheck list_option(OptionCheck piece, size_t count, char between, const std::string& what);
/// Accepts one of the names; suggests a similar one otherwise.
OptionCheck name_option(std::vector<std::string> names);

/// Escapes a text for the content of an XML element, not for an attribute: quotes stay. The text is
/// valid UTF-8 without control characters, see escaped().
std::string xml_text(std::string_view text);

}  // namespace throng
