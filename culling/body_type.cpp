#include "culling/body_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/errors.h"
#include "base/limits.h"
#include "culling/fitted.h"

namespace throng {

namespace {

/// Beyond this limit volumes leave the range of float, and pairs would be lost.
std::vector<PartShape> described(std::vector<PartShape> parts) {
  constexpr auto kMax_m = static_cast<float>(kMaxDescribed);
  for (size_t i = 0; i < parts.size(); ++i)
    for (const Eigen::Vector3f& point : parts[i].points)
      for (const float at_m : point)
        if (!(std::abs(at_m) <= kMax_m))
          throw InputError(fmt::format("parts[{}]", i),
                           fmt::format("coordinates of at most {:g} m", kMax_m),
                           fmt::format("{:g}", at_m));
  return parts;
}

}  // namespace

BodyType::BodyType(std::vector<PartShape> parts, const RootSphere& sphere, bool is_static)
    : parts_(described(std::move(parts))),
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
