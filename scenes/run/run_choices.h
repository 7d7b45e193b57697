// What somebody asks of a run beside its scene: how many people, how long, how contacts and
// distances are found.
// One rule: what is not asked for stays as the scene has it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenes/file/scene.h"

namespace throng {

struct RunChoices {
  std::optional<int> avatars;
  std::optional<double> seconds;
  std::optional<uint64_t> seed;
  std::optional<SteeringKind> steering;
  std::optional<PartVolumes> part_volume;
  bool exact = false;
  std::optional<double> near_m, person_near_m;
  std::optional<PairRules> between, parts;
};

/// Changes the scene; says on `notes` what else had to change with it. Returns how many times
/// longer the plan is, see scale_to(). A recording is not made longer than it is. Throws
/// InputError.
double apply(const RunChoices& choices, Scene& scene, std::vector<std::string>& notes);

}  // namespace throng
