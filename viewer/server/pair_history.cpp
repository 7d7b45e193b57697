#include "viewer/server/pair_history.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace throng {
namespace {

using Kind = PairBegins::ChangeKind;
constexpr int64_t kUnheard = -2;  // an end that was lost

}  // namespace

void PairHistory::add(std::span<const PairBegins::Change> changes) {
  if (changes.empty()) return;
  const std::lock_guard lock(mutex_);
  for (const PairBegins::Change& change : changes) {
    if (entries_.size() == capacity_) {
      known_from_ = std::max(known_from_, entries_.front().frame + 1);
      entries_.pop_front();
      ++forgotten_;
    }
    entries_.push_back(change);
  }
}

void PairHistory::clear() {
  const std::lock_guard lock(mutex_);
  entries_.clear();
  forgotten_ = 0;
  known_from_ = 0;
}

std::string PairHistory::of(uint32_t body, int64_t frame, size_t max) const {
  nlohmann::json pairs = nlohmann::json::array();
  std::map<PairKey, int64_t> ends;  // seen on the way back, their begins not yet
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && pairs.size() < max; ++entry) {
    const PairKey& pair = entry->pair;
    if (entry->frame > frame || (pair.a() != body && pair.b() != body)) continue;
    if (entry->kind != Kind::kBegan) {
      ends[pair] = entry->kind == Kind::kEnded ? entry->frame : kUnheard;
      continue;
    }
    const auto found = ends.find(pair);
    const int64_t end = found == ends.end() ? -1 : found->second;
    // How long a contact took whose end was lost, nobody knows: it is not told.
    if (end != kUnheard)
      pairs.push_back({entry->began, end, pair.a(), pair.b(), pair.part_a(), pair.part_b()});
    if (found != ends.end()) ends.erase(found);
  }
  return nlohmann::json{
      {"history", body}, {"frame", frame}, {"pairs", pairs}, {"forgotten", forgotten_}}
      .dump();
}

PairBegins::Begins PairHistory::begins_at(int64_t frame,
                                          const RunReader::Touching& touching) const {
  PairBegins::Begins begins;
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && begins.size() < touching.size();
       ++entry) {
    if (entry->frame > frame || !touching.contains(entry->pair)) continue;
    // A pair whose newest change is no begin touches by a list that came later.
    begins.try_emplace(entry->pair,
                       entry->kind == Kind::kBegan ? entry->began : began_before(frame + 1));
  }
  for (const auto& [pair, level] : touching) begins.try_emplace(pair, began_before(known_from_));
  return begins;
}

}  // namespace throng
