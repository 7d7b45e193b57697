#include "scenes/file/scene_keys.h"

#include <cassert>

#include "scenes/file/people.h"

namespace throng {

const std::vector<std::pair<std::string_view, std::vector<std::string>>>& scene_keys() {
  static const std::vector<std::pair<std::string_view, std::vector<std::string>>> keys = {
      {"scene",
       {"name", "description", "seed", "step_s", "duration_s", "ground", "groups", "obstacles",
        "culling", "steering", "planted_feet", "kind", "box"}},
      {"culling", {"part_volume", "exact"}},
      {"steering", {"model", "density_speed"}},
      {"group",
       {"name", "count", "spawn", "sources", "goals", "on_arrival", "delay_s", "model", "ages",
        "speed_mps", "height_m", "styles", "radius_m", "driven"}},
      {"ages", age_names()},
      {"styles", style_names()},
      {"goal", {"min_m", "max_m", "nearest_of", "wait_s", "pass"}},
      {"source", {"area", "count", "rate_per_s", "start_s", "random"}},
      {"obstacle",
       {"name", "kind", "position_m", "bottom_m", "heading_deg", "size_m", "diameter_m", "height_m",
        "file"}},
      {"box",
       {"count", "edge_m", "static_every", "min_speed_mps", "max_speed_mps", "max_spin_radps",
        "model"}},
      {"area", {"min_m", "max_m"}},
      {"distribution", {"mean", "deviation", "min", "max"}},
  };
  return keys;
}

const std::vector<std::string>& keys_of(std::string_view map) {
  for (const auto& [name, keys] : scene_keys())
    if (name == map) return keys;
  assert(false && "a map that no scene has");
  static const std::vector<std::string> none;
  return none;
}

}  // namespace throng
