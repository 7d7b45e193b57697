// BodiesView lists the bodies of a frame; PoseSource poses their parts. A body is an avatar or an
// obstacle: one or more parts, each rigid, with a common root.
// Invariant: translations of parts are relative to the root position of their body, in world axes.
// Float precision therefore suffices at any distance from the origin.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/pose.h"

namespace throng {

/// Bodies of a frame as a structure of arrays. All arrays have the same length. The caller owns
/// them; they must stay valid during Culler::step().
struct BodiesView {
  std::span<const uint32_t> ids;    ///< strictly ascending, at most PairKey::kMaxId
  std::span<const uint16_t> types;  ///< index into the culler's body types
  std::span<const float> scales;    ///< size as a factor of the type's, above 0
  std::span<const RootPose> roots;  ///< world_from_root
};

/// Poses the parts of bodies on request. Culling requests poses only of bodies in a pair that the
/// broad phase found. Functions are called from several threads at once.
class PoseSource {
 public:
  virtual ~PoseSource() = default;
  /// Writes the poses of all parts of each of `bodies` to `out`: those of the first body in the
  /// order of its parts, then those of the second, and so on. `bodies` are indices into the
  /// BodiesView, all of one type, at most kMaxBatch. Must be thread-safe.
  virtual void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const = 0;
  /// Writes a box for each of `bodies` (indices as in poses(), any types, at most kMaxBatch). The
  /// box is in the root frame and encloses all parts in their current poses. It is optional and
  /// saves time: it is cheaper than poses and tighter than the sphere of all postures. Must be
  /// thread-safe.
  virtual void bounds(std::span<const uint32_t> /*bodies*/, std::span<RootBox> out) const {
    std::fill(out.begin(), out.end(), RootBox{});
  }
  static constexpr int kMaxBatch = 128;
};

}  // namespace throng
