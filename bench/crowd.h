// Crowd moves the bench crowd; CrowdBoxes computes its boxes, and reference_pairs() their pairs.
#pragma once

#include <memory>
#include <vector>

#include "avatars/gait/gait.h"
#include "avatars/model/model.h"
#include "bench/engines/engine.h"
#include "culling/culling.h"

namespace throng::bench {

/// The bench crowd: people on a jittered square who walk straight on, through each other.
/// Without steering, every engine gets the same frames and overlaps grow as in the paper.
/// Invariant: equal shapes give equal crowds.
struct CrowdShape {
  int avatars = 20'000;
  double per_m2 = 1;
  double speed_mps = 1.3;
  double step_s = 1.0 / 60.0;
  uint64_t seed = 1;
};

class Crowd : public PoseSource {
 public:
  /// Throws InputError for a model with more joints than kMaxColumns.
  Crowd(std::shared_ptr<const Model> model, const CrowdShape& shape);
  static constexpr size_t kMaxColumns = 64;

  virtual void advance();

  BodiesView view() const { return {ids_, types_, scales_, roots_}; }
  /// Returns the body type, newly fitted to the model at each call.
  std::shared_ptr<const BodyType> body_type() const;
  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override;

  int count() const { return static_cast<int>(ids_.size()); }
  const Model& model() const { return *model_; }
  SimdTarget simd = SimdTarget::kBest;

 protected:
  std::shared_ptr<const Model> model_;
  Gait gait_;
  CrowdShape shape_;
  float dphase_ = 0;
  std::vector<uint32_t> ids_;
  std::vector<uint16_t> types_;
  std::vector<float> scales_, phases_, speeds_;
  std::vector<RootPose> roots_;
  std::vector<Eigen::Vector2d> velocities_mps_;
};

// Boxes and reference pairs are computed outside of all measured times.

/// CrowdBoxes computes tight boxes around the placed vertices of all parts.
class CrowdBoxes {
 public:
  CrowdBoxes(const Crowd& crowd, std::shared_ptr<const BodyType> type)
      : crowd_(crowd), type_(std::move(type)) {}

  /// Returns the boxes of the crowd's present state; valid until the next call.
  BoxList compute();

  /// Poses of all parts, avatar-major, from the last compute().
  const std::vector<PartPose>& poses() const { return poses_; }

 private:
  const Crowd& crowd_;
  std::shared_ptr<const BodyType> type_;
  std::vector<PartPose> poses_;
  std::vector<Box> boxes_;
};

/// Returns all overlapping pairs of boxes of different avatars, sorted. A grid with cells as wide
/// as the widest avatar selects avatars, then all their parts are tested.
std::vector<BoxPair> reference_pairs(const BoxList& frame);

}  // namespace throng::bench
