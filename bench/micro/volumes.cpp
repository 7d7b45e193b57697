// Construction, update and test of each volume over the adult's parts, with lists of candidates of
// which 0, 10 or 100 % overlap. Then or-DOP 26 on real candidates: Throng's kernels on every SIMD
// target, projection of vertices, and GJK (libccd, which FCL uses).
#include <benchmark/benchmark.h>
#include <ccd/ccd.h>
#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/counting_sort.h"
#include "bench/crowd.h"
#include "culling/fitted.h"
#include "culling/volumes/polytope.h"
#include "culling/volumes/pose_math.h"
#include "culling/volumes/slabs.h"
#include "culling/volumes/volume_list.h"

namespace throng::bench {
namespace {

// Candidates of one frame of the bench crowd: parts of different people whose boxes overlap, with
// the data of part tests. Mix and order are real: no branch is learned from a short list.

class Candidates {
 public:
  Candidates(int avatars, double per_m2);

  const BodyType& type() const { return *type_; }
  const std::vector<BodyPair>& pairs() const { return pairs_; }
  const std::vector<PartPose>& poses() const { return poses_; }
  const std::vector<Candidate>& list() const { return candidates_; }
  /// Indices into list(), sorted by bucket; bucket i is [starts()[i], starts()[i + 1]).
  const std::vector<uint32_t>& order() const { return order_; }
  const std::vector<uint32_t>& starts() const { return starts_; }

  const PartPose& pose_a(const Candidate& c) const {
    return poses_[pairs_[c.pair].pose_a + c.part_a];
  }
  const PartPose& pose_b(const Candidate& c) const {
    return poses_[pairs_[c.pair].pose_b + c.part_b];
  }
  Eigen::Vector3f shift_m(const Candidate& c) const {
    return Eigen::Vector3f(pairs_[c.pair].shift_m);
  }

 private:
  void find(const Crowd& crowd);
  void sort_into_buckets();

  std::shared_ptr<const BodyType> type_;
  std::vector<PartPose> poses_;
  std::vector<BodyPair> pairs_;
  std::vector<Candidate> candidates_;
  std::vector<uint32_t> order_, starts_;
};

/// The crowd of most micro-benchmarks: 2000 people at 4 per m2, about 70 000 candidates.
const Candidates& crowd_candidates();

Candidates::Candidates(int avatars, double per_m2) {
  Crowd crowd(load_model(adult_urdf()), {.avatars = avatars, .per_m2 = per_m2});
  for (int step = 0; step < 60; ++step) crowd.advance();
  type_ = crowd.body_type();
  find(crowd);
  sort_into_buckets();
}

void Candidates::find(const Crowd& crowd) {
  CrowdBoxes boxes(crowd, type_);
  const BoxList list = boxes.compute();
  poses_ = boxes.poses();
  const BodiesView bodies = crowd.view();
  const uint16_t first_shape = 0;
  const BucketRule bucket({nullptr, nullptr, &first_shape, list.parts}, 0, 0);
  for (const BoxPair& found : reference_pairs(list)) {
    const uint32_t a = found.a / list.parts, b = found.b / list.parts;
    if (pairs_.empty() || pairs_.back().body_a != a || pairs_.back().body_b != b) {
      const Eigen::Vector3f shift =
          (bodies.roots[b].position_m - bodies.roots[a].position_m).cast<float>();
      const float reach = shift.norm() + 4 * type_->sphere().radius_m;
      pairs_.push_back({{shift.x(), shift.y(), shift.z(), rounding_margin_m(reach)},
                        bodies.scales[a],
                        bodies.scales[b],
                        a * list.parts,
                        b * list.parts,
                        0,
                        0,
                        a,
                        b,
                        0,
                        0});
    }
    const uint32_t part_a = found.a % list.parts, part_b = found.b % list.parts;
    candidates_.push_back({static_cast<uint32_t>(pairs_.size() - 1), static_cast<uint8_t>(part_a),
                           static_cast<uint8_t>(part_b), bucket(part_a, part_b)});
  }
}

void Candidates::sort_into_buckets() {
  const size_t parts = static_cast<size_t>(type_->part_count());
  order_.resize(candidates_.size());
  starts_.resize(parts * parts + 2);
  counting_sort(
      candidates_.size(), parts * parts, starts_.data(),
      [this](size_t i) { return candidates_[i].bucket(); },
      [this](size_t i, uint32_t position) { order_[position] = static_cast<uint32_t>(i); });
  starts_.pop_back();  // needed for sorting only
}

const Candidates& crowd_candidates() {
  static const Candidates candidates(2000, 4);
  return candidates;
}

// Retired instructions of a benchmark. Most virtual machines cannot count them: then none are
// reported.

/// CountInstructions counts this thread's user-space instructions during its life (Linux perf
/// events). At the end it sets the counter `instructions` to the number per item.
class CountInstructions {
 public:
  /// `items`: number of items per iteration of the state's loop.
  CountInstructions(benchmark::State& state, int64_t items);
  ~CountInstructions();
  CountInstructions(const CountInstructions&) = delete;
  CountInstructions& operator=(const CountInstructions&) = delete;

