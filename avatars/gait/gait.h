// Gait computes joint positions from gait phase and speed.
// Invariant: phase advances with the distance walked; a planted foot stays where it landed.
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
  /// Tabulates one style of a model's gait. Joints are found by the adult's names; without them (a
  /// robot on wheels) the gait keeps the zero posture.
  explicit Gait(const Model& model, GaitStyle style = GaitStyle::kPlain);
  ~Gait();
  /// The copy has separate bounds, see share_bounds().
  Gait(const Gait& other);
  Gait(Gait&&) noexcept;
  Gait& operator=(Gait&&) noexcept;

  /// Serialises the gait, and restores it bit by bit; see gait_file.h. from() throws InputError,
  /// naming `name`, for invalid bytes.
  std::vector<uint8_t> bytes() const;
  static Gait from(std::span<const uint8_t> bytes, const std::string& name);

  int column_count() const { return column_count_; }

  /// Returns metres per gait cycle (two steps) for an avatar of this scale; above 0 even at 0 m/s.
  float stride_length_m(float speed_mps, float scale) const;

  /// Writes one posture row of column_count() floats per avatar. phase in [0, 1), 0 = right heel
  /// strike; speeds are clamped to the tabulated range. Does not allocate.
  void postures(std::span<const float> phases, std::span<const float> speeds_mps,
                std::span<const float> scales, std::span<float> rows) const;

  /// Same for avatars of one model with different styles: one gait per avatar.
  static void postures(std::span<const Gait* const> gaits, std::span<const float> phases,
                       std::span<const float> speeds_mps, std::span<const float> scales,
                       std::span<float> rows);

  /// Largest head yaw, relative to the body heading.
  static constexpr float kMaxHeadYaw_rad = 0.5f;

  /// Turns the head of a posture row to the left, limited to kMaxHeadYaw_rad to either side. The
  /// gait's bounds include it. No effect for a model without a head yaw joint.
  void apply_head_yaw(float head_yaw_rad, std::span<float> row) const;

  /// Returns the hips' lateral offset from the root, positive to the left; metres at scale 1.
  float hips_offset_m(const WalkPosture& posture) const;
  /// Outline for body avoidance; null for a model that cannot avoid.
  const Outline* outline() const { return outline_.get(); }

  /// Writes one looked-up box per avatar that contains all parts in the posture of postures() at
  /// the same inputs. Does not allocate.
  void bounds(std::span<const float> phases, std::span<const float> speeds_mps,
              std::span<const float> scales, std::span<RootBox> boxes) const;
  /// Returns the tabulated box that bounds() scales.
  const RootBox& box_at(float phase01, float speed_mps, float scale) const;

  /// Advances avatars of one model, each by its gait in batch.gaits: see Stepping::walk(). A body
  /// without legs advances its phase with the distance moved. Does not allocate.
  static void walk(WalkBatch& batch, SimdTarget target);
  /// Whether walk() computes a WalkPosture, which replaces phase, speed and scale.
  bool has_legs() const;
  /// Writes posture rows of the avatars `some` of `all`; `gaits`: parallel to `some`. Does not
  /// allocate.
  static void postures(std::span<const Gait* const> gaits, std::span<const WalkPosture> all,
                       std::span<const uint32_t> some, std::span<float> rows,
                       SimdTarget target = SimdTarget::kBest);
  /// Returns the foot track at this speed; only for a body with legs.
  FootTrack track_at(float speed_mps, float scale) const;
  const SwingCurve& swing() const { return swing_; }
  RootBox box_of(const WalkBounds& packed_bounds, float scale) const;
  /// Inverse of box_of(), without z.
  WalkBounds walk_bounds_of(const RootBox& box, float scale) const;
  /// Sets the bounds of walk(), in metres at scale 1; initially this gait's sphere and cylinder.
  /// Gaits that walk together share bounds that contain those of each.
  void share_bounds(float centre_z_m, float radius_m, float upright_radius_m);

  /// Sphere in the root frame (metres, unscaled) that bounds every part in every posture of the
  /// gait. Its centre lies on the root's z axis; the radius includes the interpolation error.
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
  std::vector<float> hips_offset_m_;                   ///< indexed by table row; empty: always 0
  float min_head_yaw_rad_ = 0, max_head_yaw_rad_ = 0;  ///< limits of the joint
  Eigen::Vector3f sphere_centre_m_ = Eigen::Vector3f::Zero();
  float sphere_radius_m_ = 0;
  float upright_radius_m_ = 0;
  std::unique_ptr<Table> table_;
  SwingCurve swing_{};
  std::shared_ptr<const Outline> outline_;
};

}  // namespace throng
