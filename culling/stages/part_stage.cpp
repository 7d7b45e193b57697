#include "culling/stages/part_stage.h"

#include <algorithm>
#include <utility>

#include "base/counting_sort.h"
#include "culling/fitted.h"
#include "culling/kernels/kernels_of.h"
#include "culling/kernels/kernels_scalar.h"
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

struct PartOf {
  const BodyType::Volumes* volumes;
  size_t part;
  const PartPose* pose;
  float scale;
};

/// Two parts that a candidate names, and how far apart their roots are.
struct PartPair {
  PartOf a, b;
  Eigen::Vector3f a_to_b_m;
  float margin_m;
};

PartPair part_pair(const PartStageFrame& frame, const PartPose* poses, const BodyPair& pair,
                   const Candidate& c) {
  return {{&frame.types[pair.type_a]->volumes(), c.part_a, &poses[pair.pose_a + c.part_a],
           pair.scale_a},
          {&frame.types[pair.type_b]->volumes(), c.part_b, &poses[pair.pose_b + c.part_b],
           pair.scale_b},
          {pair.shift_m[0], pair.shift_m[1], pair.shift_m[2]},
          pair.shift_m[3]};
}

/// Updates both volumes, then tests them: two updates a test, as the paper counts.
template <typename Volume>
bool placed_overlap(const PartPair& p) {
  const auto place = [&](const PartOf& part) {
    return Volume::place(part.volumes->of<Volume>()[part.part], *part.pose, part.scale);
  };
  return Volume::overlaps(place(p.a), place(p.b), p.a_to_b_m, p.margin_m);
}

bool parts_touch(const PartPair& p, ExactCounters& primitive) {
  return solids_touch(p.a.volumes->surfaces()[p.a.part], *p.a.pose, p.a.scale,
                      p.b.volumes->surfaces()[p.b.part], *p.b.pose, p.b.scale, p.a_to_b_m,
                      primitive);
}

