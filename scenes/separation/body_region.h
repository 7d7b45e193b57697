// Regions of the body, as studies of robots beside people tell them apart.
// One rule: a region follows from the name of a part alone; a name that says nothing, or two
// things, is of no region and said so.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace throng {

enum class BodyRegion : uint8_t {
  kHead,
  kNeck,
  kTrunk,
  kUpperArms,
  kLowerArms,
  kHands,
  kLegs,
  kFeet,
  kOther  ///< the name says nothing
};
inline constexpr size_t kBodyRegions = 9;

/// "head", "upper_arms", ..., "other".
std::string_view name_of(BodyRegion region);

/// "lowerLeftArm" is of the lower arms, "pelvis" of the trunk; large and small letters are the
/// same.
BodyRegion body_region(std::string_view part_name);

}  // namespace throng
