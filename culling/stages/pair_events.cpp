#include "culling/stages/pair_events.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace throng {

void PairEvents::begin(size_t count, size_t blocks) {
  incoming_count_ = count;
  incoming_.resize(count);
  events_.resize(touching_count_ + count);
  block_count_ = blocks;
  blocks_.resize(blocks);
  std::fill_n(blocks_.data(), blocks, Block{});
}

void PairEvents::compare(size_t block, size_t first, size_t end, PairKey low, PairKey high) {
  const PairKey* const all = touching_.data();
  const PairKey* was = std::lower_bound(all, all + touching_count_, low);
  const PairKey* const was_end = std::lower_bound(was, all + touching_count_, high);
  const PairKey *is = incoming_.data() + first, *const is_end = incoming_.data() + end;
  assert(std::is_sorted(is, is_end) && std::adjacent_find(is, is_end) == is_end);
  Block out{static_cast<size_t>(was - all) + first};
  PairEvent* event = events_.data() + out.first;
  while (was != was_end && is != is_end) {
    if (*was == *is) {
      ++out.persisting;
      ++was, ++is;
    } else if (*was < *is) {
      *event++ = {*was++, EventKind::kEnd, level_};
    } else {
      *event++ = {*is++, EventKind::kBegin, level_};
    }
  }
  while (was != was_end) *event++ = {*was++, EventKind::kEnd, level_};
  while (is != is_end) *event++ = {*is++, EventKind::kBegin, level_};
  out.events = static_cast<size_t>(event - (events_.data() + out.first));
  blocks_[block] = out;
}

void PairEvents::finish() {
  event_count_ = 0;
  persisting_ = 0;
  for (size_t i = 0; i < block_count_; ++i) {
    const PairEvent* const found = events_.data() + blocks_[i].first;
    std::copy(found, found + blocks_[i].events, events_.data() + event_count_);
    event_count_ += blocks_[i].events;
    persisting_ += blocks_[i].persisting;
  }
  std::swap(touching_, incoming_);
  incoming_.match(touching_);  // the two are swapped in every frame
  touching_count_ = incoming_count_;
}

void PairEvents::advance(std::span<const PairKey> pairs) {
  begin(pairs.size(), 1);
  std::copy(pairs.begin(), pairs.end(), incoming());
  compare(0, 0, pairs.size(), PairKey(0, 0, 0, 0), PairKey::beyond_all());
  finish();
}

uint32_t PairEvents::times_grown() const {
  return touching_.times_grown() + incoming_.times_grown() + events_.times_grown() +
         blocks_.times_grown();
}

void PairEvents::resume(std::span<const PairKey> touching) {
  advance(touching);
  event_count_ = 0;
  persisting_ = 0;
}

}  // namespace throng
