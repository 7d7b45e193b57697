#include "viewer/server/pair_history.h"

#include <map>
#include <nlohmann/json.hpp>

namespace throng {

void PairHistory::add(int64_t frame, std::span<const PairEvent> events) {
  const std::lock_guard lock(mutex_);
  for (const PairEvent& event : events) {
    if (entries_.size() == capacity_) {
      entries_.pop_front();
      ++forgotten_;
    }
    entries_.push_back({frame, event});
  }
}

void PairHistory::clear() {
  const std::lock_guard lock(mutex_);
  entries_.clear();
  forgotten_ = 0;
}

std::string PairHistory::of(uint32_t body, int64_t frame, size_t most) const {
  nlohmann::json pairs = nlohmann::json::array();
  std::map<PairKey, int64_t> ends;  // seen on the way back, their begins not yet
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && pairs.size() < most; ++entry) {
    const PairKey& pair = entry->event.pair;
    if (entry->frame > frame || (pair.a() != body && pair.b() != body)) continue;
    if (entry->event.kind == EventKind::kEnd) {
      ends[pair] = entry->frame;
      continue;
    }
    const auto end = ends.find(pair);
    pairs.push_back({entry->frame, end == ends.end() ? int64_t{-1} : end->second, pair.a(),
                     pair.b(), pair.part_a(), pair.part_b()});
    if (end != ends.end()) ends.erase(end);
  }
  return nlohmann::json{{"history", body}, {"pairs", pairs}, {"forgotten", forgotten_}}.dump();
}

}  // namespace throng
