#include "culling/stages/sphere_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/counting_sort.h"
#include "base/errors.h"
#include "culling/fitted.h"
#include "culling/stages/slots.h"

namespace throng {
namespace {

using Eigen::Vector3f;
using Pose = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>, Eigen::Aligned16>;

/// Sphere and cylinder of a body, relative to its root position, in world axes.
struct Enclosure {
  Vector3f centre_m, axis;
  float radius_m, upright_m;  ///< include a tolerance for rounding; infinite if not upright

  bool holds(const Vector3f& middle_m, float reach_m) const {
    return (middle_m - centre_m).norm() + reach_m <= radius_m &&
           (std::isinf(upright_m) || from_axis_m(middle_m) + reach_m <= upright_m);
  }
  float from_axis_m(const Vector3f& point_m) const {
    return (point_m - axis * axis.dot(point_m)).norm();
  }
};

Enclosure enclosure_of(const BodyType& type, const Eigen::Quaternionf& world_from_root,
                       float scale) {
  const RootSphere& sphere = type.sphere();
  const float tolerance_m = scale * body_margin_m(reach_m(type));
  const Eigen::Matrix3f turn = world_from_root.toRotationMatrix();
  const bool is_upright = world_from_root.x() == 0 && world_from_root.y() == 0;
  return {turn * (scale * sphere.centre_m), turn.col(2), scale * sphere.radius_m + tolerance_m,
          is_upright ? scale * sphere.upright_radius_m + tolerance_m
                     : std::numeric_limits<float>::infinity()};
}

/// Farthest points of a part; all of its points are tested.
std::optional<PartOutside> outside(const PartShape& part, const Pose& pose, float scale,
                                   const Enclosure& body) {
  float from_centre_m = 0, from_axis_m = 0;
  for (const Vector3f& point : part.points) {
    const Vector3f at_m = pose.leftCols<3>() * (scale * point) + pose.col(3);
    if (!at_m.allFinite()) return PartOutside{0, at_m.norm(), body.radius_m, false};
    from_centre_m = std::max(from_centre_m, (at_m - body.centre_m).norm());
    from_axis_m = std::max(from_axis_m, body.from_axis_m(at_m));
  }
  if (from_centre_m > body.radius_m) return PartOutside{0, from_centre_m, body.radius_m, false};
  if (from_axis_m > body.upright_m) return PartOutside{0, from_axis_m, body.upright_m, true};
  return std::nullopt;
}

/// Lower bound of the radius of every sphere around the points, in metres.
float min_radius_m(const PartShape& part) {
  const Slabs slabs = Slabs::around(part.points);
  float out_m = 0;
  for (size_t i = 0; i < slabs.slab.size(); ++i)
    out_m = std::max(out_m, slabs.slab[i].half / direction_length(static_cast<int>(i)));
  return out_m;
}

}  // namespace

std::optional<PartOutside> find_part_outside(const BodyType& type,
                                             const Eigen::Quaternionf& world_from_root, float scale,
                                             const PartPose* poses) {
  const Enclosure body = enclosure_of(type, world_from_root, scale);
  const std::vector<OrdopTable>& tables = type.volumes().tables();
  for (size_t part = 0; part < tables.size(); ++part) {
    const Pose pose(&poses[part].rows[0][0]);
    // The ball around the part's box usually lies inside, which spares the points.
    const Vector3f origin(tables[part].origin), half(tables[part].half_box);
    const Vector3f middle_m = pose.leftCols<3>() * (scale * origin) + pose.col(3);
    if (body.holds(middle_m, scale * half.norm())) continue;
    if (std::optional<PartOutside> found = outside(type.parts()[part], pose, scale, body)) {
      found->part = part;
      return found;
    }
  }
  return std::nullopt;
}

void require_wide_spheres(BodyTypes types) {
  for (size_t i = 0; i < types.size(); ++i) {
    const float radius_m = types[i]->sphere().radius_m;
    const float tolerance_m = body_margin_m(reach_m(*types[i]));
    const std::vector<PartShape>& parts = types[i]->parts();
    for (size_t part = 0; part < parts.size(); ++part)
      if (const float min_m = min_radius_m(parts[part]); !(min_m <= radius_m + tolerance_m))
        throw InputError(fmt::format("types[{}]", i),
                         fmt::format("a root sphere of at least {:.4g} m, which part {} needs in "
                                     "any pose",
                                     min_m, part),
                         fmt::format("a radius of {:.4g} m", radius_m));
  }
}

SphereCheck::SphereCheck(BodyTypes types, Workers& workers)
    : types_(types), workers_(workers), poses_(static_cast<size_t>(workers.threads())) {
  size_t parts = 0;
  for (const auto& type : types) {
    parts = std::max(parts, type->parts().size());
    type->volumes().tables();
  }
  for (std::vector<PartPose>& poses : poses_) poses.resize(parts * PoseSource::kMaxBatch);
}

/// Sorts the bodies by type, as poses are requested for bodies of one type. Returns the number of
/// batches.
size_t SphereCheck::plan(const BodiesView& bodies) {
  constexpr uint32_t kBatch = PoseSource::kMaxBatch;
  const size_t count = bodies.ids.size();
  by_type_.resize(count);
  type_start_.resize(types_.size() + 2);
  batches_.resize(count / kBatch + types_.size());
  counting_sort(
      count, types_.size(), type_start_.data(), [&](size_t i) { return bodies.types[i]; },
      [&](size_t i, uint32_t at) { by_type_[at] = static_cast<uint32_t>(i); });
  size_t batches = 0;
  for (size_t type = 0; type < types_.size(); ++type) {
    const uint32_t end = type_start_[type + 1];
    for (uint32_t first = type_start_[type]; first < end; first += kBatch)
      batches_[batches++] = {first, std::min(kBatch, end - first), kNone};
  }
  return batches;
}

void SphereCheck::check(const BodiesView& bodies, const PoseSource& source, Batch& batch,
                        std::vector<PartPose>& poses) const {
  const std::span<const uint32_t> chosen{by_type_.data() + batch.first, batch.count};
  const BodyType& type = *types_[bodies.types[chosen.front()]];
  const size_t parts = type.parts().size();
  source.poses(chosen, {poses.data(), parts * chosen.size()});
  for (size_t i = 0; i < chosen.size(); ++i) {
    const uint32_t body = chosen[i];
    if (!find_part_outside(type, bodies.roots[body].world_from_root, bodies.scales[body],
                           poses.data() + i * parts))
      continue;
    batch.outside = body;
    return;
  }
}

void SphereCheck::run(const BodiesView& bodies, const PoseSource& source) {
  const size_t batches = plan(bodies);
  workers_.for_blocks(static_cast<int>(batches), [&](int index, int worker) {
    check(bodies, source, batches_[static_cast<size_t>(index)],
          poses_[static_cast<size_t>(worker)]);
  });
  uint32_t first = kNone;
  for (size_t i = 0; i < batches; ++i) first = std::min(first, batches_[i].outside);
  if (first != kNone) reject(bodies, source, first);
}

void SphereCheck::reject(const BodiesView& bodies, const PoseSource& source, uint32_t body) {
  const BodyType& type = *types_[bodies.types[body]];
  std::vector<PartPose>& poses = poses_.front();
  source.poses({&body, 1}, {poses.data(), type.parts().size()});
  const PartOutside found =
      find_part_outside(type, bodies.roots[body].world_from_root, bodies.scales[body], poses.data())
          .value_or(PartOutside());
  const char* const from = found.is_cylinder ? "the root's z axis" : "the centre of its sphere";
  throw InputError(fmt::format("body {}", bodies.ids[body]),
                   fmt::format("parts within {:.4g} m of {} (RootSphere of type {})",
                               found.radius_m, from, bodies.types[body]),
                   fmt::format("part {} at {:.4g} m", found.part, found.distance_m));
}

}  // namespace throng
