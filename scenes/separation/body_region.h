// BodyRegion assigns body parts to regions of the human body, as studies of human-robot contact do.
// Invariant: the region follows from the part's name alone; an unknown or ambiguous name is kOther.
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
  kOther  ///< the name matches no region
};
inline constexpr size_t kBodyRegions = 9;

/// "head", "upper_arms", ..., "other".
std::string_view name_of(BodyRegion region);

/// Region of a part: "lowerLeftArm" is in kLowerArms, "pelvis" in kTrunk; case is ignored.
BodyRegion body_region(std::string_view part_name);

}  // namespace throng
