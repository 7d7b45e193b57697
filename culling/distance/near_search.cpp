#include "culling/distance/near_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/checksum.h"
#include "base/stopwatch.h"
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

namespace {

using Eigen::Vector3d;

/// Wider intervals by volumes are narrowed by hulls, and where that is not enough by triangles.
constexpr float kWide_m = 0.1f;

template <typename T>
void append(GrowBuffer<T>& to, size_t& count, const T& what) {
  to.grow(count + 1, count);
  to[count++] = what;
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

/// What the hash says of a row. `kind`: 1 for pairs of parts, 2 for the nearest of two bodies.
void add_to(EventSum& sum, const NearPair& row, uint64_t kind) {
  const uint64_t interval =
      uint64_t{std::bit_cast<uint32_t>(row.lo_m)} << 32 | std::bit_cast<uint32_t>(row.hi_m);
  const uint64_t level = 2 * static_cast<uint64_t>(row.level) + kind;
  sum.sum += mixed(mixed(row.pair.bits() + level * 0x9e3779b97f4a7c15ull) + interval);
  ++sum.count;
}

void add_to(EventSum& sum, const NearInterval& interval, uint64_t kind) {
  add_to(sum, interval.row(), kind);
}

/// Nothing: events say which pairs touch.
void add_to(EventSum&, const ContactPoint&, uint64_t) {}

/// Calls visit(pair, first, end) for the candidates of two bodies after another.
template <typename Visit>
void for_pairs(std::span<const Candidate> candidates, const Visit& visit) {
  for (size_t i = 0; i < candidates.size();) {
    const size_t first = i;
    const uint32_t pair = candidates[i].pair;
    while (i < candidates.size() && candidates[i].pair == pair) ++i;
    visit(pair, first, i);
  }
}

/// Writes those that their volumes do not prove farther apart than `within_m`; returns how many.
/// There is room for all. No branch: which are near is hard to foretell.
template <typename TouchOf, typename InnerOf>
size_t write_near(const NearParts& parts, size_t first, size_t end, float within_m,
                  NearCandidate* out, const TouchOf& touch_of, const InnerOf& inner_of) {
  const Candidate* const candidates = parts.candidates().data();
  const GapBounds* const bounds = parts.bounds().data();
  size_t count = 0;
  for (size_t i = first; i < end; ++i) {
    out[count] = {bounds[i].lo_m,       bounds[i].hi_m, candidates[i].part_a,
                  candidates[i].part_b, touch_of(i),    inner_of(i)};
    count += bounds[i].lo_m <= within_m;
  }
  return count;
}

Touch unasked(size_t) { return Touch::kUnasked; }
bool is_within(size_t) { return true; }

}  // namespace

Margins margins_of(const NearOptions& near) {
  Margins out{near.most_m(), std::min(near.near_m, near.body_near_m)};
  if (out.inner_m == out.reach_m) out.inner_m = 0;
  return out;
}

NearSearch::NearSearch(BodyTypes types, const CullerOptions& options, Workers& workers)
    : types_(types),
      options_(options),
      margins_(margins_of(options.near)),
      workers_(workers),
      parts_(static_cast<size_t>(workers.threads())) {
  for (const auto& type : types) {
    fit_for_near(*type);
    has_surfaces_.push_back(type->has_triangles());
  }
}

void NearSearch::begin_frame(const PartStageFrame& frame, const BodiesView& bodies, size_t tasks) {
  frame_ = frame;
  bodies_ = bodies;
  task_count_ = tasks;
  if (tasks_.size() < tasks) tasks_.resize(tasks);
  if (options_.deadline_ms)
    until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double, std::milli>(*options_.deadline_ms));
  for (NearParts& parts : parts_) parts.clear_counters();
  past_.begin_frame(tasks);
}

void NearSearch::begin(int worker, const PosedBodies& bodies) {
  parts_[static_cast<size_t>(worker)].begin(frame_, bodies, options_.near.most_m());
}

