#include "scenes/file/pair_rules.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "base/text.h"
#include "culling/pair_filter.h"
#include "scenes/file/part_words.h"

namespace throng {
namespace {

/// The length of the prefix of a name: it stands before the name without a blank, as a colon
/// between two names does not have to.
size_t prefix_of(std::string_view name) {
  for (const std::string_view prefix : {kGroupPrefix, kObstaclePrefix})
    if (name.starts_with(prefix) && name.size() > prefix.size() && name[prefix.size()] != ' ')
      return prefix.size();
  return 0;
}

PairRules rules_of(std::string_view text, std::string_view where, bool with_prefixes) {
  const auto prefix = [with_prefixes](std::string_view name) {
    return with_prefixes ? prefix_of(name) : 0;
  };
  PairRules rules;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view entry = without_blanks_around(text.substr(begin, end - begin));
    const size_t colon = entry.find(':', prefix(entry));
    const std::string_view left = without_blanks_around(entry.substr(0, colon));
    const std::string_view right =
        colon == std::string_view::npos ? kAll : without_blanks_around(entry.substr(colon + 1));
    if (part_words(left).empty() || part_words(right).empty() ||
        right.find_first_of(":\n", prefix(right)) != std::string_view::npos)
      throw InputError(where, "names, or pairs of names, as in 'robots: people, hands'",
                       fmt::format("'{}'", entry));
    rules.push_back({std::string(left), std::string(right)});
    begin = end + 1;
  }
  if (rules.size() > PairFilter::kMaxRules)
    throw InputError(where, fmt::format("at most {} pairs of names", PairFilter::kMaxRules),
                     fmt::format("{}", rules.size()));
  return rules;
}

}  // namespace

PairRules pair_rules_of(std::string_view text, std::string_view where) {
  return rules_of(text, where, true);
}

PairRules part_rules_of(std::string_view text, std::string_view where) {
  return rules_of(text, where, false);
}

std::string to_text(const PairRules& rules) {
  std::string text;
  for (const PairRule& rule : rules)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", rule.left, rule.right);
  return text;
}

}  // namespace throng
