// What a run's contacts add up to: how often, how long, with which body parts, how dense it was.
// One rule: a contact of two people lasts from the first of their parts that touch to the last that
// part; every contact counts once, and those cut off by the start or end of the run are counted
// apart where their length matters.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "analysis/contacts/contact_tracker.h"
#include "base/files/anonymous_file.h"
#include "scenes/run/sink.h"

namespace throng {

/// One contact of two people.
struct Contact {
  uint32_t a = 0;  ///< the lower id
  uint32_t b = 0;
  double begin_s = 0;
  double duration_s = 0;                              ///< so far, if `cut`
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< between the two at the beginning
  double density_per_m2 = 0;                          ///< mean around the two at the beginning
  uint32_t first_part_a = 0;
  uint32_t first_part_b = 0;
  uint32_t part_contacts = 0;  ///< pairs of parts that began to touch meanwhile
  bool cut = false;            ///< touched when the run began or ended: the length is a lower bound
};

/// One contact of two parts of two people.
struct PartContact {
  int64_t begin_frame = 0;
  PairKey pair;
  int64_t frames = 0;  ///< so far, if `cut`
  bool cut = false;    ///< as in Contact
};

/// By begin, then by pair.
struct PartContactOrder {
  bool operator()(const PartContact& a, const PartContact& b) const {
    if (a.begin_frame != b.begin_frame) return a.begin_frame < b.begin_frame;
    return a.pair.bits() < b.pair.bits();
  }
};

struct PersonContacts {
  double present_s = 0;
  double touching_s = 0;  ///< with anybody
  uint32_t contacts = 0;  ///< with people
  uint32_t partners = 0;  ///< after ContactStatistics::end()
  uint32_t obstacle_contacts = 0;
};

struct ContactTotals {
  uint64_t contacts = 0;  ///< of two people
  uint64_t obstacle_contacts = 0;
  uint64_t people_touched = 0;  ///< who had at least one contact
  double person_s = 0;
  double touching_s = 0;  ///< person-seconds
  double median_s = 0;    ///< of those not cut
  /// Each contact is one of both people.
  double per_person_min() const { return contacts_per_person_min(contacts, person_s, 0); }
};

struct DensityRow {
  uint64_t contacts = 0;
  double person_s = 0;  ///< that people spent at this level, sampled once a second
  double per_person_min() const { return contacts_per_person_min(contacts, person_s, 0); }
};

struct MinuteRow {
  uint64_t contacts = 0;
  double person_s = 0;
};

/// Contacts of people by the two parts; symmetric.
struct PartMatrix {
  std::vector<std::string> names;  ///< the parts of all models, then "whole body" if there was any
  std::vector<uint64_t> counts;    ///< names x names
  std::vector<double> seconds;     ///< names x names
  std::vector<uint64_t> obstacle_counts;  ///< by name
};

class ContactStatistics {
 public:
  explicit ContactStatistics(const RunInfo& run);

  void frame(const Frame& frame);
  /// What still touches ends here, cut.
  void end(const RunEnd& end);

  /// The contacts that ended in the latest frame() or end(), ordered by (a, b).
  const std::vector<Contact>& ended() const { return ended_; }

  ContactTotals totals() const;
  const std::vector<PersonContacts>& people() const { return people_; }
  const std::vector<MinuteRow>& minutes() const { return minutes_; }
  const std::array<DensityRow, DensityLevels::kCount>& densities() const { return densities_; }
  PartMatrix parts() const;
  /// How many contacts that were not cut lasted so many frames, by frames; how many these are, and
  /// how many were cut.
  const std::vector<uint64_t>& lengths() const { return lengths_; }
  uint64_t uncut_count() const { return uncut_; }
  uint64_t cut_count() const { return cut_; }
  /// After end(): every contact of two parts of people, by begin and pair. Throws EnvironmentError,
  /// as frame() does, if they do not fit into a temporary file, 32 bytes each.
  template <typename Visit>
  void for_each_part_contact(const Visit& visit) const {
    part_contacts_.for_each(visit);
  }
  double step_s() const { return step_s_; }
  std::string part_name(uint32_t id, uint32_t part) const;

 private:
  struct NoData {};

  bool is_person(uint32_t id) const { return id < people_.size(); }
  uint32_t name_index(uint32_t id, uint32_t part) const;
  void take(std::span<const PairEvent> events, bool ends_the_run);
  void begin(PairKey pair);
  void finish(PartContact part, bool cut);
  void finish(Contact contact, bool cut);
  void add_length(double duration_s);
  void add_part_time(PairKey pair, double duration_s);
  Eigen::Vector2d position_m(uint32_t id) const { return roots_[id].position_m.head<2>(); }
  void accumulate_time(const Frame& frame);
  void count_partners();

  double step_s_;
  int64_t sample_every_;
  CrowdDensity density_;
  std::vector<uint16_t> model_of_avatar_;
  std::vector<std::vector<uint32_t>> name_of_part_;  ///< by model and part: index into names_
  std::vector<std::string> names_;
  uint32_t whole_body_;  ///< index into names_

  int64_t frame_ = 0;
  bool is_first_ = true;
  std::span<const RootPose> roots_;  ///< of the latest frame
  std::vector<uint32_t> touching_;   ///< by person: how many people now
  ContactTracker<Contact> open_{0};
  ContactTracker<PartContact> open_parts_{0};
  ContactTracker<NoData> open_obstacles_{0};             ///< of a person and an obstacle
  ExternalSorter<uint64_t, std::less<>> contact_pairs_;  ///< pair_key() of each contact
  std::vector<Contact> ended_;
  ExternalSorter<PartContact, PartContactOrder> part_contacts_;

  std::vector<PersonContacts> people_;
  std::vector<MinuteRow> minutes_;
  std::array<DensityRow, DensityLevels::kCount> densities_{};
  std::vector<uint64_t> part_counts_;
  std::vector<double> part_seconds_;
  std::vector<uint64_t> obstacle_part_counts_;
  std::vector<uint64_t> lengths_;
  uint64_t uncut_ = 0;
  uint64_t cut_ = 0;
  uint64_t contacts_ = 0;
  uint64_t obstacle_contacts_ = 0;
};

}  // namespace throng
