#include "culling/pair_events.h"

#include <algorithm>
#include <cassert>

namespace throng {

void PairEvents::advance(std::span<const PairKey> pairs) {
  assert(std::is_sorted(pairs.begin(), pairs.end()));
  assert(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end());
  events_.clear();
  persisting_ = 0;
  auto was = touching_.begin();
  auto is = pairs.begin();
  while (was != touching_.end() || is != pairs.end()) {
    if (is == pairs.end() || (was != touching_.end() && *was < *is)) {
      events_.push_back({*was++, EventKind::kEnd});
    } else if (was == touching_.end() || *is < *was) {
      events_.push_back({*is++, EventKind::kBegin});
    } else {
      ++persisting_;
      ++was, ++is;
    }
  }
  touching_.assign(pairs.begin(), pairs.end());
}

}  // namespace throng
