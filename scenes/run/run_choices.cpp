#include "scenes/run/run_choices.h"

#include <fmt/format.h>

namespace throng {

double apply(const RunChoices& choices, Scene& scene, std::vector<std::string>& notes) {
  if (choices.seconds && scene.recorded && *choices.seconds > scene.duration_s)
    notes.push_back(fmt::format("{} is over after {:.6g} s", scene.name, scene.duration_s));
  else if (choices.seconds)
    scene.duration_s = *choices.seconds;
  if (choices.seed) scene.seed = *choices.seed;
  if (choices.steering) scene.steering.model = *choices.steering;
  if (choices.part_volume) scene.part_volume = *choices.part_volume;
  if (choices.exact) scene.exact = true;
  if (choices.near_m) scene.near_m = *choices.near_m;
  if (choices.person_near_m) scene.person_near_m = *choices.person_near_m;
  if (choices.between) scene.between = *choices.between;
  if (choices.parts) scene.parts = *choices.parts;
  return choices.avatars ? scale_to(scene, *choices.avatars, notes) : 1;
}

}  // namespace throng
