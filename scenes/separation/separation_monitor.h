// How near robots come to which region of whom, frame by frame, and where that is nearer than the
// scene's separation requires.
// One rule: what is not known is not made up: beyond the margin the separation is "farther", and
// what has no speed is not judged.
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

/// A robot and a region of people, in a frame.
struct RegionSeparation {
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  static constexpr float kFar = std::numeric_limits<float>::infinity();

  uint32_t robot = 0;
  BodyRegion region = BodyRegion::kOther;
  /// Of the pair of parts with the least lower bound; the margin and infinity where none is within
  /// it, and then nothing else is known.
  float lo_m = 0, hi_m = kFar;
  PairKey pair{};
  float closing_speed_mps = kUnknown;  ///< along the line between the two, as the next two
  float robot_speed_mps = kUnknown;    ///< towards the person: measured, or the scene's
  float human_speed_mps = kUnknown;    ///< towards the robot: measured, or the scene's
  float required_m = kUnknown;
  /// Of all pairs the least lo_m less what is required of it; below 0: too near. NaN: none judged.
  float min_slack_m = kUnknown;
  uint32_t people_too_close = 0;  ///< to how many people it is too near

  bool is_far() const { return hi_m == kFar; }
};

/// A robot too near to a region of a person, from the first frame to the one after the last.
struct Shortfall {
  uint32_t robot = 0, person = 0;
  BodyRegion region = BodyRegion::kOther;
  int64_t begin_frame = 0, end_frame = 0;
  float min_distance_lo_m = RegionSeparation::kFar, min_distance_hi_m = RegionSeparation::kFar;
  float max_shortfall_m = 0;  ///< what was required less lo_m, at most
  bool is_truncated = false;  ///< too near when the run began or ended
  /// More than the margin was required in some frame, so that it may have begun earlier and ended
  /// later.
  bool is_beyond_margin = false;
};

struct RegionTotals {
  bool is_there = false;  ///< people have such parts
  uint64_t shortfalls = 0;
  double shortfall_s = 0;  ///< of the robots, with anybody
  float min_distance_lo_m = RegionSeparation::kFar, min_distance_hi_m = RegionSeparation::kFar;
  float max_shortfall_m = 0;
};

struct SeparationTotals {
  std::array<RegionTotals, kBodyRegions> regions{};
  uint32_t robots = 0;
  uint64_t shortfalls = 0;
  uint64_t pairs = 0;          ///< of parts, over all frames
  uint64_t undetermined = 0;   ///< of these, without a speed that was to be measured
  uint64_t beyond_margin = 0;  ///< of these, that require more than the margin
};

class SeparationMonitor {
 public:
  /// Of a run whose scene has a separation.
  explicit SeparationMonitor(const RunInfo& run);

  /// All frames, one after another; with postures where speeds are measured.
  void frame(const RunInfo& run, const Frame& frame);
  /// What is too near ends here, cut.
  void end();

  /// Of the latest frame, by robot and region; of robots that are there and regions that people
  /// have.
  std::span<const RegionSeparation> rows() const { return rows_; }
  /// Began and ended in the latest frame or at the end, by (robot, person, region).
  std::span<const Shortfall> begun() const { return begun_; }
  std::span<const Shortfall> ended() const { return ended_; }
  const SeparationTotals& totals() const { return totals_; }
  std::span<const uint32_t> robots() const { return robots_; }

 private:
  /// A pair of parts, judged.
  struct JudgedPair {
    uint32_t robot_index = 0, person = 0;
    BodyRegion region = BodyRegion::kOther;
    RegionSeparation row;
    bool is_too_close() const { return row.lo_m < row.required_m; }
    bool is_judged() const { return row.required_m == row.required_m; }
    auto key() const { return std::tuple(robot_index, person, region); }
  };
  /// Where the parts of a robot were in the frame before.
  struct RobotParts {
    bool is_known = false;
    RootPose root;
    std::vector<PartPose> previous, current;
  };

  bool is_robot(uint32_t id) const { return id < robot_index_.size() && robot_index_[id] >= 0; }
  bool is_person(uint32_t id) const { return id < robot_index_.size() && robot_index_[id] < 0; }
  void pose_robots(const RunInfo& run, const Frame& frame);
  void remember_robots(const Frame& frame);
  void find(const ProximityPair& pair);
  double robot_speed_mps(const ProximityPair& pair, bool robot_is_a) const;
  void fill_rows(const Frame& frame);
  void judge(std::span<const JudgedPair> of_triple, size_t& open);
  void close(Shortfall shortfall, bool cut);

  SeparationRule rule_;
  double step_s_;
  float margin_m_;
  std::vector<int32_t> robot_index_;  ///< by avatar; -1: a person
  std::vector<uint32_t> robots_;
  std::vector<std::vector<BodyRegion>> regions_;  ///< by model and part
  std::vector<uint16_t> model_of_avatar_;
  std::vector<RobotParts> robot_parts_;  ///< by robot; where speeds are measured
  std::span<const RootPose> roots_;

  int64_t frame_ = 0;
  int64_t frames_seen_ = 0;  ///< nobody has a measured speed in the first
  std::vector<JudgedPair> judged_;
  std::vector<RegionSeparation> rows_;
  std::vector<Shortfall> open_, still_open_;  ///< by (robot, person, region)
  std::vector<Shortfall> begun_, ended_;
  SeparationTotals totals_;
};

}  // namespace throng