 private:
  benchmark::State& state_;
  int64_t items_;
  int counter_;  // a file descriptor; -1: not available
};

int open_counter() {
  perf_event_attr attributes{};
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.size = sizeof attributes;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  // This thread, any core, no group, no flags.
  return static_cast<int>(syscall(SYS_perf_event_open, &attributes, 0, -1, -1, 0));
}

CountInstructions::CountInstructions(benchmark::State& state, int64_t items)
    : state_(state), items_(items), counter_(open_counter()) {}

CountInstructions::~CountInstructions() {
  if (counter_ < 0) return;
  uint64_t count = 0;
  const bool known = read(counter_, &count, sizeof count) == sizeof count && count > 0;
  close(counter_);
  const double items = static_cast<double>(state_.iterations()) * static_cast<double>(items_);
  if (known && items > 0) state_.counters["instructions"] = static_cast<double>(count) / items;
}

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

/// state.range(0): percentage of overlapping pairs, spread evenly over the list.
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
  // With loose volumes, overlapping boxes rarely miss; other parts of neighbours do.
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

/// Returns the unique corners of every part's or-DOP 26.
std::vector<std::vector<Eigen::Vector3f>> corners_of(const BodyType& type) {
  std::vector<std::vector<Eigen::Vector3f>> out;
  for (const Slabs& slabs : type.volumes().of<Ordop<26>>()) {
    std::vector<Eigen::Vector3d> all = polytope_of(slabs, 26).corners_m;
    auto& corners = out.emplace_back();
    for (const Eigen::Vector3d& corner : all) {
      const Eigen::Vector3f rounded = corner.cast<float>();
      const auto same = [&](const Eigen::Vector3f& other) {
        return (other - rounded).squaredNorm() < 1e-10f;
      };
      if (std::none_of(corners.begin(), corners.end(), same)) corners.push_back(rounded);
    }
  }
  return out;
}

void report(benchmark::State& state, size_t passed) {
  const auto tests = static_cast<double>(crowd_candidates().list().size());
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(tests));
  state.counters["candidates"] = tests;
  state.counters["passed"] = static_cast<double>(passed);
}

void ordop_26_kernel(benchmark::State& state, SimdTarget target) {
  const Candidates& c = crowd_candidates();
  const Kernels& kernels = kernels_for(target);
  const auto& tables = c.type().volumes().tables();
  std::vector<uint8_t> overlaps(c.list().size());
  const CountInstructions instructions(state, static_cast<int64_t>(c.list().size()));
  for (auto _ : state) {
    for (size_t bucket = 0; bucket + 1 < c.starts().size(); ++bucket) {
      const uint32_t begin = c.starts()[bucket], count = c.starts()[bucket + 1] - begin;
      if (count > 0)
        kernels.ordop_pairs_26(tables[bucket / tables.size()], tables[bucket % tables.size()],
                               c.pairs().data(), c.poses().data(), c.list().data(),
                               c.order().data() + begin, count, overlaps.data());
    }
    benchmark::DoNotOptimize(overlaps.data());
    benchmark::ClobberMemory();
  }
  report(state, static_cast<size_t>(std::count(overlaps.begin(), overlaps.end(), 1)));
}

/// The paper's or-DOP test, pair by pair, with the candidates in the order of their discovery.
void ordop_26_pair(benchmark::State& state, SimdTarget target) {
  const Candidates& c = crowd_candidates();
  const auto& lanes = c.type().volumes().lanes<Ordop<26>>();
  const Kernels::OrdopPair test = kernels_for(target).ordop_pair_26;
  size_t passed = 0;
  const CountInstructions instructions(state, static_cast<int64_t>(c.list().size()));
  for (auto _ : state) {
    passed = 0;
    for (const Candidate& pair : c.list()) {
      const BodyPair& bodies = c.pairs()[pair.pair];
      passed += test(lanes[pair.part_a], c.pose_a(pair), bodies.scale_a, lanes[pair.part_b],
                     c.pose_b(pair), bodies.scale_b, bodies.shift_m);
    }
    benchmark::DoNotOptimize(passed);
  }
  report(state, passed);
}

/// Separating axes by projecting each corner of the other polytope.
bool apart_by_corners(const Slabs& slabs, const std::vector<Eigen::Vector3f>& corners,
                      const Eigen::Matrix3f& from_other, const Eigen::Vector3f& offset) {
  for (int d = 0; d < 13; ++d) {
    const Eigen::Vector3f n = direction_vector(d);
    const Eigen::Vector3f seen = from_other.transpose() * n;
    float low = along(seen, corners[0]), high = low;
    for (const Eigen::Vector3f& corner : corners) {
      const float at = along(seen, corner);
      low = std::min(low, at);
      high = std::max(high, at);
    }
    const float shift = along(n, offset);
    const auto i = static_cast<size_t>(d);
    const float centre = slabs.slab[i].centre, half = slabs.slab[i].half;
    if (low + shift > centre + half || high + shift < centre - half) return true;
  }
  return false;
}

Eigen::Matrix3f rotation(const PartPose& pose) {
  Eigen::Matrix3f out;
  for (int r = 0; r < 3; ++r)
    for (int col = 0; col < 3; ++col) out(r, col) = pose.rows[r][col];
  return out;
}

void ordop_26_scalar_vertices(benchmark::State& state) {
  const Candidates& c = crowd_candidates();
  const auto corners = corners_of(c.type());
  const auto& slabs = c.type().volumes().of<Ordop<26>>();
  size_t passed = 0;
  const CountInstructions instructions(state, static_cast<int64_t>(c.list().size()));
  for (auto _ : state) {
    passed = 0;
    for (const Candidate& pair : c.list()) {
      const PartPose &a = c.pose_a(pair), &b = c.pose_b(pair);
      const Eigen::Matrix3f world_from_a = rotation(a), world_from_b = rotation(b);
      const Eigen::Vector3f b_minus_a = translation_m(b) + c.shift_m(pair) - translation_m(a);
      const Eigen::Matrix3f a_from_b = world_from_a.transpose() * world_from_b;
      passed += !apart_by_corners(slabs[pair.part_a], corners[pair.part_b], a_from_b,
                                  world_from_a.transpose() * b_minus_a) &&
                !apart_by_corners(slabs[pair.part_b], corners[pair.part_a], a_from_b.transpose(),
                                  -(world_from_b.transpose() * b_minus_a));
    }
    benchmark::DoNotOptimize(passed);
  }
  report(state, passed);
}

struct GjkShape {
  const std::vector<Eigen::Vector3f>* corners;
  Eigen::Matrix3d world_from_part;
  Eigen::Vector3d position_m;
};

void gjk_support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& shape = *static_cast<const GjkShape*>(object);
  const Eigen::Vector3d d(direction->v[0], direction->v[1], direction->v[2]);
  const Eigen::Vector3f local = (shape.world_from_part.transpose() * d).cast<float>();
  const Eigen::Vector3f* best = &shape.corners->front();
  float far = along(local, *best);
  for (const Eigen::Vector3f& corner : *shape.corners) {
    const float at = along(local, corner);
    if (at <= far) continue;
    far = at;
    best = &corner;
  }
  const Eigen::Vector3d point = shape.world_from_part * best->cast<double>() + shape.position_m;
  ccdVec3Set(out, point.x(), point.y(), point.z());
}

