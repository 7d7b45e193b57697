// Verdicts on what a crowd did beside what recorded people did.
// One rule: numbers in, readings and a verdict out; nothing is simulated here, so that made-up
// numbers can show that each criterion fails where it should.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/validation/reality_tables.h"
#include "analysis/validation/validation.h"

namespace throng::validation {

struct Judgement {
  bool passed = false;
  bool differs = false;  ///< as in Outcome
  std::string summary;
  std::vector<Reading> readings;
};
/// The outcome of a test with its verdict.
Outcome judged(Outcome outcome, Judgement judgement);

/// Of a door: people who came through, of so many, and how many a second.
struct DoorFlow {
  double width_m = 0;
  double flow_per_s = 0;
  int through = 0;
  int people = 0;
};
/// Each within 15 % of the experiments' mean at its width, never less through a wider one,
/// everybody through in the end. In ascending order of widths; each in the table.
Judgement judge_doors(std::span<const DoorFlow> flows);

/// What an area is like at a moment.
struct DensitySpeed {
  double density = 0;  ///< per m2, or per m of a single file
  double speed_mps = 0;
};
/// Fewer say nothing about a bin.
inline constexpr size_t kLeastSamples = 20;
/// Bins of the recording with enough of our samples count: their means are on average at most 15 %
/// of the free speed off, 70 % of them lie between the 10 and 90 % of the recording. At least half
/// of the recording's bins must be there: a crowd that never gets dense has shown nothing.
Judgement judge_speeds(const RecordedCurve& curve, std::span<const DensitySpeed> samples);

/// Time that people spent in each lane, in any unit: at most a share in the fullest.
Judgement judge_fullest_lane(std::span<const double> lanes, double most_share);
/// ... at least so many lanes with at least a share each.
Judgement judge_used_lanes(std::span<const double> lanes, int least_lanes, double least_share);

/// Somebody fast behind somebody slow.
struct Overtaking {
  bool passed = false;
  double lost_share = 0;  ///< of the time that the way takes alone
};
/// 95 % pass and lose at most 10 %.
Judgement judge_overtaking(std::span<const Overtaking> starts);

/// Flow both ways together, people per m and s, of crowds of their own, minute by minute: at least
/// 1.0 on average and in none of them ever below a tenth of that.
Judgement judge_two_way(std::span<const std::vector<double>> crowds_per_m_s);

/// Where people of two streams walk in a corridor along x, moment by moment.
struct TwoWayUse {
  static constexpr double kAtWall_m = 0.4, kCentral_m = 1, kAbreast_m = 0.5;

  double width_m = 0;
  std::vector<double> from_right_wall_m;
  /// Of those within kAbreast_m to either side: the square of the share that goes the same way less
  /// the share that comes.
  std::vector<double> lane_orders;
  std::vector<DensitySpeed> speeds;

  void add(TwoWayUse more);
};
/// Within kAtWall_m of a wall at most twice the recorded share of the time, in the central metre at
/// least three quarters of it, lane order at most 0.9, speeds within 10 % of the recorded at each
/// density with enough samples of both.
Judgement judge_two_way_use(const TwoWayUse& ours, const TwoWayUse& theirs);

/// Of so many people, those by the far exit: at least a third, and nobody left behind.
Judgement judge_far_exit(int near, int far, int people);

}  // namespace throng::validation
