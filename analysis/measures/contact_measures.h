// ContactMeasures counts contacts per person and minute, and measures their penetration depth.
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

/// Computes penetration depths of touching parts of people at one instant. Triangles decide whether
/// parts touch; the depth is that of their convex hulls.
class ContactDepths {
 public:
  explicit ContactDepths(const RunInfo& run);

  /// Calls found(pair, depth in m) for every touching pair of parts of two people. Requires a frame
  /// with postures.
  void find(const RunInfo& run, const Frame& frame,
            const std::function<void(PairKey, double)>& found);

 private:
  const PartPose* poses_of(const RunInfo& run, const Frame& frame, uint32_t avatar);

  std::vector<std::vector<ConvexHull>> hulls_;  ///< indexed by model, then part
  /// Index into poses_ by avatar, for this frame; kNone: not posed.
  std::vector<size_t> first_pose_;
  std::vector<PartPose> poses_;
  DepthFinder finder_;
};

/// Empty histogram with the bins of all depths.
Histogram depth_histogram();

/// Contacts of two people per person and minute, by density and by part, and their depths.
/// Definitions as in contact_statistics.h, except that two people who touch again within kGap_s
/// continue their contact. Memory grows with the number of open contacts only.
class ContactMeasures {
 public:
  static constexpr double kGap_s = 0.5;
  /// Density of people within 2 m, lower ends of the levels above the lowest.
  static constexpr std::array<double, 5> kBounds_per_m2 = {0.43, 1, 2, 3.57, 5};
  static constexpr size_t kLevels = kBounds_per_m2.size() + 1;

  /// `gap_s`: contacts that begin again within this time continue. `settles_s`: people count from
  /// this time after entering, because a body that appears next to another could not avoid it.
  explicit ContactMeasures(const RunInfo& run, double gap_s = kGap_s, double settles_s = 0);

  void frame(const Frame& frame);
  void end();

  /// level_of(): density level around two people. add_depth(): records the depth of two of their
  /// parts. Both require frame() and its spans.
  size_t level_of(uint32_t a, uint32_t b) { return level_at(density_.between(a, b)); }
  void add_depth(PairKey pair, double depth_m);

  /// Level of a density in people per m2.
  static size_t level_at(double density_per_m2);

  uint64_t contacts() const;
  double person_s() const { return person_s_; }
  /// Contacts and person-seconds, indexed by density level.
  const std::array<uint64_t, kLevels>& contacts_at() const { return contacts_; }
  const std::array<double, kLevels>& person_s_at() const { return person_s_at_; }
  MeasureTable contact_table() const;
  MeasureTable depth_table() const;

 private:
  struct MaxDepth {
    double depth_m = -1;  ///< negative: not measured
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
  std::vector<double> entered_s_;  ///< time of entering by person; infinite: not in the scene
  double now_s_ = 0;

  std::vector<PairEvent> events_;       ///< events between two people in this frame
  ContactTracker<MaxDepth> open_;       ///< contacts of two people
  ContactTracker<NoData> open_groups_;  ///< contacts of two groups of parts of two people
  std::array<uint64_t, kLevels> contacts_{};
  std::array<double, kLevels> person_s_at_{};
  std::array<uint64_t, kGroupPairs> group_contacts_{};
  double person_s_ = 0;

  Histogram depths_;                  ///< depth of touching parts at sampled instants
  Histogram max_depths_;              ///< maximum depth of each contact
  std::vector<Histogram> depths_at_;  ///< indexed by density level
  std::vector<Histogram> depths_of_;  ///< indexed by pair of part groups
};

}  // namespace throng
