#include "culling/stages/mid_phase.h"

#include <algorithm>
#include <utility>

#include "base/stopwatch.h"
#include "culling/fitted.h"
#include "culling/kernels/kernels.h"

namespace throng {

void MidPhaseCounters::add(const MidPhaseCounters& other) {
  body_box += other.body_box;
  part_box += other.part_box;
  part_volume += other.part_volume;
  triangles += other.triangles;
  primitive_tests += other.primitive_tests;
}

void fit_for_mid_phase(const BodyType& type, std::span<const VolumeKind> volumes, bool exact) {
  type.volumes().tables();
  for (const VolumeKind volume : volumes)
    with_volume(volume, [&]<typename Volume>() {
      if constexpr (!KernelsOf<Volume>::kExist) type.volumes().of<Volume>();
    });
  if (exact) type.volumes().surfaces();
}

void MidPhase::finish(const MidPhaseFrame& frame, PartPairs& out) {
  find_candidates(frame);
  test_parts(frame);
  if (tally_) tally_tests(frame);
  if (frame.exact) decide_by_triangles(frame, parts_.candidates().size());
  if (tally_) tally_touching(frame);
  write_runs(out);
}

/// Boxes that are apart overrule the given result of the volumes.
void MidPhase::finish(const MidPhaseFrame& frame, const PartCandidates& wider,
                      std::span<const uint8_t> overlaps, PartPairs& out) {
  Stopwatch watch;
  tested_ = &wider;
  const std::span<const Candidate> candidates = wider.candidates();
  overlaps_.resize(candidates.size());
  for (size_t i = 0; i < candidates.size(); ++i) {
    overlaps_[i] = overlaps[i] && wider.boxes_overlap(frame, candidates[i]);
    counters_.part_volume.passed += overlaps_[i];
  }
  counters_.part_volume.tests += candidates.size();
  counters_.part_volume.test_ns += watch.lap_ns();
  if (frame.exact) decide_by_triangles(frame, candidates.size());
  write_runs(out);
}

/// Candidates of a pair are consecutive and sorted, and so are its parts. Without branches: neither
/// overlaps nor the ends of pairs are predictable.
void MidPhase::write_runs(PartPairs& out) const {
  const std::span<const Candidate> candidates = tested_->candidates();
  out.parts.resize(candidates.size() + 1);  // one extra element, written before its flag is known
  out.runs.resize(candidates.empty() ? 0 : tested_->pairs().size());
  uint16_t* const parts = out.parts.data();
  PartRun* run = out.runs.data();
  uint32_t count = 0, first = 0, pair = 0;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const bool is_next = c.pair != pair;
    run += is_next & (count != first);  // a run without parts is overwritten
    first = is_next ? count : first;
    pair = c.pair;
    parts[count] = static_cast<uint16_t>(PairKey::parts_of(c.part_a, c.part_b));
    count += overlaps_[i];  // NOLINT(clang-analyzer-*): one flag per candidate, all written
    *run = {pair, 0, first, count - first};
  }
  out.run_count = static_cast<size_t>(run - out.runs.data()) + (count != first);
  for (size_t i = 0; i < out.run_count; ++i) {
    PartRun& named = out.runs[i];
    const BodyPair& bodies = tested_->pairs()[named.body_a];
    named.body_a = bodies.body_a;
    named.body_b = bodies.body_b;
  }
}

size_t MidPhase::decide_by_triangles(const MidPhaseFrame& frame, uint64_t max_count) {
  Stopwatch watch;
  TriangleCounters primitive;
  uint64_t tests = 0;
  const std::span<const Candidate> candidates = tested_->candidates();
  size_t i = 0;
  for (; i < candidates.size(); ++i) {
    if (!overlaps_[i]) continue;  // NOLINT(clang-analyzer-*): as in write_runs()
    if (tests == max_count) break;
    ++tests;
    const Candidate& c = candidates[i];
    const PartPair p = part_pair(frame, bodies_->poses(), tested_->pairs()[c.pair], c);
    overlaps_[i] = parts_touch(p, primitive);
    counters_.triangles.passed += overlaps_[i];
  }
  counters_.triangles.tests += tests;
  counters_.primitive_tests += primitive.node_tests + primitive.triangle_tests;
  counters_.triangles.test_ns += watch.lap_ns();
  return i;
}

