// ContactStatistics counts the contacts of a run: number, duration, body parts and density.
// Invariant: a contact of two people lasts from the begin of their first touching pair of parts to
// the end of the last. Each contact counts once; truncated ones are counted apart.
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
  double duration_s = 0;                              ///< lower bound if is_truncated
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< midpoint of both at begin
  double density_per_m2 = 0;                          ///< mean around the two at begin
  uint32_t first_part_a = 0;
  uint32_t first_part_b = 0;
  uint32_t part_contacts = 0;  ///< pairs of parts that began to touch during it
  /// Exists in the first or last frame: duration is a lower bound.
  bool is_truncated = false;
};

/// One contact of two parts of two people.
struct PartContact {
  int64_t begin_frame = 0;
  PairKey pair;
  int64_t frames = 0;         ///< lower bound if is_truncated
  bool is_truncated = false;  ///< as in Contact
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
  double touching_s = 0;  ///< time in contact with at least one person
  uint32_t contacts = 0;  ///< contacts with people
  uint32_t partners = 0;  ///< number of distinct people touched; set by ContactStatistics::end()
  uint32_t obstacle_contacts = 0;
};

struct ContactTotals {
  uint64_t contacts = 0;  ///< contacts of two people
  uint64_t obstacle_contacts = 0;
  uint64_t people_touched = 0;  ///< people with at least one contact
  double person_s = 0;
  double touching_s = 0;  ///< person-seconds
  double median_s = 0;    ///< median duration of contacts that are not truncated
  /// Contacts per person and minute; each contact counts for both people.
  double per_person_min() const { return contacts_per_person_min(contacts, person_s, 0); }
};

struct DensityRow {
  uint64_t contacts = 0;
  double person_s = 0;  ///< time of people at this level, sampled once per second
  double per_person_min() const { return contacts_per_person_min(contacts, person_s, 0); }
};

struct MinuteRow {
  uint64_t contacts = 0;
  double person_s = 0;
};

/// Contacts of people by pair of parts; symmetric.
struct PartMatrix {
  std::vector<std::string> names;         ///< parts of all models, then "whole body" if it occurs
  std::vector<uint64_t> counts;           ///< names x names
  std::vector<double> seconds;            ///< names x names
  std::vector<uint64_t> obstacle_counts;  ///< indexed like names
};

class ContactStatistics {
 public:
  explicit ContactStatistics(const RunInfo& run);

  void frame(const Frame& frame);
  /// Ends all contacts that still exist, and marks them as truncated.
  void end(const RunEnd& end);

  /// Contacts that ended in the latest frame() or end(), ordered by (a, b).
  const std::vector<Contact>& ended() const { return ended_; }

  ContactTotals totals() const;
  const std::vector<PersonContacts>& people() const { return people_; }
  const std::vector<MinuteRow>& minutes() const { return minutes_; }
  const std::array<DensityRow, DensityLevels::kCount>& densities() const { return densities_; }
  PartMatrix parts() const;
  /// Number of contacts that are not truncated, indexed by duration in frames; their total; and the
  /// number of truncated contacts.
  const std::vector<uint64_t>& lengths() const { return lengths_; }
  uint64_t complete_count() const { return complete_; }
  uint64_t truncated_count() const { return truncated_; }
  /// Visits every contact of two parts of people, ordered by begin and pair. Requires end(). Throws
  /// EnvironmentError, as frame() does, if the temporary file (32 bytes each) cannot hold them.
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
  void finish(PartContact part, bool is_truncated);
  void finish(Contact contact, bool is_truncated);
  void add_length(double duration_s);
  void add_part_time(PairKey pair, double duration_s);
  Eigen::Vector2d position_m(uint32_t id) const { return roots_[id].position_m.head<2>(); }
  void accumulate_time(const Frame& frame);
  void count_partners();

  double step_s_;
  int64_t sample_every_;
  CrowdDensity density_;
  std::vector<uint16_t> model_of_avatar_;
  std::vector<std::vector<uint32_t>> name_of_part_;  ///< index into names_, by model and part
  std::vector<std::string> names_;
  uint32_t whole_body_;  ///< index into names_

  int64_t frame_ = 0;
  bool is_first_ = true;
  std::span<const RootPose> roots_;  ///< roots of the latest frame
  std::vector<uint32_t> touching_;   ///< number of people touched now, by person
  ContactTracker<Contact> open_{0};
  ContactTracker<PartContact> open_parts_{0};
  ContactTracker<NoData> open_obstacles_{0};             ///< contacts of a person and an obstacle
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
  uint64_t complete_ = 0;
  uint64_t truncated_ = 0;
  uint64_t contacts_ = 0;
  uint64_t obstacle_contacts_ = 0;
};

}  // namespace throng
