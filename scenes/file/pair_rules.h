// Which pairs a scene asks for, by names: of whom with whom, and of which parts.
// One rule: a rule asks for pairs of one on its left and one on its right.
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

/// On the right of a rule that names one side only: all.
inline constexpr std::string_view kAll = "all";

/// Before the name of a group or of an obstacle, whatever else the name may mean.
inline constexpr std::string_view kGroupPrefix = "group:", kObstaclePrefix = "obstacle:";

/// "robots: people, group:doors: people". A name that has a colon or a comma, or that begins or
/// ends with a blank, stands in quotes, single or double: "group:'doors: east': people"; such a
/// quote in it is written twice. Throws InputError, which begins with `where`.
PairRules pair_rules_of(std::string_view text, std::string_view where);
/// The same of parts, whose names have no prefixes and no quotes.
PairRules part_rules_of(std::string_view text, std::string_view where);
std::string to_text(const PairRules& rules);
/// The name of a rule as pair_rules_of() reads it.
std::string rule_name(std::string_view name);

}  // namespace throng
