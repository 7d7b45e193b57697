// What culling keeps of a kind of body: the points and triangles of its parts and the volumes
// fitted to them, once, in the part's own frame. One rule: immutable and shared by all bodies of
// the type.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "culling/volumes/volume_kind.h"

namespace throng {

/// One part's surface in its own frame, metres. No triangles: a point cloud.
struct PartShape {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3i> triangles;
  /// What encloses it; empty: CullerOptions::part_volume. Two parts with different volumes are
  /// tested with both, the one that comes first in the list of volumes first.
  std::optional<VolumeKind> volume = {};
};

/// A sphere fixed in the root frame that encloses every part in every posture the body can take;
/// and, where somebody knows it, a cylinder around the root's z axis that does so too: people are
/// tall, so it tells more of them apart. It counts while the root stands upright.
struct RootSphere {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0;
  float upright_radius_m = std::numeric_limits<float>::infinity();
};

class BodyType {
 public:
  /// At most kMaxParts parts, each with at least one point (asserted).
  BodyType(std::vector<PartShape> parts, const RootSphere& sphere, bool is_static);
  ~BodyType();

  static constexpr int kMaxParts = 255;

  int part_count() const { return static_cast<int>(parts_.size()); }
  const std::vector<PartShape>& parts() const { return parts_; }
  const RootSphere& sphere() const { return sphere_; }
  /// Two static bodies (walls, pillars) are never tested against each other.
  bool is_static() const { return is_static_; }
  /// True if every part has triangles, so that the exact stage can decide.
  bool has_triangles() const;

  struct Volumes;  // everything fitted; private to culling
  const Volumes& volumes() const { return *volumes_; }

 private:
  std::vector<PartShape> parts_;
  RootSphere sphere_;
  bool is_static_;
  std::unique_ptr<Volumes> volumes_;
};

}  // namespace throng
