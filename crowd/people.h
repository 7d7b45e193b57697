// People gives the speeds, heights and gait styles of people by age.
// Invariant: a person's properties follow from the group and from that person's random numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "avatars/gait/gait_style.h"
#include "base/random.h"

namespace throng {

/// A normal distribution truncated at both ends; min <= mean <= max and std_dev >= 0.
struct Distribution {
  double mean = 0;
  double std_dev = 0;
  double min = 0;
  double max = 0;

  bool operator==(const Distribution&) const = default;
};

/// Returns a draw from a distribution, repeated until it lies inside. `time` distinguishes several
/// draws of one person for the same purpose.
double draw(const Distribution& distribution, uint64_t seed, uint64_t id, Purpose purpose,
            uint64_t time = 0);

/// In the order of the columns of AgeShares; append only, because the order is part of every draw.
enum class Age : uint8_t { kAdult, kChild, kYoung, kMiddleAged, kElderly, kImpaired };
inline constexpr size_t kAgeCount = 6;

/// Relative frequencies of gait styles; at least one is above 0.
using StyleShares = std::array<double, kGaitStyleCount>;

struct AgeGroup {
  std::string_view name;     ///< name in scene files
  std::string_view meaning;  ///< for example "30 to 50 years"
  Distribution speed_mps;    ///< desired speed
  Distribution height_m;
  StyleShares styles;
};

/// Properties by age. Desired speeds are the ranges of Weidmann (1993) that RiMEA test 7 uses:
/// their middle and a quarter of their width. Sources of heights and styles are in people.cpp.
const AgeGroup& age_group(Age age);

/// Relative frequencies of ages; at least one is above 0.
using AgeShares = std::array<double, kAgeCount>;
inline constexpr AgeShares kAdultsOnly{1};

/// Names of ages in scene files, by Age.
const std::vector<std::string>& age_names();
/// Shares for a word of a scene file: an age, or "mixed".
std::optional<AgeShares> ages_of(std::string_view word);
/// Returns the only age with a share above 0, if there is one.
std::optional<Age> only_age(const AgeShares& shares);

/// Draws a person's age; probabilities are proportional to the shares.
Age draw_age(const AgeShares& shares, uint64_t seed, uint64_t id);

/// Names of styles in scene files, by GaitStyle.
const std::vector<std::string>& style_names();
/// Returns the shares that give all people the style of this name, if it exists.
std::optional<StyleShares> styles_of(std::string_view word);
/// Draws a person's style; probabilities are proportional to the shares.
GaitStyle draw_style(const StyleShares& shares, uint64_t seed, uint64_t id);

}  // namespace throng
