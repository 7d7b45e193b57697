#include "viewer/server/pair_history.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace throng {

int32_t to_int32(int64_t frame) {
  return static_cast<int32_t>(std::clamp<int64_t>(frame, INT32_MIN, INT32_MAX));
}

void PairBegins::set(Begins begins, const RunReader& run) {
  begins_ = std::move(begins);
  changes_.clear();
  missing_ = run.tally(Channel::kEvents).missing;
}

void PairBegins::begin(PairKey pair, int64_t frame, BeginFrame began) {
  begins_[pair] = began;
  changes_.push_back({pair, ChangeKind::kBegan, frame, began});
}

/// Marks a loss before `frame`: pairs that touched may have ended and begun again.
void PairBegins::mark_lost(int64_t frame) {
  for (const auto& [pair, began] : begins_) {
    if (began == frame) continue;
    changes_.push_back({pair, ChangeKind::kLost, frame + 1, began});
    begin(pair, frame + 1, began_before(frame + 1));
  }
}

/// Corrects the begins by a full list. Both are sorted by pair.
void PairBegins::match(const RunReader::Touching& touching, int64_t frame) {
  auto listed = touching.begin();
  for (auto known = begins_.begin(); known != begins_.end();) {
    while (listed != touching.end() && listed->first < known->first) ++listed;
    if (listed != touching.end() && listed->first == known->first) {
      ++known;
      continue;
    }
    changes_.push_back({known->first, ChangeKind::kLost, frame, known->second});
    known = begins_.erase(known);
  }
  if (begins_.size() == touching.size()) return;
  for (const auto& [pair, level] : touching)
    if (!begins_.contains(pair)) begin(pair, frame, began_before(frame + 1));
}

bool PairBegins::take(const RunReader& run, RunReader::Update update) {
  changes_.clear();
  if (run.header() == nullptr) return false;
  const bool is_new = update_begins(run, update);
  for (Change& change : changes_) change.set_place(run.state());
  return is_new;
}

void PairBegins::Change::set_place(const CrowdState& crowd) {
  const std::vector<RootPose>& roots = crowd.roots;
  const uint32_t a = pair.a(), b = pair.b();
  if (a >= roots.size()) return;
  const Eigen::Vector3d& other_m = roots[b < roots.size() ? b : a].position_m;
  place_m = (0.5 * (roots[a].position_m + other_m)).head<2>().cast<float>();
}

bool PairBegins::update_begins(const RunReader& run, RunReader::Update update) {
  const bool is_new = !has_run_ || run.run_id() != run_id_ || run.instance() != instance_;
  if (is_new) {
    *this = {};
    has_run_ = true;
    run_id_ = run.run_id();
    instance_ = run.instance();
  }
  const int64_t frame = run.header()->frame;
  if (update == RunReader::Update::kTouching || update == RunReader::Update::kRun)
    match(run.touching(), frame);
  if (update != RunReader::Update::kEvents) return is_new;
  for (const PairEvent& event : run.new_events()) {
    const auto known = begins_.find(event.pair);
    if (event.kind == EventKind::kBegin) {
      if (known != begins_.end())  // its end was not received
        changes_.push_back({event.pair, ChangeKind::kLost, frame, known->second});
      begin(event.pair, frame, frame);
    } else if (known != begins_.end()) {
      changes_.push_back({event.pair, ChangeKind::kEnded, frame, known->second});
      begins_.erase(known);
    }
  }
  const int64_t missing = run.tally(Channel::kEvents).missing;
  if (missing > missing_) mark_lost(frame);
  missing_ = missing;
  return is_new;
}

namespace {

using Kind = PairBegins::ChangeKind;
constexpr int64_t kLostEnd = -2;

}  // namespace