MidPhaseCounters MidPhase::counters() const {
  MidPhaseCounters out = counters_;
  out.body_box = parts_.counters().body_box;
  out.part_box = parts_.counters().part_box;
  return out;
}

void MidPhase::clear_counters() {
  counters_ = {};
  parts_.clear_counters();
}

void MidPhase::reserve_like(const MidPhase& other) {
  parts_.reserve_like(other.parts_);
  overlaps_.match(other.overlaps_);
}

uint32_t MidPhase::times_grown() const { return parts_.times_grown() + overlaps_.times_grown(); }

template <typename Volume>
void MidPhase::test_by_kernel(const MidPhaseFrame& frame) {
  const Kernels::OrdopPairs test = frame.kernels->*KernelsOf<Volume>::kPairs;
  parts_.for_each_bucket(
      [&](size_t a, size_t b, std::span<uint32_t> bucket) {
        test(table_of(frame, a), table_of(frame, b), parts_.pairs().data(), bodies_->poses(),
             parts_.candidates().data(), bucket.data(), bucket.size(), overlaps_.data());
      },
      [&](uint32_t one) { test_by_reference<Volume>(frame, one); });
}

/// Shapes without buckets are rare, so the scalar reference tests them.
template <typename Volume>
void MidPhase::test_by_reference(const MidPhaseFrame& frame, uint32_t candidate) {
  const Candidate& c = parts_.candidates()[candidate];
  const BodyPair& pair = parts_.pairs()[c.pair];
  const Kernels::OrdopPairs reference = scalar_kernels().*KernelsOf<Volume>::kPairs;
  reference(frame.types[pair.type_a]->volumes().tables()[c.part_a],
            frame.types[pair.type_b]->volumes().tables()[c.part_b], parts_.pairs().data(),
            bodies_->poses(), parts_.candidates().data(), &candidate, 1, overlaps_.data());
}

/// Two parts with different volumes are apart if either volume proves it. The volume that comes
/// first in the list is tested first.
void MidPhase::test_mixture(const MidPhaseFrame& frame) {
  parts_.for_each_bucket(
      [&](size_t a, size_t b, std::span<uint32_t> bucket) {
        const auto volume = [&](size_t shape) {
          const uint16_t type = frame.shape_type[shape];
          return frame.volume_of(type, shape - frame.type_first_shape[type]);
        };
        const VolumeKind of_a = volume(a), of_b = volume(b);
        const auto decide = [&](VolumeKind kind) {
          with_volume(kind, [&]<typename Volume>() {
            if constexpr (KernelsOf<Volume>::kExist)
              (frame.kernels->*KernelsOf<Volume>::kPairs)(
                  table_of(frame, a), table_of(frame, b), parts_.pairs().data(), bodies_->poses(),
                  parts_.candidates().data(), bucket.data(), bucket.size(), overlaps_.data());
            else
              test_scalar<Volume>(frame, bucket);
          });
        };
        decide(std::min(of_a, of_b));
        if (of_a == of_b) return;
        bucket = still_overlapping(bucket);
        decide(std::max(of_a, of_b));
      },
      [&](uint32_t one) {
        const Candidate& c = parts_.candidates()[one];
        const BodyPair& pair = parts_.pairs()[c.pair];
        const VolumeKind of_a = frame.volume_of(pair.type_a, c.part_a);
        const VolumeKind of_b = frame.volume_of(pair.type_b, c.part_b);
        const auto decide = [&](VolumeKind kind) {
          with_volume(kind, [&]<typename Volume>() {
            if constexpr (KernelsOf<Volume>::kExist)
              test_by_reference<Volume>(frame, one);
            else
              test_scalar<Volume>(frame, {&one, 1});
          });
        };
        decide(std::min(of_a, of_b));
        if (of_a != of_b && overlaps_[one]) decide(std::max(of_a, of_b));
      });
}

