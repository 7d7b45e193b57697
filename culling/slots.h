// The bodies of a frame in slot order, and the poses and boxes of those that a surviving pair
// needs. One rule: a body is posed at most once a frame, and only if somebody asked for it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/workers.h"
#include "culling/body_type.h"
#include "culling/culler.h"
#include "culling/grow_buffer.h"
#include "culling/kernels.h"

namespace throng {

/// What the stages after the broad phase read of a body.
struct SlotBody {
  std::array<double, 3> root_m;
  float scale;
  float margin_m;  ///< half of what a pair's tests must allow for float rounding
  uint32_t pose;   ///< its first PartPose, kNotPosed if none
  uint32_t block;  ///< its box block, in units of kBoxLanes floats
  uint32_t body;   ///< index into the BodiesView
  uint16_t type;

  Eigen::Vector3d root() const { return {root_m[0], root_m[1], root_m[2]}; }
};
inline constexpr uint32_t kNotPosed = 0xffffffff;

class Slots {
 public:
  Slots(std::span<const std::shared_ptr<const BodyType>> types, const Kernels& kernels,
        Workers& workers);

  /// Room for `count` bodies, none of them needed or posed.
  void begin_frame(size_t count);
  void fill(size_t slot, uint32_t body, const BodiesView& bodies);

  const SlotBody& operator[](size_t slot) const { return slots_[slot]; }
  const SlotBody* data() const { return slots_.data(); }
  size_t count() const { return count_; }
  bool is_static(size_t slot) const { return types_[slots_[slot].type]->is_static(); }

  /// Any thread may ask for any slot.
  void need(size_t slot);
  /// Poses every needed slot that has no pose yet and makes its boxes.
  void pose_needed(const PoseSource& source);
  /// The same for those among `slots`, which may hold one twice.
  void pose_needed_of(std::span<const uint32_t> slots, const PoseSource& source);

  const PartPose* poses() const { return poses_.data(); }
  const float* boxes() const { return boxes_.data(); }
  const float* box_of(size_t slot) const {
    return boxes_.data() + size_t{slots_[slot].block} * kBoxLanes;
  }

  struct Counters {
    uint64_t bodies = 0, parts = 0;
    double pose_ns = 0, box_ns = 0;
  };
  Counters counters() const;
  uint32_t times_grown() const;

 private:
  void plan(size_t slot);
  void pose_planned(const PoseSource& source);
  void plan_rows();
  void pose_batch(std::span<const uint32_t> slots, const PoseSource& source, int worker);

  std::span<const std::shared_ptr<const BodyType>> types_;
  const Kernels& kernels_;
  Workers& workers_;
  size_t count_ = 0;
  GrowBuffer<SlotBody> slots_;
  GrowBuffer<uint8_t> needed_;
  std::vector<GrowBuffer<uint32_t>> to_pose_;  // slots by type
  std::vector<size_t> to_pose_count_;
  GrowBuffer<PartPose> poses_;
  GrowBuffer<float> boxes_;
  size_t pose_count_ = 0, box_units_ = 0;
  std::vector<Counters> by_worker_;
};

/// Bounds |translation| + |point| over every part of an unscaled body of this type.
float reach_m(const BodyType& type);
/// Half of what a test between bodies of that reach must allow for float rounding.
float body_margin_m(float reach_m);

}  // namespace throng
