// The bench crowd, and the boxes of its parts with the pairs that every engine has to list.
#pragma once

#include <memory>
#include <vector>

#include "avatars/gait/gait.h"
#include "avatars/model/model.h"
#include "bench/engines/engine.h"
#include "culling/culling.h"

namespace throng::bench {

/// The bench crowd: people on a jittered square who walk straight on, whatever is in their way.
/// No steering, so that every engine is given the same frames and overlaps grow as in the
/// paper; the same numbers give the same crowd.
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

  /// Everybody walks on for one step.
  virtual void advance();

  BodiesView view() const { return {ids_, types_, scales_, roots_}; }
  /// The one body type, fitted to the model; a fresh one at each call.
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

// The boxes that every engine is given, and the pairs that every engine has to list.
// Computed outside of anybody's time, by loops simple enough to trust.

/// The tight boxes of all parts of a crowd: the boxes of their placed vertices.
class CrowdBoxes {
 public:
  CrowdBoxes(const Crowd& crowd, std::shared_ptr<const BodyType> type)
      : crowd_(crowd), type_(std::move(type)) {}

  /// The boxes of the crowd as it stands now; valid until the next call.
  BoxList compute();

  /// Poses of all parts, avatar-major, as of the last compute().
  const std::vector<PartPose>& poses() const { return poses_; }

 private:
  const Crowd& crowd_;
  std::shared_ptr<const BodyType> type_;
  std::vector<PartPose> poses_;
  std::vector<Box> boxes_;
};

/// All overlapping pairs of boxes of different avatars, sorted: avatars by a grid as wide as the
/// widest of them, then every part against every part.
std::vector<BoxPair> reference_pairs(const BoxList& frame);

}  // namespace throng::bench
