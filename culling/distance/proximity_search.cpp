#include "culling/distance/proximity_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/checksum.h"
#include "base/stopwatch.h"
#include "culling/pair.h"

namespace throng {

void PreviousPoses::begin_frame(size_t tasks) {
  current_ = 1 - current_;
  Tasks& own = tasks_[current_];
  if (own.size() < tasks) own.resize(tasks);
  task_count_ = tasks;
  for (Task& task : own) task.body_count = task.pose_count = 0;
}

void PreviousPoses::end_frame() {
  previous_count_ = 0;
  for (size_t t = 0; t < task_count_; ++t) {
    Task& task = tasks_[current_][t];
    previous_.grow(previous_count_ + task.body_count, previous_count_);
    const PartPose* poses = task.poses.data();
    for (size_t i = 0; i < task.body_count; ++i) {
      task.bodies[i].poses = poses;
      poses += task.bodies[i].parts;
      previous_[previous_count_++] = task.bodies[i];
    }
  }
  std::sort(previous_.data(), previous_.data() + previous_count_,
            [](const Body& p, const Body& q) { return p.id < q.id; });
  Body* const end = std::unique(previous_.data(), previous_.data() + previous_count_,
                                [](const Body& p, const Body& q) { return p.id == q.id; });
  previous_count_ = static_cast<size_t>(end - previous_.data());
}

const PreviousPoses::Body* PreviousPoses::find(uint32_t id) const {
  const Body* const end = previous_.data() + previous_count_;
  const Body* const found = std::lower_bound(
      previous_.data(), end, id, [](const Body& one, uint32_t sought) { return one.id < sought; });
  return found != end && found->id == id ? found : nullptr;
}

void PreviousPoses::archive(Archive& a) {
  uint64_t count = previous_count_;
  a(count);
  if (a.is_reading()) return restore(a, count);
  for (size_t i = 0; i < count; ++i) {
    Body body = previous_[i];
    a(body.id, body.parts, body.scale, body.root_m);
    for (uint32_t part = 0; part < body.parts; ++part) {
      PartPose pose = body.poses[part];
      a(pose.rows);
    }
  }
}

void PreviousPoses::restore(Archive& a, uint64_t count) {
  if (count > PairKey::kMaxId) a.reject("a supported number of bodies", "a larger number");
  begin_frame(1);
  Task& task = tasks_[current_][0];
  constexpr uint32_t kMaxPartCount = 256;
  for (size_t i = 0; i < count; ++i) {
    Body body{};
    a(body.id, body.parts, body.scale, body.root_m);
    if (body.parts > kMaxPartCount) a.reject("a supported number of parts", "a larger number");
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

uint64_t PreviousPoses::times_grown() const {
  uint64_t sum = previous_.times_grown();
  for (const Tasks& tasks : tasks_)
    for (const Task& task : tasks) sum += task.bodies.times_grown() + task.poses.times_grown();
  return sum;
}

namespace {

using Eigen::Vector3d;

/// Wider bounds by volumes are tightened by hulls and, if still wide, by triangles.
constexpr float kWide_m = 0.1f;

template <typename T>
void append(GrowBuffer<T>& to, size_t& count, const T& what) {
  to.grow(count + 1, count);
  to[count++] = what;
}

std::array<double, 3> to_array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Position of a point (relative to the root) in the part's frame.
Vector3d on_part(const PartPose& pose, float scale, const Vector3d& point_m) {
  const Eigen::Isometry3d there = to_isometry(pose);
  return there.linear().transpose() * (point_m - there.translation()) / static_cast<double>(scale);
}

Vector3d placed(const PartPose& pose, float scale, const Vector3d& on_part) {
  return to_isometry(pose) * (static_cast<double>(scale) * on_part);
}

/// Adds a row to the hash. `kind`: 1 for pairs of parts, 2 for the closest parts of two bodies.
void add_to(EventSum& sum, const ProximityPair& row, uint64_t kind) {
  const uint64_t interval =
      uint64_t{std::bit_cast<uint32_t>(row.lo_m)} << 32 | std::bit_cast<uint32_t>(row.hi_m);
  const uint64_t level = 2 * static_cast<uint64_t>(row.level) + kind;
  sum.sum += mixed(mixed(row.pair.bits() + level * 0x9e3779b97f4a7c15ull) + interval);
  ++sum.count;
}

void add_to(EventSum& sum, const DistanceBounds& interval, uint64_t kind) {
  add_to(sum, interval.row(), kind);
}

/// Contact points are not hashed: events include their pairs.
void add_to(EventSum&, const ContactPoint&, uint64_t) {}

/// Calls visit(pair, first, end) for the candidates of each pair of bodies.
template <typename Visit>
void for_pairs(std::span<const Candidate> candidates, const Visit& visit) {
  for (size_t i = 0; i < candidates.size();) {
    const size_t first = i;
    const uint32_t pair = candidates[i].pair;
    while (i < candidates.size() && candidates[i].pair == pair) ++i;
    visit(pair, first, i);
  }
}

/// Writes the candidates that volumes do not prove farther apart than `within_m`; returns their
/// number. `out` must hold all candidates. Without branches, because results are not predictable.
template <typename TouchOf, typename InnerOf>
size_t write_candidates(const ProximityCandidates& parts, size_t first, size_t end, float within_m,
                        ProximityCandidate* out, const TouchOf& touch_of, const InnerOf& inner_of) {
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

TouchState untested(size_t) { return TouchState::kUntested; }
bool always_inner(size_t) { return true; }

}  // namespace

Margins margins_of(const ProximityOptions& options) {
  Margins out{options.max_margin_m(), std::min(options.margin_m, options.closest_margin_m)};
  if (out.inner_m == out.reach_m) out.inner_m = 0;
  return out;
}

ProximitySearch::ProximitySearch(BodyTypes types, const CullerOptions& options, Workers& workers)
    : types_(types),
      options_(options),
      margins_(margins_of(options.proximity)),
      workers_(workers),
      parts_(static_cast<size_t>(workers.threads())) {
  for (const auto& type : types) {
    fit_for_proximity(*type);
    has_surfaces_.push_back(type->has_triangles());
  }
}

void ProximitySearch::begin_frame(const MidPhaseFrame& frame, const BodiesView& bodies,
                                  size_t tasks) {
  frame_ = frame;
  bodies_ = bodies;
  task_count_ = tasks;
  if (tasks_.size() < tasks) tasks_.resize(tasks);
  if (options_.budget_ms)
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double, std::milli>(*options_.budget_ms));
  for (ProximityCandidates& parts : parts_) parts.clear_counters();
  previous_.begin_frame(tasks);
}

void ProximitySearch::begin(int worker, const PosedBodies& bodies) {
  parts_[static_cast<size_t>(worker)].begin(frame_, bodies, options_.proximity.max_margin_m());
}

void ProximitySearch::add(int worker, std::span<const SlotPair> pairs,
                          std::span<const uint8_t> inner) {
  parts_[static_cast<size_t>(worker)].add(frame_, pairs, inner);
}

void ProximitySearch::bound(int worker, size_t index) {
  ProximityCandidates& parts = parts_[static_cast<size_t>(worker)];
  parts.find_candidates(frame_);
  Stopwatch watch;
  parts.find_bounds(frame_);
  ProximityCounters& counters = tasks_[index].counters;
  counters = {};
  counters.volume_tests = parts.candidates().size();
  counters.ns = watch.lap_ns();
}

void ProximitySearch::finish(int worker, size_t index, std::span<const uint8_t> touches) {
  const ProximityCandidates& parts = parts_[static_cast<size_t>(worker)];
  Task& task = tasks_[index];
  Stopwatch watch;
  task.posed = &parts.posed();
  if (lists_bounds_only()) {
    list_intervals(parts, task);
  } else {
    take_candidates(parts, touches, task);
    if (!options_.has_budget()) decide(task);
  }
  // With a budget all tasks have the same bodies.
  if (needs_previous_poses() && (!options_.has_budget() || index == 0))
    record_poses(index, parts.posed());
  task.counters.ns += watch.lap_ns();
}

void ProximitySearch::record_poses(size_t index, const PosedBodies& posed) {
  previous_.record(index, posed.bodies(), posed.poses(), bodies_, [&](uint16_t type) {
    return types_[type]->is_static() ? 0 : types_[type]->part_count();
  });
}

void ProximitySearch::list_intervals(const ProximityCandidates& parts, Task& task) {
  task.intervals.clear();
  ProximityCandidate* const out = task.intervals.reserve(parts.candidates().size());
  size_t count = 0;
  for_pairs(parts.candidates(), [&](uint32_t pair, size_t first, size_t end) {
    const BodyPair& bodies = parts.pairs()[pair];
    const size_t found = write_candidates(parts, first, end, options_.proximity.margin_m,
                                          out + count, untested, always_inner);
    const size_t left = tighten(bodies, {out + count, found}, task);
    task.intervals.commit(left);
    task.intervals.end_run(bodies);
    count += left;
  });
}

/// Tightens wide bounds of volumes by hulls, and those of hulls by triangles: at a wall no corner
/// is near. Returns the number of candidates within the margin, which are moved to the front.
size_t ProximitySearch::tighten(const BodyPair& bodies, std::span<ProximityCandidate> candidates,
                                Task& task) const {
  bool is_tightened = false;
  for (ProximityCandidate& c : candidates) {
    if (c.hi_m - c.lo_m <= kWide_m) continue;
    const PartPair parts = part_pair(frame_, task.posed->poses(), bodies, c.part_a, c.part_b);
    tighten_by_hulls(parts, c);
    tighten_wide(bodies, parts, c, task);
    is_tightened = true;
  }
  if (!is_tightened) return candidates.size();
  const float margin_m = options_.proximity.margin_m;
  const auto end =
      std::remove_if(candidates.begin(), candidates.end(),
                     [margin_m](const ProximityCandidate& c) { return c.lo_m > margin_m; });
  return static_cast<size_t>(end - candidates.begin());
}

void ProximitySearch::tighten_wide(const BodyPair& bodies, const PartPair& parts,
                                   ProximityCandidate& candidate, Task& task) const {
  if (candidate.hi_m - candidate.lo_m <= kWide_m) return;
  if (has_surfaces_[bodies.type_a] != 0 && has_surfaces_[bodies.type_b] != 0)
    tighten_by_triangles(parts, candidate, task.counters);
}

void ProximitySearch::take_candidates(const ProximityCandidates& parts,
                                      std::span<const uint8_t> touches, Task& task) {
  const auto touch_of = [touches](size_t i) {
    if (touches.empty()) return TouchState::kUntested;
    return touches[i] ? TouchState::kYes : TouchState::kNo;
  };
  const auto inner_of = [&](size_t i) {
    return margins_.inner_m == 0 ||
           (parts.bounds()[i].lo_m <= margins_.inner_m &&
            parts.parts().is_inner(frame_, parts.candidates()[i], margins_.inner_m));
  };
  task.pair_count = task.candidate_count = 0;
  task.candidates.grow(parts.candidates().size(), 0);
  for_pairs(parts.candidates(), [&](uint32_t of, size_t first, size_t end) {
    ProximityCandidate* const found = task.candidates.data() + task.candidate_count;
    const size_t count =
        write_candidates(parts, first, end, margins_.reach_m, found, touch_of, inner_of);
    if (count == 0) return;
    const auto less = [](const ProximityCandidate& p, const ProximityCandidate& q) {
      return p.lo_m < q.lo_m;
    };
    const float min_distance_m = std::min_element(found, found + count, less)->lo_m;
    append(task.pairs, task.pair_count,
           Pair{parts.pairs()[of], min_distance_m, static_cast<uint32_t>(task.candidate_count),
                static_cast<uint32_t>(count), options_.exact});
    task.candidate_count += count;
  });
}

/// With a budget, plans complete pairs of bodies by increasing lower bound until the budget is used
/// up. A budget of tests counts one triangle test per candidate; decide() checks the time.
void ProximitySearch::plan_budget() {
  if (!options_.exact) return;
  size_t count = 0;
  for (size_t i = 0; i < task_count_; ++i)
    for (size_t p = 0; p < tasks_[i].pair_count; ++p) append(urgent_, count, {&tasks_[i].pairs[p]});
  const auto key = [](const Urgent& u) {
    return std::tuple(u.pair->min_distance_m, u.pair->bodies.body_a, u.pair->bodies.body_b);
  };
  std::sort(urgent_.data(), urgent_.data() + count,
            [&](const Urgent& p, const Urgent& q) { return key(p) < key(q); });
  uint64_t left = options_.budget_tests.value_or(std::numeric_limits<uint64_t>::max());
  for (size_t i = 0; i < count; ++i) {
    Pair& pair = *urgent_[i].pair;
    pair.is_decided = pair.count <= left;
    left = pair.is_decided ? left - pair.count : 0;
  }
}

/// Finds the closest parts of two bodies if closest_margin_m is set.
class ProximitySearch::ClosestParts {
 public:
  ClosestParts(const ProximitySearch& search, const Pair& pair)
      : bodies_(pair.bodies),
        needs_inner_(search.options_.proximity.closest_margin_m == search.margins_.inner_m) {
    const bool has_static =
        search.types_[bodies_.type_a]->is_static() || search.types_[bodies_.type_b]->is_static();
    margin_m_ = has_static ? 0 : search.options_.proximity.closest_margin_m;
    nearest_.lo_m = nearest_.hi_m = std::numeric_limits<float>::max();
  }

  /// Distance beyond which a pair is not the closest; below 0 if none is requested.
  float within_m() const { return margin_m_ > 0 ? std::min(margin_m_, nearest_.hi_m) : -1; }
  bool may_be(const ProximityCandidate& c) const {
    return c.lo_m <= within_m() && (c.is_inner || !needs_inner_);
  }
  void take(const ProximityPair& row) {
    min_distance_m_ = std::min(min_distance_m_, row.lo_m);
    if (std::pair(row.hi_m, row.pair) < std::pair(nearest_.hi_m, nearest_.pair)) nearest_ = row;
  }
  void list(Task& task) {
    nearest_.lo_m = min_distance_m_;
    if (margin_m_ > 0 && min_distance_m_ <= margin_m_) task.nearest.add(nearest_);
    task.nearest.end_run(bodies_);
  }

 private:
  const BodyPair& bodies_;
  bool needs_inner_;
  float margin_m_;
  ProximityPair nearest_;
  /// lower bound of the distance of all parts
  float min_distance_m_ = std::numeric_limits<float>::max();
};

/// Candidates of two bodies, by increasing lower bound.
std::span<ProximityCandidate> ProximitySearch::sorted(const Pair& pair, Task& task) {
  const std::span<ProximityCandidate> out(task.candidates.data() + pair.first, pair.count);
  std::sort(out.begin(), out.end(), [](const ProximityCandidate& p, const ProximityCandidate& q) {
    return std::pair(p.lo_m, p.parts()) < std::pair(q.lo_m, q.parts());
  });
  return out;
}

void ProximitySearch::decide(Task& task) {
  task.rows.clear();
  task.nearest.clear();
  task.contacts.clear();
  for (size_t i = 0; i < task.pair_count; ++i) {
    Pair& pair = task.pairs[i];
    if (options_.budget_ms && pair.is_decided) pair.is_decided = Clock::now() < deadline_;
    if (pair.is_decided) {
      list(pair, task);
      continue;
    }
    if (options_.proximity.margin_m > 0) list_undecided(pair, task);
    if (options_.proximity.closest_margin_m > 0) list_nearest_undecided(pair, task);
  }
}

/// True if a pair of parts is listed, by its volumes. Independent of another margin.
bool ProximitySearch::is_listed(const ProximityCandidate& candidate) const {
  return candidate.lo_m <= options_.proximity.margin_m &&
         (candidate.is_inner || options_.proximity.margin_m != margins_.inner_m);
}

/// Lists candidates by volumes only, which never prove a contact.
void ProximitySearch::list_undecided(const Pair& pair, Task& task) {
  for (const ProximityCandidate& each :
       std::span(task.candidates.data() + pair.first, pair.count)) {
    if (!is_listed(each)) continue;
    ProximityCandidate c = each;
    if (tighten(pair.bodies, {&c, 1}, task) == 1)
      task.rows.add(interval_of(pair.bodies.body_a, pair.bodies.body_b, c).row());
  }
  task.rows.end_run(pair.bodies);
}

/// Lists the closest candidate of two bodies, in the order of list() until none can be closer.
void ProximitySearch::list_nearest_undecided(const Pair& pair, Task& task) {
  ClosestParts nearest(*this, pair);
  for (ProximityCandidate& c : sorted(pair, task)) {
    if (c.lo_m > nearest.within_m()) break;
    if (!nearest.may_be(c)) continue;
    const PartPair parts = part_pair(frame_, task.posed->poses(), pair.bodies, c.part_a, c.part_b);
    tighten_by_hulls(parts, c);
    tighten_wide(pair.bodies, parts, c, task);
    nearest.take(interval_of(pair.bodies.body_a, pair.bodies.body_b, c).row());
  }
  nearest.list(task);
}

/// Lists the rows of two bodies by triangles, by increasing lower bound.
void ProximitySearch::list(const Pair& pair, Task& task) {
  ClosestParts nearest(*this, pair);
  const float margin_m = options_.proximity.margin_m;
  for (const ProximityCandidate& c : sorted(pair, task)) {
    if (c.lo_m > std::max(margin_m, nearest.within_m())) break;
    const bool listed = is_listed(c), may_be_nearest = nearest.may_be(c);
    if (!listed && !may_be_nearest) continue;
    const PartPair parts = part_pair(frame_, task.posed->poses(), pair.bodies, c.part_a, c.part_b);
    const float within_m = std::max(listed ? margin_m : 0, may_be_nearest ? nearest.within_m() : 0);
    const DistanceResult result = result_of(parts, c, within_m, task);
    if (!result.is_within) continue;
    const ProximityPair row = decided(task, pair.bodies, c, result);
    if (result.touches && options_.proximity.contact_points)
      task.contacts.add({row.pair, row.point_a_m, row.normal, row.depth_m});
    if (listed && margin_m > 0 && result.lo_m <= static_cast<double>(margin_m)) task.rows.add(row);
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

DistanceResult ProximitySearch::result_of(const PartPair& parts,
                                          const ProximityCandidate& candidate, float within_m,
                                          Task& task) const {
  if (!options_.proximity.is_enabled())
    return task.decider.decide_touch(parts, candidate.touch, task.counters);
  return task.decider.decide(parts, candidate, static_cast<double>(within_m), task.counters);
}

DistanceBounds ProximitySearch::interval_of(size_t body_a, size_t body_b,
                                            const ProximityCandidate& candidate) const {
  return {PairKey(bodies_.ids[body_a], bodies_.ids[body_b], candidate.part_a, candidate.part_b),
          candidate.lo_m, candidate.hi_m};
}

ProximityPair ProximitySearch::decided(const Task& task, const BodyPair& bodies,
                                       const ProximityCandidate& candidate,
                                       const DistanceResult& result) const {
  ProximityPair row = interval_of(bodies.body_a, bodies.body_b, candidate).row();
  const Vector3d& root = bodies_.roots[bodies.body_a].position_m;
  row.level = PairLevel::kTriangles;
  row.lo_m = rounded_down(result.lo_m);
  row.hi_m = rounded_up(result.hi_m);
  row.point_a_m = to_array(root + result.on_a_m);
  row.point_b_m = to_array(root + result.on_b_m);
  for (size_t axis = 0; axis < 3; ++axis)
    row.normal[axis] = static_cast<float>(result.normal[static_cast<Eigen::Index>(axis)]);
  row.depth_m = static_cast<float>(result.depth_m);
  row.closing_speed_mps = closing_speed_mps(task, bodies, candidate, result);
  return row;
}

/// Tracks the material of each part at the point back to its position in the last frame.
float ProximitySearch::closing_speed_mps(const Task& task, const BodyPair& bodies,
                                         const ProximityCandidate& candidate,
                                         const DistanceResult& result) const {
  const auto moved = [&](uint32_t body, uint16_t type, float scale, uint32_t pose, uint32_t part,
                         const Vector3d& point_m) -> Vector3d {
    if (types_[type]->is_static()) return Vector3d::Zero();
    const PreviousPoses::Body* past = previous_.find(bodies_.ids[body]);
    if (past == nullptr) return Vector3d::Constant(ProximityPair::kNoPosition);
    const Vector3d material = on_part(task.posed->poses()[pose + part], scale, point_m);
    const Vector3d then = placed(past->poses[part], past->scale, material);
    return (bodies_.roots[body].position_m - Vector3d(past->root_m.data())) + (point_m - then);
  };
  if (!(options_.proximity.step_s > 0)) return ProximityPair::kUnknown;
  const Vector3d b_to_a =
      bodies_.roots[bodies.body_a].position_m - bodies_.roots[bodies.body_b].position_m;
  const Vector3d a_moved = moved(bodies.body_a, bodies.type_a, bodies.scale_a, bodies.pose_a,
                                 candidate.part_a, result.on_a_m);
  const Vector3d b_moved = moved(bodies.body_b, bodies.type_b, bodies.scale_b, bodies.pose_b,
                                 candidate.part_b, result.on_b_m + b_to_a);
  return static_cast<float>((a_moved - b_moved).dot(result.normal) / options_.proximity.step_s);
}

void ProximitySearch::end_frame(StageCounters& counters) {
  Stopwatch watch;
  if (options_.has_budget() && !lists_bounds_only()) {
    plan_budget();
    workers_.for_blocks(static_cast<int>(task_count_),
                        [&](int task, int) { decide(tasks_[static_cast<size_t>(task)]); });
  }
  hash_.add_frame(frame_number_++, take_rows());
  if (needs_previous_poses()) previous_.end_frame();
  for (ProximityCandidates& parts : parts_)  // any worker may run any task next time
    for (const ProximityCandidates& other : parts_) parts.reserve_like(other);
  counters = {.volume = options_.exact ? "triangles" : "ordop26"};
  for (size_t i = 0; i < task_count_; ++i) {
    const ProximityCounters& of_task = tasks_[i].counters;
    counters.tests += options_.exact ? of_task.triangle_queries : of_task.volume_tests;
    counters.test_ns += of_task.ns;
  }
  counters.passed = options_.proximity.is_enabled() ? pairs().size() : contact_points().size();
  if (!shares_boxes_) {
    const PartCandidates::Counters boxes = box_counters();
    counters.test_ns += boxes.body_box.test_ns + boxes.part_box.test_ns;
  }
  counters.test_ns = counters.test_ns / workers_.threads() + watch.lap_ns();
}

PartCandidates::Counters ProximitySearch::box_counters() const {
  PartCandidates::Counters sum;
  for (const ProximityCandidates& parts : parts_) {
    sum.body_box += parts.parts().counters().body_box;
    sum.part_box += parts.parts().counters().part_box;
  }
  return sum;
}

/// Sorts the rows of all tasks. Returns the sum for the hash.
EventSum ProximitySearch::take_rows() {
  EventSum sum;
  const auto as_it_is = [](size_t, size_t, const auto& row) { return row; };
  if (lists_bounds_only())
    sum += take(
        &Task::intervals, intervals_, 1,
        [this](size_t a, size_t b, const ProximityCandidate& c) { return interval_of(a, b, c); });
  else if (options_.proximity.margin_m > 0)
    sum += take(&Task::rows, pairs_, 1, as_it_is);
  if (options_.proximity.closest_margin_m > 0) sum += take(&Task::nearest, nearest_, 2, as_it_is);
  if (options_.proximity.contact_points) take(&Task::contacts, contacts_, 0, as_it_is);
  return sum;
}

template <typename Item, typename Row, typename RowOf>
EventSum ProximitySearch::take(TaskRows<Item> Task::*found, OrderedRows<Row, Item>& rows,
                               uint64_t kind, const RowOf& row_of) {
  const auto each_task = [&](const auto& visit) {
    for (size_t t = 0; t < task_count_; ++t) visit(tasks_[t].*found);
  };
  return rows.take(bodies_.ids.size(), workers_, each_task, row_of,
                   [kind](EventSum& sum, const Row& row) { add_to(sum, row, kind); });
}

void ProximitySearch::keep_contact_points(std::span<const PairKey> touching) {
  contacts_.remove([&](const ContactPoint& row) {
    return !std::binary_search(touching.begin(), touching.end(), row.pair);
  });
}

void ProximitySearch::archive(Archive& a) {
  uint64_t hash = hash_.value();
  a(frame_number_, hash);
  hash_ = EventHash(hash);
  previous_.archive(a);
}

uint64_t ProximitySearch::Task::times_grown() const {
  return uint64_t{pairs.times_grown()} + candidates.times_grown() + intervals.times_grown() +
         rows.times_grown() + nearest.times_grown() + contacts.times_grown();
}

uint64_t ProximitySearch::times_grown() const {
  uint64_t sum = urgent_.times_grown() + previous_.times_grown() + pairs_.times_grown() +
                 intervals_.times_grown() + nearest_.times_grown() + contacts_.times_grown();
  for (const ProximityCandidates& parts : parts_) sum += parts.times_grown();
  for (const Task& task : tasks_) sum += task.times_grown();
  return sum;
}

BudgetedProximity::BudgetedProximity(BodyTypes types, const CullerOptions& options,
                                     Workers& workers, ProximitySearch& search)
    : workers_(workers),
      proximity_(search),
      shared_(types, options, workers, margins_of(options.proximity)) {}

void BudgetedProximity::run(const BodiesView& bodies, const PoseSource& source,
                            StageCounters& counters) {
  Stopwatch watch;
  shared_.search(bodies, source);
  const BroadPhase& broad = shared_.broad();
  posed_.prepare(shared_.slots().count());
  posed_.clear();
  posed_.clear_counters();
  for (size_t block = 0; block < broad.block_count(); ++block) posed_.request(broad.block(block));
  posed_.pose(shared_.posing(source), workers_);
  const double update_ns = watch.lap_ns();
  proximity_.begin_frame(shared_.parts(), bodies, broad.block_count());
  workers_.for_blocks(static_cast<int>(broad.block_count()), [&](int block, int worker) {
    proximity_.begin(worker, posed_);
    proximity_.add(worker, broad.block(static_cast<size_t>(block)),
                   broad.inner(static_cast<size_t>(block)));
    proximity_.bound(worker, static_cast<size_t>(block));
    proximity_.finish(worker, static_cast<size_t>(block), {});
  });
  proximity_.end_frame(counters);
  counters.updates = posed_.counters().parts;
  counters.update_ns = update_ns;
}

}  // namespace throng
