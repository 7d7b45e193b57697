// BoxMotion moves rigid objects that fly, spin and pass through each other in a closed box, as in
// the paper.
// Invariant: an object never leaves the box and never loses speed; motion is equal on every
// machine.
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
  std::string name = "box";  ///< prefix of errors
  double edge_m = 3;         ///< the box spans [-edge/2, edge/2] in x and y, [0, edge] in z
  double step_s = 1.0 / 60.0;
  double min_speed_mps = 0.5;  ///< speeds are uniform in [min, max], directions on the sphere
  double max_speed_mps = 1.5;
  double max_spin_radps = 3;  ///< spins are uniform in [0, max], about uniform axes
};

class BoxDynamics {
 public:
  /// `radii_m`: reach of each object from its origin. `is_static`: 1 for objects at rest. Throws
  /// InputError if an object does not fit, or could cross the box in one step.
  BoxDynamics(const BoxOptions& options, std::span<const double> radii_m,
              std::span<const uint8_t> is_static);

  /// `count` objects with cyclically repeated radii; every `static_every`-th is at rest (0: none).
  static BoxDynamics of_kinds(const BoxOptions& options, std::span<const double> radii_m,
                              size_t count, size_t static_every);

  void step();

  void archive(Archive& a);

  size_t size() const { return positions_m_.size(); }
  const BoxOptions& options() const { return options_; }
  Eigen::Vector3d low_m() const { return {-0.5 * options_.edge_m, -0.5 * options_.edge_m, 0}; }
  Eigen::Vector3d high_m() const { return low_m().array() + options_.edge_m; }

  std::span<const Eigen::Vector3d> positions_m() const { return positions_m_; }
  std::span<const Eigen::Vector3d> velocities_mps() const { return velocities_mps_; }
  /// world_from_object, unit quaternions. Walls act on the centre only and do not change the spin
  /// axes.
  std::span<const Eigen::Quaterniond> orientations() const { return orientations_; }

  /// world_from_object, relative to the middle of the floor.
  PartPose pose(size_t object) const;

  /// Maximum length of translations; it bounds the rounding error of poses.
  double reach_m() const;

 private:
  BoxOptions options_;
  std::vector<Eigen::Vector3d> low_m_, high_m_;  ///< bounds of each object's origin
  std::vector<Eigen::Vector3d> positions_m_, velocities_mps_;
  std::vector<Eigen::Quaterniond> orientations_;
  std::vector<Eigen::Quaterniond> turns_;
};

/// One model per part, in the body's order, without joints; height_m is the sphere's diameter.
std::vector<std::shared_ptr<const Model>> loose_parts(const Model& body);

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
