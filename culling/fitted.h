// The volumes fitted to a body type, for the inside of culling only.
// One rule: fitted when first asked for, by any thread, once, in the part's frame. A pass asks for
// what it needs when it is made, so that a step only reads.
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

/// One of each for every part of a type, made once.
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

  /// One a part, as all below.
  template <BoundingVolume V>
  const std::vector<typename V::Fitted>& of() const {
    return std::get<kVolumeIndex<V>>(volumes_).get(
        parts_, [](const PartShape& part) { return V::fit(part.points); });
  }
  /// What kernels read of an or-DOP: also the source of the boxes.
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
  /// Every part has triangles (see BodyType::has_triangles()).
  const std::vector<TriangleBvh>& surfaces() const {
    return surfaces_.get(
        parts_, [](const PartShape& part) { return TriangleBvh(part.points, part.triangles); });
  }
  /// Of the points that lie on a part, for distances and depths.
  const std::vector<ConvexHull>& hulls() const {
    return hulls_.get(parts_, [](const PartShape& part) { return ConvexHull(points_on(part)); });
  }
  const std::vector<NearbyPoints>& nearby_points() const {
    return nearby_points_.get(parts_,
                              [](const PartShape& part) { return NearbyPoints(points_on(part)); });
  }

 private:
  /// All, or, where there are triangles, their corners.
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
  std::array<FittedOnce<OrdopLanes>, kVolumeCount> lanes_;  // where a volume has kernels
  FittedOnce<TriangleBvh> surfaces_;
  FittedOnce<ConvexHull> hulls_;
  FittedOnce<NearbyPoints> nearby_points_;
};

}  // namespace throng
