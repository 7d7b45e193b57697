// or-DOP 26 over the real mix of candidate pairs: our kernels on every target, against projecting
// vertices and against GJK on the same polytopes (libccd, which FCL uses).
#include <benchmark/benchmark.h>
#include <ccd/ccd.h>

#include <algorithm>

#include "bench/micro/candidates.h"
#include "bench/micro/instructions.h"
#include "culling/volumes/directions.h"
#include "culling/volumes/polytope.h"
#include "culling/volumes/pose_math.h"

namespace throng::bench {
namespace {

/// The corners of every part's or-DOP 26, each once.
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

/// The paper's or-DOP over the same candidates in the order in which they were found, one by one.
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

/// Separating axes with the corners of the other polytope projected one by one.
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

[[maybe_unused]] const bool kRegistered = [] {
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
