// The bodies of a frame, and who poses their parts.
// One rule: poses are relative to each body's own root, so that float is enough wherever it stands.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "base/pose.h"

namespace throng {

/// The bodies of a frame, structure of arrays, all of the same length.
struct BodiesView {
  std::span<const uint32_t> ids;    ///< strictly ascending, at most PairKey::kMaxId
  std::span<const uint16_t> types;  ///< index into the culler's body types
  std::span<const float> scales;
  std::span<const RootPose> roots;
};

/// Poses the parts of bodies on demand: only bodies in a surviving pair are ever asked for.
class PoseSource {
 public:
  virtual ~PoseSource() = default;
  /// Writes part_count poses for each of `bodies` (indices into the BodiesView, all of one type, at
  /// most kMaxBatch), body-major. Called from several threads at once.
  virtual void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const = 0;
  /// Writes a box for each of `bodies` (of any type, at most kMaxBatch) that holds every point of
  /// the body in the pose that poses() would give it now: far cheaper than posing it, far tighter
  /// than the sphere of all postures. A box left unknown costs nothing but time. Called from
  /// several threads at once.
  virtual void bounds(std::span<const uint32_t> /*bodies*/, std::span<RootBox> out) const {
    std::fill(out.begin(), out.end(), RootBox{});
  }
  static constexpr int kMaxBatch = 128;
};

}  // namespace throng
