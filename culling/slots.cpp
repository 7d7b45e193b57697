#include "culling/slots.h"

#include <algorithm>
#include <atomic>

#include "culling/fitted.h"
#include "culling/stopwatch.h"

namespace throng {

float reach_m(const BodyType& type) {
  return type.sphere().centre_m.norm() + type.sphere().radius_m;
}

// Lengths of up to four times either reach enter a test: the distance of the roots, two
// translations and two points.
float body_margin_m(float reach_m) { return rounding_margin_m(4 * reach_m); }

Slots::Slots(std::span<const std::shared_ptr<const BodyType>> types, const Kernels& kernels,
             Workers& workers)
    : types_(types),
      kernels_(kernels),
      workers_(workers),
      to_pose_(types.size()),
      to_pose_count_(types.size()),
      by_worker_(static_cast<size_t>(workers.threads())) {}

void Slots::begin_frame(size_t count) {
  count_ = count;
  slots_.resize(count);
  needed_.resize(count);
  std::fill_n(needed_.data(), count, uint8_t{0});
  for (auto& list : to_pose_) list.resize(count);
  std::fill(to_pose_count_.begin(), to_pose_count_.end(), size_t{0});
  pose_count_ = box_units_ = 0;
  std::fill(by_worker_.begin(), by_worker_.end(), Counters{});
}

void Slots::fill(size_t slot, uint32_t body, const BodiesView& bodies) {
  const uint16_t type = bodies.types[body];
  const float scale = bodies.scales[body];
  const Eigen::Vector3d& root = bodies.roots[body].position_m;
  slots_[slot] = {{root.x(), root.y(), root.z()},
                  scale,
                  body_margin_m(scale * reach_m(*types_[type])),
                  kNotPosed,
                  kNotPosed,
                  body,
                  type};
}

void Slots::need(size_t slot) {
  std::atomic_ref(needed_[slot]).store(1, std::memory_order_relaxed);
}

void Slots::plan(size_t slot) {
  if (!needed_[slot] || slots_[slot].pose != kNotPosed) return;
  needed_[slot] = 0;  // it is planned; a list may name it twice
  const size_t type = slots_[slot].type;
  to_pose_[type][to_pose_count_[type]++] = static_cast<uint32_t>(slot);
}

/// Rows for every planned body, type by type, so that a batch is contiguous.
void Slots::plan_rows() {
  const size_t poses_before = pose_count_, units_before = box_units_;
  for (size_t type = 0; type < types_.size(); ++type) {
    const size_t parts = static_cast<size_t>(types_[type]->part_count());
    for (size_t i = 0; i < to_pose_count_[type]; ++i) {
      SlotBody& slot = slots_[to_pose_[type][i]];
      slot.pose = static_cast<uint32_t>(pose_count_);
      slot.block = static_cast<uint32_t>(box_units_);
      pose_count_ += parts;
      box_units_ += box_block_units(parts);
    }
  }
  poses_.grow(pose_count_, poses_before);
  boxes_.grow(box_units_ * kBoxLanes, units_before * kBoxLanes);
}

void Slots::pose_needed(const PoseSource& source) {
  for (size_t slot = 0; slot < count_; ++slot) plan(slot);
  pose_planned(source);
}

void Slots::pose_needed_of(std::span<const uint32_t> slots, const PoseSource& source) {
  for (const uint32_t slot : slots) plan(slot);
  pose_planned(source);
}

void Slots::pose_planned(const PoseSource& source) {
  plan_rows();
  constexpr size_t kBatch = PoseSource::kMaxBatch;
  for (size_t type = 0; type < types_.size(); ++type) {
    const std::span<const uint32_t> list(to_pose_[type].data(), to_pose_count_[type]);
    workers_.for_blocks(
        static_cast<int>((list.size() + kBatch - 1) / kBatch), [&](int block, int worker) {
          const size_t first = static_cast<size_t>(block) * kBatch;
          pose_batch(list.subspan(first, std::min(kBatch, list.size() - first)), source, worker);
        });
    to_pose_count_[type] = 0;
  }
}

void Slots::pose_batch(std::span<const uint32_t> batch, const PoseSource& source, int worker) {
  uint32_t bodies[PoseSource::kMaxBatch];
  float scales[PoseSource::kMaxBatch], margins[PoseSource::kMaxBatch];
  float* blocks[PoseSource::kMaxBatch];
  for (size_t i = 0; i < batch.size(); ++i) {
    const SlotBody& slot = slots_[batch[i]];
    bodies[i] = slot.body;
    scales[i] = slot.scale;
    margins[i] = slot.margin_m;
    blocks[i] = boxes_.data() + size_t{slot.block} * kBoxLanes;
  }
  const SlotBody& first = slots_[batch[0]];
  const size_t parts = static_cast<size_t>(types_[first.type]->part_count());
  PartPose* rows = poses_.data() + first.pose;
  Counters& own = by_worker_[static_cast<size_t>(worker)];
  Stopwatch watch;
  source.poses({bodies, batch.size()}, {rows, batch.size() * parts});
  own.pose_ns += watch.lap_ns();
  kernels_.part_boxes(types_[first.type]->volumes().ordops.data(), parts, rows, scales, margins,
                      batch.size(), blocks);
  own.box_ns += watch.lap_ns();
  own.bodies += batch.size();
  own.parts += batch.size() * parts;
}

Slots::Counters Slots::counters() const {
  Counters sum;
  for (const Counters& own : by_worker_) {
    sum.bodies += own.bodies;
    sum.parts += own.parts;
    sum.pose_ns += own.pose_ns;
    sum.box_ns += own.box_ns;
  }
  return sum;
}

uint32_t Slots::times_grown() const {
  uint32_t sum =
      slots_.times_grown() + needed_.times_grown() + poses_.times_grown() + boxes_.times_grown();
  for (const auto& list : to_pose_) sum += list.times_grown();
  return sum;
}

}  // namespace throng