void NearSearch::add(int worker, std::span<const SlotPair> pairs, std::span<const uint8_t> inner) {
  parts_[static_cast<size_t>(worker)].add(frame_, pairs, inner);
}

void NearSearch::bound(int worker, size_t index) {
  NearParts& parts = parts_[static_cast<size_t>(worker)];
  parts.find_candidates(frame_);
  Stopwatch watch;
  parts.find_bounds(frame_);
  NearCounters& counters = tasks_[index].counters;
  counters = {};
  counters.volume_tests = parts.candidates().size();
  counters.ns = watch.lap_ns();
}

void NearSearch::finish(int worker, size_t index, std::span<const uint8_t> touches) {
  const NearParts& parts = parts_[static_cast<size_t>(worker)];
  Task& task = tasks_[index];
  Stopwatch watch;
  task.posed = &parts.posed();
  if (lists_intervals()) {
    list_intervals(parts, task);
  } else {
    take_candidates(parts, touches, task);
    if (!options_.has_deadline()) decide(task);
  }
  // Under a deadline all tasks have the same bodies.
  if (needs_past() && (!options_.has_deadline() || index == 0)) note_past(index, parts.posed());
  task.counters.ns += watch.lap_ns();
}

void NearSearch::note_past(size_t index, const PosedBodies& posed) {
  past_.note(index, posed.bodies(), posed.poses(), bodies_, [&](uint16_t type) {
    return types_[type]->is_static() ? 0 : types_[type]->part_count();
  });
}

void NearSearch::list_intervals(const NearParts& parts, Task& task) {
  task.intervals.clear();
  NearCandidate* const room = task.intervals.room(parts.candidates().size());
  size_t count = 0;
  for_pairs(parts.candidates(), [&](uint32_t pair, size_t first, size_t end) {
    const BodyPair& bodies = parts.pairs()[pair];
    const size_t near =
        write_near(parts, first, end, options_.near.near_m, room + count, unasked, is_within);
    const size_t left = narrow(bodies, {room + count, near}, task);
    task.intervals.added(left);
    task.intervals.end_run(bodies);
    count += left;
  });
}

/// Hulls bound what volumes leave wide, and triangles what hulls leave: at a wall no corner is
/// near. Returns how many are near, which come first.
size_t NearSearch::narrow(const BodyPair& bodies, std::span<NearCandidate> candidates,
                          Task& task) const {
  bool is_narrowed = false;
  for (NearCandidate& c : candidates) {
    if (c.hi_m - c.lo_m <= kWide_m) continue;
    const PartPair parts = part_pair(frame_, task.posed->poses(), bodies, c.part_a, c.part_b);
    narrow_by_hulls(parts, c);
    narrow_wide(bodies, parts, c, task);
    is_narrowed = true;
  }
  if (!is_narrowed) return candidates.size();
  const float near_m = options_.near.near_m;
  const auto end = std::remove_if(candidates.begin(), candidates.end(),
                                  [near_m](const NearCandidate& c) { return c.lo_m > near_m; });
  return static_cast<size_t>(end - candidates.begin());
}

void NearSearch::narrow_wide(const BodyPair& bodies, const PartPair& parts,
                             NearCandidate& candidate, Task& task) const {
  if (candidate.hi_m - candidate.lo_m <= kWide_m) return;
  if (has_surfaces_[bodies.type_a] != 0 && has_surfaces_[bodies.type_b] != 0)
    narrow_by_triangles(parts, candidate, task.counters);
}

