// The bodies of a frame in slot order: what stages after the broad phase read of each.
// One rule: neighbours in the world are neighbours in memory.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "culling/body_type.h"
#include "culling/culler.h"
#include "culling/grow_buffer.h"

namespace throng {

struct SlotBody {
  std::array<double, 3> root_m;
  float scale;
  float margin_m;  ///< half of what a pair's tests must allow for float rounding
  uint32_t body;   ///< index into the BodiesView
  uint16_t type;

  Eigen::Vector3d root() const { return {root_m[0], root_m[1], root_m[2]}; }
};

class Slots {
 public:
  explicit Slots(std::span<const std::shared_ptr<const BodyType>> types);

  /// Room for `count` bodies.
  void begin_frame(size_t count);
  void fill(size_t slot, uint32_t body, const BodiesView& bodies);

  const SlotBody& operator[](size_t slot) const { return slots_[slot]; }
  size_t count() const { return count_; }
  bool is_static(size_t slot) const { return static_[slots_[slot].type] != 0; }
  uint32_t times_grown() const { return slots_.times_grown(); }

 private:
  std::vector<float> margin_m_;  // by type, of an unscaled body
  std::vector<uint8_t> static_;  // by type
  size_t count_ = 0;
  GrowBuffer<SlotBody> slots_;
};

/// Bounds |translation| + |point| over every part of an unscaled body of this type.
float reach_m(const BodyType& type);
/// Half of what a test between bodies of that reach must allow for float rounding.
float body_margin_m(float reach_m);

}  // namespace throng
