// BodyType stores the points and triangles of a kind of body, and the volumes fitted to its parts.
// Invariant: immutable and shared by all bodies of the type; volumes are fitted once per part.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "culling/volumes/volume_kind.h"

namespace throng {

/// Surface of one part in its own frame, in metres. Without triangles it is a point cloud.
struct PartShape {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3i> triangles;
  /// Bounding volume of this part; empty: CullerOptions::part_volume. Two parts with different
  /// volumes are tested with both, in the order of the list of volumes.
  std::optional<VolumeKind> volume = {};
};

/// Sphere, fixed in the root frame, that encloses every part in every posture of the body.
/// Optionally also a cylinder around the root's z axis that does so: people are tall, and a
/// cylinder separates more of them. The cylinder applies while the root is upright.
struct RootSphere {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0;
  float upright_radius_m = std::numeric_limits<float>::infinity();
};

class BodyType {
 public:
  /// `parts`: 1 to kMaxParts, each with at least one point (asserted).
  BodyType(std::vector<PartShape> parts, const RootSphere& sphere, bool is_static);
  ~BodyType();

  static constexpr int kMaxParts = 255;

  int part_count() const { return static_cast<int>(parts_.size()); }
  const std::vector<PartShape>& parts() const { return parts_; }
  const RootSphere& sphere() const { return sphere_; }
  /// True if the body never moves (walls, pillars). Two static bodies are never tested.
  bool is_static() const { return is_static_; }
  /// True if every part has triangles, as the narrow phase needs them.
  bool has_triangles() const;

  struct Volumes;  // all fitted volumes; private to culling
  const Volumes& volumes() const { return *volumes_; }

 private:
  std::vector<PartShape> parts_;
  RootSphere sphere_;
  bool is_static_;
  std::unique_ptr<Volumes> volumes_;
};

}  // namespace throng
