#include "scenes/file/pair_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "culling/pair_filter.h"
#include "scenes/file/part_words.h"

namespace throng {
namespace {

/// Length of the prefix of a name. A name follows its prefix without a blank; a colon between two
/// names may have one.
size_t prefix_of(std::string_view name) {
  for (const std::string_view prefix : {kGroupPrefix, kObstaclePrefix})
    if (name.starts_with(prefix) && name.size() > prefix.size() && name[prefix.size()] != ' ' &&
        name[prefix.size()] != ',')
      return prefix.size();
  return 0;
}

/// Length of the quoted name at the start of a text, 0 without a complete one. Doubled quotes are
/// part of the name.
size_t quotes_of(std::string_view text) {
  if (!text.starts_with('"') && !text.starts_with('\'')) return 0;
  for (size_t end = text.find(text[0], 1); end < text.size(); end = text.find(text[0], end + 2))
    if (text.substr(end + 1, 1) != text.substr(0, 1)) return end + 1;
  return 0;
}

std::string without_quotes(std::string_view quoted) {
  std::string name;
  for (size_t i = 1; i + 1 < quoted.size(); ++i) {
    name += quoted[i];
    if (quoted[i] == quoted[0]) ++i;
  }
  return name;
}

std::string take_name(std::string_view& rest, bool is_of_bodies) {
  while (rest.starts_with(' ')) rest.remove_prefix(1);
  const size_t prefix = is_of_bodies ? prefix_of(rest) : 0;
  const size_t quotes = is_of_bodies ? quotes_of(rest.substr(prefix)) : 0;
  const auto stop_from = [&](size_t from) {
    return std::min(rest.find_first_of(":,", from), rest.size());
  };
  const auto take = [&](size_t size) {
    const std::string_view taken = rest.substr(0, size);
    rest.remove_prefix(size);
    return taken;
  };
  if (const size_t end = prefix + quotes, stop = stop_from(end);
      quotes > 0 && stripped(rest.substr(end, stop - end)).empty()) {
    const std::string name = without_quotes(rest.substr(prefix, quotes));
    const std::string_view written = take(stop);
    return name.empty() ? "" : std::string(written.substr(0, prefix)) + name;
  }
  const std::string name(stripped(take(stop_from(prefix))));
  const bool is_name =
      is_of_bodies ? name.find('\n') == std::string::npos : !part_words(name).empty();
  return is_name ? name : "";
}

PairRules rules_of(std::string_view text, std::string_view where, bool is_of_bodies) {
  PairRules rules;
  std::string_view rest = text;
  for (bool goes_on = true; goes_on;) {
    const std::string_view entry = rest;
    PairRule rule{take_name(rest, is_of_bodies), std::string(kAll)};
    if (rest.starts_with(':')) {
      rest.remove_prefix(1);
      rule.right = take_name(rest, is_of_bodies);
    }
    if (rule.left.empty() || rule.right.empty() || rest.starts_with(':'))
      throw InputError(
          where, "names, or pairs of names, as in 'robots: people, hands'",
          fmt::format("'{}'{}",
                      stripped(entry.substr(0, entry.find(',', entry.size() - rest.size()))),
                      is_of_bodies ? "; quote names that contain ':' or ','" : ""));
    rules.push_back(std::move(rule));
    goes_on = rest.starts_with(',');
    if (goes_on) rest.remove_prefix(1);
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
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", rule_name(rule.left),
                        rule_name(rule.right));
  return text;
}

std::string rule_name(std::string_view name) {
  const std::string_view prefix = name.substr(0, prefix_of(name));
  const std::string_view bare = name.substr(prefix.size());
  if (bare.find_first_of(":,\n") == std::string_view::npos && quotes_of(bare) == 0 &&
      bare == stripped(bare))
    return std::string(name);
  std::string text = std::string(prefix) + '"';
  for (const char c : bare) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + '"';
}

}  // namespace throng
