// VolumeOutline makes the culling volumes of parts and bodies drawable: translucent faces and bars
// along the edges.
// Invariant: a drawn volume is the tested volume, fitted and placed by the same code.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "culling/body_type.h"
#include "viewer/picture/raster.h"

namespace throng {

/// Faces and edges relative to the body's root, in world axes, metres.
struct VolumeOutline {
  Mesh faces;
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> edges;
};

/// Returns the volume of a part of a body. Empty for a kind without a drawing.
VolumeOutline outline_of(VolumeKind kind, const BodyType& type, size_t part, const PartPose& pose,
                         float scale);
VolumeOutline sphere_outline(const Eigen::Vector3f& centre_m, float radius_m);
VolumeOutline box_outline(const Eigen::Vector3f& low_m, const Eigen::Vector3f& high_m);

/// Returns bars along the edges as one mesh.
Mesh bars_of(const VolumeOutline& outline, float thickness_m);

/// Returns the linear colour of a volume by its name; unknown names get the last colour.
Eigen::Vector3f volume_rgb(std::string_view name);

/// VolumeItems collects outlines for a picture and owns the meshes that its items point to.
class VolumeItems {
 public:
  void add(const VolumeOutline& outline, const Eigen::Vector3f& root_m, const Eigen::Vector3f& rgb,
           float thickness_m);
  /// Valid until the next add().
  void append_to(std::vector<RenderItem>& items) const;

 private:
  struct Piece {
    Shape shape;
    Eigen::Vector3f root_m, rgb;
    float opacity;
  };
  std::vector<Piece> pieces_;
};

}  // namespace throng