void NearSearch::take_candidates(const NearParts& parts, std::span<const uint8_t> touches,
                                 Task& task) {
  const auto touch_of = [touches](size_t i) {
    if (touches.empty()) return Touch::kUnasked;
    return touches[i] ? Touch::kYes : Touch::kNo;
  };
  const auto inner_of = [&](size_t i) {
    return margins_.inner_m == 0 ||
           (parts.bounds()[i].lo_m <= margins_.inner_m &&
            parts.parts().is_inner(frame_, parts.candidates()[i], margins_.inner_m));
  };
  task.pair_count = task.candidate_count = 0;
  task.candidates.grow(parts.candidates().size(), 0);
  for_pairs(parts.candidates(), [&](uint32_t of, size_t first, size_t end) {
    NearCandidate* const near = task.candidates.data() + task.candidate_count;
    const size_t count = write_near(parts, first, end, margins_.reach_m, near, touch_of, inner_of);
    if (count == 0) return;
    const auto less = [](const NearCandidate& p, const NearCandidate& q) {
      return p.lo_m < q.lo_m;
    };
    const float least_m = std::min_element(near, near + count, less)->lo_m;
    append(task.pairs, task.pair_count,
           Pair{parts.pairs()[of], least_m, static_cast<uint32_t>(task.candidate_count),
                static_cast<uint32_t>(count), options_.exact});
    task.candidate_count += count;
  });
}

/// Under a deadline the two bodies that may be nearest come first, wholly, as long as the budget
/// lasts: tests of triangles, at most one a candidate; or the time, which is looked at in decide().
void NearSearch::plan_budget() {
  if (!options_.exact) return;
  size_t count = 0;
  for (size_t i = 0; i < task_count_; ++i)
    for (size_t p = 0; p < tasks_[i].pair_count; ++p) append(urgent_, count, {&tasks_[i].pairs[p]});
  const auto key = [](const Urgent& u) {
    return std::tuple(u.pair->least_m, u.pair->bodies.body_a, u.pair->bodies.body_b);
  };
  std::sort(urgent_.data(), urgent_.data() + count,
            [&](const Urgent& p, const Urgent& q) { return key(p) < key(q); });
  uint64_t left = options_.deadline_tests.value_or(std::numeric_limits<uint64_t>::max());
  for (size_t i = 0; i < count; ++i) {
    Pair& pair = *urgent_[i].pair;
    pair.is_decided = pair.count <= left;
    left = pair.is_decided ? left - pair.count : 0;
  }
}

/// Of two bodies the nearest pair of parts, where a margin asks for it.
class NearSearch::NearestParts {
 public:
  NearestParts(const NearSearch& search, const Pair& pair)
      : bodies_(pair.bodies),
        needs_inner_(search.options_.near.body_near_m == search.margins_.inner_m) {
    const bool has_static =
        search.types_[bodies_.type_a]->is_static() || search.types_[bodies_.type_b]->is_static();
    margin_m_ = has_static ? 0 : search.options_.near.body_near_m;
    nearest_.lo_m = nearest_.hi_m = std::numeric_limits<float>::max();
  }

  /// What is farther apart is not the nearest; below 0: none is asked for.
  float within_m() const { return margin_m_ > 0 ? std::min(margin_m_, nearest_.hi_m) : -1; }
  bool may_be(const NearCandidate& c) const {
    return c.lo_m <= within_m() && (c.is_inner || !needs_inner_);
  }
  void take(const NearPair& row) {
    least_m_ = std::min(least_m_, row.lo_m);
    if (std::pair(row.hi_m, row.pair) < std::pair(nearest_.hi_m, nearest_.pair)) nearest_ = row;
  }
  void list(Task& task) {
    nearest_.lo_m = least_m_;
    if (margin_m_ > 0 && least_m_ <= margin_m_) task.nearest.add(nearest_);
    task.nearest.end_run(bodies_);
  }

 private:
  const BodyPair& bodies_;
  bool needs_inner_;
  float margin_m_;
  NearPair nearest_;
  float least_m_ = std::numeric_limits<float>::max();  ///< no two parts are nearer
};

/// The candidates of two bodies, the one that may be nearest first.
std::span<NearCandidate> NearSearch::sorted(const Pair& pair, Task& task) {
  const std::span<NearCandidate> out(task.candidates.data() + pair.first, pair.count);
  std::sort(out.begin(), out.end(), [](const NearCandidate& p, const NearCandidate& q) {
    return std::pair(p.lo_m, p.parts()) < std::pair(q.lo_m, q.parts());
  });
  return out;
}

