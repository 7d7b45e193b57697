// Contacts that go on or have ended so lately that they may go on again.
// One rule: what parts for less than the gap has not parted; each contact comes out once, when it
// is over, with what was kept of it.
#pragma once

#include <cstdint>
#include <unordered_map>

namespace throng {

/// `Kept`: what the owner keeps of a contact while it lasts. In each frame first forget_ended(),
/// then begin() of all that begins (a pair that is refined further changes its parts, not its
/// contact), then finish() of all that ends.
template <typename Kept>
class LastingContacts {
 public:
  explicit LastingContacts(double gap_s) : gap_s_(gap_s) {}

  /// One more pair of parts touches. True if a contact begins, not goes on.
  bool begin(uint64_t key, double now_s) {
    const auto [found, is_new] = open_.try_emplace(key);
    Open& contact = found->second;
    const bool begins = is_new || is_over(contact, now_s);
    ++contact.touching;
    return begins;
  }
  void finish(uint64_t key, double now_s) {
    const auto found = open_.find(key);
    if (found == open_.end() || found->second.touching == 0) return;
    if (--found->second.touching == 0) found->second.ended_s = now_s;
  }
  /// Null: there is no such contact.
  Kept* find(uint64_t key) {
    const auto found = open_.find(key);
    return found == open_.end() ? nullptr : &found->second.kept;
  }
  /// Calls over(kept) for each.
  template <typename Over>
  void forget_ended(double now_s, const Over& over) {
    std::erase_if(open_, [&](const auto& contact) {
      if (!is_over(contact.second, now_s)) return false;
      over(contact.second.kept);
      return true;
    });
  }
  template <typename Over>
  void forget_all(const Over& over) {
    for (const auto& [key, contact] : open_) over(contact.kept);
    open_.clear();
  }

 private:
  struct Open {
    uint32_t touching = 0;  ///< pairs of parts
    double ended_s = 0;     ///< counts if nothing touches
    Kept kept{};
  };
  bool is_over(const Open& contact, double now_s) const {
    return contact.touching == 0 && now_s - contact.ended_s >= gap_s_ - 1e-9;
  }

  double gap_s_;
  std::unordered_map<uint64_t, Open> open_;
};

}  // namespace throng
