#include "base/option_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

/// The whole text as a number of type T, or nothing.
template <typename T>
std::optional<T> number_of(const std::string& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

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
    const std::vector<std::string> pieces = pieces_of(text, between);
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

}  // namespace throng
