// BodiesView holds the bodies of a frame; PoseSource poses their parts.
// Invariant: poses are relative to each body's own root, so that float suffices at any distance.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/pose.h"

namespace throng {

/// Bodies of a frame as a structure of arrays. All arrays have the same length.
struct BodiesView {
  std::span<const uint32_t> ids;    ///< strictly ascending, at most PairKey::kMaxId
  std::span<const uint16_t> types;  ///< index into the culler's body types
  std::span<const float> scales;
  std::span<const RootPose> roots;
};

/// Poses the parts of bodies on request. Culling requests only bodies in a surviving pair.
class PoseSource {
 public:
  virtual ~PoseSource() = default;
  /// Writes part_count poses for each of `bodies`, body-major. `bodies` are indices into the
  /// BodiesView, all of one type, at most kMaxBatch. Must be thread-safe.
  virtual void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const = 0;
  /// Writes a box for each of `bodies` (any types, at most kMaxBatch) that holds every point of the
  /// body in its current pose(). A box is far cheaper than a pose and far tighter than the sphere
  /// of all postures. An unknown box costs only time. Must be thread-safe.
  virtual void bounds(std::span<const uint32_t> /*bodies*/, std::span<RootBox> out) const {
    std::fill(out.begin(), out.end(), RootBox{});
  }
  static constexpr int kMaxBatch = 128;
};

}  // namespace throng
