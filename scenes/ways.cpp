#include "scenes/ways.h"

#include <algorithm>

namespace throng {

Ways::Ways(const Scene& scene, Workers& workers) : walkable_(scene), grid_(walkable_) {
  std::vector<Rectangle> goals;  // each once: groups often share them
  for (const Group& group : scene.groups)
    for (const Rectangle& goal : group.goals)
      if (std::find(goals.begin(), goals.end(), goal) == goals.end()) goals.push_back(goal);
  fields_.resize(goals.size());
  workers.for_blocks(static_cast<int>(goals.size()), [&](int block, int) {
    const auto goal = static_cast<size_t>(block);
    fields_[goal] = std::make_unique<FlowField>(grid_, goals[goal]);
  });
  for (const Group& group : scene.groups) {
    std::vector<Stop>& route = routes_.emplace_back();
    for (const Rectangle& area : group.goals) {
      const auto at = std::find(goals.begin(), goals.end(), area) - goals.begin();
      route.push_back({area, fields_[static_cast<size_t>(at)].get()});
    }
  }
}

}  // namespace throng
