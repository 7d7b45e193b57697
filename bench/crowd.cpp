#include "bench/crowd.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/errors.h"
#include "base/random.h"

namespace throng::bench {

Crowd::Crowd(std::shared_ptr<const Model> model, const CrowdShape& shape)
    : model_(std::move(model)), gait_(*model_), shape_(shape) {
  if (static_cast<size_t>(gait_.column_count()) > kMaxColumns)
    throw InputError(model_->name, fmt::format("a model of at most {} joints", kMaxColumns),
                     fmt::format("{}", gait_.column_count()));
  const int side = static_cast<int>(std::ceil(std::sqrt(shape.avatars)));
  const double spacing_m = 1 / std::sqrt(shape.per_m2);
  const float speed = static_cast<float>(shape.speed_mps);
  dphase_ = static_cast<float>(shape.speed_mps * shape.step_s) / gait_.stride_length_m(speed, 1);
  for (int i = 0; i < shape.avatars; ++i) {
    const auto draw = [&](Purpose purpose, double low, double high, uint32_t index = 0) {
      return random_uniform(
          {.seed = shape.seed, .id = static_cast<uint64_t>(i), .purpose = purpose}, low, high,
          index);
    };
    const double heading = draw(Purpose::kSpawnHeading, 0, 2 * std::numbers::pi);
    const int column = i % side, row = i / side;
    RootPose root;
    root.position_m = {(column + draw(Purpose::kSpawnPosition, -0.25, 0.25, 0)) * spacing_m,
                       (row + draw(Purpose::kSpawnPosition, -0.25, 0.25, 1)) * spacing_m, 0};
    root.world_from_root = Eigen::AngleAxisf(static_cast<float>(heading), Eigen::Vector3f::UnitZ());
    ids_.push_back(static_cast<uint32_t>(i));
    types_.push_back(0);
    scales_.push_back(1);
    speeds_.push_back(speed);
    phases_.push_back(static_cast<float>(draw(Purpose::kGaitPhase, 0, 1)));
    roots_.push_back(root);
    velocities_mps_.push_back(shape.speed_mps *
                              Eigen::Vector2d(std::cos(heading), std::sin(heading)));
  }
}

void Crowd::advance() {
  for (size_t i = 0; i < ids_.size(); ++i) {
    roots_[i].position_m.head<2>() += shape_.step_s * velocities_mps_[i];
    phases_[i] += dphase_;
    if (phases_[i] >= 1) phases_[i] -= 1;
  }
}

std::shared_ptr<const BodyType> Crowd::body_type() const {
  std::vector<PartShape> parts;
  for (const Part& part : model_->parts) parts.push_back({part.mesh.vertices, part.mesh.triangles});
  return std::make_shared<BodyType>(
      std::move(parts),
      RootSphere{gait_.sphere_centre_m(), gait_.sphere_radius_m(), gait_.upright_radius_m()},
      false);
}

void Crowd::poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  std::array<float, kMaxBatch> phases, speeds, scales;
  std::array<RootFrame, kMaxBatch> frames;
  std::array<float, kMaxBatch * kMaxColumns> postures;
  for (size_t i = 0; i < bodies.size(); ++i) {
    phases[i] = phases_[bodies[i]];
    speeds[i] = speeds_[bodies[i]];
    scales[i] = scales_[bodies[i]];
    frames[i] = {roots_[bodies[i]].world_from_root, scales[i]};
  }
  const size_t n = bodies.size();
  const std::span<float> rows(postures.data(), n * static_cast<size_t>(gait_.column_count()));
  gait_.postures({phases.data(), n}, {speeds.data(), n}, {scales.data(), n}, rows);
  forward_kinematics(model_->kinematics, rows, {frames.data(), n}, out, simd);
}

void Crowd::bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const {
  std::array<float, kMaxBatch> phases, speeds, scales;
  for (size_t i = 0; i < bodies.size(); ++i) {
    phases[i] = phases_[bodies[i]];
    speeds[i] = speeds_[bodies[i]];
    scales[i] = scales_[bodies[i]];
  }
  const size_t n = bodies.size();
  gait_.bounds({phases.data(), n}, {speeds.data(), n}, {scales.data(), n}, out);
}

}  // namespace throng::bench
