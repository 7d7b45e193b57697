#include "culling/stages/part_stage.h"

#include <algorithm>
#include <utility>

#include "culling/fitted.h"
#include "culling/kernels/kernels_of.h"
#include "culling/stages/part_pair.h"
#include "culling/stages/stopwatch.h"

namespace throng {
namespace {

/// The two body boxes overlap, b's shifted into a's coordinates.
bool bodies_overlap(const float* a, const float* b, const float* shift) {
  bool apart = false;
  for (size_t axis = 0; axis < 3; ++axis) {
    apart |= a[axis] > b[4 + axis] + shift[axis];
    apart |= b[axis] + shift[axis] > a[4 + axis];
  }
  return !apart;
}

void add_stage(StageCounters& sum, const StageCounters& other) {
  sum.updates += other.updates;
  sum.tests += other.tests;
  sum.passed += other.passed;
  sum.update_ns += other.update_ns;
  sum.test_ns += other.test_ns;
}

}  // namespace

void PartStageCounters::add(const PartStageCounters& other) {
  add_stage(body_box, other.body_box);
  add_stage(box, other.box);
  add_stage(part, other.part);
  add_stage(exact, other.exact);
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

uint64_t box_tests(const PartStageFrame& frame, const BodyPair& pair) {
  return uint64_t{frame.type_parts[pair.type_a]} * frame.type_parts[pair.type_b];
}

void PartStage::begin(const PartStageFrame& frame, const PosedBodies& bodies) {
  bodies_ = &bodies;
  boxes_ = {bodies.boxes(), frame.type_parts.data(), frame.type_first_shape.data(),
            static_cast<uint32_t>(frame.shape_type.size())};
  pair_count_ = 0;
}

/// Keeps the pairs whose boxes, in their poses, overlap.
void PartStage::add(const PartStageFrame& frame, std::span<const SlotPair> pairs) {
  Stopwatch watch;
  pairs_.grow(pair_count_ + pairs.size(), pair_count_);
  const size_t pairs_before = pair_count_;
  uint64_t parts = 0;
  for (const SlotPair& slots : pairs) {
    const PosedBody* a = &bodies_->of_slot(slots.a);
    const PosedBody* b = &bodies_->of_slot(slots.b);
    if (a->slot.body > b->slot.body) std::swap(a, b);
    const Eigen::Vector3f shift = (b->slot.root() - a->slot.root()).cast<float>();
    if (!bodies_overlap(bodies_->box_of(*a), bodies_->box_of(*b), shift.data())) continue;
    pairs_[pair_count_] = {{shift.x(), shift.y(), shift.z(), a->slot.margin_m + b->slot.margin_m},
                           a->slot.scale,
                           b->slot.scale,
                           a->pose,
                           b->pose,
                           a->block,
                           b->block,
                           a->slot.body,
                           b->slot.body,
                           a->slot.type,
                           b->slot.type};
    parts += box_tests(frame, pairs_[pair_count_++]);
  }
  counters_.body_box.tests += pairs.size();
  counters_.body_box.passed += pair_count_ - pairs_before;
  counters_.body_box.test_ns += watch.lap_ns();
  counters_.box.tests += parts;
}

void PartStage::finish(const PartStageFrame& frame, PartPairs& out) {
  find_candidates(frame);
  test_parts(frame);
  if (tally_) tally_tests(frame);
  if (frame.exact) decide_by_triangles(frame, candidate_count_);
  if (tally_) tally_truth(frame);
  write_runs(out);
}

PairKey PartStage::key_of(const Candidate& candidate) const {
  const BodyPair& pair = pairs_[candidate.pair];
  return {pair.body_a, pair.body_b, candidate.part_a, candidate.part_b};
}

void PartStage::keep_pairs(const PartStageFrame& frame, size_t count) {
  for (size_t i = count; i < pair_count_; ++i) counters_.box.tests -= box_tests(frame, pairs_[i]);
  pair_count_ = count;
}

/// Candidates of a pair are consecutive and sorted, and so are its parts. No branch: which
/// candidates overlap, and where a pair ends, is hard to foretell.
void PartStage::write_runs(PartPairs& out) const {
  out.parts.resize(candidate_count_ + 1);  // one more: written before it is known to count
  out.runs.resize(candidate_count_ == 0 ? 0 : pair_count_);
  uint16_t* const parts = out.parts.data();
  PartRun* run = out.runs.data();
  uint32_t count = 0, first = 0, pair = 0;
  for (size_t i = 0; i < candidate_count_; ++i) {
    const Candidate& c = candidates_[i];
    const bool is_next = c.pair != pair;
    run += is_next & (count != first);  // one without parts is overwritten
    first = is_next ? count : first;
    pair = c.pair;
    parts[count] = static_cast<uint16_t>(PairKey::parts_of(c.part_a, c.part_b));
    count += overlaps_[i];
    *run = {pair, 0, first, count - first};
  }
  out.run_count = static_cast<size_t>(run - out.runs.data()) + (count != first);
  for (size_t i = 0; i < out.run_count; ++i) {
    PartRun& named = out.runs[i];
    const BodyPair& bodies = pairs_[named.body_a];
    named.body_a = bodies.body_a;
    named.body_b = bodies.body_b;
  }
}

void PartStage::find_candidates(const PartStageFrame& frame) {
  Stopwatch watch;
  candidate_count_ = 0;
  constexpr size_t kWorstPair = size_t{BodyType::kMaxParts} * BodyType::kMaxParts + kBoxLanes;
  size_t next = 0;
  while (next < pair_count_) {
    size_t found = 0;
    next = frame.kernels->box_pairs(boxes_, pairs_.data(), next, pair_count_,
                                    candidates_.data() + candidate_count_,
                                    candidates_.capacity() - candidate_count_, &found);
    candidate_count_ += found;
    if (next < pair_count_)
      candidates_.grow(2 * candidates_.capacity() + kWorstPair, candidate_count_);
  }
  counters_.box.passed += candidate_count_;
  counters_.box.test_ns += watch.lap_ns();
}

size_t PartStage::decide_by_triangles(const PartStageFrame& frame, uint64_t most) {
  Stopwatch watch;
  ExactCounters primitive;
  uint64_t tests = 0;
  size_t i = 0;
  for (; i < candidate_count_; ++i) {
    if (!overlaps_[i]) continue;
    if (tests == most) break;
    ++tests;
    const Candidate& c = candidates_[i];
    const PartPair p = part_pair(frame, bodies_->poses(), pairs_[c.pair], c);
    overlaps_[i] = parts_touch(p, primitive);
    counters_.exact.passed += overlaps_[i];
  }
  counters_.exact.tests += tests;
  counters_.primitive_tests += primitive.node_tests + primitive.triangle_tests;
  counters_.exact.test_ns += watch.lap_ns();
  return i;
}

void PartStage::reserve_like(const PartStage& other) {
  pairs_.match(other.pairs_);
  candidates_.match(other.candidates_);
  bucket_start_.match(other.bucket_start_);
  order_.match(other.order_);
  overlaps_.match(other.overlaps_);
}

uint32_t PartStage::times_grown() const {
  return pairs_.times_grown() + candidates_.times_grown() + bucket_start_.times_grown() +
         order_.times_grown() + overlaps_.times_grown();
}

}  // namespace throng
