// Pair rules select by name the pairs of bodies and parts whose contacts and distances are found.
// Invariant: a rule selects pairs with one body on its left side and one on its right.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace throng {

struct PairRule {
  std::string left, right;
  bool operator==(const PairRule&) const = default;
};
using PairRules = std::vector<PairRule>;

/// Right side of a rule that names one side only.
inline constexpr std::string_view kAll = "all";

/// Prefixes of the names of groups and obstacles, for names that also have another meaning.
inline constexpr std::string_view kGroupPrefix = "group:", kObstaclePrefix = "obstacle:";

/// Parses "robots: people, group:doors: people". A name that contains a colon or comma, or begins
/// or ends with a blank, stands in single or double quotes: "group:'doors: east': people". A quote
/// inside is doubled. Throws InputError at `where`.
PairRules pair_rules_of(std::string_view text, std::string_view where);
/// Parses rules of parts, whose names have neither prefixes nor quotes.
PairRules part_rules_of(std::string_view text, std::string_view where);
std::string to_text(const PairRules& rules);
std::string rule_name(std::string_view name);

}  // namespace throng
