// Part words split the names of body parts into words.
// Invariant: spelling does not matter: "upperLeftArm", "left_upper_arms" and "upper left arm" have
// the same words.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace throng {

/// Words of a name in lower case and singular: arm, left, upper.
std::set<std::string> part_words(std::string_view name);

/// Returns whether the name of a part has all of these words: leftHand and right_hand have "hands".
bool has_words(std::string_view part, std::string_view words);

}  // namespace throng
