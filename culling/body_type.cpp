#include "culling/body_type.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "culling/volumes/fitted.h"

namespace throng {

BodyType::BodyType(std::vector<PartShape> parts, const RootSphere& sphere, bool is_static)
    : parts_(std::move(parts)),
      sphere_(sphere),
      is_static_(is_static),
      volumes_(std::make_unique<Volumes>()) {
  assert(!parts_.empty() && parts_.size() <= kMaxParts);
  for (const PartShape& part : parts_) {
    volumes_->slabs.push_back(Slabs::around(part.points));
    volumes_->ordops.emplace_back(part.points);
    volumes_->ordop_lanes_14.emplace_back(volumes_->slabs.back(), 14);
    volumes_->ordop_lanes_18.emplace_back(volumes_->slabs.back(), 18);
    volumes_->ordop_lanes_26.emplace_back(volumes_->slabs.back(), 26);
    volumes_->spheres.push_back(Sphere::fit(part.points));
    volumes_->aabbs.push_back(Aabb::fit(part.points));
    volumes_->obbs.push_back(Obb::fit(part.points));
  }
  if (!has_triangles()) return;
  for (const PartShape& part : parts_) volumes_->surfaces.emplace_back(part.points, part.triangles);
}

BodyType::~BodyType() = default;

bool BodyType::has_triangles() const {
  return std::all_of(parts_.begin(), parts_.end(),
                     [](const PartShape& part) { return !part.triangles.empty(); });
}

}  // namespace throng
