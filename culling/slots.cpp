#include "culling/slots.h"

#include "culling/fitted.h"

namespace throng {

float reach_m(const BodyType& type) {
  return type.sphere().centre_m.norm() + type.sphere().radius_m;
}

// Lengths of up to four times either reach enter a test: the distance of the roots, two
// translations and two points.
float body_margin_m(float reach_m) { return rounding_margin_m(4 * reach_m); }

Slots::Slots(std::span<const std::shared_ptr<const BodyType>> types) {
  for (const auto& type : types) {
    margin_m_.push_back(body_margin_m(reach_m(*type)));
    static_.push_back(type->is_static());
  }
}

void Slots::begin_frame(size_t count) {
  count_ = count;
  slots_.resize(count);
}

void Slots::fill(size_t slot, uint32_t body, const BodiesView& bodies) {
  const uint16_t type = bodies.types[body];
  const float scale = bodies.scales[body];
  const Eigen::Vector3d& root = bodies.roots[body].position_m;
  slots_[slot] = {{root.x(), root.y(), root.z()}, scale, scale * margin_m_[type], body, type};
}

}  // namespace throng
