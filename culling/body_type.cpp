#include "culling/body_type.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "culling/fitted.h"

namespace throng {

BodyType::BodyType(std::vector<PartShape> parts, const RootSphere& sphere, bool is_static)
    : parts_(std::move(parts)),
      sphere_(sphere),
      is_static_(is_static),
      volumes_(std::make_unique<Volumes>(parts_)) {
  assert(!parts_.empty() && parts_.size() <= kMaxParts);
  assert(std::none_of(parts_.begin(), parts_.end(),
                      [](const PartShape& part) { return part.points.empty(); }));
}

BodyType::~BodyType() = default;

bool BodyType::has_triangles() const {
  return std::all_of(parts_.begin(), parts_.end(),
                     [](const PartShape& part) { return !part.triangles.empty(); });
}

}  // namespace throng
