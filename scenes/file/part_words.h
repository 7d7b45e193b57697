// Parts of a body by words of their names.
// One rule: the same part whoever named it: "upperLeftArm", "left_upper_arms" and "upper left arm"
// have the same words.
#pragma once

#include <set>
#include <string>
#include <string_view>

namespace throng {

/// In lower case and singular: arm, left, upper.
std::set<std::string> part_words(std::string_view name);

/// Whether the name of a part has all of these words: leftHand and right_hand have "hands".
bool has_words(std::string_view part, std::string_view words);

}  // namespace throng
