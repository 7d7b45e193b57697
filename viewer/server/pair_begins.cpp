#include "viewer/server/pair_begins.h"

#include <utility>

namespace throng {

void PairBegins::set(Begins begins, const RunReader& run) {
  begins_ = std::move(begins);
  changes_.clear();
  missing_ = run.tally(Channel::kEvents).missing;
}

void PairBegins::begin(PairKey pair, int64_t frame, BeginFrame began) {
  begins_[pair] = began;
  changes_.push_back({pair, ChangeKind::kBegan, frame, began});
}

/// Events are missing before `frame`: what touched before it may have ended and begun anew.
void PairBegins::doubt(int64_t frame) {
  for (const auto& [pair, began] : begins_) {
    if (began == frame) continue;
    changes_.push_back({pair, ChangeKind::kLost, frame + 1, began});
    begin(pair, frame + 1, began_before(frame + 1));
  }
}

/// A full list heals what was missed. Both are sorted by pair.
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
    if (event.kind == EventKind::kBegin) {
      begin(event.pair, frame, frame);
    } else if (const auto known = begins_.find(event.pair); known != begins_.end()) {
      changes_.push_back({event.pair, ChangeKind::kEnded, frame, known->second});
      begins_.erase(known);
    }
  }
  const int64_t missing = run.tally(Channel::kEvents).missing;
  if (missing > missing_) doubt(frame);
  missing_ = missing;
  return is_new;
}

}  // namespace throng
