// Slots stores the bodies of a frame in search order: neighbours have neighbouring slots.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "culling/bodies.h"
#include "culling/body_type.h"

namespace throng {

struct SlotBody {
  std::array<double, 3> root_m;
  float scale;
  float margin_m;  ///< half of a pair's margin for float rounding
  uint32_t body;   ///< index into the BodiesView
  uint16_t type;

  Eigen::Vector3d root() const { return {root_m[0], root_m[1], root_m[2]}; }
};

class Slots {
 public:
  explicit Slots(std::span<const std::shared_ptr<const BodyType>> types);

  /// The first slots are for the bodies of `searched`, in this order, the last for those of
  /// `large`. `bodies` must outlive the frame.
  void begin_frame(const BodiesView& bodies, std::span<const uint32_t> searched,
                   std::span<const uint32_t> large);

  uint32_t body(size_t slot) const { return body_[slot]; }
  const BodiesView& bodies() const { return bodies_; }
  uint32_t id(size_t slot) const { return bodies_.ids[body_[slot]]; }
  /// Prefetches for a later operator[] with the same slot, because ids are not in memory order.
  THRONG_PREFETCH void prefetch(size_t slot) const {
    const uint32_t body = body_[slot];
    __builtin_prefetch(&bodies_.types[body]);
    __builtin_prefetch(&bodies_.scales[body]);
    __builtin_prefetch(&bodies_.roots[body].position_m);
  }
  SlotBody operator[](size_t slot) const {
    const uint32_t body = body_[slot];
    const uint16_t type = bodies_.types[body];
    const float scale = bodies_.scales[body];
    const Eigen::Vector3d& root = bodies_.roots[body].position_m;
    return {{root.x(), root.y(), root.z()}, scale, scale * margin_m_[type], body, type};
  }
  size_t count() const { return count_; }
  bool is_static(size_t slot) const { return static_[bodies_.types[body_[slot]]] != 0; }
  uint32_t times_grown() const { return body_.times_grown(); }

 private:
  std::vector<float> margin_m_;  // by type, of an unscaled body
  std::vector<uint8_t> static_;  // by type
  BodiesView bodies_;
  size_t count_ = 0;
  GrowBuffer<uint32_t> body_;
};

/// Bound of |translation| + |point| over all parts of an unscaled body of this type.
float reach_m(const BodyType& type);
/// Half of the margin for float rounding in tests between bodies of that reach.
float body_margin_m(float reach_m);

}  // namespace throng
