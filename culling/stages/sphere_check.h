// SphereCheck finds bodies whose parts lie outside the root sphere of their type, which would lose
// pairs without a message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/memory.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/body_type.h"
#include "culling/stages/pass.h"

namespace throng {

/// Part of a posed body outside its sphere, or outside its cylinder while the root is upright.
struct PartOutside {
  size_t part = 0;
  float distance_m = 0;  ///< farthest point's distance from the centre, or the root's z axis
  float radius_m = 0;    ///< radius of the sphere or the cylinder, with the body's scale
  bool is_cylinder = false;
};

/// Returns the first part outside by more than rounding. `poses`: one per part of the type.
std::optional<PartOutside> find_part_outside(const BodyType& type,
                                             const Eigen::Quaternionf& world_from_root, float scale,
                                             const PartPose* poses);

/// Throws InputError if a sphere is smaller than a part of its type, which it then encloses in no
/// pose.
void require_wide_spheres(BodyTypes types);

class SphereCheck {
 public:
  /// Keeps references to `types` and `workers`.
  SphereCheck(BodyTypes types, Workers& workers);

  /// Poses all bodies. Throws InputError for the first one with a part outside.
  void run(const BodiesView& bodies, const PoseSource& source);

 private:
  /// Bodies of one type, consecutive in by_type_.
  struct Batch {
    uint32_t first, count;
    uint32_t outside;  ///< the first of them with a part outside; kNone: none
  };
  static constexpr uint32_t kNone = 0xffffffff;

  size_t plan(const BodiesView& bodies);
  void check(const BodiesView& bodies, const PoseSource& source, Batch& batch,
             std::vector<PartPose>& poses) const;
  [[noreturn]] void reject(const BodiesView& bodies, const PoseSource& source, uint32_t body);

  BodyTypes types_;
  Workers& workers_;
  std::vector<std::vector<PartPose>> poses_;  // by worker, for any batch
  GrowBuffer<uint32_t> by_type_, type_start_;
  GrowBuffer<Batch> batches_;
};

}  // namespace throng
