#include "analysis/contacts/contact_tracker.h"

namespace throng {

void CrowdDensity::place() {
  if (is_placed_) return;
  is_placed_ = true;
  for (size_t id = 0; id < positions_m_.size(); ++id)
    positions_m_[id] = frame_->roots[id].position_m.head<2>();
  density_.place(positions_m_, frame_->present);
  std::fill(densities_.begin(), densities_.end(), -1);
}

double CrowdDensity::at(uint32_t person) {
  place();
  if (densities_[person] < 0) densities_[person] = density_.around(positions_m_[person]);
  return densities_[person];
}

}  // namespace throng