void PairHistory::add(std::span<const PairBegins::Change> changes) {
  if (changes.empty()) return;
  const std::lock_guard lock(mutex_);
  for (const PairBegins::Change& change : changes) {
    if (entries_.size() == capacity_) {
      known_from_ = std::max(known_from_, entries_.front().frame + 1);
      entries_.pop_front();
      ++discarded_;
    }
    entries_.push_back(change);
  }
}

void PairHistory::complete(int64_t frame, const CrowdState& crowd) {
  const std::lock_guard lock(mutex_);
  complete_ = frame;
  if (crowd.frame != frame) return;
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && entry->frame >= frame; ++entry)
    entry->set_place(crowd);
}

void PairHistory::clear() {
  const std::lock_guard lock(mutex_);
  entries_.clear();
  discarded_ = 0;
  complete_ = -1;
  known_from_ = 0;
}

std::string PairHistory::of(uint32_t body, int64_t frame, size_t max) const {
  nlohmann::json pairs = nlohmann::json::array();
  std::map<PairKey, int64_t> ends;  // ends whose begin lies further back
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && pairs.size() < max; ++entry) {
    const PairKey& pair = entry->pair;
    if (entry->frame > frame || (pair.a() != body && pair.b() != body)) continue;
    if (entry->kind != Kind::kBegan) {
      ends[pair] = entry->kind == Kind::kEnded ? entry->frame : kLostEnd;
      continue;
    }
    const auto found = ends.find(pair);
    const int64_t end = found == ends.end() ? -1 : found->second;
    // The duration of a contact without a recorded end is unknown.
    if (end != kLostEnd)
      pairs.push_back({entry->began, end, pair.a(), pair.b(), pair.part_a(), pair.part_b()});
    if (found != ends.end()) ends.erase(found);
  }
  return nlohmann::json{
      {"history", body}, {"frame", frame}, {"pairs", pairs}, {"discarded", discarded_}}
      .dump();
}

Bytes PairHistory::changes_from(uint64_t first, int64_t since, size_t max) const {
  Bytes out;
  const std::lock_guard lock(mutex_);
  const uint64_t skipped = first - std::min(first, discarded_);
  // A loss is dated one frame ahead of messages that follow it: no binary search.
  const auto begin = std::find_if(
      entries_.begin() + static_cast<std::ptrdiff_t>(std::min<uint64_t>(skipped, entries_.size())),
      entries_.end(), [since](const PairBegins::Change& entry) { return entry.frame >= since; });
  const size_t count = std::min(max, static_cast<size_t>(entries_.end() - begin));
  out.reserve(sizeof(ContactsHead) + count * sizeof(ContactRecord));
  put(out, ContactsHead{.count = static_cast<uint32_t>(count),
                        .first = static_cast<double>(
                            discarded_ + static_cast<uint64_t>(begin - entries_.begin())),
                        .known = static_cast<double>(discarded_ + entries_.size()),
                        .frame = static_cast<double>(complete_)});
  std::for_each_n(begin, count, [&out](const PairBegins::Change& entry) {
    const PairKey& pair = entry.pair;
    put(out,
        ContactRecord{to_int32(entry.frame), to_int32(entry.began), pair.a(), pair.b(),
                      static_cast<uint8_t>(pair.part_a()), static_cast<uint8_t>(pair.part_b()),
                      static_cast<uint8_t>(entry.kind), 0, entry.place_m.x(), entry.place_m.y()});
  });
  return out;
}

PairBegins::Begins PairHistory::begins_at(int64_t frame,
                                          const RunReader::Touching& touching) const {
  PairBegins::Begins begins;
  const std::lock_guard lock(mutex_);
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && begins.size() < touching.size();
       ++entry) {
    if (entry->frame > frame || !touching.contains(entry->pair)) continue;
    // A pair whose newest change is no begin touches according to a later list.
    begins.try_emplace(entry->pair,
                       entry->kind == Kind::kBegan ? entry->began : began_before(frame + 1));
  }
  for (const auto& [pair, level] : touching) begins.try_emplace(pair, began_before(known_from_));
  return begins;
}

}  // namespace throng
