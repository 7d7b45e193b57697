// Bodies whose parts somebody posed already: own bodies, own poses.
// One rule: a pose is checked before it is believed: within kMaxPosition_m, and a rotation without
// scale.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "culling/culler.h"

namespace throng {

/// Of a part's position, along each axis: places between parts stay far within float.
inline constexpr double kMaxPosition_m = 1e9;

/// A kind of body as somebody described it.
struct BodyShape {
  std::vector<PartShape> parts;
  std::vector<std::string> part_names;
  bool is_static = false;
};

/// Gives the culler the poses of a step. A body's root lies in the middle of its parts, turned as
/// the world is.
class PosedParts final : public PoseSource {
 public:
  explicit PosedParts(const std::vector<std::shared_ptr<const BodyShape>>& shapes);

  /// `matrices`: the upper 3 rows of world_from_part of all parts, body after body, `stride`
  /// numbers from one to the next. Throws InputError.
  void set(std::span<const double> matrices, size_t stride, std::span<const uint16_t> types,
           std::span<const float> scales);

  std::span<const RootPose> roots() const { return roots_; }
  /// How far bodies of each type reach from their roots, unscaled, in this step.
  std::span<const float> reach_m() const { return reach_m_; }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override;

 private:
  /// Of a part, in its own frame.
  struct Extent {
    Eigen::Vector3f centre_m, half_m;
    float radius_m = 0;  ///< from the part's origin
  };
  void set_body(size_t body, const double* matrices, size_t stride);

  std::vector<std::vector<Extent>> extents_;  ///< by type
  std::vector<float> reach_m_;
  std::span<const uint16_t> types_;
  std::span<const float> scales_;
  std::vector<RootPose> roots_;
  std::vector<size_t> first_;  ///< of each body in poses_
  std::vector<PartPose> poses_;
};

}  // namespace throng
