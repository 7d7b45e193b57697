#include "analysis/validation/area_speeds.h"

#include <memory>
#include <utility>

#include "analysis/measures/voronoi.h"

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

std::optional<DensitySpeed> density_and_speed(const Moment& moment, const Velocities& velocities,
                                              const Rectangle& area, const CellOf& cell) {
  double room = 0, weighted_mps = 0;
  int people = 0;
  for (size_t person = 0; person < moment.present.size(); ++person) {
    if (velocities.known[person] == 0 || !area.contains(moment.heads_m[person])) continue;
    const double own_room = cell(moment, person);
    if (own_room <= 0) continue;
    ++people;
    room += own_room;
    weighted_mps += own_room * velocities.of_mps[person].norm();
  }
  if (people == 0) return std::nullopt;
  return DensitySpeed{people / room, weighted_mps / room};
}

AreaSpeeds::AreaSpeeds(const Trial& trial, CellOf cell, std::vector<Rectangle> areas)
    : cell_(std::move(cell)), areas_(std::move(areas)), crowd_(trial.size(), 3) {}

void AreaSpeeds::watch(const Trial& trial, bool counts) {
  if (!clock_.is_due(trial.now_s())) return;
  take(trial, crowd_.next());
  crowd_.pushed();
  if (!counts) return;
  velocities_.find(crowd_, 1, kSample_s);
  for (const Rectangle& area : areas_)
    if (const auto sample = density_and_speed(crowd_.ago(1), velocities_, area, cell_))
      samples_.push_back(*sample);
}

}  // namespace throng::validation
