#include "scenes/run/bodies_there.h"

#include <numeric>

namespace throng {

BodiesThere::BodiesThere(size_t bodies) : ids_(bodies) { std::iota(ids_.begin(), ids_.end(), 0u); }

BodiesView BodiesThere::view(const BodyStates& bodies, std::span<const uint8_t> present) {
  if (present.empty()) return {ids_, bodies.types, bodies.scales, bodies.roots};
  chosen_.clear();
  types_.clear();
  scales_.clear();
  roots_.clear();
  // Once and for all, so that no later step allocates.
  chosen_.reserve(ids_.size());
  types_.reserve(ids_.size());
  scales_.reserve(ids_.size());
  roots_.reserve(ids_.size());
  for (uint32_t id = 0; id < ids_.size(); ++id) {
    if (id < present.size() && present[id] == 0) continue;
    chosen_.push_back(id);
    types_.push_back(bodies.types[id]);
    scales_.push_back(bodies.scales[id]);
    roots_.push_back(bodies.roots[id]);
  }
  return {chosen_, types_, scales_, roots_};
}

}  // namespace throng
