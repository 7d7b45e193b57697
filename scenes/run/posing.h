// Part poses of avatars and obstacles, on demand, many at a time.
// One rule: what a body gets depends on its own state only, never on who is asked for with it.
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

/// What Posing has to know of those who have a model.
struct ModelUse {
  GaitStyles styles;  ///< the plain one need not be among them
  PostureKind postures = PostureKind::kStepping;
};

class Posing : public PoseSource {
 public:
  /// Keeps a reference to `states`. Takes the gaits of each model from `tables`; `uses` by model.
  Posing(std::vector<std::shared_ptr<const Model>> models, std::span<const ModelUse> uses,
         const BodyStates& states, BodyTables& tables, Workers& workers);

  /// Of an avatar.
  const Gait& gait_of(uint32_t body) const {
    return kinds_[states_.types[body]].gaits->of(states_, body);
  }
  size_t model_count() const { return kinds_.size(); }
  /// Of a model's bodies, as far as giving way is concerned; null: they do not.
  const Outline* outline_of(size_t model) const { return kinds_[model].gaits->plain().outline(); }
  /// Every posture row of a model has so many floats.
  int column_count(size_t model) const { return kinds_[model].gaits->plain().column_count(); }
  /// Around every posture of every style of a model's walkers.
  RootSphere sphere(size_t model) const { return kinds_[model].gaits->sphere(); }
  const Model& model(size_t model) const { return *kinds_[model].model; }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override;

  /// Posture rows of some avatars of one model, at most kMaxBatch.
  void rows(std::span<const uint32_t> bodies, std::span<float> rows) const;
  /// Posture rows of consecutive avatars of one model.
  void postures(uint32_t first, uint32_t count, std::span<float> rows) const;

  /// The bodies of the view that poses() is asked about, where not all are in it: poses() is given
  /// indices into this. Empty: indices are bodies.
  void use_bodies(std::span<const uint32_t> bodies) { view_ = bodies; }

  /// Rows that postures() already computed for this frame, by avatar through `offsets`; poses()
  /// then reads them. Empty: poses() computes what it needs.
  void use_rows(std::span<const float> rows, std::span<const size_t> offsets);

  /// Nanoseconds inside poses() since the last call, summed over threads.
  struct Times {
    double gait_ns = 0;
    double kinematics_ns = 0;
  };
  Times take_times();

 private:
  /// All that is the same for the bodies of a type.
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

  std::vector<Kind> kinds_;  ///< by model; providers keep references into it
  const BodyStates& states_;
  std::span<const uint32_t> view_;
  std::span<const float> rows_;
  std::span<const size_t> row_offsets_;
  mutable std::atomic<int64_t> gait_ns_{0};
  mutable std::atomic<int64_t> kinematics_ns_{0};
};

}  // namespace throng