std::span<uint32_t> MidPhase::still_overlapping(std::span<uint32_t> candidates) const {
  size_t kept = 0;
  for (const uint32_t candidate : candidates)
    if (overlaps_[candidate]) candidates[kept++] = candidate;
  return candidates.first(kept);
}

template <typename Volume>
bool MidPhase::overlap(const MidPhaseFrame& frame, uint32_t candidate) const {
  const Candidate& c = parts_.candidates()[candidate];
  return placed_overlap<Volume>(part_pair(frame, bodies_->poses(), parts_.pairs()[c.pair], c));
}

template <typename Volume>
void MidPhase::test_scalar(const MidPhaseFrame& frame) {
  for (uint32_t i = 0; i < parts_.candidates().size(); ++i)
    overlaps_[i] = overlap<Volume>(frame, i);
  counters_.part_volume.updates += 2 * parts_.candidates().size();
}

template <typename Volume>
void MidPhase::test_scalar(const MidPhaseFrame& frame, std::span<const uint32_t> candidates) {
  for (const uint32_t i : candidates) overlaps_[i] = overlap<Volume>(frame, i);
  counters_.part_volume.updates += 2 * candidates.size();
}

void MidPhase::test_parts(const MidPhaseFrame& frame) {
  Stopwatch watch;
  overlaps_.resize(parts_.candidates().size());
  if (frame.is_mixed) {
    test_mixture(frame);
  } else {
    with_volume(frame.volume, [&]<typename Volume>() {
      if constexpr (KernelsOf<Volume>::kExist)
        test_by_kernel<Volume>(frame);
      else
        test_scalar<Volume>(frame);
    });
  }
  counters_.part_volume.tests += parts_.candidates().size();
  // Every candidate is in a bucket or in the rest, so each flag has been written.
  for (size_t i = 0; i < parts_.candidates().size(); ++i)
    counters_.part_volume.passed += overlaps_[i];  // NOLINT(clang-analyzer-*)
  counters_.part_volume.test_ns += watch.lap_ns();
}

/// Must run before triangles overwrite the results of the volumes.
void MidPhase::tally_tests(const MidPhaseFrame& frame) {
  const auto block_of = [&](const BodyPair& pair) -> PartTally::Block& {
    return tally_->block(pair.type_a, pair.type_b, frame.type_parts[pair.type_a],
                         frame.type_parts[pair.type_b]);
  };
  for (const BodyPair& pair : parts_.pairs()) ++block_of(pair).body_pairs;
  for (size_t i = 0; i < parts_.candidates().size(); ++i) {
    const Candidate& c = parts_.candidates()[i];
    const BodyPair& pair = parts_.pairs()[c.pair];
    PartPairCounts& cell =
        PartTally::cell(block_of(pair), pair.type_a, pair.type_b, c.part_a, c.part_b);
    ++cell.box_passed;
    cell.part_passed += overlaps_[i];
  }
}

/// Counts contacts as decided by triangles, or tests triangles here without changing the result.
void MidPhase::tally_touching(const MidPhaseFrame& frame) {
  TriangleCounters aside;
  for (size_t i = 0; i < parts_.candidates().size(); ++i) {
    if (!overlaps_[i]) continue;
    const Candidate& c = parts_.candidates()[i];
    const BodyPair& pair = parts_.pairs()[c.pair];
    bool touches = frame.exact;
    if (!frame.exact) {
      const auto &type_a = *frame.types[pair.type_a], &type_b = *frame.types[pair.type_b];
      tally_->counts_touching &= type_a.has_triangles() && type_b.has_triangles();
      touches = tally_->counts_touching &&
                parts_touch(part_pair(frame, bodies_->poses(), pair, c), aside);
    }
    PartTally::Block& block = tally_->block(pair.type_a, pair.type_b, frame.type_parts[pair.type_a],
                                            frame.type_parts[pair.type_b]);
    PartTally::cell(block, pair.type_a, pair.type_b, c.part_a, c.part_b).touching += touches;
  }
}

}  // namespace throng
