#include "culling/stages/posed_bodies.h"

#include <algorithm>
#include <cassert>

#include "base/counting_sort.h"
#include "base/stopwatch.h"
#include "culling/fitted.h"
#include "culling/stages/sphere_check.h"

namespace throng {

void PosedBodies::Counters::add(const Counters& other) {
  bodies += other.bodies;
  parts += other.parts;
  pose_ns += other.pose_ns;
  box_ns += other.box_ns;
}

void PosedBodies::prepare(size_t slots) {
  if (slots <= prepared_) return;
  clear();
  local_of_slot_.resize(slots);
  prepared_ = local_of_slot_.capacity();
  std::fill_n(local_of_slot_.data(), prepared_, kNone);
}

void PosedBodies::clear() {
  for (size_t i = 0; i < count_; ++i) local_of_slot_[slots_[i]] = kNone;
  count_ = posed_ = pose_count_ = unit_count_ = 0;
}

/// Assigns rows to every body that is not yet posed, type by type, so that a batch is contiguous.
/// Returns the number of batches.
size_t PosedBodies::plan_rows(const Frame& frame) {
  constexpr uint32_t kBatch = PoseSource::kMaxBatch;
  const size_t types = frame.types.size(), fresh = count_ - posed_;
  bodies_.grow(count_, posed_);
  by_type_.resize(fresh);
  type_start_.resize(types + 2);
  batches_.resize(fresh / kBatch + types);
  constexpr size_t kAhead = 16;  // slots come in pair order, not in memory order
  for (size_t i = posed_; i < count_; ++i) {
    if (i + kAhead < count_) frame.slots.prefetch(slots_[i + kAhead]);
    bodies_[i].slot = frame.slots[slots_[i]];
  }
  counting_sort(
      fresh, types, type_start_.data(), [&](size_t i) { return bodies_[posed_ + i].slot.type; },
      [&](size_t i, uint32_t at) { by_type_[at] = static_cast<uint32_t>(posed_ + i); });
  const size_t poses_before = pose_count_, units_before = unit_count_;
  size_t batches = 0;
  for (size_t type = 0; type < types; ++type) {
    const size_t parts = static_cast<size_t>(frame.types[type]->part_count());
    const uint32_t end = type_start_[type + 1];
    for (uint32_t i = type_start_[type]; i < end; ++i) {
      PosedBody& body = bodies_[by_type_[i]];
      body.pose = static_cast<uint32_t>(pose_count_);
      body.block = static_cast<uint32_t>(unit_count_);
      pose_count_ += parts;
      unit_count_ += box_block_units(parts);
    }
    for (uint32_t first = type_start_[type]; first < end; first += kBatch)
      batches_[batches++] = {first, std::min(kBatch, end - first), {}};
  }
  poses_.grow(pose_count_, poses_before);
  boxes_.grow(unit_count_ * kBoxLanes, units_before * kBoxLanes);
  posed_ = count_;
  return batches;
}

void PosedBodies::pose(const Frame& frame, Workers& workers) {
  const size_t batches = plan_rows(frame);
  workers.for_blocks(static_cast<int>(batches), [&](int batch, int) {
    pose_batch(frame, batches_[static_cast<size_t>(batch)]);
  });
  for (size_t i = 0; i < batches; ++i) counters_.add(batches_[i].counters);
}

void PosedBodies::pose_batch(const Frame& frame, Batch& batch) {
  const size_t count = batch.count;
  const uint32_t* const locals = by_type_.data() + batch.first;
  uint32_t bodies[PoseSource::kMaxBatch];
  float scales[PoseSource::kMaxBatch], margins[PoseSource::kMaxBatch];
  float* blocks[PoseSource::kMaxBatch];
  for (size_t i = 0; i < count; ++i) {
    const PosedBody& body = bodies_[locals[i]];
    bodies[i] = body.slot.body;
    scales[i] = body.slot.scale;
    margins[i] = body.slot.margin_m;
    blocks[i] = boxes_.data() + size_t{body.block} * kBoxLanes;
  }
  const PosedBody& first = bodies_[locals[0]];
  const BodyType& type = *frame.types[first.slot.type];
  const size_t parts = static_cast<size_t>(type.part_count());
  PartPose* rows = poses_.data() + first.pose;
  Stopwatch watch;
  frame.source.poses({bodies, count}, {rows, count * parts});
  const double pose_ns = watch.lap_ns();
  for (size_t i = 0; i < count; ++i)
    assert(!find_part_outside(type, frame.slots.bodies().roots[bodies[i]].world_from_root,
                              scales[i], rows + i * parts));
  frame.kernels.part_boxes(type.volumes().tables().data(), parts, rows, scales, margins, count,
                           blocks);
  batch.counters = {count, count * parts, pose_ns, watch.lap_ns()};
}

void PosedBodies::reserve_like(const PosedBodies& other) {
  slots_.match(other.slots_);
  bodies_.match(other.bodies_);
  by_type_.match(other.by_type_);
  type_start_.match(other.type_start_);
  batches_.match(other.batches_);
  poses_.match(other.poses_);
  boxes_.match(other.boxes_);
}

uint32_t PosedBodies::times_grown() const {
  return local_of_slot_.times_grown() + slots_.times_grown() + bodies_.times_grown() +
         by_type_.times_grown() + type_start_.times_grown() + batches_.times_grown() +
         poses_.times_grown() + boxes_.times_grown();
}

}  // namespace throng