void ordop_26_gjk(benchmark::State& state) {
  const Candidates& c = crowd_candidates();
  const auto corners = corners_of(c.type());
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = gjk_support;
  ccd.max_iterations = 100;
  size_t passed = 0;
  const CountInstructions instructions(state, static_cast<int64_t>(c.list().size()));
  for (auto _ : state) {
    passed = 0;
    for (const Candidate& pair : c.list()) {
      const PartPose &a = c.pose_a(pair), &b = c.pose_b(pair);
      const GjkShape shape_a{&corners[pair.part_a], rotation(a).cast<double>(),
                             translation_m(a).cast<double>()};
      const GjkShape shape_b{&corners[pair.part_b], rotation(b).cast<double>(),
                             (translation_m(b) + c.shift_m(pair)).cast<double>()};
      passed += ccdGJKIntersect(&shape_a, &shape_b, &ccd) != 0;
    }
    benchmark::DoNotOptimize(passed);
  }
  report(state, passed);
}

[[maybe_unused]] const bool kOrdopRegistered = [] {
  for (const SimdTarget target : simd_targets_of_this_machine())
    benchmark::RegisterBenchmark(("ordop_26_kernel/" + std::string(name_of(target))).c_str(),
                                 ordop_26_kernel, target);
  for (const SimdTarget target : simd_targets_of_this_machine())
    benchmark::RegisterBenchmark(("ordop_26_pair/" + std::string(name_of(target))).c_str(),
                                 ordop_26_pair, target);
  return true;
}();
BENCHMARK(ordop_26_scalar_vertices);
BENCHMARK(ordop_26_gjk);

}  // namespace

}  // namespace throng::bench
