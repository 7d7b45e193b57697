// Construction, update and test of each volume over the parts of the adult; tests on lists of
// candidates of which 0, 10 or 100 % overlap.
#include <benchmark/benchmark.h>

#include <string>

#include "bench/micro/candidates.h"
#include "bench/micro/instructions.h"
#include "culling/volumes/volume_list.h"

namespace throng::bench {
namespace {

template <typename V>
void construct(benchmark::State& state) {
  const auto& parts = crowd_candidates().type().parts();
  const CountInstructions instructions(state, static_cast<int64_t>(parts.size()));
  for (auto _ : state)
    for (const PartShape& part : parts) {
      auto fitted = V::fit(part.points);
      benchmark::DoNotOptimize(fitted);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(parts.size()));
}

template <typename V>
std::vector<typename V::Fitted> fitted_parts() {
  std::vector<typename V::Fitted> out;
  for (const PartShape& part : crowd_candidates().type().parts())
    out.push_back(V::fit(part.points));
  return out;
}

template <typename V>
void update(benchmark::State& state) {
  const auto fitted = fitted_parts<V>();
  const std::vector<PartPose>& poses = crowd_candidates().poses();
  const CountInstructions instructions(state, static_cast<int64_t>(poses.size()));
  for (auto _ : state)
    for (size_t i = 0; i < poses.size(); ++i) {
      auto placed = V::place(fitted[i % fitted.size()], poses[i], 1.0f);
      benchmark::DoNotOptimize(placed);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(poses.size()));
}

template <typename V>
void update_from_vertices(benchmark::State& state) {
  const auto& parts = crowd_candidates().type().parts();
  const std::vector<PartPose>& poses = crowd_candidates().poses();
  const CountInstructions instructions(state, static_cast<int64_t>(poses.size()));
  for (auto _ : state)
    for (size_t i = 0; i < poses.size(); ++i) {
      auto placed = V::refit(parts[i % parts.size()].points, poses[i], 1.0f);
      benchmark::DoNotOptimize(placed);
    }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(poses.size()));
}

/// state.range(0): per cent of the pairs that overlap, spread evenly over the list.
template <typename V>
void test(benchmark::State& state) {
  struct Pair {
    uint32_t a, b;
    Eigen::Vector3f shift_m;
    float margin_m;
  };
  const Candidates& c = crowd_candidates();
  const auto fitted = fitted_parts<V>();
  std::vector<typename V::Placed> placed;
  for (size_t i = 0; i < c.poses().size(); ++i)
    placed.push_back(V::place(fitted[i % fitted.size()], c.poses()[i], 1.0f));
  std::vector<Pair> hits, misses, mixed;
  const auto sort_out = [&](const BodyPair& pair, uint32_t part_a, uint32_t part_b) {
    const Pair p{pair.pose_a + part_a, pair.pose_b + part_b, Eigen::Vector3f(pair.shift_m),
                 pair.shift_m[3]};
    const bool hit = V::overlaps(placed[p.a], placed[p.b], p.shift_m, p.margin_m);
    (hit ? hits : misses).push_back(p);
  };
  for (const Candidate& candidate : c.list())
    sort_out(c.pairs()[candidate.pair], candidate.part_a, candidate.part_b);
  // Boxes that overlap hardly miss with loose volumes; neighbours' other parts do.
  for (size_t i = 0; i < c.pairs().size() && misses.size() < 40'000; ++i)
    for (uint32_t part = 0; part < fitted.size(); ++part)
      sort_out(c.pairs()[i], part, (part * 7 + 3) % static_cast<uint32_t>(fitted.size()));
  const auto percent = static_cast<size_t>(state.range(0));
  const size_t count = 20'000;
  for (size_t i = 0; i < count; ++i) {
    const bool hit = i * percent / 100 != (i + 1) * percent / 100;
    const std::vector<Pair>& from = hit ? hits : misses;
    mixed.push_back(from[(i * 7919) % from.size()]);
  }
  size_t passed = 0;
  const CountInstructions instructions(state, static_cast<int64_t>(count));
  for (auto _ : state) {
    passed = 0;
    for (const Pair& p : mixed)
      passed += V::overlaps(placed[p.a], placed[p.b], p.shift_m, p.margin_m);
    benchmark::DoNotOptimize(passed);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(count));
  state.counters["passed"] = static_cast<double>(passed) / static_cast<double>(count);
}

template <typename V>
void add(const std::string& name) {
  benchmark::RegisterBenchmark((name + "/construct").c_str(), construct<V>);
  benchmark::RegisterBenchmark((name + "/update").c_str(), update<V>);
  if constexpr (RefittedVolume<V>)
    benchmark::RegisterBenchmark((name + "/update_from_vertices").c_str(), update_from_vertices<V>);
  benchmark::RegisterBenchmark((name + "/test").c_str(), test<V>)
      ->ArgName("hits_percent")
      ->Arg(0)
      ->Arg(10)
      ->Arg(100);
}

[[maybe_unused]] const bool kRegistered = [] {
  add<Sphere>("sphere");
  add<Aabb>("aabb");
  add<Obb>("obb");
  add<Kdop<14>>("kdop14");
  add<Kdop<18>>("kdop18");
  add<Kdop<26>>("kdop26");
  add<Ordop<14>>("ordop14");
  add<Ordop<18>>("ordop18");
  add<Ordop<26>>("ordop26");
  return true;
}();

}  // namespace
}  // namespace throng::bench
