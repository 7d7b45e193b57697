#include "scenes/run/posing.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <numeric>

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;

int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

/// Rows of one batch; grows to the widest model once a thread and is then reused.
std::span<float> scratch_rows(size_t floats) {
  thread_local std::vector<float> rows;
  if (rows.size() < floats) rows.resize(floats);
  return {rows.data(), floats};
}

}  // namespace

Posing::Posing(std::vector<std::shared_ptr<const Model>> models, std::span<const Styles> styles,
               const BodyStates& states, Workers& workers)
    : models_(std::move(models)), gaits_(models_.size()), states_(states) {
  assert(styles.size() == models_.size());
  constexpr int kStyles = static_cast<int>(kGaitStyleCount);
  workers.for_blocks(static_cast<int>(models_.size()) * kStyles, [&](int index, int) {
    const auto model = static_cast<size_t>(index / kStyles);
    const auto style = static_cast<size_t>(index % kStyles);
    if (style > 0 && !styles[model][style]) return;
    gaits_[model][style] = std::make_unique<Gait>(*models_[model], static_cast<GaitStyle>(style));
  });
  for (size_t model = 0; model < models_.size(); ++model) {
    const RootSphere room = sphere(model);
    for (const std::unique_ptr<Gait>& gait : gaits_[model])
      if (gait != nullptr)
        gait->share_room(room.centre_m.z(), room.radius_m, room.upright_radius_m);
  }
}

RootSphere Posing::sphere(size_t model) const {
  const Gait& plain = *gaits_[model].front();
  RootSphere sphere{plain.sphere_centre_m(), 0, 0};
  for (const std::unique_ptr<Gait>& gait : gaits_[model]) {
    if (gait == nullptr) continue;
    const float apart_m = (gait->sphere_centre_m() - sphere.centre_m).norm();
    sphere.radius_m = std::max(sphere.radius_m, gait->sphere_radius_m() + apart_m);
    sphere.upright_radius_m = std::max(sphere.upright_radius_m, gait->upright_radius_m());
  }
  return sphere;
}

void Posing::use_rows(std::span<const float> rows, std::span<const size_t> offsets) {
  rows_ = rows;
  row_offsets_ = offsets;
}

void Posing::postures(uint32_t first, uint32_t count, std::span<float> rows) const {
  const size_t type = states_.types[first];
  const auto columns = static_cast<size_t>(column_count(type));
  std::array<uint32_t, kMaxBatch> some;
  for (uint32_t done = 0; done < count; done += kMaxBatch) {
    const size_t batch = std::min<size_t>(kMaxBatch, count - done);
    std::iota(some.begin(), some.begin() + static_cast<ptrdiff_t>(batch), first + done);
    make_rows({some.data(), batch}, type, rows.subspan(done * columns, batch * columns));
  }
}

void Posing::gather_rows(std::span<const uint32_t> bodies, size_t type,
                         std::span<float> rows) const {
  if (rows_.empty()) return make_rows(bodies, type, rows);
  const auto columns = static_cast<size_t>(column_count(type));
  for (size_t i = 0; i < bodies.size(); ++i)
    std::copy_n(rows_.begin() + static_cast<ptrdiff_t>(row_offsets_[bodies[i]]), columns,
                rows.begin() + static_cast<ptrdiff_t>(i * columns));
}

/// Of bodies of one type.
void Posing::make_rows(std::span<const uint32_t> bodies, size_t type, std::span<float> rows) const {
  const auto columns = static_cast<size_t>(column_count(type));
  if (is_held(bodies.front())) {  // all of a type are, or none
    for (size_t i = 0; i < bodies.size(); ++i)
      std::copy_n(states_.held_rows[bodies[i]], columns, rows.data() + i * columns);
    return;
  }
  std::array<const Gait*, kMaxBatch> gaits{};
  for (size_t i = 0; i < bodies.size(); ++i) {
    gaits[i] = &gait_of(bodies[i]);
    // Bodies are in the order of the search: far apart.
    if (!states_.postures.empty()) __builtin_prefetch(&states_.postures[bodies[i]]);
  }
  if (has_legs(bodies.front()))
    Gait::postures({gaits.data(), bodies.size()}, states_.postures, bodies, rows);
  else
    make_plain_rows(bodies, {gaits.data(), bodies.size()}, rows);
  for (size_t i = 0; i < bodies.size() && !states_.looks_rad.empty(); ++i)
    gaits[i]->look(states_.looks_rad[bodies[i]], rows.subspan(i * columns, columns));
}

