#include "culling/deadline/urgency.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace throng {
namespace {

constexpr uint32_t kNotTouched = 1u << 31;
/// Groups of a millimetre of overlap each: fine enough that a group is soon sorted. What overlaps
/// deeper than the last shares it.
constexpr float kGroupsPerMetre = 1024;
constexpr uint32_t kGroupsOfKind = 4096;
constexpr uint32_t kGroups = 2 * kGroupsOfKind;

/// Ascending with falling depth; not-touching ones after all touching ones.
uint32_t rank_of(bool touched, float depth_m) {
  // The bits of a float from 0 on ascend with it.
  const uint32_t bits = std::bit_cast<uint32_t>(std::max(depth_m, 0.0f));
  return (touched ? 0 : kNotTouched) | (~kNotTouched - bits);
}

uint32_t group_of(uint32_t rank) {
  const float depth_m = std::bit_cast<float>(~kNotTouched - (rank & ~kNotTouched));
  const float group = std::min(depth_m * kGroupsPerMetre, static_cast<float>(kGroupsOfKind - 1));
  return (rank & kNotTouched ? kGroupsOfKind : 0) + kGroupsOfKind - 1 -
         static_cast<uint32_t>(group);
}

std::pair<uint32_t, uint32_t> bodies_of(const UrgentPair& pair, const Slots& slots) {
  const uint32_t a = slots.body(pair.slots.a), b = slots.body(pair.slots.b);
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

void UrgencyQueue::fill(const BodiesView& bodies, const BroadPhase& broad, const Slots& slots,
                        std::span<const PairKey> touched, Workers& workers) {
  mark_touched(bodies, touched);
  const size_t blocks = broad.block_count();
  first_of_block_.resize(blocks + 1);
  first_of_block_[0] = 0;
  for (size_t i = 0; i < blocks; ++i)
    first_of_block_[i + 1] = first_of_block_[i] + broad.block(i).size();
  count_ = first_of_block_[blocks];
  next_ = sorted_ = 0;
  found_.resize(count_);
  workers.for_blocks(static_cast<int>(blocks), [&](int index, int) {
    const size_t block = static_cast<size_t>(index);
    UrgentPair* out = found_.data() + first_of_block_[block];
    for (const SlotPair& pair : broad.block(block)) {
      const uint32_t a = slots.body(pair.a), b = slots.body(pair.b);
      const bool touching = touched_before(std::min(a, b), std::max(a, b), bodies, touched);
      *out++ = {pair, rank_of(touching, broad.depth_m(pair, slots))};
    }
  });
  scatter_by_group();
}

/// Both lists ascend by id, so one walk finds where each body's pairs begin.
void UrgencyQueue::mark_touched(const BodiesView& bodies, std::span<const PairKey> touched) {
  first_touched_.resize(bodies.ids.size());
  size_t next = 0;
  for (size_t body = 0; body < bodies.ids.size(); ++body) {
    while (next < touched.size() && touched[next].a() < bodies.ids[body]) ++next;
    first_touched_[body] = static_cast<uint32_t>(next);
  }
}

bool UrgencyQueue::touched_before(uint32_t body_a, uint32_t body_b, const BodiesView& bodies,
                                  std::span<const PairKey> touched) const {
  const uint32_t a = bodies.ids[body_a], b = bodies.ids[body_b];
  for (size_t i = first_touched_[body_a]; i < touched.size() && touched[i].a() == a; ++i)
    if (touched[i].b() >= b) return touched[i].b() == b;
  return false;
}

void UrgencyQueue::scatter_by_group() {
  pairs_.resize(count_);
  group_start_.resize(kGroups + 2);
  // Counted one group late, so that after scattering group_start_[i] is where group i begins.
  std::fill_n(group_start_.data(), kGroups + 2, 0u);
  for (size_t i = 0; i < count_; ++i) ++group_start_[group_of(found_[i].rank) + 2];
  std::partial_sum(group_start_.data(), group_start_.data() + kGroups + 2, group_start_.data());
  for (size_t i = 0; i < count_; ++i)
    pairs_[group_start_[group_of(found_[i].rank) + 1]++] = found_[i];
}

/// Where the group ends that holds the pair before `at`.
size_t UrgencyQueue::group_end(size_t at) const {
  return at == 0 ? 0 : group_start_[group_of(pairs_[at - 1].rank) + 1];
}

std::span<const UrgentPair> UrgencyQueue::peek(size_t wanted) const {
  const size_t end = group_end(std::min(count_, next_ + wanted));
  return {pairs_.data() + next_, end - next_};
}

void UrgencyQueue::sort_next(size_t wanted, const Slots& slots) {
  const size_t end = std::min(count_, next_ + wanted);
  sorted_ = std::max(sorted_, next_);
  while (sorted_ < end) {
    const size_t group = group_end(sorted_ + 1);
    std::sort(pairs_.data() + sorted_, pairs_.data() + group,
              [&](const UrgentPair& x, const UrgentPair& y) {
                return x.rank != y.rank ? x.rank < y.rank
                                        : bodies_of(x, slots) < bodies_of(y, slots);
              });
    sorted_ = group;
  }
}

std::span<const UrgentPair> UrgencyQueue::peek_sorted(size_t wanted) const {
  return {pairs_.data() + next_, std::min(count_ - next_, wanted)};
}

uint64_t UrgencyQueue::times_grown() const {
  return uint64_t{found_.times_grown()} + pairs_.times_grown() + first_of_block_.times_grown() +
         first_touched_.times_grown() + group_start_.times_grown();
}

}  // namespace throng
