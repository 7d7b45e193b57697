#include "culling/distance/past_poses.h"

#include <algorithm>

#include "culling/pair.h"

namespace throng {

void PastPoses::begin_frame(size_t tasks) {
  now_ = 1 - now_;
  Tasks& own = tasks_[now_];
  if (own.size() < tasks) own.resize(tasks);
  task_count_ = tasks;
  for (Task& task : own) task.body_count = task.pose_count = 0;
}

void PastPoses::end_frame() {
  past_count_ = 0;
  for (size_t t = 0; t < task_count_; ++t) {
    Task& task = tasks_[now_][t];
    past_.grow(past_count_ + task.body_count, past_count_);
    const PartPose* poses = task.poses.data();
    for (size_t i = 0; i < task.body_count; ++i) {
      task.bodies[i].poses = poses;
      poses += task.bodies[i].parts;
      past_[past_count_++] = task.bodies[i];
    }
  }
  std::sort(past_.data(), past_.data() + past_count_,
            [](const Body& p, const Body& q) { return p.id < q.id; });
  Body* const end = std::unique(past_.data(), past_.data() + past_count_,
                                [](const Body& p, const Body& q) { return p.id == q.id; });
  past_count_ = static_cast<size_t>(end - past_.data());
}

const PastPoses::Body* PastPoses::find(uint32_t id) const {
  const Body* const end = past_.data() + past_count_;
  const Body* const found = std::lower_bound(
      past_.data(), end, id, [](const Body& one, uint32_t wanted) { return one.id < wanted; });
  return found != end && found->id == id ? found : nullptr;
}

void PastPoses::archive(Archive& a) {
  uint64_t count = past_count_;
  a(count);
  if (a.is_reading()) return restore(a, count);
  for (size_t i = 0; i < count; ++i) {
    Body body = past_[i];
    a(body.id, body.parts, body.scale, body.root_m);
    for (uint32_t part = 0; part < body.parts; ++part) {
      PartPose pose = body.poses[part];
      a(pose.rows);
    }
  }
}

void PastPoses::restore(Archive& a, uint64_t count) {
  if (count > PairKey::kMaxId) a.refuse("as many bodies as there can be", "more");
  begin_frame(1);
  Task& task = tasks_[now_][0];
  constexpr uint32_t kMostParts = 256;
  for (size_t i = 0; i < count; ++i) {
    Body body{};
    a(body.id, body.parts, body.scale, body.root_m);
    if (body.parts > kMostParts) a.refuse("as many parts as a body can have", "more");
    task.bodies.grow(i + 1, i);
    task.bodies[task.body_count++] = body;
    task.poses.grow(task.pose_count + body.parts, task.pose_count);
    for (uint32_t part = 0; part < body.parts; ++part) {
      PartPose pose{};
      a(pose.rows);
      task.poses[task.pose_count++] = pose;
    }
  }
  end_frame();
}

uint64_t PastPoses::times_grown() const {
  uint64_t sum = past_.times_grown();
  for (const Tasks& tasks : tasks_)
    for (const Task& task : tasks) sum += task.bodies.times_grown() + task.poses.times_grown();
  return sum;
}

}  // namespace throng
