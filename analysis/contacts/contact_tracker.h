// The account of contacts that all who count them read: which pairs of parts are one contact, when
// it begins and ends, and how dense it is around people.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "analysis/contacts/local_density.h"
#include "scenes/run/sink.h"

namespace throng {

/// Two people as one number, ordered as (a, b); a < b.
inline uint64_t pair_key(uint32_t a, uint32_t b) { return (uint64_t{a} << 32) | b; }
inline uint64_t people_of(PairKey pair) { return pair_key(pair.a(), pair.b()); }

/// At least one.
inline int64_t frames_in(double seconds, double step_s) {
  return std::max<int64_t>(1, std::llround(seconds / step_s));
}

/// Both people have a contact. `otherwise`: where there is no time.
inline double contacts_per_person_min(uint64_t contacts, double person_s,
                                      double fallback = std::numeric_limits<double>::quiet_NaN()) {
  return person_s > 0 ? 2 * static_cast<double>(contacts) / person_s * 60 : fallback;
}

/// Contacts that go on or have ended so lately that they may go on again: what parts for less than
/// the gap has not parted. Each contact comes out once, when it is over, with what was kept of it.
template <typename Data>
class ContactTracker {
 public:
  explicit ContactTracker(double gap_s) : gap_s_(gap_s) {}

  /// A frame's events. key_of(pair): the contact of a pair of parts. touched(pair, kept, begins)
  /// for each pair that begins; then over(kept) for each contact that is over: at once without a
  /// gap, in a later frame's call with one.
  template <typename KeyOf, typename OnTouch, typename OnEnd>
  void take(std::span<const PairEvent> events, double now_s, const KeyOf& key_of,
            const OnTouch& on_touch, const OnEnd& on_end) {
    if (gap_s_ > 0) forget_ended(now_s, on_end);
    // Begins first: a pair that is refined further than before changes its parts, not its contact.
    for (const PairEvent& event : events)
      if (event.kind == EventKind::kBegin) {
        Data* data = nullptr;
        const bool begins = begin(key_of(event.pair), data);
        on_touch(event.pair, *data, begins);
      }
    for (const PairEvent& event : events)
      if (event.kind == EventKind::kEnd) finish(key_of(event.pair), now_s, on_end);
  }
  /// One more pair of parts touches. True if a contact begins, not goes on.
  bool begin(uint64_t key, Data*& data) {
    const auto [found, is_new] = open_.try_emplace(key);
    ++found->second.touching;
    data = &found->second.data;
    return is_new;
  }
  template <typename OnEnd>
  void finish(uint64_t key, double now_s, const OnEnd& on_end) {
    const auto found = open_.find(key);
    if (found == open_.end() || found->second.touching == 0) return;
    if (--found->second.touching > 0) return;
    found->second.ended_s = now_s;
    if (!is_over(found->second, now_s)) return;
    const Data data = std::move(found->second.data);
    open_.erase(found);
    on_end(data);
  }
  /// Null: there is no such contact.
  Data* find(uint64_t key) {
    const auto found = open_.find(key);
    return found == open_.end() ? nullptr : &found->second.data;
  }
  template <typename OnEnd>
  void forget_all(const OnEnd& on_end) {
    for (const auto& [key, contact] : open_) on_end(contact.data);
    open_.clear();
  }

 private:
  struct Open {
    uint32_t touching = 0;  ///< pairs of parts
    double ended_s = 0;     ///< counts if nothing touches
    Data data{};
  };
  bool is_over(const Open& contact, double now_s) const {
    return contact.touching == 0 && now_s - contact.ended_s >= gap_s_ - 1e-9;
  }
  template <typename OnEnd>
  void forget_ended(double now_s, const OnEnd& on_end) {
    std::erase_if(open_, [&](const auto& contact) {
      if (!is_over(contact.second, now_s)) return false;
      on_end(contact.second.data);
      return true;
    });
  }

  double gap_s_;
  std::unordered_map<uint64_t, Open> open_;
};

/// How dense it is around the people of a frame, looked up only where it is asked for.
class CrowdDensity {
 public:
  explicit CrowdDensity(const RunInfo& run)
      : density_(*run.scene),
        positions_m_(run.model_of_avatar.size()),
        densities_(run.model_of_avatar.size()) {}

  /// The frame must last as long as it is asked for.
  void frame(const Frame& frame) {
    frame_ = &frame;
    is_placed_ = false;
  }
  /// People per m2 around a person; around two, the mean of both.
  double at(uint32_t person);
  double between(uint32_t a, uint32_t b) { return 0.5 * (at(a) + at(b)); }

 private:
  void place();

  LocalDensity density_;
  std::vector<Eigen::Vector2d> positions_m_;
  std::vector<double> densities_;  ///< by person, of this frame; below 0: not asked for yet
  const Frame* frame_ = nullptr;
  bool is_placed_ = false;
};

}  // namespace throng
