#include "scenes/run/postures.h"

#include <algorithm>
#include <cassert>

#include "avatars/stepping/standing.h"

namespace throng {
namespace {

class WalkingPostures : public PostureProvider {
 public:
  WalkingPostures(const ModelGaits& gaits, const BodyStates& states)
      : gaits_(gaits), states_(states) {}

  void rows(std::span<const uint32_t> bodies, std::span<float> scratch,
            std::span<const float*> rows) const final {
    assert(bodies.size() <= PoseSource::kMaxBatch);
    const auto columns = static_cast<size_t>(gaits_.plain().column_count());
    std::array<const Gait*, PoseSource::kMaxBatch> own{};
    for (const uint32_t body : bodies) {
      if (!states_.styles.empty()) __builtin_prefetch(&states_.styles[body]);
      fetch(body);
    }
    for (size_t i = 0; i < bodies.size(); ++i) {
      own[i] = &gait_of(bodies[i]);
      rows[i] = scratch.data() + i * columns;
    }
    write({own.data(), bodies.size()}, bodies, scratch.first(bodies.size() * columns));
    if (states_.head_yaws_rad.empty() && states_.avoidance.empty()) return;
    for (size_t i = 0; i < bodies.size(); ++i)
      pose_upper_body(*own[i], bodies[i], scratch.subspan(i * columns, columns));
  }

 protected:
  const Gait& gait_of(uint32_t body) const { return gaits_.of(states_, body); }
  const BodyStates& states() const { return states_; }
  /// Prefetches the data that write() reads; bodies of a batch are far apart in memory.
  virtual void fetch(uint32_t body) const = 0;
  virtual void write(std::span<const Gait* const> gaits, std::span<const uint32_t> bodies,
                     std::span<float> rows) const = 0;

 private:
  void pose_upper_body(const Gait& gait, uint32_t body, std::span<float> row) const {
    float head_yaw_rad = states_.head_yaws_rad.empty() ? 0 : states_.head_yaws_rad[body];
    const Outline* const outline = states_.avoidance.empty() ? nullptr : gait.outline();
    StandingPosture posture;
    if (outline != nullptr && states_.avoidance[body].standing > 0) {
      posture = states_.standing[body];
      head_yaw_rad = std::clamp(head_yaw_rad + states_.avoidance[body].standing * posture.head_rad,
                                -Gait::kMaxHeadYaw_rad, Gait::kMaxHeadYaw_rad);
      const float breath = states_.postures[body].numbers[WalkPosture::kBreath];
      for (auto& arm_rad : posture.arms_rad)
        arm_rad[AvoidanceColumns::kAbduction] += kBreath_rad * breath;
    }
    if (head_yaw_rad != 0) gait.apply_head_yaw(head_yaw_rad, row);
    if (outline != nullptr)
      apply_avoidance(outline->columns, states_.avoidance[body], posture, row);
  }

  const ModelGaits& gaits_;
  const BodyStates& states_;
};

class SteppingPostures final : public WalkingPostures {
 public:
  using WalkingPostures::WalkingPostures;

  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i) {
      const uint32_t body = bodies[i];
      out[i] = gait_of(body).box_of({states().bounds_x[body], states().bounds_y[body]},
                                    states().scales[body]);
    }
  }

 private:
  void fetch(uint32_t body) const override { __builtin_prefetch(&states().postures[body]); }
  void write(std::span<const Gait* const> gaits, std::span<const uint32_t> bodies,
             std::span<float> rows) const override {
    Gait::postures(gaits, states().postures, bodies, rows);
  }
};

class TablePostures final : public WalkingPostures {
 public:
  using WalkingPostures::WalkingPostures;

  /// Prefetches all boxes first: those of all styles exceed a core's cache.
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override {
    assert(bodies.size() <= PoseSource::kMaxBatch);
    std::array<const RootBox*, PoseSource::kMaxBatch> boxes;
    for (size_t i = 0; i < bodies.size(); ++i) {
      const uint32_t body = bodies[i];
      boxes[i] = &gait_of(body).box_at(states().phases[body], states().gait_mps[body],
                                       states().scales[body]);
      __builtin_prefetch(boxes[i]);
      __builtin_prefetch(&boxes[i]->max_m[2]);
    }
    for (size_t i = 0; i < bodies.size(); ++i)
      out[i] = scaled(*boxes[i], states().scales[bodies[i]]);
  }

