#include "culling/stages/budgeted_pass.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "base/stopwatch.h"

namespace throng {
namespace {

constexpr uint32_t kNotTouched = 1u << 31;
/// Groups of 1/1024 m of overlap are quick to sort. Deeper overlaps share the last group.
constexpr float kGroupsPerMetre = 1024;
constexpr uint32_t kGroupsOfKind = 4096;
constexpr uint32_t kGroups = 2 * kGroupsOfKind;

/// Ascending with falling depth; pairs that did not touch follow all that did.
uint32_t rank_of(bool touched, float depth_m) {
  // The bits of non-negative floats are ordered as the floats.
  const uint32_t bits = std::bit_cast<uint32_t>(std::max(depth_m, 0.0f));
  return (touched ? 0 : kNotTouched) | (~kNotTouched - bits);
}

uint32_t group_of(uint32_t rank) {
  const float depth_m = std::bit_cast<float>(~kNotTouched - (rank & ~kNotTouched));
  const float group = std::min(depth_m * kGroupsPerMetre, static_cast<float>(kGroupsOfKind - 1));
  return (rank & kNotTouched ? kGroupsOfKind : 0) + kGroupsOfKind - 1 -
         static_cast<uint32_t>(group);
}

std::pair<uint32_t, uint32_t> bodies_of(const UrgentPair& pair, const Slots& slots) {
  const uint32_t a = slots.body(pair.slots.a), b = slots.body(pair.slots.b);
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

void UrgencyQueue::fill(const BodiesView& bodies, const BroadPhase& broad, const Slots& slots,
                        std::span<const PairKey> touched, Workers& workers) {
  mark_touched(bodies, touched);
  const size_t blocks = broad.block_count();
  first_of_block_.resize(blocks + 1);
  first_of_block_[0] = 0;
  for (size_t i = 0; i < blocks; ++i)
    first_of_block_[i + 1] = first_of_block_[i] + broad.block(i).size();
  count_ = first_of_block_[blocks];
  next_ = sorted_ = 0;
  found_.resize(count_);
  workers.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    UrgentPair* out = found_.data() + first_of_block_[block];
    for (const SlotPair& pair : broad.block(block)) {
      const uint32_t a = slots.body(pair.a), b = slots.body(pair.b);
      const bool touching = touched_before(std::min(a, b), std::max(a, b), bodies, touched);
      *out++ = {pair, rank_of(touching, broad.depth_m(pair, slots))};
    }
  });
  scatter_by_group();
}

/// Finds the first pair of each body. Both lists ascend by id, so one walk suffices.
void UrgencyQueue::mark_touched(const BodiesView& bodies, std::span<const PairKey> touched) {
  first_touched_.resize(bodies.ids.size());
  size_t next = 0;
  for (size_t body = 0; body < bodies.ids.size(); ++body) {
    while (next < touched.size() && touched[next].a() < bodies.ids[body]) ++next;
    first_touched_[body] = static_cast<uint32_t>(next);
  }
}

bool UrgencyQueue::touched_before(uint32_t body_a, uint32_t body_b, const BodiesView& bodies,
                                  std::span<const PairKey> touched) const {
  const uint32_t a = bodies.ids[body_a], b = bodies.ids[body_b];
  for (size_t i = first_touched_[body_a]; i < touched.size() && touched[i].a() == a; ++i)
    if (touched[i].b() >= b) return touched[i].b() == b;
  return false;
}

void UrgencyQueue::scatter_by_group() {
  pairs_.resize(count_);
  group_start_.resize(kGroups + 2);
  // Counts are shifted by one group: after scattering, group_start_[i] is the start of group i.
  std::fill_n(group_start_.data(), kGroups + 2, 0u);
  for (size_t i = 0; i < count_; ++i) ++group_start_[group_of(found_[i].rank) + 2];
  std::partial_sum(group_start_.data(), group_start_.data() + kGroups + 2, group_start_.data());
  for (size_t i = 0; i < count_; ++i)
    pairs_[group_start_[group_of(found_[i].rank) + 1]++] = found_[i];
}

/// End of the group of the pair before `at`.
size_t UrgencyQueue::group_end(size_t at) const {
  return at == 0 ? 0 : group_start_[group_of(pairs_[at - 1].rank) + 1];
}

std::span<const UrgentPair> UrgencyQueue::peek(size_t target_count) const {
  const size_t end = group_end(std::min(count_, next_ + target_count));
  return {pairs_.data() + next_, end - next_};
}

void UrgencyQueue::sort_next(size_t target_count, const Slots& slots) {
  const size_t end = std::min(count_, next_ + target_count);
  sorted_ = std::max(sorted_, next_);
  while (sorted_ < end) {
    const size_t group = group_end(sorted_ + 1);
    std::sort(pairs_.data() + sorted_, pairs_.data() + group,
              [&](const UrgentPair& x, const UrgentPair& y) {
                return x.rank != y.rank ? x.rank < y.rank
                                        : bodies_of(x, slots) < bodies_of(y, slots);
              });
    sorted_ = group;
  }
}

std::span<const UrgentPair> UrgencyQueue::peek_sorted(size_t target_count) const {
  return {pairs_.data() + next_, std::min(count_ - next_, target_count)};
}

uint64_t UrgencyQueue::times_grown() const {
  return uint64_t{found_.times_grown()} + pairs_.times_grown() + first_of_block_.times_grown() +
         first_touched_.times_grown() + group_start_.times_grown();
}

namespace {

constexpr size_t kWaveTaskPairs = 512;  // pairs of bodies per task
constexpr size_t kWaveTasks = 16;       // the same for any number of threads
constexpr size_t kMaxInWave = kWaveTaskPairs * kWaveTasks;
constexpr size_t kMinInWave = 16;
constexpr size_t kMinByClock = 64;
constexpr size_t kSortBodies = 4096;  // bodies per task when keys are sorted
/// Initial estimate of the time to refine a pair of bodies to part volumes.
constexpr double kInitialPair_ns = 200;
constexpr uint64_t kNoLimit = std::numeric_limits<uint64_t>::max();

/// Maximum number of tests per pair of bodies: two boxes, then all parts at every stage.
uint64_t max_tests_per_pair(BodyTypes types, const CullerOptions& options) {
  uint64_t parts = 0;
  for (const auto& type : types) parts = std::max(parts, static_cast<uint64_t>(type->part_count()));
  return 1 + parts * parts * (options.exact ? 3 : 2);
}

}  // namespace

BudgetedPass::BudgetedPass(BodyTypes types, const CullerOptions& options, Workers& workers)
    : options_(options),
      workers_(workers),
      shared_(types, options, workers),
      stages_(kWaveTasks),
      max_exact_(kWaveTasks),
      decided_(kWaveTasks),
      max_tests_per_pair_(max_tests_per_pair(types, options)),
      pair_ns_(kInitialPair_ns) {}

void BudgetedPass::run(const BodiesView& bodies, const PoseSource& source, PairEvents& events,
                       CullingCounters& counters) {
  begin_budget();
  shared_.search(bodies, source);
  refine(bodies, source);
  MidPhaseCounters parts;
  for (const MidPhase& stage : stages_) parts.add(stage.counters());
  shared_.count(parts, bodies_.counters(), counters);
  Stopwatch watch;
  take_events(bodies, events);
  counters.events_ns = watch.lap_ns();
  counters.levels = reported_;
}

void BudgetedPass::add(PairKey key, PairLevel level) {
  found_.grow(found_count_ + 1, found_count_);
  found_[found_count_++] = {key, static_cast<uint8_t>(level)};
}

bool BudgetedPass::time_is_up() const {
  return options_.budget_ms.has_value() && Clock::now() >= deadline_;
}

void BudgetedPass::begin_budget() {
  tests_left_ = options_.budget_tests.value_or(kNoLimit);
  deadline_ = Clock::now() + std::chrono::nanoseconds(static_cast<int64_t>(
                                 options_.budget_ms.value_or(0) * 1e6 - events_ns_));
}

void BudgetedPass::refine(const BodiesView& bodies, const PoseSource& source) {
  const Slots& slots = shared_.slots();
  for (MidPhase& stage : stages_) stage.clear_counters();
  found_count_ = 0;
  find_touched();
  queue_.fill(bodies, shared_.broad(), slots, {touched_.data(), touched_count_}, workers_);
  bodies_.clear_counters();
  bodies_.clear();
  bodies_.prepare(slots.count());
  const Frame frame{shared_.posing(source), shared_.parts()};
  while (!queue_.empty() && tests_left_ > 0 && !time_is_up()) refine_wave(frame, next_wave(slots));
  for (const UrgentPair& pair : queue_.rest()) {
    const uint32_t a = slots.body(pair.slots.a), b = slots.body(pair.slots.b);
    add(PairKey(std::min(a, b), std::max(a, b), kWholeBody, kWholeBody), PairLevel::kSphere);
  }
}

/// Collects pairs that were decided to touch, without undecided ones.
void BudgetedPass::find_touched() {
  const auto last = static_cast<uint8_t>(last_level(options_));
  touched_.resize(current_.count);
  touched_count_ = 0;
  for (size_t i = 0; i < current_.count; ++i)
    if (current_.levels[i] == last) touched_[touched_count_++] = current_.keys[i];
}

/// Returns as many pairs as the budget surely covers, in groups, or a few in exact order.
std::span<const UrgentPair> BudgetedPass::next_wave(const Slots& slots) {
  size_t target_count = kMaxInWave;
  if (options_.budget_ms) {
    const double left_ns =
        std::chrono::duration<double, std::nano>(deadline_ - Clock::now()).count();
    const double half = std::clamp(0.5 * left_ns / pair_ns_, 0.0, double{kMaxInWave});
    target_count = std::max(kMinByClock, static_cast<size_t>(half));
  }
  // Results with a time budget are not repeatable, so the order of groups suffices.
  if (!options_.budget_tests) return queue_.peek_sorted(target_count);
  const uint64_t covered = tests_left_ / max_tests_per_pair_;
  if (!queue_.sorting()) {
    const auto groups = queue_.peek(target_count);
    if (groups.size() <= std::min<uint64_t>(covered, kMaxInWave)) return groups;
  }
  target_count = std::clamp(static_cast<size_t>(covered), kMinInWave, target_count);
  queue_.sort_next(target_count, slots);
  return queue_.peek_sorted(target_count);
}

void BudgetedPass::refine_wave(const Frame& frame, std::span<const UrgentPair> wave) {
  Stopwatch watch;
  wave = wave.first(std::min<uint64_t>(wave.size(), tests_left_));
  pose(frame, wave);
  const size_t tasks = test_bodies(frame, wave);
  const auto run = [&](const auto& step) {
    workers_.for_blocks(static_cast<int>(tasks),
                        [&](int task, int) { step(static_cast<size_t>(task)); });
  };
  cut_pairs(frame, tasks);
  run([&](size_t task) { stages_[task].find_candidates(frame.parts); });
  cut_candidates(tasks);
  run([&](size_t task) { stages_[task].test_parts(frame.parts); });
  cut_triangles(tasks);
  if (options_.exact)
    run([&](size_t task) {
      decided_[task] = stages_[task].decide_by_triangles(frame.parts, max_exact_[task]);
    });
  for (size_t task = 0; task < tasks; ++task) report(stages_[task], decided_[task]);
  queue_.take(wave.size());
  pair_ns_ = std::max(1.0, watch.lap_ns() / static_cast<double>(std::max<size_t>(1, wave.size())));
}

void BudgetedPass::pose(const Frame& frame, std::span<const UrgentPair> wave) {
  for (const UrgentPair& pair : wave) {
    bodies_.request(pair.slots.a);
    bodies_.request(pair.slots.b);
  }
  bodies_.pose(frame.posing, workers_);
}

/// Tests the body boxes of every pair in the wave; returns the number of tasks.
size_t BudgetedPass::test_bodies(const Frame& frame, std::span<const UrgentPair> wave) {
  wave_pairs_.resize(wave.size());
  for (size_t i = 0; i < wave.size(); ++i) wave_pairs_[i] = wave[i].slots;
  const size_t tasks = (wave.size() + kWaveTaskPairs - 1) / kWaveTaskPairs;
  workers_.for_blocks(static_cast<int>(tasks), [&](int index, int) {
    const size_t first = static_cast<size_t>(index) * kWaveTaskPairs;
    MidPhase& stage = stages_[static_cast<size_t>(index)];
    stage.begin(frame.parts, bodies_);
    stage.add(frame.parts,
              {wave_pairs_.data() + first, std::min(kWaveTaskPairs, wave.size() - first)});
  });
  tests_left_ -= wave.size();
  return tasks;
}

/// Drops pairs of bodies whose part boxes exceed the budget.
void BudgetedPass::cut_pairs(const Frame& frame, size_t tasks) {
  bool stop = time_is_up();
  for (size_t task = 0; task < tasks; ++task) {
    MidPhase& stage = stages_[task];
    size_t kept = 0;
    for (const BodyPair& pair : stage.parts().pairs()) {
      const uint64_t tests = box_tests(frame.parts, pair);
      stop = stop || tests > tests_left_;
      if (stop) {
        add(PairKey(pair.body_a, pair.body_b, kWholeBody, kWholeBody), PairLevel::kBox);
      } else {
        tests_left_ -= tests;
        ++kept;
      }
    }
    stage.parts().keep_pairs(frame.parts, kept);
  }
}

/// Drops pairs of parts whose volumes exceed the budget.
void BudgetedPass::cut_candidates(size_t tasks) {
  const bool stop = time_is_up();
  for (size_t task = 0; task < tasks; ++task) {
    MidPhase& stage = stages_[task];
    const auto candidates = stage.parts().candidates();
    const size_t kept = stop ? 0 : std::min<uint64_t>(candidates.size(), tests_left_);
    for (const Candidate& c : candidates.subspan(kept))
      add(stage.parts().key_of(c), PairLevel::kBox);
    tests_left_ -= kept;
    stage.parts().keep_candidates(kept);
    decided_[task] = kept;
  }
}

void BudgetedPass::cut_triangles(size_t tasks) {
  if (!options_.exact) return;
  const bool stop = time_is_up();
  for (size_t task = 0; task < tasks; ++task) {
    const std::span<const uint8_t> overlaps = stages_[task].overlaps();
    const auto hits = static_cast<uint64_t>(std::count(overlaps.begin(), overlaps.end(), 1));
    max_exact_[task] = stop ? 0 : std::min(hits, tests_left_);
    tests_left_ -= max_exact_[task];
  }
}

void BudgetedPass::report(const MidPhase& stage, size_t decided) {
  const PairLevel last = last_level(options_);
  const auto candidates = stage.parts().candidates();
  const auto overlaps = stage.overlaps();
  for (size_t i = 0; i < candidates.size(); ++i)
    if (overlaps[i])
      add(stage.parts().key_of(candidates[i]), i < decided ? last : PairLevel::kPartVolume);
}

/// Counting sort by body a, then comparisons by body b. Replaces indices by ids, ordered alike.
void BudgetedPass::sort_found(size_t bodies) {
  start_of_body_.resize(bodies + 2);
  std::fill_n(start_of_body_.data(), bodies + 2, 0u);
  for (size_t i = 0; i < found_count_; ++i) ++start_of_body_[size_t{found_[i].key.a()} + 2];
  std::partial_sum(start_of_body_.data(), start_of_body_.data() + bodies + 2,
                   start_of_body_.data());
  sorted_.resize(found_count_);
  for (size_t i = 0; i < found_count_; ++i)
    sorted_[start_of_body_[size_t{found_[i].key.a()} + 1]++] = found_[i];
  workers_.for_blocks(static_cast<int>((bodies + kSortBodies - 1) / kSortBodies), [&](int block,
                                                                                      int) {
    const size_t first = static_cast<size_t>(block) * kSortBodies;
    for (size_t body = first; body < std::min(bodies, first + kSortBodies); ++body)
      std::sort(sorted_.data() + start_of_body_[body], sorted_.data() + start_of_body_[body + 1],
                [](const KeyWithLevel& x, const KeyWithLevel& y) { return x.key < y.key; });
  });
}

void BudgetedPass::take_events(const BodiesView& bodies, PairEvents& events) {
  Stopwatch watch;
  sort_found(bodies.ids.size());
  std::swap(current_, previous_);
  current_.count = found_count_;
  current_.keys.resize(found_count_);
  current_.levels.resize(found_count_);
  reported_ = {};
  for (size_t i = 0; i < found_count_; ++i) {
    const auto& [key, level] = sorted_[i];
    current_.keys[i] =
        PairKey(bodies.ids[key.a()], bodies.ids[key.b()], key.part_a(), key.part_b());
    current_.levels[i] = level;
    ++reported_[level];
  }
  events.advance({current_.keys.data(), current_.count});
  level_events(events);
  events_ns_ = watch.lap_ns();
}

void BudgetedPass::archive(Archive& a, std::span<const PairKey> touching) {
  std::vector<uint8_t> last(levels().begin(), levels().end());
  a.resized(last, touching.size());
  if (!a.is_reading()) return;
  if (last.size() != touching.size())
    a.reject("a level for every pair", "another number of levels");
  for (const uint8_t level : last)
    if (level >= kPairLevels) a.reject("a level", std::to_string(level));
  current_.count = touching.size();
  current_.keys.resize(current_.count);
  current_.levels.resize(current_.count);
  std::copy(touching.begin(), touching.end(), current_.keys.data());
  std::copy(last.begin(), last.end(), current_.levels.data());
}

void BudgetedPass::finish(PairEvents& events) {
  std::swap(current_, previous_);
  current_.count = 0;
  events.advance({});
  level_events(events);
}

/// Events and the pairs of both frames have the same order, so one walk suffices.
void BudgetedPass::level_events(PairEvents& events) const {
  size_t current = 0, previous = 0;
  for (PairEvent& event : events.events_to_level()) {
    const bool begins = event.kind == EventKind::kBegin;
    size_t& at = begins ? current : previous;
    const Reported& in = begins ? current_ : previous_;
    while (in.keys[at] < event.pair) ++at;
    event.level = static_cast<PairLevel>(in.levels[at]);
  }
}

uint64_t BudgetedPass::times_grown() const {
  uint64_t sum = shared_.times_grown() + queue_.times_grown() + wave_pairs_.times_grown() +
                 bodies_.times_grown() + found_.times_grown() + sorted_.times_grown() +
                 start_of_body_.times_grown() + touched_.times_grown();
  for (const Reported* each : {&current_, &previous_})
    sum += each->keys.times_grown() + each->levels.times_grown();
  for (const MidPhase& stage : stages_) sum += stage.times_grown();
  return sum;
}

}  // namespace throng
