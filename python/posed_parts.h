// PosedParts supplies a culler with part poses given by the caller.
// Invariant: a pose is checked before use: within kMaxPosition_m, and a rotation without scale.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "culling/culler.h"

namespace throng {

/// Maximum part position per axis; distances between parts stay within float precision.
inline constexpr double kMaxPosition_m = 1e9;

/// A kind of body as given by the caller.
struct BodyShape {
  std::vector<PartShape> parts;
  std::vector<std::string> part_names;
  bool is_static = false;
};

/// Supplies the poses of a step. The root of a body lies in the middle of its parts, with world
/// axes.
class PosedParts final : public PoseSource {
 public:
  explicit PosedParts(const std::vector<std::shared_ptr<const BodyShape>>& shapes);

  /// `matrices`: the upper 3 rows of world_from_part of all parts, body after body, `stride`
  /// numbers apart. Throws InputError.
  void set(std::span<const double> matrices, size_t stride, std::span<const uint16_t> types,
           std::span<const float> scales);

  std::span<const RootPose> roots() const { return roots_; }
  /// Reach of each type of body from its root in this step, unscaled, in metres.
  std::span<const float> reach_m() const { return reach_m_; }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override;

 private:
  struct Extent {
    Eigen::Vector3f centre_m, half_m;
    float radius_m = 0;  ///< from the part's origin
  };
  void set_body(size_t body, const double* matrices, size_t stride);

  std::vector<std::vector<Extent>> extents_;
  std::vector<float> reach_m_;
  std::span<const uint16_t> types_;
  std::span<const float> scales_;
  std::vector<RootPose> roots_;
  std::vector<size_t> first_;
  std::vector<PartPose> poses_;
};

}  // namespace throng
