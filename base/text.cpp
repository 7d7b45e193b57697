#include "base/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/errors.h"
#include "base/limits.h"

namespace throng {
namespace {

/// Code point and byte count of the first character of a text; 0 bytes: not UTF-8.
struct Character {
  uint32_t code = 0;
  size_t bytes = 0;
};

Character first_of(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  if (text.empty()) return {};
  if (byte(0) < 0x80) return {byte(0), 1};
  const size_t bytes = byte(0) < 0xe0 ? 2 : byte(0) < 0xf0 ? 3 : 4;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < bytes) return {};
  uint32_t code = byte(0) & (0x7fu >> bytes);
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr uint32_t kMinCode[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kMinCode[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
  return {code, bytes};
}

bool is_control(uint32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// Parses the whole text as a number of type T.
template <typename T>
std::optional<T> number_of(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

size_t printable_character(std::string_view text) {
  const Character first = first_of(text);
  return is_control(first.code) ? 0 : first.bytes;
}

size_t find_invalid_utf8(std::string_view text) {
  for (size_t at = 0; at < text.size();) {
    const size_t bytes = first_of(text.substr(at)).bytes;
    if (bytes == 0) return at;
    at += bytes;
  }
  return std::string_view::npos;
}

std::string defect_of_name(std::string_view name) {
  if (name.find_first_not_of(" \t\r\n") == std::string_view::npos) return "an empty one";
  for (size_t at = 0; at < name.size();) {
    const size_t bytes = printable_character(name.substr(at));
    if (bytes == 0)
      return fmt::format(
          "one with {}: '{}'",
          first_of(name.substr(at)).bytes == 0 ? "bytes that are no UTF-8" : "a control character",
          escaped(name.substr(0, kMaxNameBytes)));
    at += bytes;
  }
  if (name.size() > kMaxNameBytes)
    return fmt::format("one of {} bytes, more than {}", name.size(), kMaxNameBytes);
  return "";
}

std::string escaped(std::string_view text) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const size_t bytes = printable_character(text.substr(at));
    if (bytes > 0)
      out += text.substr(at, bytes);
    else
      out += fmt::format("\\x{:02x}", static_cast<uint8_t>(text[at]));
    at += bytes > 0 ? bytes : 1;
  }
  return out;
}

std::string in_quotes(std::string_view text) {
  constexpr size_t kMaxBytes = 60;
  const bool is_cut = text.size() > kMaxBytes;
  return fmt::format("'{}{}'", escaped(text.substr(0, kMaxBytes)), is_cut ? "..." : "");
}

std::vector<std::string> display_name(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names) out.push_back(display_name(std::string_view(name)));
  return out;
}

std::vector<std::string> split_text(std::string_view text, char between) {
  std::vector<std::string> pieces;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(between, begin), text.size());
    pieces.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return pieces;
}

std::string_view stripped(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::string display_name(std::string_view name) {
  const auto is_lower = [&](size_t i) { return name[i] >= 'a' && name[i] <= 'z'; };
  const auto is_upper = [&](size_t i) { return name[i] >= 'A' && name[i] <= 'Z'; };
  const auto is_digit = [&](size_t i) { return name[i] >= '0' && name[i] <= '9'; };
  // A capital begins a word after a small letter or a digit, and as the last of several capitals
  // ("URDFLink").
  const auto begins_word = [&](size_t i) {
    return i > 0 && is_upper(i) &&
           (is_lower(i - 1) || is_digit(i - 1) ||
            (is_upper(i - 1) && i + 1 < name.size() && is_lower(i + 1)));
  };
  std::string out;
  for (size_t i = 0; i < name.size(); ++i) {
    if (begins_word(i)) out += ' ';
    if (name[i] != '_' && name[i] != ' ')
      out += is_upper(i) ? static_cast<char>(name[i] - 'A' + 'a') : name[i];
    else if (!out.empty() && out.back() != ' ')
      out += ' ';
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out.empty() ? std::string(name) : out;
}

std::string name_after(std::string_view file_stem) {
  std::string name = escaped(file_stem);
  if (name.size() <= kMaxNameBytes) return name;
  constexpr std::string_view kCut = "...";
  size_t end = 0;
  for (size_t bytes; (bytes = printable_character(std::string_view(name).substr(end))) > 0 &&
                     end + bytes + kCut.size() <= kMaxNameBytes;)
    end += bytes;
  return name.substr(0, end) + std::string(kCut);
}

OptionCheck number_option(double low, double high, bool open, const std::string& what) {
  return [=](const std::string& text) -> std::string {
    const std::optional<double> value = number_of<double>(text);
    if (value && std::isfinite(*value) && (open ? *value > low : *value >= low) && *value <= high)
      return "";
    return fmt::format("expected {}, found '{}'", what, text);
  };
}

OptionCheck whole_option(int64_t low, int64_t high, const std::string& what) {
  return [=](const std::string& text) -> std::string {
    const std::optional<int64_t> value = number_of<int64_t>(text);
    if (value && *value >= low && *value <= high) return "";
    return fmt::format("expected {}, found '{}'", what, text);
  };
}

OptionCheck list_option(OptionCheck piece, size_t count, char between, const std::string& what) {
  return [=, piece = std::move(piece)](const std::string& text) -> std::string {
    const std::vector<std::string> pieces = split_text(text, between);
    if (pieces.size() == count &&
        std::all_of(pieces.begin(), pieces.end(), [&](const auto& p) { return piece(p).empty(); }))
      return "";
    return fmt::format("expected {}, found '{}'", what, text);
  };
}

OptionCheck name_option(std::vector<std::string> names) {
  return [names = std::move(names)](const std::string& text) -> std::string {
    if (std::find(names.begin(), names.end(), text) != names.end()) return "";
    return fmt::format("expected one of {}, found '{}'{}", fmt::join(names, ", "), text,
                       did_you_mean(text, names));
  };
}

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

}  // namespace throng
