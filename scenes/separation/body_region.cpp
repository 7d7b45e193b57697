#include "scenes/separation/body_region.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace throng {
namespace {

constexpr std::array<std::string_view, kBodyRegions> kNames = {
    "head", "neck", "trunk", "upper_arms", "lower_arms", "hands", "legs", "feet", "other"};

struct Row {
  BodyRegion region;
  std::string_view word, other_word = "";
};
constexpr Row kRows[] = {{BodyRegion::kHead, "head"},
                         {BodyRegion::kHead, "face"},
                         {BodyRegion::kHead, "skull"},
                         {BodyRegion::kNeck, "neck"},
                         {BodyRegion::kTrunk, "torso"},
                         {BodyRegion::kTrunk, "trunk"},
                         {BodyRegion::kTrunk, "chest"},
                         {BodyRegion::kTrunk, "thorax"},
                         {BodyRegion::kTrunk, "abdomen"},
                         {BodyRegion::kTrunk, "spine"},
                         {BodyRegion::kTrunk, "pelvis"},
                         {BodyRegion::kUpperArms, "upper", "arm"},
                         {BodyRegion::kLowerArms, "lower", "arm"},
                         {BodyRegion::kLowerArms, "forearm"},
                         {BodyRegion::kHands, "hand"},
                         {BodyRegion::kHands, "finger"},
                         {BodyRegion::kHands, "thumb"},
                         {BodyRegion::kLegs, "leg"},
                         {BodyRegion::kLegs, "thigh"},
                         {BodyRegion::kLegs, "shin"},
                         {BodyRegion::kLegs, "calf"},
                         {BodyRegion::kLegs, "knee"},
                         {BodyRegion::kFeet, "foot"},
                         {BodyRegion::kFeet, "feet"},
                         {BodyRegion::kFeet, "toe"}};

}  // namespace

std::string_view name_of(BodyRegion region) { return kNames[static_cast<size_t>(region)]; }

BodyRegion body_region(std::string_view part_name) {
  std::string name(part_name);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  BodyRegion found = BodyRegion::kOther;
  for (const Row& row : kRows) {
    if (name.find(row.word) == std::string::npos || name.find(row.other_word) == std::string::npos)
      continue;
    if (found != BodyRegion::kOther && found != row.region) return BodyRegion::kOther;
    found = row.region;
  }
  return found;
}

}  // namespace throng
