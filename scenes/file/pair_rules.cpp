#include "scenes/file/pair_rules.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/errors.h"
#include "base/text.h"
#include "culling/pair_filter.h"
#include "scenes/file/part_words.h"

namespace throng {
PairRules pair_rules_of(std::string_view text, std::string_view where) {
  PairRules rules;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view entry = text.substr(begin, end - begin);
    const size_t colon = entry.find(':');
    const std::string_view left = without_blanks_around(entry.substr(0, colon));
    const std::string_view right =
        colon == std::string_view::npos ? kAll : without_blanks_around(entry.substr(colon + 1));
    if (part_words(left).empty() || part_words(right).empty() ||
        right.find_first_of(":\n") != std::string_view::npos)
      throw InputError(where, "names, or pairs of names, as in 'robots: people, hands'",
                       fmt::format("'{}'", without_blanks_around(entry)));
    rules.push_back({std::string(left), std::string(right)});
    begin = end + 1;
  }
  if (rules.size() > PairFilter::kMaxRules)
    throw InputError(where, fmt::format("at most {} pairs of names", PairFilter::kMaxRules),
                     fmt::format("{}", rules.size()));
  return rules;
}

std::string to_text(const PairRules& rules) {
  std::string text;
  for (const PairRule& rule : rules)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", rule.left, rule.right);
  return text;
}

}  // namespace throng
