#include "bench/paper/strategies.h"

#include <algorithm>
#include <cmath>

#include "bench/paper/census.h"
#include "culling/pair_search.h"
#include "culling/stopwatch.h"

namespace throng::paper {
namespace {

using Refined = Ordop<26>;

/// The widest register, in floats: kernels load whole registers at the last slot.
constexpr size_t kPadding = 16;

/// Runs shorter than kLongRun_ms are repeated until they have had kEnough_ms together.
constexpr int kMinRepetitions = 7;
constexpr int kMaxRepetitions = 1000;
constexpr double kEnough_ms = 100;
constexpr double kLongRun_ms = 300;

}  // namespace

BoxWorld part_two_world(const std::vector<Object>& objects, size_t count, uint64_t seed) {
  BoxWorldOptions options = part_one_box(seed);
  options.edge_m *= std::cbrt(static_cast<double>(count) / static_cast<double>(objects.size()));
  return world_of(objects, count, 2, options);
}

struct StrategyRun::State {
  State(Strategy strategy_in, const std::vector<Object>& objects_in, size_t count, uint64_t seed,
        SimdTarget simd)
      : strategy(strategy_in),
        objects(objects_in),
        n(static_cast<uint32_t>(count)),
        world(part_two_world(objects_in, count, seed)),
        kernels(kernels_for(simd)),
        margin(margin_m(objects_in, world)),
        fitted(fit_all<Turned<Refined>>(objects_in)),
        x(count + kPadding),
        y(count + kPadding),
        z(count + kPadding),
        radius(count + kPadding),
        placed(count),
        placed_in(count) {
    for (size_t i = 0; i < count; ++i) {
      // Half the margin each; a little more, so that the sum is no less.
      radius[i] =
          std::nextafter(static_cast<float>(objects[kind(i)].radius_m) + 0.5f * margin, 1e9f);
      everyone.push_back(static_cast<uint32_t>(i));
    }
  }

  size_t kind(size_t object) const { return object % objects.size(); }

  void update_spheres() {
    const auto positions = world.positions_m();
    for (size_t i = 0; i < n; ++i) {
      x[i] = static_cast<float>(positions[i].x());
      y[i] = static_cast<float>(positions[i].y());
      z[i] = static_cast<float>(positions[i].z());
    }
    work.sphere_updates += n;
  }
  void update_ordop(size_t i) {
    placed[i] = Refined::place(fitted[kind(i)], world.pose(i), 1.0f);
    ++work.ordop_updates;
  }
  void update_ordop_once(size_t i) {
    if (placed_in[i] == frames) return;
    placed_in[i] = frames;
    update_ordop(i);
  }
  bool spheres_overlap(size_t a, size_t b) const {
    const float dx = x[b] - x[a], dy = y[b] - y[a], dz = z[b] - z[a];
    const float reach = radius[a] + radius[b];
    return dx * dx + dy * dy + dz * dz <= reach * reach;
  }
  bool ordops_overlap(size_t a, size_t b) {
    ++work.ordop_tests;
    return Refined::overlaps(placed[a], placed[b], Eigen::Vector3f::Zero(), margin);
  }
  void make_room(size_t more) {
    if (pairs.size() < found + more) pairs.resize(2 * (found + more));
  }

  void sphere_pass() {
    update_spheres();
    const SphereRows rows{x.data(), y.data(), z.data(), radius.data(), radius.data()};
    for (uint32_t a = 0; a + 1 < n; ++a) {
      make_room(n - a + kPadding);
      found += kernels.sphere_run(rows, a, a + 1, n, pairs.data() + found);
    }
    work.sphere_tests += uint64_t{n} * (n - 1) / 2;
  }
  void grid_pass() {
    update_spheres();
    search_bodies.resize(n);
    for (size_t i = 0; i < n; ++i) {
      // A rectangle that never separates: the strategies know spheres only.
      constexpr float kEverywhere = 1e18f;
      search_bodies[i] = {x[i], y[i], z[i], radius[i],   radius[i],  0,
                          0,    1,    0,    kEverywhere, kEverywhere};
    }
    search.build(PairSearch::kGrid, search_bodies, everyone, workers);
    for (size_t block = 0; block < search.block_count(); ++block) {
      const PairSearcher::Found in_block = search.search_block(kernels, block, block_pairs);
      const size_t count = in_block.pairs;
      work.sphere_tests += in_block.tests;
      make_room(count);
      for (size_t i = 0; i < count; ++i) {
        const uint32_t a = search.body_of_slot(block_pairs[i].a);
        const uint32_t b = search.body_of_slot(block_pairs[i].b);
        pairs[found++] = {std::min(a, b), std::max(a, b)};
      }
    }
  }
  /// The second pass: keeps the pairs whose or-DOPs overlap.
  void refine() {
    size_t kept = 0;
    for (size_t i = 0; i < found; ++i) {
      const SlotPair pair = pairs[i];
      update_ordop_once(pair.a);
      update_ordop_once(pair.b);
      if (ordops_overlap(pair.a, pair.b)) pairs[kept++] = pair;
    }
    found = kept;
  }
  void ordop_all() {
    for (uint32_t i = 0; i < n; ++i) update_ordop(i);
    for (uint32_t a = 0; a < n; ++a) {
      make_room(n - a);
      for (uint32_t b = a + 1; b < n; ++b)
        if (ordops_overlap(a, b)) pairs[found++] = {a, b};
    }
  }
  void hybrid_one() {
    update_spheres();
    make_room(n);
    work.sphere_tests += n - 1;
    for (uint32_t b = 1; b < n; ++b) {
      if (!spheres_overlap(0, b)) continue;
      update_ordop_once(0);
      update_ordop_once(b);
      if (ordops_overlap(0, b)) pairs[found++] = {0, b};
    }
  }
  void hybrid_all() {
    update_spheres();
    for (uint32_t i = 0; i < n; ++i) update_ordop(i);
    work.sphere_tests += uint64_t{n} * (n - 1) / 2;
    for (uint32_t a = 0; a < n; ++a) {
      make_room(n - a);
      for (uint32_t b = a + 1; b < n; ++b)
        if (spheres_overlap(a, b) && ordops_overlap(a, b)) pairs[found++] = {a, b};
    }
  }
  void cull() {
    switch (strategy) {
      case Strategy::kControl:
        return;
      case Strategy::kSphere:
        return sphere_pass();
      case Strategy::kOrdop:
        return ordop_all();
      case Strategy::kHybridOne:
        return hybrid_one();
      case Strategy::kHybridAll:
        return hybrid_all();
      case Strategy::kTwoPass:
        sphere_pass();
        return refine();
      case Strategy::kTwoPassGrid:
        grid_pass();
        refine();
        std::sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(found),
                  [](const SlotPair& p, const SlotPair& q) {
                    return p.a != q.a ? p.a < q.a : p.b < q.b;
                  });
        return;
    }
  }

