// BodyType::Volumes holds the volumes fitted to the parts of a type, inside culling only.
// Invariant: a volume is fitted once, on first use by any thread, in the part's frame. A pass
// requests its volumes on construction, so that a step only reads.
#pragma once

#include <array>
#include <atomic>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include "culling/body_type.h"
#include "culling/distance/hull_depth.h"
#include "culling/kernels/kernels.h"
#include "culling/triangles/triangle_bvh.h"
#include "culling/volumes/nearby_points.h"
#include "culling/volumes/ordop_table.h"
#include "culling/volumes/volume_list.h"

namespace throng {

/// One fitted object per part of a type, created once.
template <typename Fitted>
class FittedOnce {
 public:
  template <typename Fit>
  const std::vector<Fitted>& get(const std::vector<PartShape>& parts, const Fit& fit) const {
    if (!is_fitted_.load(std::memory_order_acquire)) {
      const std::lock_guard lock(mutex_);
      if (!is_fitted_.load(std::memory_order_relaxed)) {
        fitted_.reserve(parts.size());
        for (const PartShape& part : parts) fitted_.push_back(fit(part));
        is_fitted_.store(true, std::memory_order_release);
      }
    }
    return fitted_;
  }

 private:
  mutable std::atomic<bool> is_fitted_ = false;
  mutable std::mutex mutex_;
  mutable std::vector<Fitted> fitted_;
};

struct BodyType::Volumes {
 public:
  explicit Volumes(const std::vector<PartShape>& parts) : parts_(parts) {}

  /// Fitted volumes, one per part, as in all functions below.
  template <BoundingVolume V>
  const std::vector<typename V::Fitted>& of() const {
    return std::get<kVolumeIndex<V>>(volumes_).get(
        parts_, [](const PartShape& part) { return V::fit(part.points); });
  }
  /// or-DOPs as the kernels read them; part boxes are also computed from these.
  const std::vector<OrdopTable>& tables() const {
    return tables_.get(parts_, [](const PartShape& part) { return OrdopTable(part.points); });
  }
  template <typename V>
  const std::vector<OrdopLanes>& lanes() const {
    constexpr int kCount = KernelsOf<V>::kDirectionCount;
    return lanes_[kVolumeIndex<V>].get(parts_, [](const PartShape& part) {
      return OrdopLanes(Slabs::around(part.points), kCount);
    });
  }
  /// Triangle trees. Requires triangles in every part (see BodyType::has_triangles()).
  const std::vector<TriangleBvh>& surfaces() const {
    return surfaces_.get(
        parts_, [](const PartShape& part) { return TriangleBvh(part.points, part.triangles); });
  }
  /// Convex hulls of the points on each part, for distances and penetration depths.
  const std::vector<ConvexHull>& hulls() const {
    return hulls_.get(parts_, [](const PartShape& part) { return ConvexHull(points_on(part)); });
  }
  const std::vector<NearbyPoints>& nearby_points() const {
    return nearby_points_.get(parts_,
                              [](const PartShape& part) { return NearbyPoints(points_on(part)); });
  }

 private:
  /// All points or, if there are triangles, their corners.
  static std::vector<Eigen::Vector3f> points_on(const PartShape& part);

  template <typename List>
  struct FitsOf;
  template <typename... Entries>
  struct FitsOf<const std::tuple<Entries...>> {
    using Type = std::tuple<FittedOnce<typename Entries::Volume::Fitted>...>;
  };

  const std::vector<PartShape>& parts_;
  FitsOf<decltype(kVolumeList)>::Type volumes_;
  FittedOnce<OrdopTable> tables_;
  std::array<FittedOnce<OrdopLanes>, kVolumeCount> lanes_;  // only volumes with kernels
  FittedOnce<TriangleBvh> surfaces_;
  FittedOnce<ConvexHull> hulls_;
  FittedOnce<NearbyPoints> nearby_points_;
};

}  // namespace throng
