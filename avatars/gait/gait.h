// Walking: joint angles from the phase of the gait cycle and the speed.
// One rule: phase advances by distance walked, so a planted foot stays where it landed.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "avatars/body_avoidance/body_avoidance.h"
#include "avatars/gait/gait_style.h"
#include "avatars/model/model.h"
#include "avatars/stepping/stepping.h"

namespace throng {

class Archive;

/// The box of a body of so many times the size.
inline RootBox scaled(const RootBox& box, float scale) {
  RootBox out;
  for (int axis = 0; axis < 3; ++axis) {
    out.min_m[axis] = scale * box.min_m[axis];
    out.max_m[axis] = scale * box.max_m[axis];
  }
  return out;
}

class Gait {
 public:
  /// Tabulates one style of a model's gait over phase and speed. Joints are found by the adult's
  /// names; a model without them (a robot on wheels) gets a gait that keeps the zero posture.
  explicit Gait(const Model& model, GaitStyle style = GaitStyle::kPlain);
  ~Gait();
  /// With a room of its own, see share_bounds().
  Gait(const Gait& other);
  Gait(Gait&&) noexcept;
  Gait& operator=(Gait&&) noexcept;

  /// All of it as bytes, and a gait that is the same bit by bit from these; see gait_file.h. Throws
  /// InputError for what no gait has given; `name` says where it is from.
  std::vector<uint8_t> bytes() const;
  static Gait from(std::span<const uint8_t> bytes, const std::string& name);

  int column_count() const { return column_count_; }

  /// Metres per gait cycle (two steps) at this speed, for an avatar of this scale; > 0 also at 0
  /// m/s.
  float stride_length_m(float speed_mps, float scale) const;

  /// Writes one posture row (column_count() floats) each for phases.size() avatars.
  /// phase in [0, 1), 0 = right heel strike; speed >= 0, clamped to the tabulated range. No
  /// allocation.
  void postures(std::span<const float> phases, std::span<const float> speeds_mps,
                std::span<const float> scales, std::span<float> rows) const;

  /// The same for avatars of one model that walk in styles of their own: a gait each.
  static void postures(std::span<const Gait* const> gaits, std::span<const float> phases,
                       std::span<const float> speeds_mps, std::span<const float> scales,
                       std::span<float> rows);

  /// The farthest that a head turns away from where the body goes.
  static constexpr float kMaxHeadYaw_rad = 0.5f;

  /// Turns the head of a posture row to the left by as much, at most kMaxHeadYaw_rad to either
  /// side; the gait's bounds hold that, too. Nothing happens to a model without a head that turns.
  void apply_head_yaw(float head_yaw_rad, std::span<float> row) const;

  /// How far the hips are to the left of the root, metres at scale 1.
  float hips_offset_m(const WalkPosture& posture) const;
  /// What giving way needs to know of this body; null for one that cannot.
  const Outline* outline() const { return outline_.get(); }

  /// Writes a box each that holds every part in the posture that postures() gives for the same
  /// phase, speed and scale; looked up, not computed. No allocation.
  void bounds(std::span<const float> phases, std::span<const float> speeds_mps,
              std::span<const float> scales, std::span<RootBox> boxes) const;
  /// The one of these that bounds() scales.
  const RootBox& box_at(float phase01, float speed_mps, float scale) const;

  /// Walks avatars on by a step, each by its own of chunk.gaits, all of one model: see
  /// Stepping::walk(). A body without human legs rolls on by the way walked. No allocation.
  static void walk(WalkBatch& batch, SimdTarget target);
  /// Whether walk() gives postures, which then stand in for phase, speed and scale.
  bool has_legs() const;
  /// Writes the posture rows of some of all, whose gaits are given. No allocation.
  static void postures(std::span<const Gait* const> gaits, std::span<const WalkPosture> all,
                       std::span<const uint32_t> some, std::span<float> rows,
                       SimdTarget target = SimdTarget::kBest);
  /// Of a body with legs.
  FootTrack track_at(float speed_mps, float scale) const;
  const SwingCurve& swing() const { return swing_; }
  /// A box that holds every part.
  RootBox box_of(const WalkBounds& packed_bounds, float scale) const;
  /// The other way round; nothing in z.
  WalkBounds walk_bounds_of(const RootBox& box, float scale) const;
  /// What walk() keeps bodies in, metres unscaled: at first this gait's own sphere and cylinder.
  /// All gaits of a model that walk together share one that holds those of each.
  void share_bounds(float centre_z_m, float radius_m, float upright_radius_m);

  /// A sphere in the root frame (metres, unscaled) that bounds every part in every posture the gait
  /// can produce: its centre lies on the root's z axis, the radius includes the interpolation
  /// error.
  Eigen::Vector3f sphere_centre_m() const { return sphere_centre_m_; }
  float sphere_radius_m() const { return sphere_radius_m_; }
  /// Radius of the cylinder around the root's z axis that bounds the same (metres, unscaled).
  float upright_radius_m() const { return upright_radius_m_; }

 private:
  Gait();
  void archive(Archive& a);
  void roll(WalkBatch& batch, size_t i) const;
  void stand_as_tabled(WalkBatch& batch, size_t i) const;

  struct Table;
  int column_count_ = 0;
  int head_yaw_column_ = -1;
  std::vector<float> hips_offset_m_;                   ///< of the table's rows; empty: never aside
  float min_head_yaw_rad_ = 0, max_head_yaw_rad_ = 0;  ///< the joint's limits
  Eigen::Vector3f sphere_centre_m_ = Eigen::Vector3f::Zero();
  float sphere_radius_m_ = 0;
  float upright_radius_m_ = 0;
  std::unique_ptr<Table> table_;
  SwingCurve swing_{};
  std::shared_ptr<const Outline> outline_;
};

}  // namespace throng
