#include "scenes/run/posing.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <numeric>

#include "scenes/run/body_tables.h"

namespace throng {
namespace {

using Clock = std::chrono::steady_clock;

int64_t nanoseconds(Clock::duration duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

/// Buffer for the rows of a batch, one per thread; grows to the widest model.
std::span<float> scratch_rows(size_t floats) {
  thread_local std::vector<float> rows;
  if (rows.size() < floats) rows.resize(floats);
  return {rows.data(), floats};
}

}  // namespace

Posing::Posing(std::vector<std::shared_ptr<const Model>> models, std::span<const ModelUse> uses,
               const BodyStates& states, BodyTables& tables, Workers& workers)
    : kinds_(models.size()), states_(states) {
  assert(uses.size() == models.size());
  for (size_t model = 0; model < models.size(); ++model) {
    Kind& kind = kinds_[model];
    kind.model = std::move(models[model]);
    kind.gaits = tables.gaits(kind.model, uses[model].styles, workers);
    kind.provider = make_posture_provider(uses[model].postures, *kind.gaits, states);
  }
}

void Posing::use_rows(std::span<const float> rows, std::span<const size_t> offsets) {
  rows_ = rows;
  row_offsets_ = offsets;
}

void Posing::rows(std::span<const uint32_t> bodies, std::span<float> rows) const {
  assert(bodies.size() <= kMaxBatch);
  const Kind& kind = kinds_[states_.types[bodies.front()]];
  const auto columns = static_cast<size_t>(kind.gaits->plain().column_count());
  std::array<const float*, kMaxBatch> found;
  kind.provider->rows(bodies, rows, {found.data(), bodies.size()});
  for (size_t i = 0; i < bodies.size(); ++i)
    if (float* to = rows.data() + i * columns; found[i] != to) std::copy_n(found[i], columns, to);
}

void Posing::postures(uint32_t first, uint32_t count, std::span<float> rows) const {
  const auto columns = static_cast<size_t>(column_count(states_.types[first]));
  std::array<uint32_t, kMaxBatch> some;
  for (uint32_t done = 0; done < count; done += kMaxBatch) {
    const size_t batch = std::min<size_t>(kMaxBatch, count - done);
    std::iota(some.begin(), some.begin() + static_cast<ptrdiff_t>(batch), first + done);
    this->rows({some.data(), batch}, rows.subspan(done * columns, batch * columns));
  }
}

void Posing::find_rows(const Kind& kind, std::span<const uint32_t> bodies,
                       std::span<const float*> rows) const {
  if (!rows_.empty()) {
    for (size_t i = 0; i < bodies.size(); ++i) rows[i] = &rows_[row_offsets_[bodies[i]]];
    return;
  }
  const auto columns = static_cast<size_t>(kind.gaits->plain().column_count());
  kind.provider->rows(bodies, scratch_rows(bodies.size() * columns), rows);
}

void Posing::poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  assert(bodies.size() <= kMaxBatch);
  if (bodies.empty()) return;
  std::array<uint32_t, kMaxBatch> in_view;
  if (!view_.empty()) {
    for (size_t i = 0; i < bodies.size(); ++i) in_view[i] = view_[bodies[i]];
    bodies = {in_view.data(), bodies.size()};
  }
  if (is_obstacle(bodies.front()))
    pose_obstacles(bodies, out);
  else
    pose_avatars(bodies, out);
}

void Posing::pose_of(uint32_t body, std::span<PartPose> out) const {
  if (is_obstacle(body))
    pose_obstacles({&body, 1}, out);
  else
    pose_avatars({&body, 1}, out);
}

void Posing::pose_obstacles(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  for (size_t i = 0; i < bodies.size(); ++i) {
    Eigen::Isometry3d world_from_part = Eigen::Isometry3d::Identity();
    world_from_part.linear() =
        states_.roots[bodies[i]].world_from_root.cast<double>().toRotationMatrix();
    out[i] = to_part_pose(world_from_part);
  }
}

void Posing::pose_avatars(std::span<const uint32_t> bodies, std::span<PartPose> out) const {
  const auto start = Clock::now();
  const Kind& kind = kinds_[states_.types[bodies.front()]];
  std::array<const float*, kMaxBatch> rows;
  find_rows(kind, bodies, {rows.data(), bodies.size()});
  const auto posed = Clock::now();
  std::array<RootFrame, kMaxBatch> frames;
  for (size_t i = 0; i < bodies.size(); ++i)
    frames[i] = {states_.roots[bodies[i]].world_from_root, states_.scales[bodies[i]]};
  forward_kinematics(kind.model->kinematics,
                     std::span<const float* const>(rows.data(), bodies.size()),
                     {frames.data(), bodies.size()}, out);
  gait_ns_.fetch_add(nanoseconds(posed - start), std::memory_order_relaxed);
  kinematics_ns_.fetch_add(nanoseconds(Clock::now() - posed), std::memory_order_relaxed);
}

void Posing::bounds(std::span<const uint32_t> bodies, std::span<RootBox> out) const {
  assert(bodies.size() <= kMaxBatch);
  std::array<uint32_t, kMaxBatch> run;
  for (size_t first = 0; first < bodies.size();) {
    const size_t type = states_.types[body_at(bodies[first])];
    size_t count = 0;
    for (size_t i = first; i < bodies.size(); ++i) {
      const uint32_t body = body_at(bodies[i]);
      if (states_.types[body] != type) break;
      run[count++] = body;
    }
    const std::span<RootBox> boxes = out.subspan(first, count);
    if (type < kinds_.size())
      kinds_[type].provider->bounds({run.data(), count}, boxes);
    else
      std::fill(boxes.begin(), boxes.end(), RootBox{});  // an obstacle: only its sphere bounds it
    first += count;
  }
}

Posing::Times Posing::take_times() {
  return {static_cast<double>(gait_ns_.exchange(0, std::memory_order_relaxed)),
          static_cast<double>(kinematics_ns_.exchange(0, std::memory_order_relaxed))};
}

}  // namespace throng
