// Measures of contacts: how many a person and minute, by density and by part; and how deep.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "analysis/contacts/contact_tracker.h"
#include "analysis/measures/measure_table.h"
#include "analysis/part_names.h"
#include "culling/distance/hull_depth.h"
#include "scenes/run/sink.h"

namespace throng {

/// How deep the parts of people who touch are in each other, at one instant.
/// Triangles decided that they touch; hulls only say how far.
class ContactDepths {
 public:
  explicit ContactDepths(const RunInfo& run);

  /// Calls found(pair, depth in m) for every pair of parts of two people that touch now. The frame
  /// has postures.
  void find(const RunInfo& run, const Frame& frame,
            const std::function<void(PairKey, double)>& found);

 private:
  const PartPose* poses_of(const RunInfo& run, const Frame& frame, uint32_t avatar);

  std::vector<std::vector<ConvexHull>> hulls_;  ///< by model and part
  std::vector<size_t> first_pose_;              ///< by avatar, of this frame; kNone: not posed
  std::vector<PartPose> poses_;
  DepthFinder finder_;
};

/// The bins of all depths.
Histogram depth_histogram();

/// Contacts of two people: how many a person and minute, by density and by part; and how deep.
/// As in contact_statistics.h, but two people who part for less than half a second are
/// still at the same contact, and memory grows with the people who touch now, not with the
/// contacts.
class ContactMeasures {
 public:
  static constexpr double kGap_s = 0.5;
  /// People per m2 within 2 m.
  static constexpr std::array<double, 5> kBounds_per_m2 = {0.43, 1, 2, 3.57, 5};
  static constexpr size_t kLevels = kBounds_per_m2.size() + 1;

  /// Who parts for less than gap_s has not parted. Whoever came in less than settles_s ago does not
  /// count: a body that appears beside another had no time to give way.
  explicit ContactMeasures(const RunInfo& run, double gap_s = kGap_s, double settles_s = 0);

  void frame(const Frame& frame);
  void end();

  /// After frame(), while its spans last: the level of density around two people; how deep two
  /// parts of them are.
  size_t level_of(uint32_t a, uint32_t b) { return level_at(density_.between(a, b)); }
  void add_depth(PairKey pair, double depth_m);

  /// Of so many people per m2.
  static size_t level_at(double density_per_m2);

  uint64_t contacts() const;
  double person_s() const { return person_s_; }
  /// By level of density.
  const std::array<uint64_t, kLevels>& contacts_at() const { return contacts_; }
  const std::array<double, kLevels>& person_s_at() const { return person_s_at_; }
  MeasureTable contact_table() const;
  MeasureTable depth_table() const;

 private:
  struct MaxDepth {
    double depth_m = -1;  ///< below 0: not looked at
  };
  struct NoData {};

  void note_entries(const Frame& frame);
  bool is_settled(uint32_t person) const {
    return now_s_ - entered_s_[person] >= settles_s_ - 1e-9;
  }
  void add_max_depth(const MaxDepth& max_depth);
  void accumulate_time(const Frame& frame);
  uint64_t group_key(PairKey pair) const;

  double step_s_;
  double gap_s_;
  double settles_s_;
  int64_t sample_every_;
  size_t people_;
  PartGroups groups_;
  CrowdDensity density_;
  std::vector<double> entered_s_;  ///< by person; infinite: is not there
  double now_s_ = 0;

  std::vector<PairEvent> events_;       ///< of two people, of this frame
  ContactTracker<MaxDepth> open_;       ///< of two people
  ContactTracker<NoData> open_groups_;  ///< of groups of parts of two people
  std::array<uint64_t, kLevels> contacts_{};
  std::array<double, kLevels> person_s_at_{};
  std::array<uint64_t, kGroupPairs> group_contacts_{};
  double person_s_ = 0;

  Histogram depths_;                  ///< of two parts, at sampled instants
  Histogram max_depths_;              ///< of a contact
  std::vector<Histogram> depths_at_;  ///< by level
  std::vector<Histogram> depths_of_;  ///< by pair of groups
};

}  // namespace throng
