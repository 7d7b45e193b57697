#include "scenes/ways/ways.h"

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

namespace {

/// The pieces of ground that an area lies on, by samples: the rim and inside.
std::vector<int> pieces_of(const NavMesh& mesh, const Goal& goal) {
  constexpr int kSamples = 8;
  std::vector<int> pieces;
  for (const Rectangle& area : goal.areas)
    for (int i = 0; i <= kSamples; ++i)
      for (int j = 0; j <= kSamples; ++j) {
        const Eigen::Vector2d share(i / double{kSamples}, j / double{kSamples});
        const int piece = mesh.piece_at(area.min_m + area.size_m().cwiseProduct(share));
        if (piece >= 0 && std::find(pieces.begin(), pieces.end(), piece) == pieces.end())
          pieces.push_back(piece);
      }
  return pieces;
}

}  // namespace

Ways::Ways(const Scene& scene, Workers& workers) : walkable_(scene), grid_(walkable_) {
  std::vector<std::vector<Rectangle>> goals;  // each once: groups often share them
  for (const Group& group : scene.groups)
    for (const Goal& goal : group.goals)
      if (std::find(goals.begin(), goals.end(), goal.areas) == goals.end())
        goals.push_back(goal.areas);
  fields_.resize(goals.size());
  // Nobody walks in a box of parts.
  if (scene.groups.empty()) return;
  // The mesh first, it takes longest.
  workers.for_blocks(static_cast<int>(goals.size()) + 1, [&](int block, int) {
    if (block == 0) {
      nav_mesh_ = std::make_unique<NavMesh>(walkable_.ground(), walkable_.footprints(),
                                            grid_.passages(), grid_.closures());
    } else {
      const auto goal = static_cast<size_t>(block - 1);
      fields_[goal] = std::make_unique<FlowField>(grid_, goals[goal]);
    }
  });
  for (const Group& group : scene.groups) {
    std::vector<Stop>& route = routes_.emplace_back();
    for (const Goal& goal : group.goals) {
      const auto at = std::find(goals.begin(), goals.end(), goal.areas) - goals.begin();
      route.push_back({goal, fields_[static_cast<size_t>(at)].get(), pieces_of(*nav_mesh_, goal)});
    }
    on_arrival_.push_back(group.on_arrival);
    for (const Source& source : group.sources) entrances_.push_back(source.area);
  }
}

bool Ways::leads(const Stop& stop, const Eigen::Vector2d& point) const {
  if (stop.field->reaches(point)) return true;
  // In the margin of an obstacle the field points out of it, perhaps to the wrong side.
  if (stop.field->direction(point).squaredNorm() == 0) return false;
  const int piece = nav_mesh_->piece_at(point);
  return piece < 0 || std::find(stop.pieces.begin(), stop.pieces.end(), piece) != stop.pieces.end();
}

}  // namespace throng
