#include "culling/distance/near_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/checksum.h"
#include "culling/stages/stopwatch.h"

namespace throng {
namespace {

using Eigen::Vector3d;

template <typename T>
void append(GrowBuffer<T>& to, size_t& count, const T& what) {
  to.grow(count + 1, count);
  to[count++] = what;
}

template <typename T>
size_t append_all(GrowBuffer<T>& to, size_t count, const GrowBuffer<T>& from, size_t more) {
  to.grow(count + more, count);
  std::copy_n(from.data(), more, to.data() + count);
  return count + more;
}

float rounded_down(double x) {
  const float near = static_cast<float>(x);
  return static_cast<double>(near) > x ? std::nextafter(near, 0.0f) : near;
}

float rounded_up(double x) {
  const float near = static_cast<float>(x);
  return static_cast<double>(near) < x
             ? std::nextafter(near, std::numeric_limits<float>::infinity())
             : near;
}

std::array<double, 3> to_array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Where the material at a point, relative to the root, is on the part.
Vector3d on_part(const PartPose& pose, float scale, const Vector3d& point_m) {
  const Eigen::Isometry3d there = to_isometry(pose);
  return there.linear().transpose() * (point_m - there.translation()) / static_cast<double>(scale);
}

Vector3d placed(const PartPose& pose, float scale, const Vector3d& on_part) {
  return to_isometry(pose) * (static_cast<double>(scale) * on_part);
}

}  // namespace

NearSearch::NearSearch(BodyTypes types, const CullerOptions& options, Workers& workers)
    : types_(types),
      options_(options.near),
      exact_(options.exact),
      deadline_ms_(options.deadline_ms),
      deadline_tests_(options.deadline_tests),
      kernels_(kernels_for(options.simd)),
      workers_(workers),
      slots_(types),
      broad_(types, kernels_, workers, options.pair_search, options.near.most_m()) {
  for (const auto& type : types) fit_for_near(*type, exact_);
}

void NearSearch::run(const BodiesView& bodies, const PoseSource& source, StageCounters& counters) {
  Stopwatch watch;
  if (deadline_ms_)
    until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double, std::milli>(*deadline_ms_));
  ids_ = bodies.ids;
  broad_.run(bodies, source, slots_);
  posed_.prepare(slots_.count());
  posed_.clear();
  posed_.clear_counters();
  for (size_t block = 0; block < broad_.block_count(); ++block) {
    for (const SlotPair& pair : broad_.block(block)) {
      posed_.need(pair.a);
      posed_.need(pair.b);
    }
  }
  posed_.pose({types_, kernels_, slots_, source}, workers_);
  counters = {.volume = exact_ ? "triangles" : "hull"};
  counters.updates = posed_.counters().parts;
  counters.update_ns = watch.lap_ns();

  task_count_ = broad_.block_count();
  if (tasks_.size() < task_count_) tasks_.resize(task_count_);
  workers_.for_blocks(static_cast<int>(task_count_),
                      [&](int task, int) { find(static_cast<size_t>(task)); });
  plan_budget();
  workers_.for_blocks(static_cast<int>(task_count_),
                      [&](int task, int) { decide(static_cast<size_t>(task)); });
  gather();
  hash_rows();
  remember(bodies);
  for (size_t i = 0; i < task_count_; ++i)
    counters.tests += exact_ ? tasks_[i].counters.exact_tests : tasks_[i].counters.volume_tests;
  counters.passed = pair_count_;
  counters.test_ns = watch.lap_ns();
}

NearBodies NearSearch::bodies_of(const Pair& pair) const {
  const PosedBody &a = posed_.of_slot(pair.slot_a), &b = posed_.of_slot(pair.slot_b);
  return {&a, &b, (b.slot.root() - a.slot.root()).cast<float>(), a.slot.margin_m + b.slot.margin_m};
}

