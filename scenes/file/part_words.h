// Part words split the names of body parts into words.
// Invariant: spelling does not matter: "upperLeftArm", "left_upper_arms" and "upper left arm" have
// the same words.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace throng {

/// Words of a name in lower case and singular: arm, left, upper.
std::set<std::string> part_words(std::string_view name);

/// Returns whether the name of a part has all of these words: leftHand and right_hand have "hands".
bool has_words(std::string_view part, std::string_view words);

/// Parts of a body: a part number; a name; words that names have ("hand": both hands); "": all.
using PartChoice = std::variant<int64_t, std::string>;

/// Returns the part numbers that a choice means, ascending. A part of exactly this name is the only
/// one. Throws InputError with `where`, which lists the names, if there is none.
std::vector<uint8_t> chosen_parts(const PartChoice& choice, std::span<const std::string> names,
                                  std::string_view where);

}  // namespace throng
