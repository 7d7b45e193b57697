#include "culling/pair_events.h"

#include <algorithm>
#include <cassert>

namespace throng {

void PairEvents::advance(std::span<const PairKey> pairs) {
  assert(std::is_sorted(pairs.begin(), pairs.end()));
  assert(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
  events_.resize(touching_count_ + pairs.size());  // at the worst, all end and all begin
  event_count_ = 0;
  persisting_ = 0;
  const PairKey* was = touching_.data();
  const PairKey* const was_end = was + touching_count_;
  auto is = pairs.begin();
  while (was != was_end || is != pairs.end()) {
    if (is == pairs.end() || (was != was_end && *was < *is)) {
      events_[event_count_++] = {*was++, EventKind::kEnd};
    } else if (was == was_end || *is < *was) {
      events_[event_count_++] = {*is++, EventKind::kBegin};
    } else {
      ++persisting_;
      ++was, ++is;
    }
  }
  touching_count_ = pairs.size();
  touching_.resize(touching_count_);
  std::copy(pairs.begin(), pairs.end(), touching_.data());
}

}  // namespace throng
