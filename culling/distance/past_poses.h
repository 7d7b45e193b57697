// Where bodies were in the last frame, part by part, for the speeds at which they come nearer.
// One rule: a task notes all bodies that it has posed, also those that another has: what is kept,
// and how much room it takes, depends on the frame alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/files/archive.h"
#include "base/grow_buffer.h"
#include "culling/bodies.h"
#include "culling/stages/posed_bodies.h"

namespace throng {

class PastPoses {
 public:
  /// A body that was posed.
  struct Body {
    uint32_t id, parts;
    float scale;
    std::array<double, 3> root_m;
    const PartPose* poses;
  };

  void begin_frame(size_t tasks);
  /// Of a frame's bodies, those posed for a task; parts_of(type) is 0 for those that never move.
  template <typename PartsOf>
  void note(size_t task, std::span<const PosedBody> bodies, const PartPose* poses,
            const BodiesView& view, const PartsOf& parts_of);
  /// From now on they are past.
  void end_frame();

  /// Null for a body that was not noted in the last frame.
  const Body* find(uint32_t id) const;
  void archive(Archive& a);
  uint64_t times_grown() const;

 private:
  struct Task {
    GrowBuffer<Body> bodies;
    GrowBuffer<PartPose> poses;
    size_t body_count = 0, pose_count = 0;
  };
  using Tasks = std::vector<Task>;

  void restore(Archive& a, uint64_t count);

  std::array<Tasks, 2> tasks_;  // of this frame and of the last, in turn
  size_t now_ = 0, task_count_ = 0;
  GrowBuffer<Body> past_;  // by id, none twice
  size_t past_count_ = 0;
};

template <typename PartsOf>
void PastPoses::note(size_t task, std::span<const PosedBody> bodies, const PartPose* poses,
                     const BodiesView& view, const PartsOf& parts_of) {
  Task& own = tasks_[now_][task];
  for (const PosedBody& body : bodies) {
    const auto parts = static_cast<size_t>(parts_of(body.slot.type));
    if (parts == 0) continue;
    own.bodies.grow(own.body_count + 1, own.body_count);
    own.bodies[own.body_count++] = {view.ids[body.slot.body], static_cast<uint32_t>(parts),
                                    body.slot.scale, body.slot.root_m, nullptr};
    own.poses.grow(own.pose_count + parts, own.pose_count);
    std::copy_n(poses + body.pose, parts, own.poses.data() + own.pose_count);
    own.pose_count += parts;
  }
}

}  // namespace throng
