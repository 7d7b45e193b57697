// ContactTracker merges touching pairs of parts into contacts with a begin and an end.
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

/// Key of an unordered pair of people; requires a < b, keeps the order of (a, b).
inline uint64_t pair_key(uint32_t a, uint32_t b) { return (uint64_t{a} << 32) | b; }
inline uint64_t people_of(PairKey pair) { return pair_key(pair.a(), pair.b()); }

/// Number of frames in a duration; at least 1.
inline int64_t frames_in(double seconds, double step_s) {
  return std::max<int64_t>(1, std::llround(seconds / step_s));
}

/// Contacts per person and minute; each contact counts for both people. `fallback`: result if
/// `person_s` is 0.
inline double contacts_per_person_min(uint64_t contacts, double person_s,
                                      double fallback = std::numeric_limits<double>::quiet_NaN()) {
  return person_s > 0 ? 2 * static_cast<double>(contacts) / person_s * 60 : fallback;
}

/// Tracks open contacts and recently ended ones. A contact that ends and begins again within the
/// gap is one contact. Each contact is reported once, when it is over, with its data.
template <typename Data>
class ContactTracker {
 public:
  explicit ContactTracker(double gap_s) : gap_s_(gap_s) {}

  /// Processes the events of a frame. key_of(pair) returns the contact of a pair of parts.
  /// on_touch(pair, data, begins) is called for each pair that begins. on_end(data) is called for
  /// each contact that is over: immediately without a gap, in a later frame with one.
  template <typename KeyOf, typename OnTouch, typename OnEnd>
  void take(std::span<const PairEvent> events, double now_s, const KeyOf& key_of,
            const OnTouch& on_touch, const OnEnd& on_end) {
    if (gap_s_ > 0) forget_ended(now_s, on_end);
    // Begins first: a pair that is refined further changes its parts, not its contact.
    for (const PairEvent& event : events)
      if (event.kind == EventKind::kBegin) {
        Data* data = nullptr;
        const bool begins = begin(key_of(event.pair), data);
        on_touch(event.pair, *data, begins);
      }
    for (const PairEvent& event : events)
      if (event.kind == EventKind::kEnd) finish(key_of(event.pair), now_s, on_end);
  }
  /// Adds a touching pair of parts. Returns true if this begins a contact.
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
  /// Returns null if the contact does not exist.
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
    uint32_t touching = 0;  ///< number of touching pairs of parts
    double ended_s = 0;     ///< valid if touching is 0
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

/// Density around the people of a frame, computed on demand.
class CrowdDensity {
 public:
  explicit CrowdDensity(const RunInfo& run)
      : density_(*run.scene),
        positions_m_(run.model_of_avatar.size()),
        densities_(run.model_of_avatar.size()) {}

  /// Sets the frame; it must outlive the calls of at() and between().
  void frame(const Frame& frame) {
    frame_ = &frame;
    is_placed_ = false;
  }
  /// People per m2 around one person, and the mean of the densities around two.
  double at(uint32_t person);
  double between(uint32_t a, uint32_t b) { return 0.5 * (at(a) + at(b)); }

 private:
  void place();

  LocalDensity density_;
  std::vector<Eigen::Vector2d> positions_m_;
  /// Indexed by person, for this frame; negative: not computed yet.
  std::vector<double> densities_;
  const Frame* frame_ = nullptr;
  bool is_placed_ = false;
};

}  // namespace throng