 private:
  void fetch(uint32_t body) const override {
    __builtin_prefetch(&states().phases[body]);
    __builtin_prefetch(&states().gait_mps[body]);
    __builtin_prefetch(&states().scales[body]);
  }
  void write(std::span<const Gait* const> gaits, std::span<const uint32_t> bodies,
             std::span<float> rows) const override {
    std::array<float, PoseSource::kMaxBatch> phases;
    std::array<float, PoseSource::kMaxBatch> speeds;
    std::array<float, PoseSource::kMaxBatch> scales;
    for (size_t i = 0; i < bodies.size(); ++i) {
      phases[i] = states().phases[bodies[i]];
      speeds[i] = states().gait_mps[bodies[i]];
      scales[i] = states().scales[bodies[i]];
    }
    Gait::postures(gaits, {phases.data(), bodies.size()}, {speeds.data(), bodies.size()},
                   {scales.data(), bodies.size()}, rows);
  }
};

/// Rows set from outside; bodies without one walk.
class ExternalPostures : public PostureProvider {
 public:
  ExternalPostures(std::unique_ptr<const PostureProvider> walking, size_t columns,
                   const BodyStates& states)
      : walking_(std::move(walking)), columns_(columns), states_(states) {}

  void rows(std::span<const uint32_t> bodies, std::span<float> scratch,
            std::span<const float*> rows) const override {
    for (size_t i = 0; i < bodies.size(); ++i) {
      rows[i] = states_.external_rows[bodies[i]];
      if (rows[i] == nullptr)
        walking_->rows(bodies.subspan(i, 1), scratch.subspan(i * columns_, columns_),
                       rows.subspan(i, 1));
    }
  }
  /// External joints have no box: only the sphere bounds them.
  void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const override {
    std::fill(out.begin(), out.end(), RootBox{});
    for (size_t i = 0; i < bodies.size(); ++i)
      if (states_.external_rows[bodies[i]] == nullptr)
        walking_->bounds(bodies.subspan(i, 1), out.subspan(i, 1));
  }

 private:
  std::unique_ptr<const PostureProvider> walking_;
  size_t columns_;
  const BodyStates& states_;
};

}  // namespace

RootSphere ModelGaits::sphere() const {
  RootSphere sphere{plain().sphere_centre_m(), 0, 0};
  for (const std::unique_ptr<Gait>& gait : gaits_) {
    if (gait == nullptr) continue;
    const float apart_m = (gait->sphere_centre_m() - sphere.centre_m).norm();
    sphere.radius_m = std::max(sphere.radius_m, gait->sphere_radius_m() + apart_m);
    sphere.upright_radius_m = std::max(sphere.upright_radius_m, gait->upright_radius_m());
  }
  return sphere;
}

void ModelGaits::share_bounds() {
  const RootSphere common = sphere();
  for (const std::unique_ptr<Gait>& gait : gaits_)
    if (gait != nullptr)
      gait->share_bounds(common.centre_m.z(), common.radius_m, common.upright_radius_m);
}

std::unique_ptr<const PostureProvider> make_posture_provider(PostureKind kind,
                                                             const ModelGaits& gaits,
                                                             const BodyStates& states) {
  if (kind == PostureKind::kExternal)
    return std::make_unique<ExternalPostures>(
        make_posture_provider(
            states.postures.empty() ? PostureKind::kTable : PostureKind::kStepping, gaits, states),
        static_cast<size_t>(gaits.plain().column_count()), states);
  if (kind == PostureKind::kStepping && gaits.plain().has_legs())
    return std::make_unique<SteppingPostures>(gaits, states);
  return std::make_unique<TablePostures>(gaits, states);
}

}  // namespace throng
