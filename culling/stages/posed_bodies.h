// PosedBodies stores the poses and boxes of the bodies of one task, or of one frame with a budget.
// A task poses into its own memory, to find poses in the cache when it tests parts. A body on the
// border of two tasks is posed by both.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/workers.h"
#include "culling/bodies.h"
#include "culling/body_type.h"
#include "culling/kernels/kernels.h"
#include "culling/stages/slots.h"

namespace throng {

struct PosedBody {
  SlotBody slot;
  uint32_t pose;   ///< index of its first PartPose
  uint32_t block;  ///< index of its box block, in units of kBoxLanes floats
};

class PosedBodies {
 public:
  struct Frame {
    std::span<const std::shared_ptr<const BodyType>> types;
    const Kernels& kernels;
    const Slots& slots;
    const PoseSource& source;
  };

  /// Reserves memory for slots below `slots`. No other call grows with the crowd.
  void prepare(size_t slots);
  void clear();
  /// Requests the body of a slot. Repeated requests are harmless.
  void request(uint32_t slot) {
    uint32_t& local = local_of_slot_[slot];
    if (local != kNone) return;
    local = static_cast<uint32_t>(count_);
    slots_.grow(count_ + 1, count_);
    slots_[count_++] = slot;
  }
  void request(std::span<const SlotPair> pairs) {
    for (const SlotPair& pair : pairs) {
      request(pair.a);
      request(pair.b);
    }
  }
  /// Poses every requested body that is not yet posed and computes its boxes, on all workers.
  void pose(const Frame& frame, Workers& workers);

  size_t count() const { return count_; }
  bool has(uint32_t slot) const { return local_of_slot_[slot] != kNone; }
  /// Body of a slot that was requested before the last pose().
  const PosedBody& of_slot(uint32_t slot) const { return bodies_[local_of_slot_[slot]]; }
  std::span<const PosedBody> bodies() const { return {bodies_.data(), posed_}; }
  const PartPose* poses() const { return poses_.data(); }
  const float* boxes() const { return boxes_.data(); }
  /// Low corner, -, high corner, - relative to the root.
  const float* box_of(const PosedBody& body) const {
    return boxes_.data() + size_t{body.block} * kBoxLanes;
  }

  struct Counters {
    uint64_t bodies = 0, parts = 0;
    double pose_ns = 0, box_ns = 0;
    void add(const Counters& other);
  };
  const Counters& counters() const { return counters_; }
  void clear_counters() { counters_ = {}; }

  void reserve_like(const PosedBodies& other);
  uint32_t times_grown() const;

 private:
  static constexpr uint32_t kNone = 0xffffffff;
  /// Bodies of one type, consecutive in by_type_.
  struct Batch {
    uint32_t first, count;
    Counters counters;
  };

  size_t plan_rows(const Frame& frame);
  void pose_batch(const Frame& frame, Batch& batch);

  GrowBuffer<uint32_t> local_of_slot_;  // kNone if not requested
  size_t prepared_ = 0;
  GrowBuffer<uint32_t> slots_;  // by local index
  size_t count_ = 0, posed_ = 0;
  GrowBuffer<PosedBody> bodies_;
  GrowBuffer<uint32_t> by_type_, type_start_;  // local indices, type by type
  GrowBuffer<Batch> batches_;
  GrowBuffer<PartPose> poses_;
  GrowBuffer<float> boxes_;
  size_t pose_count_ = 0, unit_count_ = 0;
  Counters counters_;
};

}  // namespace throng