void NearSearch::decide(Task& task) {
  task.rows.clear();
  task.nearest.clear();
  task.contacts.clear();
  for (size_t i = 0; i < task.pair_count; ++i) {
    Pair& pair = task.pairs[i];
    if (options_.deadline_ms && pair.is_decided) pair.is_decided = Clock::now() < until_;
    if (pair.is_decided) {
      list(pair, task);
      continue;
    }
    if (options_.near.near_m > 0) list_undecided(pair, task);
    if (options_.near.body_near_m > 0) list_nearest_undecided(pair, task);
  }
}

/// Whether a row of a pair of parts may be listed, by its volumes: the same with and without
/// another margin.
bool NearSearch::is_listed(const NearCandidate& candidate) const {
  return candidate.lo_m <= options_.near.near_m &&
         (candidate.is_inner || options_.near.near_m != margins_.inner_m);
}

/// By volumes alone, which prove of nothing that it touches.
void NearSearch::list_undecided(const Pair& pair, Task& task) {
  for (const NearCandidate& each : std::span(task.candidates.data() + pair.first, pair.count)) {
    if (!is_listed(each)) continue;
    NearCandidate c = each;
    if (narrow(pair.bodies, {&c, 1}, task) == 1)
      task.rows.add(interval_of(pair.bodies.body_a, pair.bodies.body_b, c).row());
  }
  task.rows.end_run(pair.bodies);
}

/// Candidates as list() sorts them, for the nearest of two bodies: as long as one can be nearer
/// than the nearest yet.
void NearSearch::list_nearest_undecided(const Pair& pair, Task& task) {
  NearestParts nearest(*this, pair);
  for (NearCandidate& c : sorted(pair, task)) {
    if (c.lo_m > nearest.within_m()) break;
    if (!nearest.may_be(c)) continue;
    const PartPair parts = part_pair(frame_, task.posed->poses(), pair.bodies, c.part_a, c.part_b);
    narrow_by_hulls(parts, c);
    narrow_wide(pair.bodies, parts, c, task);
    nearest.take(interval_of(pair.bodies.body_a, pair.bodies.body_b, c).row());
  }
  nearest.list(task);
}

/// The rows of two bodies that triangles decide. The candidates that may be nearest come first.
void NearSearch::list(const Pair& pair, Task& task) {
  NearestParts nearest(*this, pair);
  const float near_m = options_.near.near_m;
  for (const NearCandidate& c : sorted(pair, task)) {
    if (c.lo_m > std::max(near_m, nearest.within_m())) break;
    const bool listed = is_listed(c), may_be_nearest = nearest.may_be(c);
    if (!listed && !may_be_nearest) continue;
    const PartPair parts = part_pair(frame_, task.posed->poses(), pair.bodies, c.part_a, c.part_b);
    const float within_m = std::max(listed ? near_m : 0, may_be_nearest ? nearest.within_m() : 0);
    const NearVerdict verdict = verdict_of(parts, c, within_m, task);
    if (!verdict.is_near) continue;
    const NearPair row = decided(task, pair.bodies, c, verdict);
    if (verdict.touches && options_.near.contact_points)
      task.contacts.add({row.pair, row.point_a_m, row.normal, row.depth_m});
    if (listed && near_m > 0 && verdict.lo_m <= static_cast<double>(near_m)) task.rows.add(row);
    if (may_be_nearest) nearest.take(row);
  }
  const auto by_pair = [](const auto& p, const auto& q) { return p.pair < q.pair; };
  const auto sort = [&](auto rows) { std::sort(rows.begin(), rows.end(), by_pair); };
  sort(task.rows.open());
  sort(task.contacts.open());
  task.rows.end_run(pair.bodies);
  task.contacts.end_run(pair.bodies);
  nearest.list(task);
}

NearVerdict NearSearch::verdict_of(const PartPair& parts, const NearCandidate& candidate,
                                   float within_m, Task& task) const {
  if (!options_.near.is_asked())
    return task.decider.decide_touch(parts, candidate.touch, task.counters);
  return task.decider.decide(parts, candidate, static_cast<double>(within_m), task.counters);
}

