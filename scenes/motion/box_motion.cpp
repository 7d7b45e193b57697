#include "scenes/motion/box_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string_view>

#include "base/checksum.h"
#include "base/errors.h"
#include "base/portable_math.h"
#include "base/random.h"
#include "culling/volumes/sphere.h"
#include "scenes/run/posing.h"
#include "scenes/run/sink.h"

namespace throng {
namespace {

/// Indices of an object's random draws.
enum Draw : uint32_t { kPosition = 0, kSpeed = 3, kVelocity = 4, kSpin = 6, kAttitude = 9 };

/// Uniform on the unit sphere, by height and azimuth (Archimedes).
Eigen::Vector3d random_direction(const RandomKey& key, uint32_t draw) {
  const double z = random_uniform(key, -1, 1, draw);
  const SinCos azimuth = sin_cos(random_uniform(key, 0, 2 * std::numbers::pi, draw + 1));
  const double rim = std::sqrt(1 - z * z);
  return {rim * azimuth.cos, rim * azimuth.sin, z};
}

/// Uniform over all attitudes (Shoemake 1992).
Eigen::Quaterniond random_attitude(const RandomKey& key, uint32_t draw) {
  const double u = random_uniform(key, draw);
  const SinCos a = sin_cos(random_uniform(key, 0, 2 * std::numbers::pi, draw + 1));
  const SinCos b = sin_cos(random_uniform(key, 0, 2 * std::numbers::pi, draw + 2));
  const double p = std::sqrt(1 - u), q = std::sqrt(u);
  return {q * b.cos, p * a.sin, p * a.cos, q * b.sin};
}

/// Written out, because Eigen's vectorised product may sum in another order.
Eigen::Quaterniond product(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return {a.w() * b.w() - a.x() * b.x() - a.y() * b.y() - a.z() * b.z(),
          a.w() * b.x() + a.x() * b.w() + a.y() * b.z() - a.z() * b.y(),
          a.w() * b.y() - a.x() * b.z() + a.y() * b.w() + a.z() * b.x(),
          a.w() * b.z() + a.x() * b.y() - a.y() * b.x() + a.z() * b.w()};
}

Eigen::Quaterniond normalised(const Eigen::Quaterniond& q) {
  const double inverse =
      1 / std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
  return {inverse * q.w(), inverse * q.x(), inverse * q.y(), inverse * q.z()};
}

Eigen::Quaterniond turn_of(const Eigen::Vector3d& axis, double angle_rad) {
  const SinCos half = sin_cos(0.5 * angle_rad);
  return {half.cos, half.sin * axis.x(), half.sin * axis.y(), half.sin * axis.z()};
}

}  // namespace

BoxDynamics::BoxDynamics(const BoxOptions& options, std::span<const double> radii_m,
                         std::span<const uint8_t> is_static)
    : options_(options) {
  assert(radii_m.size() == is_static.size());
  for (size_t i = 0; i < radii_m.size(); ++i) {
    const double clearance_m = options.edge_m - 2 * radii_m[i];
    if (!(clearance_m > options.max_speed_mps * options.step_s))
      throw InputError(options.name,
                       fmt::format("an edge of more than {:.3f} m, in which object {} can move",
                                   2 * radii_m[i] + options.max_speed_mps * options.step_s, i),
                       fmt::format("{} m", options.edge_m));
    low_m_.push_back(low_m().array() + radii_m[i]);
    high_m_.push_back(high_m().array() - radii_m[i]);
    const RandomKey key{options.seed, i, 0, Purpose::kBoxWorld};
    Eigen::Vector3d position;
    for (uint32_t axis = 0; axis < 3; ++axis)
      position[axis] =
          random_uniform(key, low_m_[i][axis], high_m_[i][axis], Draw::kPosition + axis);
    positions_m_.push_back(position);
    orientations_.push_back(random_attitude(key, Draw::kAttitude));
    const bool moves = is_static[i] == 0;
    const double speed_mps =
        moves ? random_uniform(key, options.min_speed_mps, options.max_speed_mps, Draw::kSpeed) : 0;
    velocities_mps_.push_back(speed_mps * random_direction(key, Draw::kVelocity));
    const Eigen::Vector3d axis = random_direction(key, Draw::kSpin);
    const double spin_radps =
        moves ? random_uniform(key, 0, options.max_spin_radps, Draw::kSpin + 2) : 0;
    turns_.push_back(turn_of(axis, spin_radps * options.step_s));
  }
}

BoxDynamics BoxDynamics::of_kinds(const BoxOptions& options, std::span<const double> radii_m,
                                  size_t count, size_t static_every) {
  std::vector<double> radii(count);
  std::vector<uint8_t> is_static(count);
  for (size_t i = 0; i < count; ++i) {
    radii[i] = radii_m[i % radii_m.size()];
    is_static[i] = static_every != 0 && i % static_every == static_every - 1;
  }
  return BoxDynamics(options, radii, is_static);
}

void BoxDynamics::archive(Archive& a) {
  a(positions_m_, velocities_mps_, orientations_);
  if (!a.is_reading()) return;
  for (size_t i = 0; i < positions_m_.size(); ++i) {
    const bool is_inside = (positions_m_[i].array() >= low_m_[i].array()).all() &&
                           (positions_m_[i].array() <= high_m_[i].array()).all();
    // Negated comparison: also rejects NaN. The diagonal is the longest displacement.
    const bool is_slow = velocities_mps_[i].norm() <= 2 * options_.max_speed_mps;
    const bool is_unit = std::abs(orientations_[i].norm() - 1) < 1e-6;
    if (!is_inside || !is_slow || !is_unit) a.reject("an object in the box", "another");
  }
}

void BoxDynamics::step() {
  for (size_t i = 0; i < positions_m_.size(); ++i) {
    Eigen::Vector3d& position = positions_m_[i];
    Eigen::Vector3d& velocity = velocities_mps_[i];
    for (int axis = 0; axis < 3; ++axis) {
      double moved = position[axis] + options_.step_s * velocity[axis];
      const double low = low_m_[i][axis], high = high_m_[i][axis];
      // Mirror image behind the wall; rounding may place it an ulp outside.
      if (moved < low || moved > high) {
        moved = std::clamp(2 * (moved < low ? low : high) - moved, low, high);
        velocity[axis] = -velocity[axis];
      }
      position[axis] = moved;
    }
    // Normalised every step, or the error of the length would grow.
    orientations_[i] = normalised(product(turns_[i], orientations_[i]));
  }
}

PartPose BoxDynamics::pose(size_t object) const {
  const Eigen::Quaterniond& q = orientations_[object];
  const Eigen::Vector3d& t = positions_m_[object];
  const double x2 = 2 * q.x(), y2 = 2 * q.y(), z2 = 2 * q.z();
  const double xx = x2 * q.x(), yy = y2 * q.y(), zz = z2 * q.z();
  const double xy = x2 * q.y(), xz = x2 * q.z(), yz = y2 * q.z();
  const double wx = x2 * q.w(), wy = y2 * q.w(), wz = z2 * q.w();
  const auto f = [](double v) { return static_cast<float>(v); };
  return {{{f(1 - yy - zz), f(xy - wz), f(xz + wy), f(t.x())},
           {f(xy + wz), f(1 - xx - zz), f(yz - wx), f(t.y())},
           {f(xz - wy), f(yz + wx), f(1 - xx - yy), f(t.z())}}};
}

double BoxDynamics::reach_m() const { return std::sqrt(1.5) * options_.edge_m; }

namespace {

std::shared_ptr<const Model> alone(const Model& body, const Part& part) {
  Robot robot;
  robot.name = part.name;
  robot.links.push_back({part.name, {}, {}, {}});
  Part centred{part.name, part.source, 0, part.mesh};
  const Eigen::Vector3f middle = Sphere::fit(part.mesh.vertices).centre_m;
  for (Eigen::Vector3f& vertex : centred.mesh.vertices) vertex -= middle;
  const std::array<int, 1> links = {0};
  FlatModel kinematics(robot, links);
  Model model{part.name,
              std::move(robot),
              {std::move(centred)},
              std::move(kinematics),
              0,
              Hasher().add(body.content_hash).add(std::string_view(part.name)).value()};
  model.height_m = static_cast<float>(2 * reach_m(model));
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace

std::vector<std::shared_ptr<const Model>> loose_parts(const Model& body) {
  std::vector<std::shared_ptr<const Model>> models;
  for (const Part& part : body.parts) models.push_back(alone(body, part));
  return models;
}

double reach_m(const Model& loose_part) {
  double reach = 0;
  for (const Eigen::Vector3f& vertex : loose_part.parts.front().mesh.vertices)
    reach = std::max(reach, vertex.cast<double>().norm());
  return reach;
}

namespace {

BoxDynamics box_of(const Scene& scene, std::span<const std::shared_ptr<const Model>> parts) {
  const PartsBox& box = *scene.box;
  std::vector<double> radii_m;
  for (const std::shared_ptr<const Model>& part : parts) radii_m.push_back(reach_m(*part));
  BoxOptions options;
  options.seed = scene.seed;
  if (!scene.file.empty()) options.name = scene.file.string();
  options.edge_m = box.edge_m;
  options.step_s = scene.step_s;
  options.min_speed_mps = box.min_speed_mps;
  options.max_speed_mps = box.max_speed_mps;
  options.max_spin_radps = box.max_spin_radps;
  return BoxDynamics::of_kinds(options, radii_m, static_cast<size_t>(box.count),
                               static_cast<size_t>(box.static_every));
}

}  // namespace

BoxMotion::BoxMotion(const Scene& scene)
    : parts_(loose_parts(*scene.box->body)), box_(box_of(scene, parts_)) {}

void BoxMotion::place(BodyStates& bodies) {
  for (size_t i = 0; i < box_.size(); ++i) {
    bodies.types.push_back(static_cast<uint16_t>(i % parts_.size()));
    bodies.scales.push_back(1);
    bodies.phases.push_back(0);
  }
}

void BoxMotion::describe(RunInfo& info) const {
  info.groups = {"part"};
  info.group_of_avatar.assign(box_.size(), 0);
  info.control_channels.resize(1);
}

void BoxMotion::update(const Posing&, BodyStates& bodies, std::span<float> speeds_mps) {
  for (size_t i = 0; i < box_.size(); ++i) {
    bodies.roots[i] = {box_.positions_m()[i], box_.orientations()[i].cast<float>()};
    speeds_mps[i] = static_cast<float>(box_.velocities_mps()[i].norm());
  }
}

}  // namespace throng