/// As phases, speeds and scales have it, without planted feet.
void Posing::make_plain_rows(std::span<const uint32_t> bodies, std::span<const Gait* const> gaits,
                             std::span<float> rows) const {
  std::array<float, kMaxBatch> phases;
  std::array<float, kMaxBatch> speeds;
  std::array<float, kMaxBatch> scales;
  for (size_t i = 0; i < bodies.size(); ++i) {
    phases[i] = states_.phases[bodies[i]];
    speeds[i] = states_.gait_mps[bodies[i]];
    scales[i] = states_.scales[bodies[i]];
  }
  Gait::postures(gaits, {phases.data(), bodies.size()}, {speeds.data(), bodies.size()},
                 {scales.data(), bodies.size()}, rows);
}

void Posing::poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  assert(bodies.size() <= kMaxBatch);
  if (bodies.empty()) return;
  if (view_.empty()) return poses_of(bodies, out);
  std::array<uint32_t, kMaxBatch> in_view;
  for (size_t i = 0; i < bodies.size(); ++i) in_view[i] = view_[bodies[i]];
  poses_of({in_view.data(), bodies.size()}, out);
}

void Posing::poses_of(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  const size_t type = states_.types[bodies.front()];
  if (type >= models_.size()) {  // an obstacle: one part, in the root frame
    for (size_t i = 0; i < bodies.size(); ++i) {
      Eigen::Isometry3d world_from_part = Eigen::Isometry3d::Identity();
      world_from_part.linear() =
          states_.roots[bodies[i]].world_from_root.cast<double>().toRotationMatrix();
      out[i] = to_part_pose(world_from_part);
    }
    return;
  }
  const auto start = Clock::now();
  const auto columns = static_cast<size_t>(column_count(type));
  const std::span<float> rows = scratch_rows(bodies.size() * columns);
  gather_rows(bodies, type, rows);
  const auto posed = Clock::now();
  std::array<RootFrame, kMaxBatch> frames;
  for (size_t i = 0; i < bodies.size(); ++i)
    frames[i] = {states_.roots[bodies[i]].world_from_root, states_.scales[bodies[i]]};
  forward_kinematics(models_[type]->kinematics, rows, {frames.data(), bodies.size()}, out);
  gait_ns_.fetch_add(nanoseconds(posed - start), std::memory_order_relaxed);
  kinematics_ns_.fetch_add(nanoseconds(Clock::now() - posed), std::memory_order_relaxed);
}

void Posing::bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const {
  for (size_t i = 0; i < bodies.size(); ++i) {
    const uint32_t body = view_.empty() ? bodies[i] : view_[bodies[i]];
    const size_t type = states_.types[body];
    if (type < models_.size() && !(body < states_.phases.size() && is_held(body))) {
      const Gait& gait = gait_of(body);
      if (has_legs(body))
        out[i] = gait.box_of({states_.room_x[body], states_.room_y[body]}, states_.scales[body]);
      else
        gait.bounds({&states_.phases[body], 1}, {&states_.gait_mps[body], 1},
                    {&states_.scales[body], 1}, {&out[i], 1});
    } else {
      out[i] = {};  // an obstacle, or joints that the gait knows nothing of: the sphere has to do
    }
  }
}

Posing::Times Posing::take_times() {
  return {static_cast<double>(gait_ns_.exchange(0, std::memory_order_relaxed)),
          static_cast<double>(kinematics_ns_.exchange(0, std::memory_order_relaxed))};
}

}  // namespace throng
