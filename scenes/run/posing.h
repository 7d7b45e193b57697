// Postures and part poses of avatars and obstacles, on demand, many at a time.
// One rule: what a body gets depends on its own state only, never on who is asked for with it.
#pragma once

#include <array>
#include <atomic>
#include <bitset>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "avatars/gait/gait.h"
#include "avatars/model/model.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/body_type.h"

namespace throng {

/// The state of all bodies that poses depend on, by body: avatars first, then obstacles.
struct BodyStates {
  std::vector<uint16_t> types;  ///< models first, then one type an obstacle
  std::vector<RootPose> roots;
  std::vector<float> scales;
  // Avatars only.
  /// The posture row of an avatar that something outside moves, null for others; empty if there are
  /// none.
  std::vector<const float*> held_rows;
  std::vector<GaitStyle> styles;     ///< empty: everybody walks plainly
  std::span<const float> looks_rad;  ///< how far heads are turned; empty: they are not
  std::vector<float> phases;
  // What stepping brings along and gives, see WalkChunk; where feet are not planted, all but the
  // speed is empty.
  std::vector<float> gait_mps;
  std::array<std::vector<float>, WalkChunk::kFeetNumbers> feet;
  std::vector<WalkPosture> postures;
  std::vector<float> room_x, room_y;

  /// Makes room for avatars that have not come in yet.
  void resize_steps(size_t avatars) {
    gait_mps.assign(avatars, kNotComeIn);
    for (std::vector<float>& numbers : feet) numbers.assign(avatars, 0);
    postures.resize(avatars);
    room_x.resize(avatars);
    room_y.resize(avatars);
  }
};

class Posing : public PoseSource {
 public:
  /// The styles that walkers of a model have.
  using Styles = std::bitset<kGaitStyleCount>;

  /// Keeps a reference to `states`. Tabulates the gaits of each model: the plain one and those in
  /// `styles`, by model.
  Posing(std::vector<std::shared_ptr<const Model>> models, std::span<const Styles> styles,
         const BodyStates& states, Workers& workers);

  /// Of an avatar.
  const Gait& gait_of(uint32_t body) const { return *gaits_[states_.types[body]][style_of(body)]; }
  /// Every posture row of a model has so many floats.
  int column_count(size_t model) const { return gaits_[model][0]->column_count(); }
  /// Around every posture of every style of a model's walkers.
  RootSphere sphere(size_t model) const;
  const Model& model(size_t model) const { return *models_[model]; }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override;
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override;

  /// Posture rows of consecutive avatars of one model.
  void postures(uint32_t first, uint32_t count, std::span<float> rows) const;

  /// The bodies of the view that poses() is asked about, where not all are in it: poses() is given
  /// indices into this. Empty: indices are bodies.
  void use_bodies(std::span<const uint32_t> bodies) { view_ = bodies; }

  /// Rows that postures() already computed for this frame, by avatar through `offsets`; poses()
  /// then copies them. Empty: poses() computes what it needs.
  void use_rows(std::span<const float> rows, std::span<const size_t> offsets);

  /// Nanoseconds inside poses() since the last call, summed over threads.
  struct Times {
    double gait_ns = 0;
    double kinematics_ns = 0;
  };
  Times take_times();

 private:
  void poses_of(std::span<const uint32_t> bodies, std::span<PartPose> out) const;
  size_t style_of(uint32_t body) const {
    return states_.styles.empty() ? 0 : static_cast<size_t>(states_.styles[body]);
  }
  bool is_held(uint32_t body) const {
    return !states_.held_rows.empty() && states_.held_rows[body] != nullptr;
  }
  bool has_legs(uint32_t body) const {
    return !states_.postures.empty() && gait_of(body).has_legs();
  }
  void gather_rows(std::span<const uint32_t> bodies, size_t type, std::span<float> rows) const;
  void make_rows(std::span<const uint32_t> bodies, size_t type, std::span<float> rows) const;
  void make_plain_rows(std::span<const uint32_t> bodies, std::span<const Gait* const> gaits,
                       std::span<float> rows) const;

  std::vector<std::shared_ptr<const Model>> models_;
  using Gaits = std::array<std::unique_ptr<Gait>, kGaitStyleCount>;
  std::vector<Gaits> gaits_;  ///< by model; of styles that nobody has, null
  const BodyStates& states_;
  std::span<const uint32_t> view_;
  std::span<const float> rows_;
  std::span<const size_t> row_offsets_;
  mutable std::atomic<int64_t> gait_ns_{0};
  mutable std::atomic<int64_t> kinematics_ns_{0};
};

}  // namespace throng