NearInterval NearSearch::interval_of(size_t body_a, size_t body_b,
                                     const NearCandidate& candidate) const {
  return {PairKey(bodies_.ids[body_a], bodies_.ids[body_b], candidate.part_a, candidate.part_b),
          candidate.lo_m, candidate.hi_m};
}

NearPair NearSearch::decided(const Task& task, const BodyPair& bodies,
                             const NearCandidate& candidate, const NearVerdict& verdict) const {
  NearPair row = interval_of(bodies.body_a, bodies.body_b, candidate).row();
  const Vector3d& root = bodies_.roots[bodies.body_a].position_m;
  row.level = PairLevel::kExact;
  row.lo_m = rounded_down(verdict.lo_m);
  row.hi_m = rounded_up(verdict.hi_m);
  row.point_a_m = to_array(root + verdict.on_a_m);
  row.point_b_m = to_array(root + verdict.on_b_m);
  for (size_t axis = 0; axis < 3; ++axis)
    row.normal[axis] = static_cast<float>(verdict.normal[static_cast<Eigen::Index>(axis)]);
  row.depth_m = static_cast<float>(verdict.depth_m);
  row.closing_mps = closing_mps(task, bodies, candidate, verdict);
  return row;
}

/// The material of each part at the point, where it was in the last frame.
float NearSearch::closing_mps(const Task& task, const BodyPair& bodies,
                              const NearCandidate& candidate, const NearVerdict& verdict) const {
  const auto moved = [&](uint32_t body, uint16_t type, float scale, uint32_t pose, uint32_t part,
                         const Vector3d& point_m) -> Vector3d {
    if (types_[type]->is_static()) return Vector3d::Zero();
    const PastPoses::Body* past = past_.find(bodies_.ids[body]);
    if (past == nullptr) return Vector3d::Constant(NearPair::kNowhere);
    const Vector3d material = on_part(task.posed->poses()[pose + part], scale, point_m);
    const Vector3d then = placed(past->poses[part], past->scale, material);
    return (bodies_.roots[body].position_m - Vector3d(past->root_m.data())) + (point_m - then);
  };
  if (!(options_.near.step_s > 0)) return NearPair::kUnknown;
  const Vector3d b_to_a =
      bodies_.roots[bodies.body_a].position_m - bodies_.roots[bodies.body_b].position_m;
  const Vector3d a_moved = moved(bodies.body_a, bodies.type_a, bodies.scale_a, bodies.pose_a,
                                 candidate.part_a, verdict.on_a_m);
  const Vector3d b_moved = moved(bodies.body_b, bodies.type_b, bodies.scale_b, bodies.pose_b,
                                 candidate.part_b, verdict.on_b_m + b_to_a);
  return static_cast<float>((a_moved - b_moved).dot(verdict.normal) / options_.near.step_s);
}

void NearSearch::end_frame(StageCounters& counters) {
  Stopwatch watch;
  if (options_.has_deadline() && !lists_intervals()) {
    plan_budget();
    workers_.for_blocks(static_cast<int>(task_count_),
                        [&](int task, int) { decide(tasks_[static_cast<size_t>(task)]); });
  }
  hash_.add_frame(frame_number_++, take_rows());
  if (needs_past()) past_.end_frame();
  for (NearParts& parts : parts_)  // any worker may get any task next time
    for (const NearParts& other : parts_) parts.reserve_like(other);
  counters = {.volume = options_.exact ? "triangles" : "ordop26"};
  for (size_t i = 0; i < task_count_; ++i) {
    const NearCounters& of_task = tasks_[i].counters;
    counters.tests += options_.exact ? of_task.exact_tests : of_task.volume_tests;
    counters.test_ns += of_task.ns;
  }
  counters.passed = options_.near.is_asked() ? pairs().size() : contact_points().size();
  if (!shares_boxes_) {
    const PartCandidates::Counters boxes = box_counters();
    counters.test_ns += boxes.body_box.test_ns + boxes.box.test_ns;
  }
  counters.test_ns = counters.test_ns / workers_.threads() + watch.lap_ns();
}