/// Two bodies of the block after another, down to the parts that their volumes do not prove farther
/// apart.
void NearSearch::find(size_t index) {
  Task& task = tasks_[index];
  task.pair_count = task.candidate_count = 0;
  task.counters = {};
  const NearFrame frame{types_, posed_, options_.most_m()};
  for (const SlotPair& slots : broad_.block(index)) {
    const bool in_order = slots_.body(slots.a) < slots_.body(slots.b);
    Pair pair{in_order ? slots.a : slots.b,
              in_order ? slots.b : slots.a,
              std::numeric_limits<float>::max(),
              static_cast<uint32_t>(task.candidate_count),
              0,
              exact_};
    const NearBodies bodies = bodies_of(pair);
    if (!may_be_near(frame, bodies)) continue;
    find_near_parts(frame, bodies, task.candidates, task.candidate_count, task.counters);
    pair.count = static_cast<uint32_t>(task.candidate_count) - pair.first;
    if (pair.count == 0) continue;
    for (uint32_t i = pair.first; i < task.candidate_count; ++i)
      pair.least_m = std::min(pair.least_m, task.candidates[i].lo_m);
    append(task.pairs, task.pair_count, pair);
  }
}

/// Under a deadline the two bodies that may be nearest come first, wholly, as long as the budget
/// lasts: tests of triangles, at most one a candidate; or the time, which is looked at in decide().
void NearSearch::plan_budget() {
  if (!exact_ || (!deadline_tests_ && !deadline_ms_)) return;
  size_t count = 0;
  for (size_t i = 0; i < task_count_; ++i)
    for (size_t p = 0; p < tasks_[i].pair_count; ++p) append(urgent_, count, {&tasks_[i].pairs[p]});
  const auto key = [&](const Urgent& u) {
    return std::tuple(u.pair->least_m, slots_.body(u.pair->slot_a), slots_.body(u.pair->slot_b));
  };
  std::sort(urgent_.data(), urgent_.data() + count,
            [&](const Urgent& p, const Urgent& q) { return key(p) < key(q); });
  uint64_t left = deadline_tests_.value_or(std::numeric_limits<uint64_t>::max());
  for (size_t i = 0; i < count; ++i) {
    Pair& pair = *urgent_[i].pair;
    pair.is_decided = pair.count <= left;
    left = pair.is_decided ? left - pair.count : 0;
  }
}

void NearSearch::decide(size_t index) {
  Task& task = tasks_[index];
  task.row_count = task.nearest_count = 0;
  for (size_t i = 0; i < task.pair_count; ++i) {
    Pair& pair = task.pairs[i];
    if (deadline_ms_ && pair.is_decided) pair.is_decided = Clock::now() < until_;
    list(pair, task);
  }
}

/// The rows of two bodies. By triangles the candidates that may be nearest come first: all within
/// near_m, then as long as one can be nearer than the nearest yet.
void NearSearch::list(const Pair& pair, Task& task) {
  const NearFrame frame{types_, posed_, options_.most_m()};
  const NearBodies bodies = bodies_of(pair);
  const bool has_static =
      types_[bodies.a->slot.type]->is_static() || types_[bodies.b->slot.type]->is_static();
  const float body_near_m = has_static ? 0 : options_.body_near_m;
  NearCandidate* const first = task.candidates.data() + pair.first;
  NearCandidate* const end = first + pair.count;
  std::sort(first, end, [](const NearCandidate& p, const NearCandidate& q) {
    return std::pair(p.lo_m, p.parts()) < std::pair(q.lo_m, q.parts());
  });
  NearPair nearest;
  nearest.lo_m = nearest.hi_m = std::numeric_limits<float>::max();
  float least_m = std::numeric_limits<float>::max();  // no two parts are nearer
  for (const NearCandidate* c = first; c != end; ++c) {
    const bool is_listed = c->lo_m <= options_.near_m;
    const float of_bodies_m = std::min(body_near_m, nearest.hi_m);
    if (!is_listed && (body_near_m == 0 || c->lo_m > of_bodies_m)) break;
    NearPair row = undecided(bodies, *c);
    if (pair.is_decided) {
      const float within_m = std::max(is_listed ? options_.near_m : 0, of_bodies_m);
      const NearVerdict verdict =
          task.decider.decide(frame, bodies, *c, static_cast<double>(within_m), task.counters);
      if (!verdict.is_near) continue;
      row = decided(bodies, *c, verdict);
    }
    if (options_.near_m > 0 && row.lo_m <= options_.near_m) append(task.rows, task.row_count, row);
    least_m = std::min(least_m, row.lo_m);
    if (std::pair(row.hi_m, row.pair) < std::pair(nearest.hi_m, nearest.pair)) nearest = row;
  }
  nearest.lo_m = least_m;
  if (body_near_m > 0 && nearest.lo_m <= body_near_m)
    append(task.nearest, task.nearest_count, nearest);
}

