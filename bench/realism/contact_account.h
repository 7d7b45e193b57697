// Contacts of two people by density, and what is wrong with them: depth, trunk in trunk, a hand
// inside somebody, and how many are there because two heads are nearer than bodies allow.
// One rule: sums alone, so that those of several runs add up to those of all.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "analysis/measures/contact_measures.h"
#include "analysis/measures/histogram.h"
#include "scenes/run/sink.h"

namespace throng::realism {

/// Contacts whose heads never came nearer than this are counted once more by themselves. The first
/// are all.
inline constexpr std::array<double, 4> kNearHeads_m = {0, 0.30, 0.35, 0.38};

/// Of the contacts at one level of density whose heads stayed so far apart. Depths and what follows
/// from them are those of sampled instants, as long as the heads are so far apart then.
struct ContactTally {
  ContactTally();

  uint64_t contacts = 0;
  uint64_t trunks = 0;       ///< of these: trunk touched trunk
  uint64_t hands_in = 0;     ///< of these: a hand was wholly inside another part
  uint64_t hands_deep = 0;   ///< of these: one was deeper in another part than it is thick
  Histogram depths;          ///< of two parts
  Histogram depths_of_most;  ///< of two people: the deepest of their parts

  void add(const ContactTally& other);
};

struct ContactLevel {
  double person_s = 0;
  double touching_s = 0;  ///< person-seconds of those who touch somebody
  std::array<ContactTally, kNearHeads_m.size()> apart;  ///< by kNearHeads_m

  void add(const ContactLevel& other);
};

struct ContactSums {
  static constexpr size_t kLevels = ContactMeasures::kLevels;

  ContactSums();

  double person_s = 0;
  std::array<ContactLevel, kLevels> levels;
  std::vector<Histogram> depths_of;  ///< by pair of groups
  double nearest_heads_m = 100;      ///< of those who touched

  void add(const ContactSums& other);
  /// Of all levels.
  ContactLevel all() const;
};

class ContactAccount final : public Sink {
 public:
  ContactAccount();
  ~ContactAccount() override;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// After end().
  const ContactSums& sums() const { return sums_; }

 private:
  struct State;
  struct Met;

  void add_up(const Met& met);
  void sample(const RunInfo& run, const Frame& frame);
  void meet(const Frame& frame);
  void spend_time(const Frame& frame);

  std::unique_ptr<State> state_;
  ContactSums sums_;
};

}  // namespace throng::realism
