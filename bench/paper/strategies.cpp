#include "bench/paper/strategies.h"

#include <algorithm>
#include <cmath>

#include "bench/paper/census.h"
#include "bench/workbench/repeat.h"
#include "culling/fitted.h"
#include "culling/strategies/paper_search.h"

namespace throng::paper {
namespace {

/// Runs shorter than kLongRun_ms are repeated until their sum reaches kMinTotal_ms.
constexpr int kMinRepetitions = 7;
constexpr int kMaxRepetitions = 1000;
constexpr double kMinTotal_ms = 100;
constexpr double kLongRun_ms = 300;

}  // namespace

BoxDynamics part_two_world(const std::vector<Object>& objects, size_t count, uint64_t seed) {
  BoxOptions options = part_one_box(objects, seed);
  options.edge_m *= std::cbrt(static_cast<double>(count) / static_cast<double>(objects.size()));
  return world_of(objects, count, 2, options);
}

namespace {

std::unique_ptr<PaperSearch> recipe_of(Strategy strategy, SimdTarget simd, BodyTypes types) {
  CullerOptions options;
  options.part_volume = VolumeKind::kOrdop26;
  options.pair_search = strategy == Strategy::kTwoPassGrid ? PairSearch::kGrid : PairSearch::kBrute;
  options.simd = simd;
  constexpr std::array<throng::Strategy, kStrategies.size()> kRecipes = {
      throng::Strategy::kNone,      throng::Strategy::kSphere,    throng::Strategy::kVolume,
      throng::Strategy::kHybridOne, throng::Strategy::kHybridAll, throng::Strategy::kTwoPass,
      throng::Strategy::kTwoPass};
  return PaperSearch::make(kRecipes[static_cast<size_t>(strategy)], options, types);
}

std::vector<std::shared_ptr<const BodyType>> types_of(const std::vector<Object>& objects) {
  std::vector<std::shared_ptr<const BodyType>> types;
  for (const Object& object : objects) types.push_back(object.type);
  return types;
}

}  // namespace

struct StrategyRun::State : PoseSource {
  State(Strategy strategy, const std::vector<Object>& objects, size_t count, uint64_t seed,
        SimdTarget simd)
      : world(part_two_world(objects, count, seed)),
        types(types_of(objects)),
        scales(count, 1.0f),
        roots(count),
        recipe(recipe_of(strategy, simd, types)) {
    for (size_t i = 0; i < count; ++i) {
      ids.push_back(static_cast<uint32_t>(i));
      kinds.push_back(static_cast<uint16_t>(i % objects.size()));
    }
  }

  void poses(std::span<const uint32_t> bodies, std::span<PartPose> out) const override {
    for (size_t i = 0; i < bodies.size(); ++i) {
      out[i] = world.pose(bodies[i]);
      for (float(&row)[4] : out[i].rows) row[3] = 0;  // relative to the body's own root
    }
  }

  BoxDynamics world;
  std::vector<std::shared_ptr<const BodyType>> types;
  std::vector<uint32_t> ids;
  std::vector<uint16_t> kinds;
  std::vector<float> scales;
  std::vector<RootPose> roots;
  std::unique_ptr<PaperSearch> recipe;
  Work work;
};

StrategyRun::StrategyRun(Strategy strategy, const std::vector<Object>& objects, size_t count,
                         uint64_t seed, SimdTarget simd)
    : state_(std::make_unique<State>(strategy, objects, count, seed, simd)) {}
StrategyRun::~StrategyRun() = default;

void StrategyRun::frame() {
  State& s = *state_;
  s.world.step();
  for (size_t i = 0; i < s.roots.size(); ++i) s.roots[i].position_m = s.world.positions_m()[i];
  s.recipe->run({s.ids, s.kinds, s.scales, s.roots}, s);
  s.work.sphere_updates += s.recipe->spheres().updates;
  s.work.sphere_tests += s.recipe->spheres().tests;
  s.work.ordop_updates += s.recipe->volumes().updates;
  s.work.ordop_tests += s.recipe->volumes().tests;
  s.work.passed += s.recipe->pairs().size();
}

std::vector<SlotPair> StrategyRun::pairs() const {
  std::vector<SlotPair> pairs;
  for (const PairKey& pair : state_->recipe->pairs()) pairs.push_back({pair.a(), pair.b()});
  return pairs;
}
const Work& StrategyRun::work() const { return state_->work; }
const BoxDynamics& StrategyRun::world() const { return state_->world; }

size_t StrategyRun::count_primitives() {
  State& s = *state_;
  TriangleCounters counters;
  size_t touching = 0;
  const auto surface = [&](uint32_t body) -> const TriangleBvh& {
    return s.types[s.kinds[body]]->volumes().surfaces().front();
  };
  for (const SlotPair& pair : pairs())
    touching += solids_touch(surface(pair.a), s.world.pose(pair.a), 1, surface(pair.b),
                             s.world.pose(pair.b), 1, Eigen::Vector3f::Zero(), counters);
  s.work.primitives += counters.node_tests + counters.triangle_tests;
  return touching;
}

namespace {

void sum_up(StrategyResult& result, std::vector<double> samples_ms) {
  std::sort(samples_ms.begin(), samples_ms.end());
  const size_t last = samples_ms.size() - 1;
  result.median_ms = samples_ms[last / 2];
  result.low_ms = samples_ms[last / 10];
  result.high_ms = samples_ms[last - last / 10];
  result.samples = static_cast<int>(samples_ms.size());
}

}  // namespace

StrategyResult measure_strategy(Strategy strategy, const std::vector<Object>& objects, size_t count,
                                int frames, uint64_t seed) {
  StrategyResult result;
  result.objects = count;
  result.frames = frames;
  double first_ms = 0;
  std::vector<double> samples_ms;
  {
    StrategyRun run(strategy, objects, count, seed);
    for (int frame = 0; frame < frames; ++frame) {
      bench::ThreadClock watch;
      run.frame();
      samples_ms.push_back(watch.lap_ns() * 1e-6);
      first_ms += samples_ms.back();
      run.count_primitives();
    }
    result.work = run.work();
  }
  result.frame_ms = first_ms / frames;
  // Short runs are repeated without the exact test, because it would disturb their caches.
  if (first_ms > kLongRun_ms) {
    sum_up(result, std::move(samples_ms));
    return result;
  }
  samples_ms.clear();
  double spent_ms = 0;
  for (int repetition = 0; repetition < kMaxRepetitions; ++repetition) {
    if (repetition >= kMinRepetitions && spent_ms > kMinTotal_ms) break;
    StrategyRun run(strategy, objects, count, seed);
    bench::ThreadClock watch;
    for (int frame = 0; frame < frames; ++frame) run.frame();
    const double run_ms = watch.lap_ns() * 1e-6;
    spent_ms += run_ms;
    samples_ms.push_back(run_ms / frames);
  }
  result.frame_ms = *std::min_element(samples_ms.begin(), samples_ms.end());
  sum_up(result, std::move(samples_ms));
  return result;
}

}  // namespace throng::paper
