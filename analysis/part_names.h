// part_names maps body parts to names and to groups such as arm and trunk.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/run/sink.h"

namespace throng {

/// Name of a part as in its model. "whole body" if culling tests no parts, "obstacle" if the body
/// is no avatar.
inline std::string part_name(const RunInfo& run, uint32_t body, uint32_t part) {
  if (body >= run.model_of_avatar.size()) return "obstacle";
  const std::vector<Part>& parts = run.models[run.model_of_avatar[body]]->parts;
  return part < parts.size() ? parts[part].name : "whole body";
}

// The group of a part follows from its name alone, so it is defined for any model.

enum class PartGroup : uint8_t { kHead, kTrunk, kArm, kHand, kLeg, kFoot, kOther };
inline constexpr size_t kPartGroups = 7;

/// "lowerLeftArm" is an arm, "pelvis" belongs to the trunk; kOther if the name is not recognised.
PartGroup part_group(const std::string& part_name);

/// Number of an unordered pair of groups, below kGroupPairs.
inline constexpr size_t kGroupPairs = kPartGroups * (kPartGroups + 1) / 2;
size_t group_pair(PartGroup a, PartGroup b);
/// Name of a pair of groups: "arm and trunk", "trunk and trunk".
const std::string& name_of_group_pair(size_t pair);

/// Groups of all parts of a run.
class PartGroups {
 public:
  explicit PartGroups(const RunInfo& run);
  PartGroup of(uint32_t avatar, uint32_t part) const;

 private:
  std::vector<uint16_t> model_of_avatar_;
  std::vector<std::vector<PartGroup>> groups_;  ///< indexed by model, then part
};

}  // namespace throng
