#include "scenes/ways.h"

#include <algorithm>

namespace throng {

const Rectangle& Stop::area_near(const Eigen::Vector2d& point) const {
  const auto square_m2 = [&](const Rectangle& area) {
    return (point - point.cwiseMax(area.min_m).cwiseMin(area.max_m)).squaredNorm();
  };
  return *std::min_element(
      goal.areas.begin(), goal.areas.end(),
      [&](const Rectangle& a, const Rectangle& b) { return square_m2(a) < square_m2(b); });
}

Ways::Ways(const Scene& scene, Workers& workers) : walkable_(scene), grid_(walkable_) {
  std::vector<std::vector<Rectangle>> goals;  // each once: groups often share them
  for (const Group& group : scene.groups)
    for (const Goal& goal : group.goals)
      if (std::find(goals.begin(), goals.end(), goal.areas) == goals.end())
        goals.push_back(goal.areas);
  fields_.resize(goals.size());
  workers.for_blocks(static_cast<int>(goals.size()), [&](int block, int) {
    const auto goal = static_cast<size_t>(block);
    fields_[goal] = std::make_unique<FlowField>(grid_, goals[goal]);
  });
  for (const Group& group : scene.groups) {
    std::vector<Stop>& route = routes_.emplace_back();
    for (const Goal& goal : group.goals) {
      const auto at = std::find(goals.begin(), goals.end(), goal.areas) - goals.begin();
      route.push_back({goal, fields_[static_cast<size_t>(at)].get()});
    }
    on_arrival_.push_back(group.on_arrival);
    for (const Source& source : group.sources) entrances_.push_back(source.area);
  }
}

bool Ways::leads(const Stop& stop, const Eigen::Vector2d& point) const {
  return stop.field->reaches(point) || stop.field->direction(point).squaredNorm() > 0;
}

}  // namespace throng
