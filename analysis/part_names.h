// What the parts of bodies are called: by themselves and by group.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scenes/run/sink.h"

namespace throng {

// What a part of a body is called in tables.
// Every part of every body of a run has a name.

/// As its model has it; "whole body" where no part was asked, "obstacle" for what is no avatar.
inline std::string part_name(const RunInfo& run, uint32_t body, uint32_t part) {
  if (body >= run.model_of_avatar.size()) return "obstacle";
  const std::vector<Part>& parts = run.models[run.model_of_avatar[body]]->parts;
  return part < parts.size() ? parts[part].name : "whole body";
}

// Body parts as people speak of them: arms, legs, trunk.
// A group follows from the name of a part alone, so that any model's parts have one.

enum class PartGroup : uint8_t { kHead, kTrunk, kArm, kHand, kLeg, kFoot, kOther };
inline constexpr size_t kPartGroups = 7;

/// "lowerLeftArm" is an arm, "pelvis" the trunk; kOther where the name says nothing.
PartGroup part_group(const std::string& part_name);

/// Two groups in any order, as one number below kGroupPairs.
inline constexpr size_t kGroupPairs = kPartGroups * (kPartGroups + 1) / 2;
size_t group_pair(PartGroup a, PartGroup b);
/// "arm and trunk"; "trunk and trunk".
const std::string& name_of_group_pair(size_t pair);

/// The groups of all parts of a run.
class PartGroups {
 public:
  explicit PartGroups(const RunInfo& run);
  PartGroup of(uint32_t avatar, uint32_t part) const;

 private:
  std::vector<uint16_t> model_of_avatar_;
  std::vector<std::vector<PartGroup>> groups_;  ///< by model and part
};

}  // namespace throng