NearPair NearSearch::undecided(const NearBodies& bodies, const NearCandidate& candidate) const {
  NearPair row;
  row.pair = PairKey(ids_[bodies.a->slot.body], ids_[bodies.b->slot.body], candidate.part_a,
                     candidate.part_b);
  row.lo_m = candidate.lo_m;
  row.hi_m = candidate.hi_m;
  return row;
}

NearPair NearSearch::decided(const NearBodies& bodies, const NearCandidate& candidate,
                             const NearVerdict& verdict) const {
  NearPair row = undecided(bodies, candidate);
  const Vector3d root = bodies.a->slot.root();
  row.level = PairLevel::kExact;
  row.lo_m = rounded_down(verdict.lo_m);
  row.hi_m = rounded_up(verdict.hi_m);
  row.point_a_m = to_array(root + verdict.on_a_m);
  row.point_b_m = to_array(root + verdict.on_b_m);
  for (size_t axis = 0; axis < 3; ++axis)
    row.normal[axis] = static_cast<float>(verdict.normal[static_cast<Eigen::Index>(axis)]);
  row.depth_m = static_cast<float>(verdict.depth_m);
  row.closing_mps = closing_mps(bodies, candidate, verdict);
  return row;
}

/// The material of each part at the point, where it was in the last frame.
float NearSearch::closing_mps(const NearBodies& bodies, const NearCandidate& candidate,
                              const NearVerdict& verdict) const {
  const auto moved = [&](const PosedBody& body, uint32_t part,
                         const Vector3d& point_m) -> Vector3d {
    if (types_[body.slot.type]->is_static()) return Vector3d::Zero();
    const Was* before = was(ids_[body.slot.body]);
    if (before == nullptr) return Vector3d::Constant(NearPair::kNowhere);
    const Vector3d material = on_part(posed_.poses()[body.pose + part], body.slot.scale, point_m);
    const Vector3d then = placed(was_poses_[before->pose + part], before->scale, material);
    const Vector3d root_then(before->root_m.data());
    return (body.slot.root() - root_then) + (point_m - then);
  };
  if (!(options_.step_s > 0)) return NearPair::kUnknown;
  const Vector3d b_to_a = bodies.a->slot.root() - bodies.b->slot.root();
  const Vector3d a_moved = moved(*bodies.a, candidate.part_a, verdict.on_a_m);
  const Vector3d b_moved = moved(*bodies.b, candidate.part_b, verdict.on_b_m + b_to_a);
  return static_cast<float>((a_moved - b_moved).dot(verdict.normal) / options_.step_s);
}

const NearSearch::Was* NearSearch::was(uint32_t id) const {
  const Was* const end = was_.data() + was_count_;
  const Was* const found = std::lower_bound(
      was_.data(), end, id, [](const Was& one, uint32_t wanted) { return one.id < wanted; });
  return found != end && found->id == id ? found : nullptr;
}

