#include "base/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace throng {
namespace {

/// Levenshtein distance: insertions, deletions and substitutions cost one each.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// What was found may hold line ends and bytes that a terminal obeys.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

}  // namespace

InputError::InputError(std::string_view where, std::string_view expected, std::string_view found)
    : std::runtime_error(
          one_line(fmt::format("{}: expected {}, found {}", where, expected, found))),
      where_(one_line(std::string(where))) {}

std::string at_line(std::string_view file, int line) { return fmt::format("{}:{}", file, line); }

std::string did_you_mean(std::string_view found, std::span<const std::string> candidates) {
  // A third of the word wrong is still a slip of the finger; more is another word.
  size_t nearest = found.size() / 3 + 1;
  const std::string* best = nullptr;
  for (const std::string& candidate : candidates) {
    const size_t distance = edit_distance(found, candidate);
    if (distance <= nearest && (best == nullptr || distance < nearest)) {
      nearest = distance;
      best = &candidate;
    }
  }
  return best == nullptr ? "" : fmt::format(" (did you mean '{}'?)", *best);
}

}  // namespace throng
