// Where the posture of a body comes from, chosen once for each type of body.
// One rule: a row depends on the state of its own body only, and one that lies somewhere already is
// read where it lies.
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

/// A velocity that nobody knows beforehand.
inline const Eigen::Vector2f kUnknownVelocity =
    Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());

/// The state of all bodies that poses depend on, by body: avatars first, then obstacles.
struct BodyStates {
  std::vector<uint16_t> types;  ///< models first, then one type an obstacle
  std::vector<RootPose> roots;
  std::vector<float> scales;
  // Avatars only.
  /// The posture row of an avatar that something outside moves or that a recording holds, null for
  /// others; empty if there are none.
  std::vector<const float*> external_rows;
  std::vector<GaitStyle> styles;         ///< empty: everybody walks plainly
  std::span<const float> head_yaws_rad;  ///< how far heads are turned; empty: they are not
  std::vector<float> phases;
  // What stepping brings along and gives, see WalkBatch; where feet are not planted, all but the
  // speed is empty.
  std::vector<float> gait_mps;
  std::array<std::vector<float>, WalkBatch::kFeetNumbers> feet;
  std::array<std::vector<float>, WalkBatch::kGaitRateCount> gait_rates;
  std::vector<WalkPosture> postures;
  std::vector<float> bounds_x, bounds_y;
  /// Velocities over the ground that people are about to have (a mean over some tenths of a second)
  /// as far as they are known beforehand: empty, or kUnknownVelocity, where they are not.
  std::vector<Eigen::Vector2f> next_mps;
  std::vector<AvoidancePosture> avoidance;  ///< empty: nobody gives way
  std::vector<StandingPosture> standing;    ///< see AvoidancePosture::standing; as many as yields
  std::vector<float> standing_time_s;       ///< see advance_standing_time()
  /// What quiet_standing() needs; without a seed nobody breathes.
  std::optional<uint64_t> standing_seed;
  double now_s = 0;

  /// Makes room for avatars that have not come in yet.
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

/// The styles that walkers of a model have.
using GaitStyles = std::bitset<kGaitStyleCount>;

/// The gaits of one model: the plain one and those of `styles`; of others, null.
class ModelGaits {
 public:
  ModelGaits() = default;
  std::unique_ptr<Gait>& of_style(size_t style) { return gaits_[style]; }
  const Gait& plain() const { return *gaits_[0]; }
  const Gait& of(const BodyStates& states, uint32_t body) const {
    return *gaits_[states.styles.empty() ? 0 : static_cast<size_t>(states.styles[body])];
  }
  /// Around every posture of every style.
  RootSphere sphere() const;
  /// All styles walk within sphere().
  void share_bounds();

 private:
  std::array<std::unique_ptr<Gait>, kGaitStyleCount> gaits_;
};

/// Gives the postures of all bodies of one type. From several threads at once; allocates nothing.
class PostureProvider {
 public:
  virtual ~PostureProvider() = default;
  /// Points rows[i] to the posture row of bodies[i], at most PoseSource::kMaxBatch. Those that lie
  /// nowhere yet are written to `room`, which is large enough for all.
  virtual void rows(std::span<const uint32_t> bodies, std::span<float> scratch,
                    std::span<const float*> rows) const = 0;
  /// See PoseSource::bounds().
  virtual void bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const = 0;
};

/// What moves the bodies of a type.
enum class PostureKind {
  kExternal,  ///< something outside: BodyStates::external_rows
  kStepping,  ///< the gait, with planted feet
  kTable,     ///< the gait's table as it is
};

/// Keeps references to both. A model without human legs has no feet to plant: it gets its table.
std::unique_ptr<const PostureProvider> make_posture_provider(PostureKind kind,
                                                             const ModelGaits& gaits,
                                                             const BodyStates& states);

}  // namespace throng