void NearSearch::gather() {
  pair_count_ = nearest_count_ = 0;
  for (size_t i = 0; i < task_count_; ++i) {
    const Task& task = tasks_[i];
    pair_count_ = append_all(pairs_, pair_count_, task.rows, task.row_count);
    nearest_count_ = append_all(nearest_, nearest_count_, task.nearest, task.nearest_count);
  }
  const auto by_key = [](const NearPair& p, const NearPair& q) { return p.pair < q.pair; };
  std::sort(pairs_.data(), pairs_.data() + pair_count_, by_key);
  std::sort(nearest_.data(), nearest_.data() + nearest_count_, by_key);
}

void NearSearch::hash_rows() {
  EventSum sum;
  const auto add = [&](std::span<const NearPair> rows, uint64_t of) {
    for (const NearPair& row : rows) {
      const uint64_t interval =
          uint64_t{std::bit_cast<uint32_t>(row.lo_m)} << 32 | std::bit_cast<uint32_t>(row.hi_m);
      const uint64_t level = 2 * static_cast<uint64_t>(row.level) + of;
      sum.sum += mixed(mixed(row.pair.bits() + level * 0x9e3779b97f4a7c15ull) + interval);
      ++sum.count;
    }
  };
  add(pairs(), 1);
  add(bodies(), 2);
  hash_.add_frame(frame_++, sum);
}

/// Where the bodies of this frame are, for the next.
void NearSearch::remember(const BodiesView& bodies) {
  if (!exact_ || !(options_.step_s > 0)) return;
  was_count_ = 0;
  was_.resize(posed_.count());
  size_t poses = 0;
  for (size_t slot = 0; slot < slots_.count(); ++slot) {
    if (!posed_.has(static_cast<uint32_t>(slot))) continue;
    const PosedBody& body = posed_.of_slot(static_cast<uint32_t>(slot));
    was_[was_count_++] = {bodies.ids[body.slot.body], body.pose, body.slot.scale, body.slot.root_m};
    poses += static_cast<size_t>(types_[body.slot.type]->part_count());
  }
  std::sort(was_.data(), was_.data() + was_count_,
            [](const Was& p, const Was& q) { return p.id < q.id; });
  was_pose_count_ = poses;
  was_poses_.resize(poses);
  std::copy_n(posed_.poses(), poses, was_poses_.data());
}

void NearSearch::archive(Archive& a) {
  uint64_t hash = hash_.value();
  uint64_t count = was_count_, poses = was_pose_count_;
  a(frame_, hash, count, poses);
  hash_ = EventHash(hash);
  if (a.is_reading()) {
    constexpr uint64_t kMost = uint64_t{1} << 32;
    if (count > PairKey::kMaxId || poses > kMost)
      a.refuse("as many bodies as there can be", "more");
    was_.resize(count);
    was_poses_.resize(poses);
    was_count_ = count;
    was_pose_count_ = poses;
    std::fill_n(was_.data(), count, Was{});
    std::fill_n(was_poses_.data(), poses, PartPose{});
  }
  for (size_t i = 0; i < count; ++i) {
    Was& one = was_[i];
    a(one.id, one.pose, one.scale, one.root_m);
    if (a.is_reading() && one.pose >= poses) a.refuse("a pose of those kept", "another");
  }
  for (size_t i = 0; i < poses; ++i) a(was_poses_[i].rows);
}

uint32_t NearSearch::Task::times_grown() const {
  return pairs.times_grown() + candidates.times_grown() + rows.times_grown() +
         nearest.times_grown();
}

uint64_t NearSearch::times_grown() const {
  uint64_t sum = uint64_t{slots_.times_grown()} + broad_.times_grown() + posed_.times_grown() +
                 urgent_.times_grown() + pairs_.times_grown() + nearest_.times_grown() +
                 was_.times_grown() + was_poses_.times_grown();
  for (const Task& task : tasks_) sum += task.times_grown();
  return sum;
}

}  // namespace throng
