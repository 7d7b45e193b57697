// The box of the paper: rigid objects that fly and spin, pass through each other and turn at walls.
// One rule: an object never leaves the box, never loses speed, and moves alike on every machine.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "avatars/model/model.h"
#include "base/files/archive.h"
#include "base/pose.h"
#include "scenes/motion/motion_source.h"

namespace throng {

struct BoxOptions {
  uint64_t seed = 1;
  std::string name = "box";  ///< what an error says first
  double edge_m = 3;         ///< the box spans [-edge/2, edge/2] in x and y, [0, edge] in z
  double step_s = 1.0 / 60.0;
  double min_speed_mps = 0.5;  ///< speeds are uniform between the two, directions on the sphere
  double max_speed_mps = 1.5;
  double max_spin_radps = 3;  ///< spins are uniform up to this, about uniform axes
};

class BoxDynamics {
 public:
  /// `radii_m`: how far each object reaches from its origin. `is_static`: 1 for objects that stand
  /// still. Throws InputError if an object does not fit, or could cross the box in one step.
  BoxDynamics(const BoxOptions& options, std::span<const double> radii_m,
              std::span<const uint8_t> is_static);

  /// `count` objects whose radii come in turn; every `static_every`-th stands still (0: none does).
  static BoxDynamics of_kinds(const BoxOptions& options, std::span<const double> radii_m,
                              size_t count, size_t static_every);

  /// Advances by step_s. Allocates nothing.
  void step();

  /// Everything that the next step depends on and that the constructor does not know.
  void archive(Archive& a);

  size_t size() const { return positions_m_.size(); }
  const BoxOptions& options() const { return options_; }
  Eigen::Vector3d low_m() const { return {-0.5 * options_.edge_m, -0.5 * options_.edge_m, 0}; }
  Eigen::Vector3d high_m() const { return low_m().array() + options_.edge_m; }

  std::span<const Eigen::Vector3d> positions_m() const { return positions_m_; }
  std::span<const Eigen::Vector3d> velocities_mps() const { return velocities_mps_; }
  /// World axes; constant, because walls act on the centre only.
  /// world_from_object, unit length.
  std::span<const Eigen::Quaterniond> orientations() const { return orientations_; }

  /// world_from_object, relative to the middle of the floor.
  PartPose pose(size_t object) const;

  /// No translation is longer than this: what bounds the rounding of poses.
  double reach_m() const;

 private:
  BoxOptions options_;
  std::vector<Eigen::Vector3d> low_m_, high_m_;  ///< where each object's origin may be
  std::vector<Eigen::Vector3d> positions_m_, velocities_mps_;
  std::vector<Eigen::Quaterniond> orientations_;
  std::vector<Eigen::Quaterniond> turns_;  ///< the rotation of one step
};

/// One model a part, in the body's order, without joints; height_m is the sphere's diameter.
std::vector<std::shared_ptr<const Model>> loose_parts(const Model& body);

/// How far a loose part reaches from its origin.
double reach_m(const Model& loose_part);

class BoxMotion final : public MotionSource {
 public:
  /// Throws InputError if a part does not fit.
  explicit BoxMotion(const Scene& scene);

  const std::vector<std::shared_ptr<const Model>>& models() const override { return parts_; }
  void place(BodyStates& bodies) override;
  void describe(RunInfo& info) const override;
  void step() override { box_.step(); }
  void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) override;
  void archive(Archive& a) override { box_.archive(a); }

 private:
  std::vector<std::shared_ptr<const Model>> parts_;
  BoxDynamics box_;
};

}  // namespace throng
