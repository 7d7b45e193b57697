#include "crowd/people.h"

#include <algorithm>
#include <numeric>

namespace throng {
namespace {

/// A thousand draws outside [min, max] mean that the distribution is almost outside: use the mean.
constexpr uint64_t kDraws = 1000;

constexpr Distribution inside(double min, double max) {
  return {0.5 * (min + max), 0.25 * (max - min), min, max};
}

// Speeds: Weidmann (1993) for all adults; by age the ranges that RiMEA test 7 quotes from him. His
// range below 30 years begins with small children: young adults have its upper half. Children walk
// at the same Froude number as adults, inside the same range.
//
// Heights: ANSUR II, men and women mixed. Children of 6 to 12 years after the WHO's growth
// reference (2007), whose medians are 1.16 m and 1.50 m. The elderly are 4 cm shorter (Sorkin,
// Muller & Andres 1999: men lose 3 cm and women 5 cm from 30 to 70 years).
constexpr Distribution kAdultHeight_m{1.70, 0.09, 1.45, 2.00};
constexpr Distribution kElderlyHeight_m{1.66, 0.09, 1.41, 1.96};
//
// Styles: our own estimate, because no counts are published. Order: plain, relaxed, brisk, stiff,
// pockets, short_steps.
constexpr StyleShares kAdultStyles = {45, 20, 10, 7, 13, 5};
constexpr StyleShares kElderlyStyles = {30, 10, 0, 10, 10, 40};
constexpr std::array<AgeGroup, kAgeCount> kAgeGroups = {{
    {"adults", "of any age", {1.34, 0.26, 0.5, 2.2}, kAdultHeight_m, kAdultStyles},
    {"children",
     "6 to 12 years",
     {1.18, 0.15, 0.58, 1.61},
     {1.33, 0.12, 1.10, 1.60},
     {45, 40, 15, 0, 0, 0}},
    {"young",
     "under 30 years",
     inside(0.5 * (0.58 + 1.61), 1.61),
     kAdultHeight_m,
     {40, 30, 10, 5, 15, 0}},
    {"middle_aged", "30 to 50 years", inside(1.41, 1.54), kAdultHeight_m, {50, 15, 15, 8, 12, 0}},
    {"elderly", "over 50 years", inside(0.68, 1.41), kElderlyHeight_m, kElderlyStyles},
    {"impaired",
     "people who walk with difficulty",
     inside(0.46, 0.76),
     kElderlyHeight_m,
     {0, 0, 0, 0, 0, 100}},
}};

// Passers-by of a town: our own estimate.
constexpr AgeShares kMixedAges = {0, 0.10, 0.25, 0.35, 0.25, 0.05};

/// Returns the index of a share, with a probability proportional to it; `where` in [0, 1).
template <size_t kCount>
size_t pick(const std::array<double, kCount>& shares, double where) {
  double left = where * std::accumulate(shares.begin(), shares.end(), 0.0);
  size_t last = 0;
  for (size_t i = 0; i < kCount; ++i) {
    if (shares[i] <= 0) continue;
    if (left < shares[i]) return i;
    left -= shares[i];
    last = i;
  }
  return last;  // rounding
}

template <size_t kCount>
std::array<double, kCount> only(size_t index) {
  std::array<double, kCount> shares{};
  shares[index] = 1;
  return shares;
}

}  // namespace

double draw(const Distribution& distribution, uint64_t seed, uint64_t id, Purpose purpose,
            uint64_t time) {
  if (distribution.std_dev == 0) return distribution.mean;
  for (uint64_t attempt = 0; attempt < kDraws; ++attempt) {
    const double value = random_normal({seed, id, kDraws * time + attempt, purpose},
                                       distribution.mean, distribution.std_dev);
    if (value >= distribution.min && value <= distribution.max) return value;
  }
  return distribution.mean;
}

const AgeGroup& age_group(Age age) { return kAgeGroups[static_cast<size_t>(age)]; }

const std::vector<std::string>& age_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const AgeGroup& group : kAgeGroups) all.emplace_back(group.name);
    return all;
  }();
  return names;
}

std::optional<AgeShares> ages_of(std::string_view word) {
  if (word == "mixed") return kMixedAges;
  for (size_t age = 0; age < kAgeCount; ++age)
    if (word == kAgeGroups[age].name) return only<kAgeCount>(age);
  return std::nullopt;
}

std::optional<Age> only_age(const AgeShares& shares) {
  const auto has_share = [](double share) { return share > 0; };
  if (std::count_if(shares.begin(), shares.end(), has_share) != 1) return std::nullopt;
  return static_cast<Age>(std::find_if(shares.begin(), shares.end(), has_share) - shares.begin());
}

Age draw_age(const AgeShares& shares, uint64_t seed, uint64_t id) {
  return static_cast<Age>(pick(shares, random_uniform({seed, id, 0, Purpose::kAge})));
}

const std::vector<std::string>& style_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (size_t style = 0; style < kGaitStyleCount; ++style)
      all.emplace_back(parameters_of(static_cast<GaitStyle>(style)).name);
    return all;
  }();
  return names;
}

std::optional<StyleShares> styles_of(std::string_view word) {
  const std::vector<std::string>& names = style_names();
  const auto found = std::find(names.begin(), names.end(), word);
  if (found == names.end()) return std::nullopt;
  return only<kGaitStyleCount>(static_cast<size_t>(found - names.begin()));
}

GaitStyle draw_style(const StyleShares& shares, uint64_t seed, uint64_t id) {
  return static_cast<GaitStyle>(pick(shares, random_uniform({seed, id, 0, Purpose::kStyle})));
}

}  // namespace throng
