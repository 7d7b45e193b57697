#include "scenes/validation/area_speeds.h"

#include <memory>
#include <utility>

#include "scenes/measures/voronoi.h"

namespace throng::validation {

CellOf voronoi_cells(const Scene& scene) {
  return [cells = std::make_shared<VoronoiCells>(scene), others = std::vector<Eigen::Vector2d>()](
             const Moment& moment, size_t person) mutable {
    constexpr double kNear_m = 2 * VoronoiCells::kCap_m;
    others.clear();
    for (size_t i = 0; i < moment.present.size(); ++i) {
      if (i == person || moment.present[i] == 0) continue;
      if ((moment.heads_m[i] - moment.heads_m[person]).norm() < kNear_m)
        others.push_back(moment.heads_m[i]);
    }
    const std::optional<VoronoiCell> cell = cells->cell(moment.heads_m[person], others);
    return cell ? cell->area_m2 : 0;
  };
}

AreaSpeeds::AreaSpeeds(const Trial& trial, CellOf cell, std::vector<Rectangle> areas)
    : cell_(std::move(cell)), areas_(std::move(areas)), crowd_(trial.size(), 3) {}

void AreaSpeeds::watch(const Trial& trial, bool counts) {
  if (!clock_.is_due(trial.now_s())) return;
  take(trial, crowd_.next());
  crowd_.pushed();
  if (!counts) return;
  const Moment& moment = crowd_.ago(1);
  velocities_.find(crowd_, 1, kSample_s);
  for (const Rectangle& area : areas_) {
    double room = 0, weighted_mps = 0;
    int people = 0;
    for (size_t id = 0; id < trial.size(); ++id) {
      if (velocities_.known[id] == 0 || !area.contains(moment.heads_m[id])) continue;
      const double cell = cell_(moment, id);
      if (cell <= 0) continue;
      ++people;
      room += cell;
      weighted_mps += cell * velocities_.of_mps[id].norm();
    }
    if (people > 0) samples_.push_back({people / room, weighted_mps / room});
  }
}

}  // namespace throng::validation
