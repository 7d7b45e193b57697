// PostureProvider gives the postures of all bodies of one model, from gait or external rows.
// Invariant: a row depends on the state of one body only; existing rows are read in place.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "avatars/gait/gait.h"
#include "culling/bodies.h"
#include "culling/body_type.h"

namespace throng {

inline const Eigen::Vector2f kUnknownVelocity =
    Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());

/// State of all bodies that poses depend on, by body: avatars first, then obstacles.
struct BodyStates {
  std::vector<uint16_t> types;  ///< models first, then one type per obstacle
  std::vector<RootPose> roots;
  std::vector<float> scales;
  // Avatars only.
  /// Posture rows of externally controlled avatars, null for others; empty if there are none.
  std::vector<const float*> external_rows;
  std::vector<GaitStyle> styles;         ///< empty: all avatars walk plainly
  std::span<const float> head_yaws_rad;  ///< head yaw per avatar; empty: heads face forward
  std::vector<float> phases;
  // State of stepping, see WalkBatch. Without planted feet all but the speed is empty.
  std::vector<float> gait_mps;
  std::array<std::vector<float>, WalkBatch::kFeetNumbers> feet;
  std::array<std::vector<float>, WalkBatch::kGaitRateCount> gait_rates;
  std::vector<WalkPosture> postures;
  std::vector<float> bounds_x, bounds_y;
  /// Mean velocities of the next tenths of a second, where known in advance, else kUnknownVelocity.
  /// Empty: unknown for all.
  std::vector<Eigen::Vector2f> next_mps;
  std::vector<AvoidancePosture> avoidance;  ///< empty: no body avoidance
  /// See AvoidancePosture::standing; same size as avoidance.
  std::vector<StandingPosture> standing;
  std::vector<float> standing_time_s;
  /// Seed of quiet_standing(); without a seed people do not breathe.
  std::optional<uint64_t> standing_seed;
  double now_s = 0;

  void resize_steps(size_t avatars) {
    gait_mps.assign(avatars, kNotEntered);
    for (std::vector<float>& numbers : feet) numbers.assign(avatars, 0);
    for (std::vector<float>& numbers : gait_rates) numbers.assign(avatars, 0);
    postures.resize(avatars);
    bounds_x.resize(avatars);
    bounds_y.resize(avatars);
    standing_time_s.assign(avatars, 0);
  }
};

using GaitStyles = std::bitset<kGaitStyleCount>;

/// Gaits of one model: plain, and those of its styles; null for other styles.
class ModelGaits {
 public:
  ModelGaits() = default;
  std::unique_ptr<Gait>& of_style(size_t style) { return gaits_[style]; }
  const Gait& plain() const { return *gaits_[0]; }
  const Gait& of(const BodyStates& states, uint32_t body) const {
    return *gaits_[states.styles.empty() ? 0 : static_cast<size_t>(states.styles[body])];
  }
  RootSphere sphere() const;
  /// Sets the bounds of all styles to those of sphere().
  void share_bounds();

 private:
  std::array<std::unique_ptr<Gait>, kGaitStyleCount> gaits_;
};

/// Gives the postures of all bodies of one model. Thread-safe; allocates nothing.
class PostureProvider {
 public:
  virtual ~PostureProvider() = default;
  /// Points rows[i] to the posture row of bodies[i], at most PoseSource::kMaxBatch. Rows that do
  /// not exist yet are written to `scratch`, which is large enough for all.
  virtual void rows(std::span<const uint32_t> bodies, std::span<float> scratch,
                    std::span<const float*> rows) const = 0;
  virtual void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const = 0;
};

enum class PostureKind {
  kExternal,  ///< external rows, see BodyStates::external_rows
  kStepping,
  kTable,
};

/// Keeps references to both. A model without human legs has no feet to plant and uses its table.
std::unique_ptr<const PostureProvider> make_posture_provider(PostureKind kind,
                                                             const ModelGaits& gaits,
                                                             const BodyStates& states);

}  // namespace throng
