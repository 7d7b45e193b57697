#include "culling/stages/part_stage.h"

#include <algorithm>
#include <utility>

#include "base/stopwatch.h"
#include "culling/fitted.h"
#include "culling/kernels/kernels_of.h"
#include "culling/stages/part_pair.h"

namespace throng {
void PartStageCounters::add(const PartStageCounters& other) {
  body_box += other.body_box;
  box += other.box;
  part += other.part;
  exact += other.exact;
  primitive_tests += other.primitive_tests;
}

void fit_for_part_stage(const BodyType& type, std::span<const VolumeKind> volumes, bool exact) {
  type.volumes().tables();
  for (const VolumeKind volume : volumes)
    with_volume(volume, [&]<typename Volume>() {
      if constexpr (!KernelsOf<Volume>::kExist) type.volumes().of<Volume>();
    });
  if (exact) type.volumes().surfaces();
}

void PartStage::finish(const PartStageFrame& frame, PartPairs& out) {
  find_candidates(frame);
  test_parts(frame);
  if (tally_) tally_tests(frame);
  if (frame.exact) decide_by_triangles(frame, parts_.candidates().size());
  if (tally_) tally_truth(frame);
  write_runs(out);
}

/// Boxes that are apart decide before volumes do: volumes that are said to overlap are not, then.
void PartStage::finish(const PartStageFrame& frame, const PartCandidates& wider,
                       std::span<const uint8_t> overlaps, PartPairs& out) {
  Stopwatch watch;
  tested_ = &wider;
  const std::span<const Candidate> candidates = wider.candidates();
  overlaps_.resize(candidates.size());
  for (size_t i = 0; i < candidates.size(); ++i) {
    overlaps_[i] = overlaps[i] && wider.boxes_overlap(frame, candidates[i]);
    counters_.part.passed += overlaps_[i];
  }
  counters_.part.tests += candidates.size();
  counters_.part.test_ns += watch.lap_ns();
  if (frame.exact) decide_by_triangles(frame, candidates.size());
  write_runs(out);
}

/// Candidates of a pair are consecutive and sorted, and so are its parts. No branch: which
/// candidates overlap, and where a pair ends, is hard to foretell.
void PartStage::write_runs(PartPairs& out) const {
  const std::span<const Candidate> candidates = tested_->candidates();
  out.parts.resize(candidates.size() + 1);  // one more: written before it is known to count
  out.runs.resize(candidates.empty() ? 0 : tested_->pairs().size());
  uint16_t* const parts = out.parts.data();
  PartRun* run = out.runs.data();
  uint32_t count = 0, first = 0, pair = 0;
  for (size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const bool is_next = c.pair != pair;
    run += is_next & (count != first);  // one without parts is overwritten
    first = is_next ? count : first;
    pair = c.pair;
    parts[count] = static_cast<uint16_t>(PairKey::parts_of(c.part_a, c.part_b));
    count += overlaps_[i];  // NOLINT(clang-analyzer-*): one a candidate, all are written
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

size_t PartStage::decide_by_triangles(const PartStageFrame& frame, uint64_t most) {
  Stopwatch watch;
  ExactCounters primitive;
  uint64_t tests = 0;
  const std::span<const Candidate> candidates = tested_->candidates();
  size_t i = 0;
  for (; i < candidates.size(); ++i) {
    if (!overlaps_[i]) continue;  // NOLINT(clang-analyzer-*): as in write_runs()
    if (tests == most) break;
    ++tests;
    const Candidate& c = candidates[i];
    const PartPair p = part_pair(frame, bodies_->poses(), tested_->pairs()[c.pair], c);
    overlaps_[i] = parts_touch(p, primitive);
    counters_.exact.passed += overlaps_[i];
  }
  counters_.exact.tests += tests;
  counters_.primitive_tests += primitive.node_tests + primitive.triangle_tests;
  counters_.exact.test_ns += watch.lap_ns();
  return i;
}

PartStageCounters PartStage::counters() const {
  PartStageCounters out = counters_;
  out.body_box = parts_.counters().body_box;
  out.box = parts_.counters().box;
  return out;
}

void PartStage::clear_counters() {
  counters_ = {};
  parts_.clear_counters();
}

void PartStage::reserve_like(const PartStage& other) {
  parts_.reserve_like(other.parts_);
  overlaps_.match(other.overlaps_);
}

uint32_t PartStage::times_grown() const { return parts_.times_grown() + overlaps_.times_grown(); }

}  // namespace throng
