#include "culling/stages/part_candidates.h"

#include <algorithm>
#include <utility>

#include "base/counting_sort.h"
#include "base/stopwatch.h"

namespace throng {
namespace {

/// True if two body boxes are within `margin_m` along every axis, b's shifted to a's coordinates.
bool bodies_are_within(const float* a, const float* b, const float* shift, float margin_m) {
  bool apart = false;
  for (size_t axis = 0; axis < 3; ++axis) {
    apart |= a[axis] - margin_m > b[4 + axis] + shift[axis];
    apart |= b[axis] + shift[axis] > a[4 + axis] + margin_m;
  }
  return !apart;
}

}  // namespace

uint64_t box_tests(const MidPhaseFrame& frame, const BodyPair& pair) {
  return uint64_t{frame.type_parts[pair.type_a]} * frame.type_parts[pair.type_b];
}

void PartCandidates::begin(const MidPhaseFrame& frame, const PosedBodies& bodies, float margin_m) {
  bodies_ = &bodies;
  boxes_ = {bodies.boxes(), frame.type_parts.data(), frame.type_first_shape.data(),
            static_cast<uint32_t>(frame.shape_type.size()), margin_m};
  pair_count_ = 0;
}

/// Keeps pairs whose posed boxes are within the margin.
void PartCandidates::add(const MidPhaseFrame& frame, std::span<const SlotPair> pairs,
                         std::span<const uint8_t> inner) {
  Stopwatch watch;
  pairs_.grow(pair_count_ + pairs.size(), pair_count_);
  if (!inner.empty()) inner_.grow(pair_count_ + pairs.size(), pair_count_);
  const size_t pairs_before = pair_count_;
  uint64_t parts = 0;
  for (const SlotPair& slots : pairs) {
    const PosedBody* a = &bodies_->of_slot(slots.a);
    const PosedBody* b = &bodies_->of_slot(slots.b);
    if (a->slot.body > b->slot.body) std::swap(a, b);
    const Eigen::Vector3f shift = (b->slot.root() - a->slot.root()).cast<float>();
    if (!bodies_are_within(bodies_->box_of(*a), bodies_->box_of(*b), shift.data(), boxes_.margin_m))
      continue;
    if (!inner.empty()) inner_[pair_count_] = inner[static_cast<size_t>(&slots - pairs.data())];
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
  counters_.part_box.tests += parts;
}

void PartCandidates::find(const MidPhaseFrame& frame) {
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
  if (!frame.filter->sides_of_part.empty()) drop_filtered(*frame.filter);
  counters_.part_box.passed += candidate_count_;
  counters_.part_box.test_ns += watch.lap_ns();
}

/// Equals box_pairs() of the kernels bit for bit.
bool PartCandidates::boxes_are_within(const MidPhaseFrame& frame, const Candidate& candidate,
                                      float margin_m) const {
  const BodyPair& pair = pairs_[candidate.pair];
  const size_t padded_a = padded_parts(frame.type_parts[pair.type_a]);
  const size_t padded_b = padded_parts(frame.type_parts[pair.type_b]);
  const float* a = boxes_.blocks + (size_t{pair.box_a} + 1) * kBoxLanes + candidate.part_a;
  const float* b = boxes_.blocks + (size_t{pair.box_b} + 1) * kBoxLanes + candidate.part_b;
  bool apart = false;
  for (size_t axis = 0; axis < 3; ++axis) {
    apart |= b[axis * padded_b] + pair.shift_m[axis] > a[(axis + 3) * padded_a] + margin_m;
    apart |= b[(axis + 3) * padded_b] + pair.shift_m[axis] < a[axis * padded_a] - margin_m;
  }
  return !apart;
}

void PartCandidates::drop_filtered(const PairFilter& filter) {
  Candidate* const end = candidates_.data() + candidate_count_;
  const auto is_excluded = [&](const Candidate& c) {
    const BodyPair& pair = pairs_[c.pair];
    return !filter.includes_parts(pair.type_a, c.part_a, pair.type_b, c.part_b);
  };
  candidate_count_ = static_cast<size_t>(std::remove_if(candidates_.data(), end, is_excluded) -
                                         candidates_.data());
}

PairKey PartCandidates::key_of(const Candidate& candidate) const {
  const BodyPair& pair = pairs_[candidate.pair];
  return {pair.body_a, pair.body_b, candidate.part_a, candidate.part_b};
}

void PartCandidates::keep_pairs(const MidPhaseFrame& frame, size_t count) {
  for (size_t i = count; i < pair_count_; ++i)
    counters_.part_box.tests -= box_tests(frame, pairs_[i]);
  pair_count_ = count;
}

void PartCandidates::sort_into_buckets() {
  const size_t buckets = bucket_count(boxes_.shapes);
  bucket_start_.resize(buckets + 2);
  order_.resize(candidate_count_);
  counting_sort(
      candidate_count_, buckets, bucket_start_.data(),
      [&](size_t i) { return candidates_[i].bucket(); },
      [&](size_t i, uint32_t at) { order_[at] = static_cast<uint32_t>(i); });
}

void PartCandidates::reserve_like(const PartCandidates& other) {
  pairs_.match(other.pairs_);
  inner_.match(other.inner_);
  candidates_.match(other.candidates_);
  bucket_start_.match(other.bucket_start_);
  order_.match(other.order_);
}

uint32_t PartCandidates::times_grown() const {
  return pairs_.times_grown() + inner_.times_grown() + candidates_.times_grown() +
         bucket_start_.times_grown() + order_.times_grown();
}

}  // namespace throng