PartCandidates::Counters NearSearch::box_counters() const {
  PartCandidates::Counters sum;
  for (const NearParts& parts : parts_) {
    sum.body_box += parts.parts().counters().body_box;
    sum.box += parts.parts().counters().box;
  }
  return sum;
}

/// Brings what the tasks have found into order. Returns the sum of what the hash is of.
EventSum NearSearch::take_rows() {
  EventSum sum;
  const auto as_it_is = [](size_t, size_t, const auto& row) { return row; };
  if (lists_intervals())
    sum +=
        take(&Task::intervals, intervals_, 1,
             [this](size_t a, size_t b, const NearCandidate& c) { return interval_of(a, b, c); });
  else if (options_.near.near_m > 0)
    sum += take(&Task::rows, pairs_, 1, as_it_is);
  if (options_.near.body_near_m > 0) sum += take(&Task::nearest, nearest_, 2, as_it_is);
  if (options_.near.contact_points) take(&Task::contacts, contacts_, 0, as_it_is);
  return sum;
}

template <typename Item, typename Row, typename RowOf>
EventSum NearSearch::take(FoundRows<Item> Task::*found, OrderedRows<Row, Item>& rows, uint64_t kind,
                          const RowOf& row_of) {
  const auto each_task = [&](const auto& visit) {
    for (size_t t = 0; t < task_count_; ++t) visit(tasks_[t].*found);
  };
  return rows.take(bodies_.ids.size(), workers_, each_task, row_of,
                   [kind](EventSum& sum, const Row& row) { add_to(sum, row, kind); });
}

void NearSearch::keep_contact_points(std::span<const PairKey> touching) {
  contacts_.remove([&](const ContactPoint& row) {
    return !std::binary_search(touching.begin(), touching.end(), row.pair);
  });
}

void NearSearch::archive(Archive& a) {
  uint64_t hash = hash_.value();
  a(frame_number_, hash);
  hash_ = EventHash(hash);
  past_.archive(a);
}

uint64_t NearSearch::Task::times_grown() const {
  return uint64_t{pairs.times_grown()} + candidates.times_grown() + intervals.times_grown() +
         rows.times_grown() + nearest.times_grown() + contacts.times_grown();
}

uint64_t NearSearch::times_grown() const {
  uint64_t sum = urgent_.times_grown() + past_.times_grown() + pairs_.times_grown() +
                 intervals_.times_grown() + nearest_.times_grown() + contacts_.times_grown();
  for (const NearParts& parts : parts_) sum += parts.times_grown();
  for (const Task& task : tasks_) sum += task.times_grown();
  return sum;
}

NearAlone::NearAlone(BodyTypes types, const CullerOptions& options, Workers& workers,
                     NearSearch& near)
    : workers_(workers), near_(near), shared_(types, options, workers, margins_of(options.near)) {}

void NearAlone::run(const BodiesView& bodies, const PoseSource& source, StageCounters& counters) {
  Stopwatch watch;
  shared_.search(bodies, source);
  const BroadPhase& broad = shared_.broad();
  posed_.prepare(shared_.slots().count());
  posed_.clear();
  posed_.clear_counters();
  for (size_t block = 0; block < broad.block_count(); ++block) posed_.need(broad.block(block));
  posed_.pose(shared_.posing(source), workers_);
  const double update_ns = watch.lap_ns();
  near_.begin_frame(shared_.parts(), bodies, broad.block_count());
  workers_.for_blocks(static_cast<int>(broad.block_count()), [&](int block, int worker) {
    near_.begin(worker, posed_);
    near_.add(worker, broad.block(static_cast<size_t>(block)),
              broad.inner(static_cast<size_t>(block)));
    near_.bound(worker, static_cast<size_t>(block));
    near_.finish(worker, static_cast<size_t>(block), {});
  });
  near_.end_frame(counters);
  counters.updates = posed_.counters().parts;
  counters.update_ns = update_ns;
}

}  // namespace throng
