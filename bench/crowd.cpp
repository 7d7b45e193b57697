#include "bench/crowd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/errors.h"
#include "base/random.h"
#include "culling/volumes/aabb.h"

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

namespace {

struct Cell {
  int32_t x, y;
  uint32_t avatar;
  auto operator<=>(const Cell&) const = default;
};

/// Returns the box around each avatar's part boxes.
std::vector<Box> avatar_boxes(const BoxList& frame) {
  std::vector<Box> out(frame.boxes.size() / frame.parts);
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = frame.boxes[i * frame.parts];
    for (const Box& part : frame.boxes.subspan(i * frame.parts, frame.parts))
      for (int axis = 0; axis < 3; ++axis) {
        out[i].min_m[axis] = std::min(out[i].min_m[axis], part.min_m[axis]);
        out[i].max_m[axis] = std::max(out[i].max_m[axis], part.max_m[axis]);
      }
  }
  return out;
}

void append_part_pairs(const BoxList& frame, uint32_t a, uint32_t b, std::vector<BoxPair>& out) {
  for (uint32_t i = a * frame.parts; i < (a + 1) * frame.parts; ++i)
    for (uint32_t j = b * frame.parts; j < (b + 1) * frame.parts; ++j)
      if (overlap(frame.boxes[i], frame.boxes[j])) append_pair(frame, i, j, out);
}

}  // namespace

BoxList CrowdBoxes::compute() {
  const BodiesView bodies = crowd_.view();
  const size_t parts = static_cast<size_t>(type_->part_count()), count = bodies.ids.size();
  poses_.resize(count * parts);
  boxes_.resize(count * parts);
  std::array<uint32_t, PoseSource::kMaxBatch> batch;
  for (size_t first = 0; first < count; first += batch.size()) {
    const size_t n = std::min(batch.size(), count - first);
    for (size_t i = 0; i < n; ++i) batch[i] = static_cast<uint32_t>(first + i);
    crowd_.poses({batch.data(), n}, {poses_.data() + first * parts, n * parts});
  }
  for (size_t i = 0; i < boxes_.size(); ++i) {
    const size_t body = i / parts;
    const Aabb::Placed box =
        Aabb::refit(type_->parts()[i % parts].points, poses_[i], bodies.scales[body]);
    for (int axis = 0; axis < 3; ++axis) {
      const double root = bodies.roots[body].position_m[axis];
      const double centre = root + static_cast<double>(box.centre_m[axis]);
      boxes_[i].min_m[axis] = static_cast<float>(centre - static_cast<double>(box.half_m[axis]));
      boxes_[i].max_m[axis] = static_cast<float>(centre + static_cast<double>(box.half_m[axis]));
    }
  }
  return {boxes_, static_cast<uint32_t>(parts)};
}

std::vector<BoxPair> reference_pairs(const BoxList& frame) {
  const std::vector<Box> avatars = avatar_boxes(frame);
  float width = std::numeric_limits<float>::min();
  for (const Box& box : avatars)
    for (int axis = 0; axis < 2; ++axis) width = std::max(width, box.max_m[axis] - box.min_m[axis]);
  std::vector<Cell> cells;
  for (uint32_t i = 0; i < avatars.size(); ++i)
    cells.push_back({static_cast<int32_t>(std::floor(avatars[i].min_m[0] / width)),
                     static_cast<int32_t>(std::floor(avatars[i].min_m[1] / width)), i});
  std::sort(cells.begin(), cells.end());
  std::vector<BoxPair> out;
  for (const Cell& cell : cells)
    for (int32_t dx = -1; dx <= 1; ++dx) {
      auto other = std::lower_bound(cells.begin(), cells.end(), Cell{cell.x + dx, cell.y - 1, 0});
      for (; other != cells.end() && other->x == cell.x + dx && other->y <= cell.y + 1; ++other)
        if (cell.avatar < other->avatar && overlap(avatars[cell.avatar], avatars[other->avatar]))
          append_part_pairs(frame, cell.avatar, other->avatar, out);
    }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace throng::bench