  Strategy strategy;
  const std::vector<Object>& objects;
  uint32_t n;
  BoxWorld world;
  const Kernels& kernels;
  float margin;
  std::vector<Slabs> fitted;  ///< one a kind, shared by its objects
  std::vector<TriangleBvh> surfaces;
  std::vector<float> x, y, z, radius;
  std::vector<Refined::Placed> placed;
  std::vector<int64_t> placed_in;  ///< the frame of the last update; frames count from 1
  std::vector<uint32_t> everyone;
  PairSearcher search;
  std::vector<PlacedBody> search_bodies;
  Workers workers{1};
  GrowBuffer<SlotPair> block_pairs;
  std::vector<SlotPair> pairs;
  size_t found = 0;
  int64_t frames = 0;
  Work work;
};

StrategyRun::StrategyRun(Strategy strategy, const std::vector<Object>& objects, size_t count,
                         uint64_t seed, SimdTarget simd)
    : state_(std::make_unique<State>(strategy, objects, count, seed, simd)) {}
StrategyRun::~StrategyRun() = default;

void StrategyRun::frame() {
  State& s = *state_;
  s.world.step();
  ++s.frames;
  s.found = 0;
  s.cull();
  s.work.passed += s.found;
}

std::span<const SlotPair> StrategyRun::pairs() const {
  return {state_->pairs.data(), state_->found};
}
const Work& StrategyRun::work() const { return state_->work; }
const BoxWorld& StrategyRun::world() const { return state_->world; }

size_t StrategyRun::count_primitives() {
  State& s = *state_;
  if (s.surfaces.empty()) s.surfaces = fit_all<Triangles>(s.objects);
  ExactCounters counters;
  size_t touching = 0;
  for (const SlotPair& pair : pairs())
    touching += solids_touch(s.surfaces[s.kind(pair.a)], s.world.pose(pair.a), 1,
                             s.surfaces[s.kind(pair.b)], s.world.pose(pair.b), 1,
                             Eigen::Vector3f::Zero(), counters);
  s.work.primitives += counters.node_tests + counters.triangle_tests;
  return touching;
}

StrategyResult measure_strategy(Strategy strategy, const std::vector<Object>& objects, size_t count,
                                int frames, uint64_t seed) {
  StrategyResult result{count, frames, {}, 0};
  double first_ms = 0;
  {
    StrategyRun run(strategy, objects, count, seed);
    for (int frame = 0; frame < frames; ++frame) {
      Stopwatch watch;
      run.frame();
      first_ms += watch.lap_ns() * 1e-6;
      run.count_primitives();
    }
    result.work = run.work();
  }
  result.frame_ms = first_ms / frames;
  // Where the exact test's traces in the caches would show, runs without it are short.
  if (first_ms > kLongRun_ms) return result;
  double best_ms = first_ms, spent_ms = 0;
  for (int repetition = 0; repetition < kMaxRepetitions; ++repetition) {
    if (repetition >= kMinRepetitions && spent_ms > kEnough_ms) break;
    StrategyRun run(strategy, objects, count, seed);
    Stopwatch watch;
    for (int frame = 0; frame < frames; ++frame) run.frame();
    const double run_ms = watch.lap_ns() * 1e-6;
    spent_ms += run_ms;
    best_ms = std::min(best_ms, run_ms);
  }
  result.frame_ms = best_ms / frames;
  return result;
}

}  // namespace throng::paper
