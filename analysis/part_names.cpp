#include "analysis/part_names.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace throng {
namespace {

constexpr const char* kNames[kPartGroups] = {"head", "trunk", "arm",  "hand",
                                             "leg",  "foot",  "other"};

constexpr std::pair<const char*, PartGroup> kWords[] = {
    // First, because "forearm" and similar names also contain "arm" or "leg".
    {"hand", PartGroup::kHand},   {"foot", PartGroup::kFoot},    {"head", PartGroup::kHead},
    {"torso", PartGroup::kTrunk}, {"pelvis", PartGroup::kTrunk}, {"trunk", PartGroup::kTrunk},
    {"chest", PartGroup::kTrunk}, {"arm", PartGroup::kArm},      {"leg", PartGroup::kLeg},
    {"thigh", PartGroup::kLeg},   {"shin", PartGroup::kLeg}};

}  // namespace

PartGroup part_group(const std::string& part_name) {
  std::string name = part_name;
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& [word, group] : kWords)
    if (name.find(word) != std::string::npos) return group;
  return PartGroup::kOther;
}

size_t group_pair(PartGroup a, PartGroup b) {
  const auto [low, high] = std::minmax({static_cast<size_t>(a), static_cast<size_t>(b)});
  return high * (high + 1) / 2 + low;
}

const std::string& name_of_group_pair(size_t pair) {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out(kGroupPairs);
    for (size_t a = 0; a < kPartGroups; ++a)
      for (size_t b = 0; b <= a; ++b)
        out[group_pair(static_cast<PartGroup>(a), static_cast<PartGroup>(b))] =
            std::string(kNames[b]) + " and " + kNames[a];
    return out;
  }();
  return names[pair];
}

PartGroups::PartGroups(const RunInfo& run) : model_of_avatar_(run.model_of_avatar) {
  for (const std::shared_ptr<const Model>& model : run.models) {
    std::vector<PartGroup>& groups = groups_.emplace_back();
    for (const Part& part : model->parts) groups.push_back(part_group(part.name));
  }
}

PartGroup PartGroups::of(uint32_t avatar, uint32_t part) const {
  return part == kWholeBody ? PartGroup::kOther : groups_[model_of_avatar_[avatar]][part];
}

}  // namespace throng