/// A shape that has buckets.
const OrdopTable& table_of(const PartStageFrame& frame, size_t shape) {
  const uint16_t type = frame.shape_type[shape];
  return frame.types[type]->volumes().tables()[shape - frame.type_first_shape[type]];
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

void PartStage::test_parts(const PartStageFrame& frame) {
  Stopwatch watch;
  overlaps_.resize(candidate_count_);
  if (frame.is_mixed) {
    test_mixture(frame);
  } else {
    with_volume(frame.volume, [&]<typename Volume>() {
      if constexpr (KernelsOf<Volume>::kExist)
        test_by_kernel<Volume>(frame);
      else
        test_one_by_one<Volume>(frame);
    });
  }
  counters_.part.tests += candidate_count_;
  counters_.part.passed +=
      static_cast<uint64_t>(std::count(overlaps_.data(), overlaps_.data() + candidate_count_, 1));
  counters_.part.test_ns += watch.lap_ns();
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

void PartStage::sort_into_buckets() {
  const size_t buckets = bucket_count(boxes_.shapes);
  bucket_start_.resize(buckets + 2);
  order_.resize(candidate_count_);
  counting_sort(
      candidate_count_, buckets, bucket_start_.data(),
      [&](size_t i) { return candidates_[i].bucket(); },
      [&](size_t i, uint32_t at) { order_[at] = static_cast<uint32_t>(i); });
}

template <typename Test, typename Rest>
void PartStage::for_each_bucket(const Test& test, const Rest& rest) {
  sort_into_buckets();
  const uint32_t shapes = boxes_.shapes;
  for (size_t a = 0; a < shapes; ++a) {
    for (size_t b = a; b < shapes; ++b) {
      const size_t bucket = a * shapes + b;
      const uint32_t begin = bucket_start_[bucket], count = bucket_start_[bucket + 1] - begin;
      if (count > 0) test(a, b, std::span(order_.data() + begin, count));
    }
  }
  for (uint32_t i = bucket_start_[bucket_count(shapes) - 1]; i < candidate_count_; ++i)
    rest(order_[i]);
}

template <typename Volume>
void PartStage::test_by_kernel(const PartStageFrame& frame) {
  const Kernels::OrdopPairs test = frame.kernels->*KernelsOf<Volume>::kPairs;
  for_each_bucket(
      [&](size_t a, size_t b, std::span<uint32_t> some) {
        test(table_of(frame, a), table_of(frame, b), pairs_.data(), bodies_->poses(),
             candidates_.data(), some.data(), some.size(), overlaps_.data());
      },
      [&](uint32_t one) { test_by_reference<Volume>(frame, one); });
}

/// Shapes beyond the buckets: rare, so one by one with the reference.
template <typename Volume>
void PartStage::test_by_reference(const PartStageFrame& frame, uint32_t candidate) {
  const Candidate& c = candidates_[candidate];
  const BodyPair& pair = pairs_[c.pair];
  const Kernels::OrdopPairs reference = scalar_kernels().*KernelsOf<Volume>::kPairs;
  reference(frame.types[pair.type_a]->volumes().tables()[c.part_a],
            frame.types[pair.type_b]->volumes().tables()[c.part_b], pairs_.data(), bodies_->poses(),
            candidates_.data(), &candidate, 1, overlaps_.data());
}

/// Two parts with different volumes are apart if either kind of volume says so: the one that comes
/// first in the list is asked first, then the other.
void PartStage::test_mixture(const PartStageFrame& frame) {
  for_each_bucket(
      [&](size_t a, size_t b, std::span<uint32_t> some) {
        const auto volume = [&](size_t shape) {
          const uint16_t type = frame.shape_type[shape];
          return frame.volume_of(type, shape - frame.type_first_shape[type]);
        };
        const VolumeKind of_a = volume(a), of_b = volume(b);
        const auto decide = [&](VolumeKind kind) {
          with_volume(kind, [&]<typename Volume>() {
            if constexpr (KernelsOf<Volume>::kExist)
              (frame.kernels->*KernelsOf<Volume>::kPairs)(
                  table_of(frame, a), table_of(frame, b), pairs_.data(), bodies_->poses(),
                  candidates_.data(), some.data(), some.size(), overlaps_.data());
            else
              test_one_by_one<Volume>(frame, some);
          });
        };
        decide(std::min(of_a, of_b));
        if (of_a == of_b) return;
        some = still_overlapping(some);
        decide(std::max(of_a, of_b));
      },
      [&](uint32_t one) {
        const Candidate& c = candidates_[one];
        const BodyPair& pair = pairs_[c.pair];
        const VolumeKind of_a = frame.volume_of(pair.type_a, c.part_a);
        const VolumeKind of_b = frame.volume_of(pair.type_b, c.part_b);
        const auto decide = [&](VolumeKind kind) {
          with_volume(kind, [&]<typename Volume>() {
            if constexpr (KernelsOf<Volume>::kExist)
              test_by_reference<Volume>(frame, one);
            else
              test_one_by_one<Volume>(frame, {&one, 1});
          });
        };
        decide(std::min(of_a, of_b));
        if (of_a != of_b && overlaps_[one]) decide(std::max(of_a, of_b));
      });
}

/// Moves them to the front.
std::span<uint32_t> PartStage::still_overlapping(std::span<uint32_t> candidates) const {
  size_t kept = 0;
  for (const uint32_t candidate : candidates)
    if (overlaps_[candidate]) candidates[kept++] = candidate;
  return candidates.first(kept);
}

template <typename Volume>
bool PartStage::overlap(const PartStageFrame& frame, uint32_t candidate) const {
  const Candidate& c = candidates_[candidate];
  return placed_overlap<Volume>(part_pair(frame, bodies_->poses(), pairs_[c.pair], c));
}

template <typename Volume>
void PartStage::test_one_by_one(const PartStageFrame& frame) {
  for (uint32_t i = 0; i < candidate_count_; ++i) overlaps_[i] = overlap<Volume>(frame, i);
  counters_.part.updates += 2 * candidate_count_;
}

template <typename Volume>
void PartStage::test_one_by_one(const PartStageFrame& frame, std::span<const uint32_t> candidates) {
  for (const uint32_t i : candidates) overlaps_[i] = overlap<Volume>(frame, i);
  counters_.part.updates += 2 * candidates.size();
}

/// Before triangles decide, which write over what the volumes said.
void PartStage::tally_tests(const PartStageFrame& frame) {
  const auto block_of = [&](const BodyPair& pair) -> PartTally::Block& {
    return tally_->block(pair.type_a, pair.type_b, frame.type_parts[pair.type_a],
                         frame.type_parts[pair.type_b]);
  };
  for (size_t i = 0; i < pair_count_; ++i) ++block_of(pairs_[i]).body_pairs;
  for (size_t i = 0; i < candidate_count_; ++i) {
    const Candidate& c = candidates_[i];
    const BodyPair& pair = pairs_[c.pair];
    PartPairCounts& cell =
        PartTally::cell(block_of(pair), pair.type_a, pair.type_b, c.part_a, c.part_b);
    ++cell.box_passed;
    cell.part_passed += overlaps_[i];
  }
}

/// What truly touches: as the triangles have decided, or judged here, aside from the answer.
void PartStage::tally_truth(const PartStageFrame& frame) {
  ExactCounters aside;
  for (size_t i = 0; i < candidate_count_; ++i) {
    if (!overlaps_[i]) continue;
    const Candidate& c = candidates_[i];
    const BodyPair& pair = pairs_[c.pair];
    bool touches = frame.exact;
    if (!frame.exact) {
      const auto &type_a = *frame.types[pair.type_a], &type_b = *frame.types[pair.type_b];
      tally_->knows_truth &= type_a.has_triangles() && type_b.has_triangles();
      touches =
          tally_->knows_truth && parts_touch(part_pair(frame, bodies_->poses(), pair, c), aside);
    }
    PartTally::Block& block = tally_->block(pair.type_a, pair.type_b, frame.type_parts[pair.type_a],
                                            frame.type_parts[pair.type_b]);
    PartTally::cell(block, pair.type_a, pair.type_b, c.part_a, c.part_b).touching += touches;
  }
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
