#include "culling/stages/slots.h"

#include <algorithm>

#include "culling/fitted.h"

namespace throng {

float reach_m(const BodyType& type) {
  return type.sphere().centre_m.norm() + type.sphere().radius_m;
}

// A test adds up to four times either reach: distance of roots, two translations, two points.
float body_margin_m(float reach_m) { return rounding_margin_m(4 * reach_m); }

Slots::Slots(std::span<const std::shared_ptr<const BodyType>> types) {
  for (const auto& type : types) {
    margin_m_.push_back(body_margin_m(reach_m(*type)));
    static_.push_back(type->is_static());
  }
}

void Slots::begin_frame(const BodiesView& bodies, std::span<const uint32_t> searched,
                        std::span<const uint32_t> large) {
  bodies_ = bodies;
  count_ = searched.size() + large.size();
  body_.resize(count_);
  std::copy(large.begin(), large.end(), std::copy(searched.begin(), searched.end(), body_.data()));
}

}  // namespace throng
