#include "bench/paper/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "base/random.h"
#include "bench/workbench/repeat.h"

namespace throng::paper {
namespace {

using bench::repeat;
using bench::shuffle;
using bench::ThreadClock;
using bench::use;

/// The exact test's tree is not part of the paper, and building it takes longer than all volumes.
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
  BoxDynamics world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  const auto count = static_cast<uint32_t>(objects.size());
  Inputs inputs;
  inputs.margin_m = margin_m(objects, world);
  const uint32_t poses = count * static_cast<uint32_t>(frames - 1);
  std::vector<uint32_t> place(poses);  // shuffled position of each pose
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
  TriangleCounters primitives;
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

/// Measures the milliseconds of one run: motion, updates, tests.
template <typename Method>
double run_ms(const std::vector<Object>& objects, int frames, uint64_t seed) {
  const auto fitted = fit_all<Method>(objects);
  BoxDynamics world = world_of(objects, objects.size(), 0, part_one_box(objects, seed));
  const float margin = margin_m(objects, world);
  std::vector<typename Method::Placed> placed;
  placed.reserve(objects.size());
  TriangleCounters primitives;
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

namespace {

constexpr int kPlaces = 100;  // per pair of attitudes
constexpr size_t kBatches = 10;

/// Draws a uniformly distributed rotation (Shoemake 1992).
Eigen::Quaterniond any_attitude(const RandomKey& key, uint32_t& index) {
  const double u = random_uniform(key, index++);
  const double p = 2 * std::numbers::pi * random_uniform(key, index++);
  const double q = 2 * std::numbers::pi * random_uniform(key, index++);
  const double r = std::sqrt(1 - u), s = std::sqrt(u);
  return {s * std::cos(q), r * std::sin(p), r * std::cos(p), s * std::sin(q)};
}

PartPose pose_of(const Eigen::Quaterniond& attitude) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = attitude.toRotationMatrix();
  return to_part_pose(pose);
}

struct Trial {
  PartPose a, b;
  std::array<Eigen::Vector3f, kPlaces> b_at_m;
};

Trial draw_trial(uint64_t seed, size_t pair, int attitude, double half_edge_m) {
  const RandomKey key{seed, pair, 2 + static_cast<uint64_t>(attitude), Purpose::kBoxWorld};
  uint32_t index = 0;
  Trial trial;
  trial.a = pose_of(any_attitude(key, index));
  trial.b = pose_of(any_attitude(key, index));
  for (Eigen::Vector3f& at : trial.b_at_m)
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = static_cast<float>(random_uniform(key, -half_edge_m, half_edge_m, index++));
  return trial;
}

template <typename Method>
int hits_of(const typename Method::Fitted& fit_a, const Object& a,
            const typename Method::Fitted& fit_b, const Object& b, const Trial& trial,
            float margin_m, TriangleCounters& unused) {
  const auto placed_a = Method::update(fit_a, a, trial.a);
  const auto placed_b = Method::update(fit_b, b, trial.b);
  int hits = 0;
  for (const Eigen::Vector3f& at : trial.b_at_m)
    hits += Method::test_at(placed_a, placed_b, at, margin_m, unused);
  return hits;
}

template <typename Method>
OverlapVolume measure(const std::vector<Object>& objects, int attitudes, uint64_t seed) {
  const auto fitted = fit_all<Method>(objects);
  OverlapVolume out;
  out.by_object_l.resize(objects.size());
  std::array<double, kBatches> batches{};
  TriangleCounters unused;
  size_t pair = 0;
  for (size_t a = 0; a < objects.size(); ++a) {
    for (size_t b = a + 1; b < objects.size(); ++b, ++pair) {
      // The box around a turned box around a sphere reaches up to sqrt(3) times its radius.
      const double reach_m = std::sqrt(3.0) * (objects[a].radius_m + objects[b].radius_m);
      const double cube_l = 8e3 * reach_m * reach_m * reach_m;
      const auto margin_m = rounding_margin_m(static_cast<float>(4 * reach_m));
      double sum_l = 0;
      for (int attitude = 0; attitude < attitudes; ++attitude) {
        const Trial trial = draw_trial(seed, pair, attitude, reach_m);
        const double litres =
            cube_l / kPlaces *
            hits_of<Method>(fitted[a], objects[a], fitted[b], objects[b], trial, margin_m, unused);
        sum_l += litres;
        batches[static_cast<size_t>(attitude) % kBatches] += litres;
      }
      sum_l /= attitudes;
      out.litres += sum_l;
      for (const size_t object : {a, b})
        out.by_object_l[object] += sum_l / static_cast<double>(objects.size() - 1);
    }
  }
  const auto pairs = static_cast<double>(pair);
  out.litres /= pairs;
  double square = 0;
  for (const double batch : batches) {
    const double off = batch * kBatches / (attitudes * pairs) - out.litres;
    square += off * off;
  }
  out.error_l = std::sqrt(square / (kBatches * (kBatches - 1)));
  return out;
}

}  // namespace

OverlapTable measure_overlap(const std::vector<Object>& objects, int attitudes, uint64_t seed) {
  OverlapTable table;
  for_each_method([&](size_t index, auto method) {
    table[index] = measure<decltype(method)>(objects, attitudes, seed);
  });
  return table;
}

double elongation(const Object& object) {
  Eigen::Vector3f low = object.shape.points.front(), high = low;
  for (const Eigen::Vector3f& point : object.shape.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  const Eigen::Vector3f sides = high - low;
  return static_cast<double>(sides.maxCoeff() / sides.minCoeff());
}

namespace {

/// The paper's three sizes and larger ones, where a grid outperforms all other strategies.
constexpr std::array<size_t, 9> kSizes = {15, 50, 150, 350, 500, 1000, 2000, 5000, 10000};
/// The paper's first 100 frames.
constexpr int kFrames = 100;
constexpr int kFramesAboveMany = 10;
/// Above this number of objects, few frames suffice.
constexpr size_t kMany = 1000;

int frames_for(size_t objects) { return objects > kMany ? kFramesAboveMany : kFrames; }

double cost_ms(uint64_t count, const Cost& cost) {
  return static_cast<double>(count) * cost.median_ns * 1e-6;
}

void fill_collisions(std::vector<VolumeResult>& volumes, const std::vector<CensusTable>& censuses) {
  const auto runs = static_cast<double>(censuses.size());
  for (size_t v = 0; v < volumes.size(); ++v) {
    VolumeResult& volume = volumes[v];
    uint64_t found = 0, wrong = 0;
    for (const CensusTable& table : censuses) {
      found += table[v].collisions[kMarks - 1];
      wrong += table[v].false_positives;
      volume.missed += table[v].missed;
      for (size_t mark = 0; mark < kMarks; ++mark)
        volume.collisions[mark] += static_cast<double>(table[v].collisions[mark]) / runs;
    }
    for (size_t mark = 0; mark < kMarks; ++mark) {
      double sum = 0;
      for (const CensusTable& table : censuses) {
        const double off = static_cast<double>(table[v].collisions[mark]) - volume.collisions[mark];
        sum += off * off;
      }
      volume.deviation[mark] = runs > 1 ? std::sqrt(sum / (runs - 1)) : 0;
    }
    volume.census = censuses.front()[v];
    volume.false_positive_rate =
        found == 0 ? 0 : static_cast<double>(wrong) / static_cast<double>(found);
  }
}

StrategyCost cost_strategy(const PaperResult& result, Strategy strategy,
                           const std::vector<Object>& objects, size_t count) {
  const VolumeResult& sphere = result.volumes[kSphereMethod];
  const VolumeResult& ordop = result.volumes[kOrdop26Method];
  StrategyCost cost;
  cost.strategy = strategy;
  cost.result = measure_strategy(strategy, objects, count, frames_for(count), result.options.seed);
  const Work& work = cost.result.work;
  cost.culling_ms = cost_ms(work.sphere_updates, sphere.costs.update) +
                    cost_ms(work.sphere_tests, sphere.costs.test) +
                    cost_ms(work.ordop_updates, ordop.costs.update) +
                    cost_ms(work.ordop_tests, ordop.costs.test);
  // Volumes are fitted once per kind of object.
  if (strategy != Strategy::kControl && strategy != Strategy::kOrdop)
    cost.built_ms += sphere.costs.construction_all.median_ns * 1e-6;
  if (strategy != Strategy::kControl && strategy != Strategy::kSphere)
    cost.built_ms += ordop.costs.construction_all.median_ns * 1e-6;
  cost.exact_ms = static_cast<double>(work.primitives) * result.primitive_ns * 1e-6;
  return cost;
}

}  // namespace

double VolumeResult::total_ms(int length) const { return runs_ms(census.updates, length); }

double VolumeResult::total_paper_count_ms(int length) const {
  return runs_ms(census.updates_paper(), length);
}

double VolumeResult::runs_ms(uint64_t updates, int length) const {
  // Frame 0 is never tested, for any length of the run.
  const double runs = (static_cast<double>(length) * frames - 1) / (frames - 1);
  return runs * (cost_ms(updates, costs.update) + cost_ms(census.tests, costs.test)) +
         costs.construction_all.median_ns * 1e-6;
}

const Scale* PaperResult::scale(size_t object_count) const {
  for (const Scale& each : scales)
    if (each.objects == object_count) return &each;
  return nullptr;
}

double PaperResult::noise() const {
  std::vector<double> ratios;
  for (const Scale& each : scales)
    for (const StrategyCost& cost : each.strategies)
      if (cost.result.low_ms > 0) ratios.push_back(cost.result.high_ms / cost.result.low_ms);
  if (ratios.empty()) return 1;
  std::sort(ratios.begin(), ratios.end());
  return ratios[(ratios.size() - 1) / 2];
}

std::string PaperResult::frame_in_words() const {
  return fmt::format("{} updates, {} tests", objects.size(),
                     objects.size() * (objects.size() - 1) / 2);
}

double PaperResult::frame_ns(const VolumeResult& volume) const {
  const auto count = static_cast<double>(objects.size());
  return count * volume.costs.update.median_ns +
         count * (count - 1) / 2 * volume.costs.test.median_ns;
}

PaperResult run_experiments(const std::vector<Object>& objects, const PaperOptions& options,
                            const std::function<void(const std::string&)>& announce,
                            const std::function<void(const PaperResult&)>& keep) {
  PaperResult result;
  const auto finished = [&](CompletedStage stage) {
    result.done = stage;
    if (keep) keep(result);
  };
  result.options = options;
  result.edge_m = part_one_box(objects, options.seed).edge_m;
  for (const Object& object : objects) {
    result.objects.push_back(object.name);
    result.elongations.push_back(elongation(object));
  }
  for (const std::string_view name : kMethods) {
    result.volumes.emplace_back();
    result.volumes.back().name = name;
    result.volumes.back().frames = options.frames;
  }

  announce(
      fmt::format("Part I: collisions over {} frames, {} seeds", options.frames, options.seeds));
  Workers workers(options.threads);
  const std::vector<CensusTable> censuses =
      take_censuses(objects, options.frames, options.seed, options.seeds, workers);
  fill_collisions(result.volumes, censuses);
  const CensusTable long_run =
      take_census(objects, kRunLengths.back() * options.frames, options.seed);
  for (size_t v = 0; v < result.volumes.size(); ++v)
    result.volumes[v].long_collisions = long_run[v].collisions;
  finished(CompletedStage::kCollisions);

  announce("Part I: overlap volumes");
  const OverlapTable overlaps = measure_overlap(objects, options.attitudes, options.seed);
  for (size_t v = 0; v < result.volumes.size(); ++v) result.volumes[v].overlap = overlaps[v];
  finished(CompletedStage::kOverlapVolumes);

  announce("Part I: costs of construction, update and test");
  const auto costs = measure_costs(objects, options.frames, options.seed, options.constructions);
  for (size_t v = 0; v < result.volumes.size(); ++v) result.volumes[v].costs = costs[v];
  result.primitive_ns = costs[kExactMethod].primitive_ns;
  finished(CompletedStage::kCosts);

  for (const size_t size : kSizes) {
    if (size > options.max_objects) break;
    announce(fmt::format("Part II: {} objects", size));
    Scale scale{size, {}};
    for (size_t s = 0; s < kStrategies.size(); ++s)
      scale.strategies.push_back(cost_strategy(result, static_cast<Strategy>(s), objects, size));
    result.scales.push_back(std::move(scale));
    finished(CompletedStage::kCosts);
  }
  result.claims = judge(result, censuses);
  result.winners = find_winners(result.scales);
  finished(CompletedStage::kAll);
  return result;
}

namespace {

size_t method_of(std::string_view name) {
  return static_cast<size_t>(std::find(kMethods.begin(), kMethods.end(), name) - kMethods.begin());
}

bool compare(double left, double right, const std::string& relation) {
  return relation == ">" ? left > right : left >= right;
}

Claim collision_claim(const PaperResult& result, std::span<const CensusTable> censuses,
                      const std::string& left, const std::string& relation,
                      const std::string& right) {
  const size_t l = method_of(left), r = method_of(right);
  Claim claim{"Table 2", left, right, 0, 0, relation, 0, false};
  claim.left_value = result.volumes[l].collisions.back();
  claim.right_value = result.volumes[r].collisions.back();
  claim.holds = compare(claim.left_value, claim.right_value, relation);
  size_t count = 0;
  for (const CensusTable& table : censuses)
    count += compare(static_cast<double>(table[l].collisions.back()),
                     static_cast<double>(table[r].collisions.back()), relation);
  claim.share = static_cast<double>(count) / static_cast<double>(censuses.size());
  return claim;
}

void judge_table_2(const PaperResult& result, std::span<const CensusTable> censuses,
                   std::vector<Claim>& claims) {
  const auto add = [&](const std::string& left, const char* relation, const std::string& right) {
    claims.push_back(collision_claim(result, censuses, left, relation, right));
  };
  for (const char* aabb : {"aabb", "aabb_turned"}) {
    add("sphere", ">", aabb);
    add(aabb, ">", "obb");
  }
  for (const char* k : {"14", "18", "26"}) {
    const std::string ordop = std::string("ordop") + k;
    for (const char* rule : {"", "_refit"}) {
      const std::string kdop = std::string("kdop") + k + rule;
      add("obb", ">", kdop);
      add(kdop, ">=", ordop);
    }
    add(ordop, ">=", "exact");
  }
}

/// The headline of Part I, Table 3 with Fig. 9 and 10: the sphere has the lowest T, the or-DOP the
/// second lowest; with and without the cost of construction.
void judge_table_3(const PaperResult& result, std::vector<Claim>& claims) {
  for (const int length : {kRunLengths.front(), kRunLengths.back()})
    for (const bool is_built : {true, false}) {
      const auto total_ms = [&](const std::string& name) {
        const VolumeResult& volume = result.volumes[method_of(name)];
        return volume.total_ms(length) -
               (is_built ? 0 : volume.costs.construction_all.median_ns * 1e-6);
      };
      const auto add = [&](const std::string& more, const std::string& less) {
        Claim claim{fmt::format("Table 3, T in ms {} C_o, {} frames", is_built ? "with" : "without",
                                length * result.options.frames),
                    more,
                    less,
                    total_ms(more),
                    total_ms(less),
                    ">",
                    0,
                    false};
        claim.holds = compare(claim.left_value, claim.right_value, claim.relation);
        claim.share = claim.holds ? 1 : 0;
        claims.push_back(claim);
      };
      add("ordop26", "sphere");
      for (const char* other : {"kdop26", "kdop26_refit", "aabb_turned", "aabb", "obb"}) {
        add(other, "sphere");
        add(other, "ordop26");
      }
    }
}

/// The strategies of Fig. 13, from the fastest to the slowest.
constexpr std::array<Strategy, 6> kFigure13 = {Strategy::kControl,   Strategy::kHybridOne,
                                               Strategy::kSphere,    Strategy::kTwoPass,
                                               Strategy::kHybridAll, Strategy::kOrdop};

void judge_figure_13(const Scale& scale, std::vector<Claim>& claims) {
  const auto cost = [&](Strategy s) -> const StrategyCost& {
    return scale.strategies[static_cast<size_t>(s)];
  };
  for (size_t i = 0; i + 1 < kFigure13.size(); ++i) {
    const StrategyCost& fast = cost(kFigure13[i]);
    const StrategyCost& slow = cost(kFigure13[i + 1]);
    const std::string objects = std::to_string(scale.objects) + " objects, ";
    const auto per_frame = [](const StrategyCost& each) {
      return each.culling_ms / each.result.frames;
    };
    Claim counted{"Fig. 13, " + objects + "counted ms per frame",
                  slow.name(),
                  fast.name(),
                  0,
                  0,
                  ">=",
                  0,
                  false};
    counted.left_value = per_frame(slow);
    counted.right_value = per_frame(fast);
    Claim measured{"Fig. 13, " + objects + "measured frames/s",
                   fast.name(),
                   slow.name(),
                   0,
                   0,
                   ">=",
                   0,
                   false};
    measured.left_value = fast.result.fps();
    measured.right_value = slow.result.fps();
    for (Claim* claim : {&counted, &measured}) {
      claim->holds = claim->left_value >= claim->right_value;
      claim->share = claim->holds ? 1 : 0;
      claims.push_back(*claim);
    }
  }
}

bool looks_at_all_pairs(Strategy strategy) {
  return strategy != Strategy::kControl && strategy != Strategy::kHybridOne;
}

template <typename Measure>
void add_winners(std::span<const Scale> scales, const char* name, bool with_grid,
                 const Measure& measure, std::vector<Winner>& winners) {
  std::string last;
  for (const Scale& scale : scales) {
    const StrategyCost* best = nullptr;
    for (const StrategyCost& each : scale.strategies) {
      if (!looks_at_all_pairs(each.strategy)) continue;
      if (!with_grid && each.strategy == Strategy::kTwoPassGrid) continue;
      if (best == nullptr || measure(each) < measure(*best)) best = &each;
    }
    if (best == nullptr || best->name() == last) continue;
    last = best->name();
    winners.push_back({name, scale.objects, last});
  }
}

}  // namespace

std::vector<Claim> judge(const PaperResult& result, std::span<const CensusTable> censuses) {
  std::vector<Claim> claims;
  judge_table_2(result, censuses, claims);
  judge_table_3(result, claims);
  for (const size_t size : {size_t{50}, size_t{350}, size_t{500}})
    judge_figure_13(*result.scale(size), claims);
  return claims;
}

std::vector<Winner> find_winners(std::span<const Scale> scales) {
  const auto frames = [](const StrategyCost& each) { return each.result.frames; };
  const auto counted = [&](const StrategyCost& each) { return each.culling_ms / frames(each); };
  const auto measured = [](const StrategyCost& each) { return each.result.frame_ms; };
  const auto exact = [&](const StrategyCost& each) { return each.exact_ms / frames(each); };
  std::vector<Winner> winners;
  for (const bool with_grid : {false, true}) {
    const auto add = [&](const char* name, const auto& measure) {
      add_winners(scales, name, with_grid, measure, winners);
    };
    add(with_grid ? "culling, counted, grid allowed" : "culling, counted", counted);
    add(with_grid ? "culling, measured, grid allowed" : "culling, measured", measured);
    add(with_grid ? "to the triangles, counted, grid allowed" : "to the triangles, counted",
        [&](const StrategyCost& each) { return counted(each) + exact(each); });
    add(with_grid ? "to the triangles, measured, grid allowed" : "to the triangles, measured",
        [&](const StrategyCost& each) { return measured(each) + exact(each); });
  }
  return winners;
}

}  // namespace throng::paper
