// The people of a crowd: how fast, how tall and in which style those of an age walk.
// One rule: what a person is like follows from the group and from random numbers of that person
// alone.
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

/// A normal distribution cut off at both ends; always min <= mean <= max and deviation >= 0.
struct Distribution {
  double mean = 0;
  double std_dev = 0;
  double min = 0;
  double max = 0;

  bool operator==(const Distribution&) const = default;
};

/// A draw from a distribution: repeated until it lies inside. `time` tells several draws of one
/// person for the same purpose apart.
double draw(const Distribution& distribution, uint64_t seed, uint64_t id, Purpose purpose,
            uint64_t time = 0);

/// In the order of the columns of AgeShares; append only, the order is part of every draw.
enum class Age : uint8_t { kAdult, kChild, kYoung, kMiddleAged, kElderly, kImpaired };
inline constexpr size_t kAgeCount = 6;

/// How many walk in each style, relative to the others; at least one is above 0.
using StyleShares = std::array<double, kGaitStyleCount>;

/// What people of an age are like.
struct AgeGroup {
  std::string_view name;     ///< in scene files
  std::string_view meaning;  ///< "30 to 50 years"
  Distribution speed_mps;    ///< free speed
  Distribution height_m;
  StyleShares styles;
};

/// Free speeds lie in the ranges of Weidmann (1993) that RiMEA test 7 uses: their middle, a quarter
/// of their width. people.cpp tells where heights and styles come from.
const AgeGroup& age_group(Age age);

/// How many of each age, relative to the others; at least one is above 0.
using AgeShares = std::array<double, kAgeCount>;
inline constexpr AgeShares kAdultsOnly{1};

/// Names of ages in scene files, by Age.
const std::vector<std::string>& age_names();
/// The shares that one word of a scene file stands for: an age, or "mixed".
std::optional<AgeShares> ages_of(std::string_view word);
/// The only age that has a share, if there is one.
std::optional<Age> only_age(const AgeShares& shares);

/// The age of a person: each as often as its share.
Age draw_age(const AgeShares& shares, uint64_t seed, uint64_t id);

/// Names of styles in scene files, by GaitStyle.
const std::vector<std::string>& style_names();
/// Everybody in the style of this name, if there is one.
std::optional<StyleShares> styles_of(std::string_view word);
/// The style of a person: each as often as its share.
GaitStyle draw_style(const StyleShares& shares, uint64_t seed, uint64_t id);

}  // namespace throng
