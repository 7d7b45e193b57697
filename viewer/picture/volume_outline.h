// The volumes that culling puts around parts and bodies, as things to draw: faces that let through
// what is inside, and bars along the edges.
// One rule: what is drawn is the volume that the stage tests, fitted and placed by the same code.
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

/// Relative to the body's root, in world axes.
struct VolumeOutline {
  Mesh faces;
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> edges;
};

/// Around a part of a body. Empty for a kind that nobody has said how to draw.
VolumeOutline outline_of(VolumeKind kind, const BodyType& type, size_t part, const PartPose& pose,
                         float scale);
VolumeOutline sphere_outline(const Eigen::Vector3f& centre_m, float radius_m);
VolumeOutline box_outline(const Eigen::Vector3f& low_m, const Eigen::Vector3f& high_m);

/// Bars of a thickness along the edges, as one mesh.
Mesh bars_of(const VolumeOutline& outline, float thickness_m);

/// The colour of a volume by its name; of those that it does not know the last.
Eigen::Vector3f volume_rgb(std::string_view name);

/// Outlines on their way into a picture: keeps the meshes that items point to.
class VolumeItems {
 public:
  /// `thickness_m` is that of the bars.
  void add(const VolumeOutline& outline, const Eigen::Vector3f& root_m, const Eigen::Vector3f& rgb,
           float thickness_m);
  /// Valid until the next add().
  void append_to(std::vector<RenderItem>& items) const;

 private:
  struct Piece {
    Mesh mesh;
    Eigen::Vector3f root_m, rgb;
    float opacity;
  };
  std::vector<Piece> pieces_;
};

}  // namespace throng
