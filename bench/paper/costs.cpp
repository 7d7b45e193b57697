#include "bench/paper/costs.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "bench/paper/census.h"
#include "bench/workbench/thread_clock.h"

namespace throng::paper {
namespace {

using bench::repeat;
using bench::shuffle;
using bench::ThreadClock;
using bench::use;

/// The exact test's tree is not the paper's, and takes longer than all its volumes together.
constexpr int kTreeConstructions = 10;
struct Inputs {
  struct Pose {
    uint32_t object;
    PartPose pose;
  };
  struct Pair {
    uint32_t a, b;  ///< indices into poses
  };
  std::vector<Pose> poses;  ///< shuffled
  std::vector<Pair> pairs;  ///< shuffled
  float margin_m = 0;
};

Inputs record_inputs(const std::vector<Object>& objects, int frames, uint64_t seed) {
  BoxWorld world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  const auto count = static_cast<uint32_t>(objects.size());
  Inputs inputs;
  inputs.margin_m = margin_m(objects, world);
  const uint32_t poses = count * static_cast<uint32_t>(frames - 1);
  std::vector<uint32_t> place(poses);  // where a pose goes
  for (uint32_t i = 0; i < poses; ++i) place[i] = i;
  shuffle(place, seed);
  inputs.poses.resize(poses);
  for (uint32_t first = 0; first < poses; first += count) {
    world.step();
    for (uint32_t a = 0; a < count; ++a) {
      inputs.poses[place[first + a]] = {a, world.pose(a)};
      for (uint32_t b = a + 1; b < count; ++b)
        inputs.pairs.push_back({place[first + a], place[first + b]});
    }
  }
  shuffle(inputs.pairs, seed);
  return inputs;
}

template <typename Method>
void measure_construction(const std::vector<Object>& objects, int repetitions, MethodCosts& costs) {
  std::vector<std::vector<double>> by_object(objects.size());
  std::vector<double> all;
  if (std::is_same_v<Method, Triangles>) repetitions = std::min(repetitions, kTreeConstructions);
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    double sum_ns = 0;
    for (size_t i = 0; i < objects.size(); ++i) {
      ThreadClock watch;
      const auto fitted = Method::fit(objects[i]);
      use(&fitted);
      by_object[i].push_back(watch.lap_ns());
      sum_ns += by_object[i].back();
    }
    all.push_back(sum_ns);
  }
  for (std::vector<double>& samples : by_object)
    costs.construction.push_back(cost_of(std::move(samples)));
  costs.construction_all = cost_of(std::move(all));
}

template <typename Method>
void measure_motion(const std::vector<Object>& objects, const Inputs& inputs, MethodCosts& costs) {
  const auto fitted = fit_all<Method>(objects);
  std::vector<typename Method::Placed> placed;
  placed.reserve(inputs.poses.size());
  costs.update = repeat(inputs.poses.size(), [&] {
    placed.clear();
    for (const Inputs::Pose& p : inputs.poses)
      placed.push_back(Method::update(fitted[p.object], objects[p.object], p.pose));
    use(placed.data());
  });
  ExactCounters primitives;
  uint64_t runs = 0;
  costs.test = repeat(inputs.pairs.size(), [&] {
    uint64_t hits = 0;
    for (const Inputs::Pair& pair : inputs.pairs)
      hits += Method::test(placed[pair.a], placed[pair.b], inputs.margin_m, primitives);
    use(&hits);
    ++runs;
  });
  const uint64_t tests = primitives.node_tests + primitives.triangle_tests;
  if (tests > 0)
    costs.primitive_ns = costs.test.median_ns * static_cast<double>(inputs.pairs.size() * runs) /
                         static_cast<double>(tests);
}

/// Milliseconds of one run: motion, updates, tests.
template <typename Method>
double run_ms(const std::vector<Object>& objects, int frames, uint64_t seed) {
  const auto fitted = fit_all<Method>(objects);
  BoxWorld world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  const float margin = margin_m(objects, world);
  std::vector<typename Method::Placed> placed;
  placed.reserve(objects.size());
  ExactCounters primitives;
  uint64_t hits = 0;
  ThreadClock watch;
  for (int frame = 1; frame < frames; ++frame) {
    world.step();
    placed.clear();
    for (size_t i = 0; i < objects.size(); ++i)
      placed.push_back(Method::update(fitted[i], objects[i], world.pose(i)));
    for (size_t a = 0; a < objects.size(); ++a)
      for (size_t b = a + 1; b < objects.size(); ++b)
        hits += Method::test(placed[a], placed[b], margin, primitives);
  }
  use(&hits);
  return watch.lap_ns() * 1e-6;
}

}  // namespace

std::array<MethodCosts, kMethods.size()> measure_costs(const std::vector<Object>& objects,
                                                       int frames, uint64_t seed,
                                                       int constructions) {
  const Inputs inputs = record_inputs(objects, frames, seed);
  std::array<MethodCosts, kMethods.size()> costs;
  for_each_method([&](size_t index, auto method) {
    measure_construction<decltype(method)>(objects, constructions, costs[index]);
    measure_motion<decltype(method)>(objects, inputs, costs[index]);
    for (size_t i = 0; i < kRunLengths.size(); ++i)
      costs[index].run_ms[i] = run_ms<decltype(method)>(objects, kRunLengths[i] * frames, seed);
  });
  return costs;
}

}  // namespace throng::paper
