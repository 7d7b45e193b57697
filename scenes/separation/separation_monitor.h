// SeparationMonitor measures the separation of robots from people per body region and reports
// shortfalls of the required distance.
// Invariant: nothing is extrapolated; beyond the margin the separation is unknown, and pairs
// without a speed are undetermined.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "base/pose.h"
#include "culling/proximity.h"
#include "scenes/run/sink.h"
#include "scenes/separation/body_region.h"

namespace throng {

/// Separation of a robot from one region of people, in a frame.
struct RegionSeparation {
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  uint32_t robot = 0;
  BodyRegion region = BodyRegion::kOther;
  /// Distance bounds of the pair of parts with the least lower bound. The margin and infinity if no
  /// pair is within the margin; other members are then unknown.
  float lo_m = 0, hi_m = kFar;
  PairKey pair{};
  float closing_speed_mps = kUnknown;  ///< along the line between the parts, as the next two
  float robot_speed_mps = kUnknown;    ///< towards the person: measured or from the rule
  float human_speed_mps = kUnknown;    ///< towards the robot: measured or from the rule
  float required_m = kUnknown;
  /// Minimum of lo_m minus the required distance over all pairs; below 0: too close; NaN: unknown.
  float min_slack_m = kUnknown;
  uint32_t people_too_close = 0;  ///< number of people that the robot is too close to

  bool is_far() const { return hi_m == kFar; }
};

/// Interval in which a robot is too close to a region of a person: [begin_frame, end_frame).
struct Shortfall {
  uint32_t robot = 0, person = 0;
  BodyRegion region = BodyRegion::kOther;
  int64_t begin_frame = 0, end_frame = 0;
  float min_distance_lo_m = RegionSeparation::kFar, min_distance_hi_m = RegionSeparation::kFar;
  float max_shortfall_m = 0;  ///< maximum of the required distance minus lo_m
  bool is_truncated = false;  ///< too close at the start or end of the run
  /// In some frame more than the margin was required: it may have begun earlier and ended later.
  bool is_beyond_margin = false;
};

struct RegionTotals {
  bool is_there = false;
  uint64_t shortfalls = 0;
  double shortfall_s = 0;  ///< summed over robots, with any person
  float min_distance_lo_m = RegionSeparation::kFar, min_distance_hi_m = RegionSeparation::kFar;
  float max_shortfall_m = 0;
};

struct SeparationTotals {
  std::array<RegionTotals, kBodyRegions> regions{};
  uint32_t robots = 0;
  uint64_t shortfalls = 0;
  uint64_t pairs = 0;  ///< pairs of parts over all frames
  uint64_t undetermined = 0;
  uint64_t beyond_margin = 0;
};

class SeparationMonitor {
 public:
  explicit SeparationMonitor(const RunInfo& run);

  /// Processes the next frame; frames need postures if speeds are measured.
  void frame(const RunInfo& run, const Frame& frame);
  /// Ends all open shortfalls as truncated.
  void end();

  /// Rows of the latest frame by robot and region: robots in the scene, regions that people have.
  std::span<const RegionSeparation> rows() const { return rows_; }
  /// Shortfalls that began or ended in the latest frame or at the end, by (robot, person, region).
  std::span<const Shortfall> begun() const { return begun_; }
  std::span<const Shortfall> ended() const { return ended_; }
  const SeparationTotals& totals() const { return totals_; }
  std::span<const uint32_t> robots() const { return robots_; }

 private:
  struct EvaluatedPair {
    uint32_t robot_index = 0, person = 0;
    BodyRegion region = BodyRegion::kOther;
    RegionSeparation row;
    bool is_too_close() const { return row.lo_m < row.required_m; }
    bool is_determined() const { return row.required_m == row.required_m; }
    auto key() const { return std::tuple(robot_index, person, region); }
  };
  struct RobotParts {
    bool is_known = false;
    RootPose root;
    std::vector<PartPose> previous, current;
  };

  bool is_robot(uint32_t id) const { return id < robot_index_.size() && robot_index_[id] >= 0; }
  bool is_person(uint32_t id) const { return id < robot_index_.size() && robot_index_[id] < 0; }
  void pose_robots(const RunInfo& run, const Frame& frame);
  void store_robot_poses(const Frame& frame);
  void add(const ProximityPair& pair);
  double robot_speed_mps(const ProximityPair& pair, bool robot_is_a) const;
  void fill_rows(const Frame& frame);
  void update_shortfall(std::span<const EvaluatedPair> pairs, size_t& open);
  void close(Shortfall shortfall, bool truncated);

  SeparationRule rule_;
  double step_s_;
  float margin_m_;
  std::vector<int32_t> robot_index_;  ///< indexed by avatar; -1: person
  std::vector<uint32_t> robots_;
  std::vector<std::vector<BodyRegion>> regions_;
  std::vector<uint16_t> model_of_avatar_;
  std::vector<RobotParts> robot_parts_;  ///< indexed by robot; only if speeds are measured
  std::span<const RootPose> roots_;

  int64_t frame_ = 0;
  int64_t frames_seen_ = 0;  ///< no measured speeds in the first frame
  std::vector<EvaluatedPair> evaluated_;
  std::vector<RegionSeparation> rows_;
  std::vector<Shortfall> open_, next_open_;  ///< sorted by (robot, person, region)
  std::vector<Shortfall> begun_, ended_;
  SeparationTotals totals_;
};

}  // namespace throng
