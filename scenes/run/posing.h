// Posing computes part poses of avatars and obstacles on demand, in batches.
// Invariant: a body's poses depend on its own state only, not on the batch.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "avatars/model/model.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/body_type.h"
#include "scenes/run/postures.h"

namespace throng {

class BodyTables;  // scenes/run/body_tables.h

struct ModelUse {
  GaitStyles styles;
  PostureKind postures = PostureKind::kStepping;
};

class Posing : public PoseSource {
 public:
  /// Keeps a reference to `states`. Takes the gaits of each model from `tables`; `uses` per model.
  Posing(std::vector<std::shared_ptr<const Model>> models, std::span<const ModelUse> uses,
         const BodyStates& states, BodyTables& tables, Workers& workers);

  const Gait& gait_of(uint32_t body) const {
    return kinds_[states_.types[body]].gaits->of(states_, body);
  }
  size_t model_count() const { return kinds_.size(); }
  /// Outline of a model's bodies for body avoidance; null: they do not adapt.
  const Outline* outline_of(size_t model) const { return kinds_[model].gaits->plain().outline(); }
  int column_count(size_t model) const { return kinds_[model].gaits->plain().column_count(); }
  RootSphere sphere(size_t model) const { return kinds_[model].gaits->sphere(); }
  const Model& model(size_t model) const { return *kinds_[model].model; }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override;
  /// Poses one body by its id, whichever use_bodies() set.
  void pose_of(uint32_t body, std::span<PartPose> out) const;

  /// Writes posture rows of avatars of one model, at most kMaxBatch.
  void rows(std::span<const uint32_t> bodies, std::span<float> rows) const;
  void postures(uint32_t first, uint32_t count, std::span<float> rows) const;

  /// Sets the bodies that the indices of poses() refer to. Empty: indices are body ids.
  void use_bodies(std::span<const uint32_t> bodies) { view_ = bodies; }

  /// Sets rows that postures() already computed for this frame; `offsets` locates them by avatar.
  /// Empty: poses() computes the rows it needs.
  void use_rows(std::span<const float> rows, std::span<const size_t> offsets);

  /// Nanoseconds spent in poses() since the last call, summed over threads.
  struct Times {
    double gait_ns = 0;
    double kinematics_ns = 0;
  };
  Times take_times();

 private:
  struct Kind {
    std::shared_ptr<const Model> model;
    std::shared_ptr<const ModelGaits> gaits;
    std::unique_ptr<const PostureProvider> provider;
  };

  uint32_t body_at(uint32_t index) const { return view_.empty() ? index : view_[index]; }
  bool is_obstacle(uint32_t body) const { return states_.types[body] >= kinds_.size(); }
  void pose_obstacles(std::span<const uint32_t> bodies, std::span<PartPose> out) const;
  void pose_avatars(std::span<const uint32_t> bodies, std::span<PartPose> out) const;
  void find_rows(const Kind& kind, std::span<const uint32_t> bodies,
                 std::span<const float*> rows) const;

  std::vector<Kind> kinds_;  ///< indexed by model; providers keep references to its elements
  const BodyStates& states_;
  std::span<const uint32_t> view_;
  std::span<const float> rows_;
  std::span<const size_t> row_offsets_;
  mutable std::atomic<int64_t> gait_ns_{0};
  mutable std::atomic<int64_t> kinematics_ns_{0};
};

}  // namespace throng
